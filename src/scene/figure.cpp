#include "scene/figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "draw/page/measure.h"
#include "draw/page/plot.h"
#include "draw/picture/color.h"
#include "draw/picture/formula.h"
#include "draw/picture/formula_values.h"
#include "scene/fields.h"
#include "scene/links.h"
#include "scene/picture.h"
#include "scene/scene.h"

namespace obscura::scene {

namespace {

constexpr double kLowestInPrint = 12;  // points: a figure's plot's axis
constexpr double kNarrowest = 0.08;    // of the picture's height: a plot with all that is beside its axis
constexpr double kLowestAxis = 0.05;   // of the picture's height: that of a plot
constexpr double kMostPlots = 0.75;    // of the picture: what plots take

// why a quantity of the whole room goes with no body
std::string of_room(std::string_view name) {
  return fmt::format("'{}' is of the whole room: leave 'of' out; of a body there are 'kinetic' and 'gravity'",
                     name);
}

draw::Quantity quantity(const std::string& word) {
  const draw::Measure* found = draw::measure(word);
  return found && found->arrow ? *found->arrow : draw::Quantity::position;
}

template <int D>
class Reader {
 public:
  Reader(const Seating<D>& roster, const sim::World<D>& world, Diagnostics& complaints,
         const draw::Pace& speed = {})
      : roster_(roster), world_(world), complaints_(complaints), speed_(speed) {}

