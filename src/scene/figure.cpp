#include "scene/figure.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "draw/picture/color.h"
#include "scene/fields.h"
#include "scene/links.h"

namespace obscura::scene {

namespace {

draw::Quantity quantity(const std::string& word) {
  using enum draw::Quantity;
  constexpr std::array<std::pair<const char*, draw::Quantity>, 10> words{{{"position", position},
                                                                          {"velocity", velocity},
                                                                          {"weight", weight},
                                                                          {"spring", spring},
                                                                          {"contact", contact},
                                                                          {"impulse", impulse},
                                                                          {"blast", blast},
                                                                          {"normal", normal},
                                                                          {"spin", spin},
                                                                          {"torque", torque}}};
  for (const auto& [known, value] : words)
    if (word == known) return value;
  return position;
}

template <int D>
class Reader {
 public:
  Reader(const Seating<D>& roster, const sim::World<D>& world, Diagnostics& complaints)
      : roster_(roster), world_(world), complaints_(complaints) {}

  int body(const Fields& fields, const char* key) const {
    const Node* name = fields.given(key);
    if (!name) return -1;
    const std::vector<int> all = roster_.bodies(name->text(), name->place, complaints_);
    return all.empty() ? -1 : all.front();
  }
  std::optional<draw::Site> site(const Fields& fields, const char* key) const {
    const Node* node = fields.given(key);
    return node ? site(*node) : std::nullopt;
  }
  std::optional<draw::Site> site(const Node& node) const {
    const std::vector<sim::End<D>> all = ends(node, roster_, world_, complaints_);
    if (all.empty()) return {};
    draw::Site site{all.front().body};
    site.local.template head<D>() = all.front().local;
    return site;
  }
  // the quantities of a plot, and their body
  draw::Measured measured(const Fields& fields) const {
    draw::Measured found;
    const Node* wanted = fields.given("quantity");
    for (const Node& each : wanted ? wanted->list() : Node::List{}) found.quantities.push_back(each.text());
    found.body = body(fields, "of");
    if (!fields.given("of"))
      for (const draw::Measure* each : found.measures())
        if (each->of_body)
          complaints_.add(fields.place(),
                          fmt::format("a plot of '{}' needs 'of', the body that has it", each->name));
    if (wanted && wanted->list().empty())
      complaints_.add(wanted->place, "'quantity': expected one at least, such as [\"energy\"]");
    return found;
  }
  static std::optional<draw::Color> color(const Fields& fields) {
    const Node* node = fields.given("color");
    return node && node->is_text() ? draw::color(node->text()) : std::nullopt;
  }