  int body(const Fields& fields, const char* key) const {
    const Node* name = fields.given(key);
    if (!name) return -1;
    const std::vector<int> all = roster_.bodies(name->text(), name->place, complaints_);
    if (all.size() > 1) tell_one(*name, all.size());
    return all.empty() ? -1 : all.front();
  }
  std::vector<int> bodies(const Fields& fields, const char* key) const {
    std::vector<int> all;
    const Node* names = fields.given(key);
    for (const Node& each : names ? names->list() : Node::List{})
      for (const int body : roster_.bodies(each.text(), each.place, complaints_)) all.push_back(body);
    return all;
  }
  std::optional<draw::Site> site(const Fields& fields, const char* key) const {
    const Node* node = fields.given(key);
    return node ? site(*node) : std::nullopt;
  }
  std::optional<draw::Site> site(const Node& node) const {
    const std::vector<sim::End<D>> all = ends(node, roster_, world_, complaints_);
    if (all.empty()) return {};
    if (all.size() > 1)
      tell_one(node.is_text() ? node : node.is_table() ? *node.find("body") : node.list()[0], all.size());
    draw::Site site{all.front().body};
    site.local.template head<D>() = all.front().local;
    return site;
  }
  // the quantities of a plot, and their body
  draw::Measured measured(const Fields& fields) const {
    draw::Measured found;
    const Node* wanted = fields.given("quantity");
    for (const Node& each : wanted ? wanted->list() : Node::List{}) found.quantities.push_back(each.text());
    if (const Node* of = fields.given("of")) {
      const Node::List one{*of};
      for (const Node& each : of->is_list() ? of->list() : one)
        for (const int body : roster_.bodies(each.text(), each.place, complaints_))
          found.bodies.push_back(body);
    }
    if (const Node* against = fields.given("against")) found.against = against->text();
    if (const Node* range = fields.given("range"))
      found.range = {range->list()[0].number(), range->list()[1].number()};
    if (const draw::Measure* other = draw::measure(found.against);
        other && other->of == draw::Measure::Of::body && !fields.given("of"))
      complaints_.add(fields.place("against"),
                      fmt::format("a plot against '{}' needs 'of', the body that has it", found.against));
    const std::vector<const draw::Measure*> measures = found.measures();
    for (const draw::Measure* each : measures)
      if (std::string_view(each->unit) != measures[0]->unit) {
        complaints_.add(
            wanted->place,
            fmt::format("'{}' is in {} and '{}' in {}: an axis has one unit, give each a plot of its own",
                        measures[0]->name, measures[0]->unit, each->name, each->unit));
        break;
      }
    for (const draw::Measure* each : found.measures()) {
      if (!fields.given("of") && each->of == draw::Measure::Of::body)
        complaints_.add(fields.place(),
                        fmt::format("a plot of '{}' needs 'of', the body that has it", each->name));
      if (fields.given("of") && each->of == draw::Measure::Of::room)
        complaints_.add(fields.place("of"), of_room(each->name));
    }
    if (wanted && wanted->list().empty())
      complaints_.add(wanted->place, "'quantity': expected one at least, such as [\"energy\"]");
    return found;
  }
  // from when to when a mark is shown
  draw::Interval shown(const Fields& fields) const {
    draw::Interval interval{cue(fields, "start"), cue(fields, "end")};
    const auto &start = interval.start, &end = interval.end;
    if (start && end && (end->after && start->after ? end->film <= start->film : end->time < start->time))
      complaints_.add(fields.place("end"), "'end' comes before 'start': it would never be shown");
    return interval;
  }
  // the same, and in which panels of a figure
  draw::Interval marked(const Fields& fields, bool film) const {
    draw::Interval interval = shown(fields);
    interval.panels = fields.text("panel");
    if (film && fields.given("panel"))
      complaints_.add(fields.place("panel"),
                      "'panel' is of figures: a film shows its marks from 'start' to 'end'");
    else if (interval.panels.find_first_not_of("abcdefghijklmnopqrstuvwxyz") != std::string::npos)
      complaints_.add(
          fields.place("panel"),
          fmt::format("'panel': expected the letters of panels, as in \"a\" or \"bc\", got \"{}\"",
                      interval.panels));
    return interval;
  }
  // what is not whole or not known in a part of the text, and where; whether there is something
  bool mathematics(const Fields& fields, const char* key, std::size_t from = 0,
                   std::size_t length = std::string::npos) const {
    if (!fields.given(key)) return false;
    const std::string& text = fields.text(key);
    const auto wrong = draw::mistake(std::string_view(text).substr(from, length));
    if (!wrong) return false;
    const auto before = std::count_if(text.begin(), text.begin() + std::ptrdiff_t(from),
                                      [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
    complaints_.add(fields.place(key), fmt::format("'{}', column {}: {}", key,
                                                   wrong->column + std::size_t(before), wrong->what));
    return true;
  }
  // what a label says, and whether the value in it can be shown
  std::string label(const Fields& fields, const char* key, bool valued = true) const {
    const std::string& text = fields.text(key);
    mathematics(fields, key);
    const auto slot = draw::value_slot(text);
    if (const auto typed = text.find("{:"); typed != text.npos && !slot)
      complaints_.add(fields.place(key),
                      fmt::format("'{}': expected {{}} or {{:.2}}, the number of decimals, got \"{}\"", key,
                                  text.substr(typed, text.find('}', typed) - typed + 1)));
    // in mathematics an empty group may carry a script, as in {}^{14}C
    const auto script = [&](std::size_t at) {
      return at < text.size() && (text[at] == '^' || text[at] == '_');
    };
    const bool group =
        slot && !slot->decimals && (script(slot->end) || (slot->begin > 0 && script(slot->begin - 1)));
    if (slot && !valued && !group)
      complaints_.add(fields.place(key), fmt::format("'{}' has no value to show: {} stands for one", key,
                                                     text.substr(slot->begin, slot->end - slot->begin)));
    if (slot && valued && draw::value_slot(std::string_view(text).substr(slot->end)))
      complaints_.add(fields.place(key), fmt::format("'{}' shows one value, and has two places for it", key));
    return text;
  }
  static std::optional<draw::Color> color(const Fields& fields) {
    const Node* node = fields.given("color");
    return node && node->is_text() ? draw::color(node->text()) : std::nullopt;
  }

 private:
  void tell_one(const Node& name, std::size_t count) const {
    complaints_.add(name.place, fmt::format("{} is {} bodies, and one is wanted: say which",
                                            scene::in_quotes(name.text()), count));
  }
  std::optional<draw::Cue> cue(const Fields& fields, const char* key) const {
    const Node* node = fields.given(key);
    if (!node) return {};
    if (!node->is_table()) return draw::Cue{sim::value(exact(*node))};
    draw::Cue cue{sim::value(exact(*node->find("time")))};
    if (const Node* after = node->find("after"))
      cue.after = true,
      cue.film = sim::value(speed_.film(exact(*node->find("time")))) + sim::value(exact(*after));
    return cue;
  }

  const Seating<D>& roster_;
  const sim::World<D>& world_;
  Diagnostics& complaints_;
  draw::Pace speed_;
};

const Node::List& tables(const Fields& fields, const char* key) {
  static const Node::List none;
  const Node* node = fields.given(key);
  return node ? node->list() : none;
}

// What a vector's `with` names, as readings have it (draw::Reading::part): what is touched, springs, or
// joints.
template <int D>
std::vector<int> its_others(const Node& with, draw::Quantity quantity, const WhenNames<D>& names,
                            Diagnostics& complaints) {
  const std::string& text = with.text();
  std::vector<int> found;
  switch (quantity) {
    case draw::Quantity::contact:
    case draw::Quantity::normal_force:
    case draw::Quantity::friction:
    case draw::Quantity::impulse:
    case draw::Quantity::normal:
      return names.side(with);
    case draw::Quantity::spring:
    case draw::Quantity::spring_force:
      found = names.springs_called(text);
      if (found.empty())
        complaints.add(with.place, fmt::format("no spring is called {}", scene::in_quotes(text)));
      return found;
    case draw::Quantity::joint_force:
    case draw::Quantity::joint_torque:
      found = names.joints(text);
      if (found.empty()) complaints.add(with.place, names.unknown_joint(text));
      return found;
    default:
      complaints.add(
          with.place,
          "'with' is of forces that have one arrow for each thing: contact, normal_force, friction, "
          "impulse, normal, spring_force, spring, joint_force, joint_torque");
      return {};
  }
}

// The marks of [figure] or [film].
template <int D>
draw::Marks read_marks(const Fields& fields, const std::string& owner, const Reader<D>& read,
                       const WhenNames<D>& names, Diagnostics& complaints) {
  draw::Marks marks;
  const bool film = owner == "film";
  marks.axes = fields.flag("axes");
  for (const Node& node : tables(fields, "point")) {
    const Fields its(node, owner + ".point");
    if (const auto at = read.site(its, "at"))
      marks.points.push_back(
          {*at, read.label(its, "label", false), its.flag("dot"), read.color(its), read.marked(its, film)});
  }
  for (const Node& node : tables(fields, "vector")) {
    const Fields its(node, owner + ".vector");
    draw::Marks::Vector vector{quantity(its.text("quantity")), read.body(its, "of"),     read.site(its, "at"),
                               read.site(its, "to"),           read.label(its, "label"), read.color(its),
                               read.marked(its, film)};
    const bool position = vector.quantity == draw::Quantity::position;
    // one that names no body here is told of at its place
    if (!its.given("of") && !(position && vector.to))
      complaints.add(node.place, position ? "a position needs 'to', a place, or 'of', a body"
                                          : "this vector needs 'of', the body that has it");
    if (its.given("with")) vector.with = its_others(*its.given("with"), vector.quantity, names, complaints);
    marks.vectors.push_back(vector);
  }
  for (const Node& node : tables(fields, "angle")) {
    const Fields its(node, owner + ".angle");
    marks.angles.push_back({read.body(its, "of"), read.site(its, "at"), read.site(its, "from"),
                            read.site(its, "to"), read.label(its, "label"), read.marked(its, film)});
    if (!its.given("of") && (!its.given("at") || !its.given("from") || !its.given("to")))
      complaints.add(node.place, "an angle needs 'of', a body, or 'at', 'from' and 'to', three places");
    if (D == 3 && its.given("of"))
      complaints.add(its.place("of"), "in space a body has no one angle: 'at', 'from' and 'to' say which");
  }
  for (const Node& node : tables(fields, "cone")) {
    const Fields its(node, owner + ".cone");
    marks.cones.push_back({read.body(its, "of"), read.label(its, "label"), read.marked(its, film)});
  }
  for (const Node& node : tables(fields, "length")) {
    const Fields its(node, owner + ".length");
    const Node* between = its.given("between");
    if (!between) continue;
    const auto from = read.site(between->list()[0]), to = read.site(between->list()[1]);
    if (from && to)
      marks.lengths.push_back(
          {*from, *to, read.label(its, "label"), its.number("offset"), read.marked(its, film)});
  }
  for (const Node& node : tables(fields, "label")) {
    const Fields its(node, owner + ".label");
    const auto at = read.site(its, "at");
    if (!at || !its.given("text")) continue;
    draw::Marks::Label label{*at, read.label(its, "text", its.given("quantity")), "", read.body(its, "of"),
                             read.marked(its, film)};
    if (its.given("quantity")) label.quantity = its.text("quantity");
    if (const draw::Measure* shown = draw::measure(label.quantity)) {
      if (shown->of == draw::Measure::Of::body && label.body < 0)
        complaints.add(its.place("quantity"),
                       fmt::format("a label of '{}' needs 'of', the body that has it", label.quantity));
      if (shown->of == draw::Measure::Of::room && label.body >= 0)
        complaints.add(its.place("of"), of_room(label.quantity));
    }
    marks.labels.push_back(label);
  }
  for (const Node& node : tables(fields, "path")) {
    const Fields its(node, owner + ".path");
    const auto at = read.site(its, "at");
    if (!at) continue;
    if (at->body < 0) complaints.add(its.place("at"), "a place of the room has no path: expected a body");
    const Node* lasting = its.given("lasting");
    marks.paths.push_back(
        {*at, lasting ? lasting->number() : 0, its.flag("front"), read.color(its), read.marked(its, film)});
  }
  for (const Node& node : tables(fields, "ghost")) {
    const Fields its(node, owner + ".ghost");
    if (!its.given("time")) continue;
    draw::Marks::Ghost ghost{its.rational("time"), read.bodies(its, "of"), read.marked(its, film)};
    if (!ghost.shown.start) ghost.shown.start = draw::Cue{sim::value(ghost.time)};
    marks.ghosts.push_back(ghost);
  }
  return marks;
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
  figure.formula = fields.text("formula");
  read.mathematics(fields, "formula");
  figure.times_of = read.body(fields, "times_of");
  const std::string& titles = fields.text("titles");
  for (std::size_t from = 0; fields.given("titles") && from <= titles.size();) {
    const std::size_t end = std::min(titles.find(';', from), titles.size());
    const std::size_t first = std::min(titles.find_first_not_of(' ', from), end);
    figure.titles.push_back(titles.substr(first, end - first));
    if (read.mathematics(fields, "titles", first, end - first)) break;
    from = end + 1;
  }
  figure.vary = fields.text("vary");
  if (const auto equals = figure.vary.find('=');
      fields.given("vary") && (equals == 0 || equals == std::string::npos))
    complaints.add(fields.place("vary"),
                   "'vary': expected a path and its values, as in \"crate.elasticity=0,0.5,1\"");
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
  if (!(plot.from < plot.to)) complaints.add(its.place("from"), "a plot needs 'from' before 'to'");
  return plot;
}

}  // namespace

template <int D>
draw::Figure figure(const WhenNames<D>& names, const Seating<D>& roster, const sim::World<D>& world,
                    Diagnostics& complaints) {
  draw::Figure figure;
  const Node& top = names.top;
  const Fields fields = Fields::of(top, "figure");
  const Reader<D> read(roster, world, complaints);
  read_frame(fields, read, complaints, figure);
  static_cast<draw::Marks&>(figure) = read_marks<D>(fields, "figure", read, names, complaints);
  for (const Node& node : tables(fields, "plot"))
    figure.plots.push_back(plot_of(top, node, read, complaints));
  if (!figure.room && figure.plots.empty())
    complaints.add(fields.place("room"), "a figure without its picture needs a plot: [[figure.plot]]");
  return figure;
}

template <int D>
std::vector<draw::Caption> captions(const Node& top, const Seating<D>& roster, const sim::World<D>& world,
                                    const draw::Pace& speed, Diagnostics& complaints) {
  const Reader<D> read(roster, world, complaints, speed);
  const Fields fields = Fields::of(top, "film");
  const sim::Rational duration = Fields(top, "").rational("duration");
  const Node* given = top.find("duration");
  const bool shortened = given && given->place.set > 0;
  std::vector<draw::Caption> all;
  for (const Node& node : tables(fields, "caption")) {
    const Fields its(node, "film.caption");
    if (!its.given("text")) continue;
    draw::Caption caption{prose(its, "text", complaints), read.shown(its)};
    const auto film = [&](const draw::Cue& cue) {
      if (cue.after) return cue.film;
      const auto exact = sim::from_double(cue.time);
      return exact ? sim::value(speed.film(*exact)) : cue.time;
    };
    const double ends = sim::value(duration);
    // what waits for a mark that does not come is silent, and what a shorter run by --set leaves out
    if (caption.shown.start && caption.shown.start->time > ends &&
        caption.shown.start->time < double(kNever) && !shortened)
      complaints.add(its.place("start"),
                     fmt::format("a caption from {:g} s on is never shown: the scene ends at {:g} s",
                                 caption.shown.start->time, ends));
    if (caption.shown.start) caption.begin = film(*caption.shown.start);
    if (caption.shown.end) caption.end = film(*caption.shown.end);
    all.push_back(std::move(caption));
  }
  return all;
}

template <int D>
std::vector<draw::Chart> charts(const Node& top, const Seating<D>& roster, const sim::World<D>& world,
                                Diagnostics& complaints) {
  const Fields fields = Fields::of(top, "film");
  const Reader<D> read(roster, world, complaints);
  std::vector<draw::Chart> all;
  const std::size_t before = complaints.count();
  double below = 0, right = 0;
  bool sound = true;
  std::optional<Place> crowded;  // the first plot that has no room
  for (const Node& node : tables(fields, "plot")) {
    const Fields its(node, "film.plot");
    sound = sound && its.given("quantity");
    draw::Chart chart{read.measured(its)};
    chart.place = its.text("place") == "right" ? draw::Chart::Place::right : draw::Chart::Place::below;
    chart.share = its.number("size") / 100;
    if (chart.place == draw::Chart::Place::below) below += chart.share;
    if (chart.place == draw::Chart::Place::right) right = std::max(right, chart.share);
    if (std::max(below, right) > kMostPlots && !crowded) crowded = its.place("size");
    all.push_back(chart);
  }
  // plots with other mistakes may have to go
  if (crowded && sound && complaints.count() == before)
    complaints.add(*crowded, fmt::format("the plots take {:.0f} percent of the picture: {:.0f} is the most",
                                         100 * std::max(below, right), 100 * kMostPlots));
  return all;
}

void refuse_low_plots(const Node& top, const draw::Figure& figure, const Film& film, double type_scale,
                      Diagnostics& complaints) {
  if (!complaints.none()) return;
  const double least = ((draw::kPlotAbove + draw::kPlotBelow) * type_scale + kLowestInPrint) * 25.4 / 72;
  for (std::size_t i = 0; i < figure.plots.size(); ++i) {
    if (figure.plots[i].height >= least) continue;
    complaints.add(
        Fields(tables(Fields::of(top, "figure"), "plot")[i], "figure.plot").place("height"),
        fmt::format("there is no room for this plot: its title and its numbers take {:.1f} mm, and "
                    "its axis 4 at least; give it a 'height' of {:.0f}",
                    least - kLowestInPrint * 25.4 / 72, std::ceil(least)));
    return;
  }
  if (film.charts.empty()) return;
  const double aspect = double(film.width) / film.height;
  const double foot = draw::laid_out(film.titles, aspect, type_scale).foot;
  const std::vector<double> heights = draw::Charts::axis_heights(film.charts, aspect, foot, type_scale);
  const std::vector<Node>& nodes = tables(Fields::of(top, "film"), "plot");
  const std::vector<double> widths = draw::Charts::widths(film.charts, aspect, foot);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (widths[i] < kNarrowest * 1080) {
      complaints.add(
          Fields(nodes[i], "film.plot").place("size"),
          fmt::format("there is no room for this plot: it would be {:.0f} of the picture's {} pixels "
                      "wide; give it a larger 'size'",
                      std::max(0.0, widths[i] * film.height / 1080), film.width));
      return;
    }
    if (heights[i] >= kLowestAxis * 1080) continue;
    const bool right = film.charts[i].place == draw::Chart::Place::right;
    complaints.add(
        Fields(nodes[i], "film.plot").place("size"),
        fmt::format(
            "there is no room for this plot: its axis would be {:.0f} of the picture's {} pixels high; {}",
            std::max(0.0, heights[i] * film.height / 1080), film.height,
            right ? "put fewer plots at the right, or give those below a smaller 'size'"
                  : "give it a larger 'size'"));
    return;
  }
}

template <int D>
draw::Marks film_marks(const WhenNames<D>& names, const Seating<D>& roster, const sim::World<D>& world,
                       const draw::Pace& speed, Diagnostics& complaints) {
  const Node& top = names.top;
  const Fields fields = Fields::of(top, "film");
  draw::Marks marks =
      read_marks<D>(fields, "film", Reader<D>(roster, world, complaints, speed), names, complaints);
  if (!fields.flag("figure")) return marks;
  // what the figure says comes first; it has been checked
  Diagnostics known("", {});
  const WhenNames<D> silent{top, roster, names.springs, names.bonds, names.model, names.constants, known};
  draw::Marks own = read_marks<D>(Fields::of(top, "figure"), "figure", Reader<D>(roster, world, known, speed),
                                  silent, known);
  // a film has no panels
  const auto unbound = [](auto& all) {
    std::erase_if(all, [](const auto& mark) { return !mark.shown.panels.empty(); });
  };
  unbound(own.points), unbound(own.vectors), unbound(own.angles), unbound(own.lengths), unbound(own.cones);
  unbound(own.labels), unbound(own.paths), unbound(own.ghosts);
  own.axes = own.axes || marks.axes;
  const auto join = [](auto& to, auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  join(own.points, marks.points), join(own.vectors, marks.vectors), join(own.angles, marks.angles);
  join(own.lengths, marks.lengths), join(own.cones, marks.cones), join(own.labels, marks.labels);
  join(own.paths, marks.paths), join(own.ghosts, marks.ghosts);
  return own;
}

template draw::Figure figure<2>(const WhenNames<2>&, const Seating<2>&, const sim::World<2>&, Diagnostics&);
template draw::Figure figure<3>(const WhenNames<3>&, const Seating<3>&, const sim::World<3>&, Diagnostics&);
template draw::Marks film_marks<2>(const WhenNames<2>&, const Seating<2>&, const sim::World<2>&,
                                   const draw::Pace&, Diagnostics&);
template draw::Marks film_marks<3>(const WhenNames<3>&, const Seating<3>&, const sim::World<3>&,
                                   const draw::Pace&, Diagnostics&);
template std::vector<draw::Caption> captions<2>(const Node&, const Seating<2>&, const sim::World<2>&,
                                                const draw::Pace&, Diagnostics&);
template std::vector<draw::Caption> captions<3>(const Node&, const Seating<3>&, const sim::World<3>&,
                                                const draw::Pace&, Diagnostics&);
template std::vector<draw::Chart> charts<2>(const Node&, const Seating<2>&, const sim::World<2>&,
                                            Diagnostics&);
template std::vector<draw::Chart> charts<3>(const Node&, const Seating<3>&, const sim::World<3>&,
                                            Diagnostics&);

}  // namespace obscura::scene