 private:
  const Seating<D>& roster_;
  const sim::World<D>& world_;
  Diagnostics& complaints_;
};

const Node::List& tables(const Fields& fields, const char* key) {
  static const Node::List none;
  const Node* node = fields.given(key);
  return node ? node->list() : none;
}

// the instants, the size and the extent of the picture
template <int D>
void read_frame(const Fields& fields, const Reader<D>& read, Diagnostics& complaints, draw::Figure& figure) {
  if (const Node* at = fields.given("at")) {
    if (at->is_list())
      for (const Node& each : at->list()) figure.at.push_back(exact(each));
    else
      figure.at.push_back(exact(*at));
  }
  figure.impact = read.body(fields, "impact");
  if (const Node* width = fields.given("width")) figure.width = width->number();
  const auto corner = [&](const char* key, std::optional<sim::Vec3>& to) {
    if (!fields.given(key)) return;
    to = sim::Vec3::Zero();
    to->template head<D>() = fields.template vector<D>(key);
  };
  corner("low", figure.low), corner("high", figure.high);
  if (figure.low.has_value() != figure.high.has_value() ||
      (figure.low &&
       !(figure.high->template head<D>().array() > figure.low->template head<D>().array()).all()))
    complaints.add(fields.place(figure.low ? "low" : "high"),
                   "'low' and 'high' are the corners of what is shown: both, the lower left one first");
  if (fields.given("every")) figure.every = fields.rational("every");
  if (const Node* columns = fields.given("columns")) figure.columns = int(columns->number());
  figure.room = fields.flag("room");
  figure.scale_bar = fields.flag("scale_bar");
  figure.axes = fields.flag("axes");
  figure.formula = fields.text("formula");
  figure.vary = fields.text("vary");
  if (const auto equals = figure.vary.find('=');
      fields.given("vary") && (equals == 0 || equals == std::string::npos))
    complaints.add(fields.place("vary"),
                   "'vary': expected a path and its values, as in \"crate.elasticity=0,0.5,1\"");
}

template <int D>
void read_vectors(const Fields& fields, const Reader<D>& read, Diagnostics& complaints,
                  draw::Figure& figure) {
  for (const Node& node : tables(fields, "vector")) {
    const Fields its(node, "figure.vector");
    draw::Figure::Vector vector{quantity(its.text("quantity")), read.body(its, "of"), read.site(its, "at"),
                                read.site(its, "to"),           its.text("label"),    read.color(its)};
    const bool position = vector.quantity == draw::Quantity::position;
    if (position ? !vector.to && vector.body < 0 : vector.body < 0)
      complaints.add(node.place, position ? "a position needs 'to', a place, or 'of', a body"
                                          : "this vector needs 'of', the body that has it");
    figure.vectors.push_back(vector);
  }
}

template <int D>
void read_angles(const Fields& fields, const Reader<D>& read, Diagnostics& complaints, draw::Figure& figure) {
  for (const Node& node : tables(fields, "angle")) {
    const Fields its(node, "figure.angle");
    draw::Figure::Angle angle{read.body(its, "of"), read.site(its, "at"), read.site(its, "from"),
                              read.site(its, "to"), its.text("label")};
    if (!its.given("of") && (!its.given("at") || !its.given("from") || !its.given("to")))
      complaints.add(node.place, "an angle needs 'of', a body, or 'at', 'from' and 'to', three places");
    if (D == 3 && its.given("of"))
      complaints.add(its.place("of"), "in space a body has no one angle: 'at', 'from' and 'to' say which");
    figure.angles.push_back(angle);
  }
}

// points, cones, lengths and labels
template <int D>
void read_marks(const Fields& fields, const Reader<D>& read, draw::Figure& figure) {
  for (const Node& node : tables(fields, "point")) {
    const Fields its(node, "figure.point");
    if (const auto at = read.site(its, "at"))
      figure.points.push_back({*at, its.text("label"), its.flag("dot"), read.color(its)});
  }
  for (const Node& node : tables(fields, "cone")) {
    const Fields its(node, "figure.cone");
    figure.cones.push_back({read.body(its, "of"), its.text("label")});
  }
  for (const Node& node : tables(fields, "length")) {
    const Fields its(node, "figure.length");
    const Node* between = its.given("between");
    if (!between) continue;
    const auto from = read.site(between->list()[0]), to = read.site(between->list()[1]);
    if (from && to) figure.lengths.push_back({*from, *to, its.text("label"), its.number("offset")});
  }
  for (const Node& node : tables(fields, "label")) {
    const Fields its(node, "figure.label");
    const auto at = read.site(its, "at");
    if (at && its.given("text")) figure.labels.push_back({*at, its.text("text")});
  }
}

template <int D>
draw::Figure::Plot plot_of(const Node& top, const Node& node, const Reader<D>& read,
                           Diagnostics& complaints) {
  const Fields its(node, "figure.plot");
  draw::Figure::Plot plot;
  static_cast<draw::Measured&>(plot) = read.measured(its);
  plot.from = its.rational("from");
  plot.to = its.given("to") ? its.rational("to") : Fields(top, "").rational("duration");
  plot.height = its.number("height");
  if (const Node* against = its.given("against")) plot.against = against->text();
  plot.over = its.text("over");
  plot.reference = its.text("reference");
  plot.log = its.text("scale") == "log";
  const auto equals = plot.over.find('=');
  if (its.given("over") && (equals == 0 || equals == std::string::npos))
    complaints.add(its.place("over"),
                   "'over': expected a path and its values, as in \"physics.rate=10,20,40\"");
  if (its.given("over") && its.given("against"))
    complaints.add(its.place("against"), "a plot is 'against' a quantity or 'over' a key, not both");
  if (its.given("reference") && !its.given("over"))
    complaints.add(its.place("reference"), "'reference' is for a plot 'over' a key");
  if (const draw::Measure* other = draw::measure(plot.against); other && other->of_body && plot.body < 0)
    complaints.add(its.place("against"),
                   fmt::format("a plot against '{}' needs 'of', the body that has it", plot.against));
  if (!(plot.from < plot.to)) complaints.add(its.place("from"), "a plot needs 'from' before 'to'");
  return plot;
}

}  // namespace

template <int D>
draw::Figure figure(const Node& top, const Seating<D>& roster, const sim::World<D>& world,
                    Diagnostics& complaints) {
  draw::Figure figure;
  const Fields fields = Fields::of(top, "figure");
  const Reader<D> read(roster, world, complaints);
  read_frame(fields, read, complaints, figure);
  read_marks(fields, read, figure);
  read_vectors(fields, read, complaints, figure);
  read_angles(fields, read, complaints, figure);
  for (const Node& node : tables(fields, "plot"))
    figure.plots.push_back(plot_of(top, node, read, complaints));
  if (!figure.room && figure.plots.empty())
    complaints.add(fields.place("room"), "a figure without its picture needs a plot: [[figure.plot]]");
  return figure;
}

template <int D>
std::vector<draw::Chart> charts(const Node& top, const Seating<D>& roster, const sim::World<D>& world,
                                Diagnostics& complaints) {
  const Fields fields = Fields::of(top, "film");
  const Reader<D> read(roster, world, complaints);
  std::vector<draw::Chart> all;
  double below = 0, right = 0;
  for (const Node& node : tables(fields, "plot")) {
    const Fields its(node, "film.plot");
    draw::Chart chart{read.measured(its)};
    chart.place = its.text("place") == "right" ? draw::Chart::Place::right : draw::Chart::Place::below;
    chart.share = its.number("size") / 100;
    if (chart.place == draw::Chart::Place::below) below += chart.share;
    if (chart.place == draw::Chart::Place::right) right = std::max(right, chart.share);
    if (std::max(below, right) > 0.75 && all.size() < 100)
      complaints.add(its.place("size"),
                     fmt::format("the plots take {:.0f} percent of the picture: 75 is the most",
                                 100 * std::max(below, right)));
    all.push_back(chart);
  }
  return all;
}

template draw::Figure figure<2>(const Node&, const Seating<2>&, const sim::World<2>&, Diagnostics&);
template draw::Figure figure<3>(const Node&, const Seating<3>&, const sim::World<3>&, Diagnostics&);
template std::vector<draw::Chart> charts<2>(const Node&, const Seating<2>&, const sim::World<2>&,
                                            Diagnostics&);
template std::vector<draw::Chart> charts<3>(const Node&, const Seating<3>&, const sim::World<3>&,
                                            Diagnostics&);

}  // namespace obscura::scene
