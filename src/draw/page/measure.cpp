#include "draw/page/measure.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "draw/page/readings.h"

namespace obscura::draw {
namespace {

constexpr double kDegrees = 57.29577951308232;
// of what words tell as zero: rounding, and that of energies, which go with the squares of speeds
constexpr double kOfRounding = 1e-3, kOfRoundingOfSquares = 1e-6;

using Now = const sim::Snapshot&;

const sim::Snapshot::Body& of(Now now, int body) {
  static const sim::Snapshot::Body none;
  return body < 0 ? none : now.bodies[std::size_t(body)];
}

/// The first spring that holds it; one of no length where none does.
const sim::Snapshot::Spring& spring(Now now, int body) {
  static const sim::Snapshot::Spring none;
  for (const sim::Snapshot::Spring& each : now.springs)
    if (body >= 0 && !each.loose && (each.holds_a == body || each.holds_b == body)) return each;
  return none;
}

using Cast = const sim::SceneInfo&;

/// How long the sum of a body's arrows is.
template <Quantity quantity>
double length(Cast cast, Now now, int body) {
  return sum(quantity, body, cast, now).norm();
}

/// A number, of all the room or of a body.
constexpr Measure number(std::string_view name, const char* label, const char* unit, std::string_view color,
                         Measure::Of of, double (*read)(Cast, Now, int)) {
  return {name, label, unit, color, of, read, {}};
}

/// What arrows show; its number is how long their sum is, where that says something.
constexpr Measure vector(std::string_view name, const char* label, const char* unit, std::string_view color,
                         Quantity quantity, double (*read)(Cast, Now, int)) {
  return {name, label, unit, color, Measure::Of::body, read, quantity};
}

constexpr std::array kMeasures{
    number("energy", "total", "J", "", Measure::Of::room,
           [](Cast, Now now, int) { return now.energies.total(); }),
    number("kinetic", "kinetic", "J", "orange", Measure::Of::either,
           [](Cast, Now now, int body) { return body < 0 ? now.energies.kinetic : of(now, body).kinetic; }),
    number("potential", "potential", "J", "purple", Measure::Of::room,
           [](Cast, Now now, int) { return now.energies.potential(); }),
    number("gravity", "gravity", "J", "purple", Measure::Of::either,
           [](Cast, Now now, int body) { return body < 0 ? now.energies.gravity : of(now, body).gravity; }),
    number("springs", "springs", "J", "sky", Measure::Of::room,
           [](Cast, Now now, int) { return now.energies.springs; }),
    number("fields", "fields", "J", "grey", Measure::Of::room,
           [](Cast, Now now, int) { return now.energies.fields; }),
    number("hand", "hand", "J", "sky", Measure::Of::room,
           [](Cast, Now now, int) { return now.energies.hand; }),
    number("work", "work", "J", "grey", Measure::Of::room,
           [](Cast, Now now, int) { return now.energies.work; }),
    number("x", "x", "m", "blue", Measure::Of::body,
           [](Cast, Now now, int body) { return of(now, body).position.x(); }),
    number("height", "height", "m", "blue", Measure::Of::body,
           [](Cast, Now now, int body) { return of(now, body).position.y(); }),
    number("speed", "speed", "m/s", "green", Measure::Of::body,
           [](Cast, Now now, int body) { return of(now, body).velocity.norm(); }),
    number("vx", "v_x", "m/s", "blue", Measure::Of::body,
           [](Cast, Now now, int body) { return of(now, body).velocity.x(); }),
    number("vy", "v_y", "m/s", "green", Measure::Of::body,
           [](Cast, Now now, int body) { return of(now, body).velocity.y(); }),
    number("angle", "\\theta", "°", "", Measure::Of::body,
           [](Cast, Now now, int body) { return kDegrees * of(now, body).angle; }),
    vector("spin", "\\omega", "rad/s", "", Quantity::spin,
           [](Cast, Now now, int body) { return of(now, body).spin.z(); }),
    number("length", "l", "m", "blue", Measure::Of::body,
           [](Cast, Now now, int body) { return (spring(now, body).b - spring(now, body).a).norm(); }),
    number("push", "f", "N", "vermilion", Measure::Of::body,
           [](Cast, Now now, int body) { return spring(now, body).push; }),
    vector("acceleration", "a", "m/s²", "purple", Quantity::acceleration, length<Quantity::acceleration>),
    vector("momentum", "p", "kg m/s", "green", Quantity::momentum, length<Quantity::momentum>),
    vector("weight", "weight", "N", "vermilion", Quantity::weight, length<Quantity::weight>),
    vector("normal_force", "normal", "N", "vermilion", Quantity::normal_force,
           length<Quantity::normal_force>),
    vector("friction", "friction", "N", "vermilion", Quantity::friction, length<Quantity::friction>),
    vector("net_force", "net", "N", "vermilion", Quantity::net_force, length<Quantity::net_force>),
    vector("spring_force", "spring", "N", "vermilion", Quantity::spring_force,
           length<Quantity::spring_force>),
    vector("joint_force", "joint", "N", "vermilion", Quantity::joint_force, length<Quantity::joint_force>),
    vector("drag", "drag", "N", "vermilion", Quantity::drag, length<Quantity::drag>),
    vector("field", "field", "N", "vermilion", Quantity::field, length<Quantity::field>),
    vector("contact", "contact", "N", "vermilion", Quantity::contact, length<Quantity::contact>),
    vector("blast", "blast", "N", "vermilion", Quantity::blast, length<Quantity::blast>),
    vector("torque", "\\tau", "N m", "", Quantity::torque,
           [](Cast cast, Now now, int body) {
             const sim::Vec3 all = sum(Quantity::torque, body, cast, now);
             return cast.dimension == 2 ? all.z() : all.norm();
           }),
    vector("joint_torque", "\\tau_\\text{joint}", "N m", "", Quantity::joint_torque,
           [](Cast cast, Now now, int body) {
             const sim::Vec3 all = sum(Quantity::joint_torque, body, cast, now);
             return cast.dimension == 2 ? all.z() : all.norm();
           }),
    vector("position", "r", "m", "blue", Quantity::position, nullptr),
    vector("velocity", "v", "m/s", "green", Quantity::velocity, nullptr),
    vector("spring", "spring", "N", "green", Quantity::spring, nullptr),
    vector("impulse", "J", "N s", "vermilion", Quantity::impulse, nullptr),
    vector("normal", "n", "", "", Quantity::normal, nullptr),
};

std::vector<std::string> names(bool (*wanted)(const Measure&)) {
  std::vector<std::string> all;
  for (const Measure& each : kMeasures)
    if (wanted(each)) all.emplace_back(each.name);
  return all;
}

}  // namespace

std::vector<std::string> plotted() {
  return names([](const Measure& each) { return each.read != nullptr; });
}

std::vector<std::string> arrows() {
  return names([](const Measure& each) { return each.arrow.has_value(); });
}

const Measure* measure(std::string_view name) {
  const auto found = std::find_if(kMeasures.begin(), kMeasures.end(),
                                  [&](const Measure& each) { return each.name == name; });
  return found == kMeasures.end() ? nullptr : &*found;
}

std::vector<const Measure*> Measured::measures() const {
  std::vector<const Measure*> all;
  for (const std::string& name : quantities)
    if (const Measure* found = measure(name)) all.push_back(found);
  return all;
}

namespace {

/// What several quantities of one unit are called together.
std::string symbol(std::string_view unit) {
  static constexpr std::pair<std::string_view, const char*> kSymbols[] = {
      {"J", "E"},           {"N", "F"},    {"m/s", "v"},    {"m", "\"position\""}, {"°", "\\theta"},
      {"rad/s", "\\omega"}, {"m/s²", "a"}, {"kg m/s", "p"}, {"N m", "\\tau"}};
  for (const auto& [of, name] : kSymbols)
    if (of == unit) return name;
  return "";
}

}  // namespace

std::vector<Measured::Line> Measured::lines() const {
  std::vector<Line> all;
  for (const Measure* each : measures()) {
    const bool of_room = each->of == Measure::Of::room || bodies.empty();
    if (of_room) all.push_back({each, bodies.empty() ? -1 : bodies.front()});
    for (const int body : of_room ? std::vector<int>() : bodies) all.push_back({each, body});
  }
  return all;
}

std::optional<Measured::Line> Measured::along(const Line& line) const {
  const Measure* other = measure(against);
  if (!other) return {};
  return Line{other, line.body};
}

std::string in_words(std::string_view name) {
  std::string words(name);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string spoken(std::string name) {
  name = in_words(name);
  // one of several: "crate[2]"
  std::string number;
  if (const std::size_t bracket = name.find('['); bracket != name.npos && name.back() == ']')
    number = "_{" + name.substr(bracket + 1, name.size() - bracket - 2) + "}", name.resize(bracket);
  return "\"" + name + "\"" + number;
}

namespace {

// of an axis: beside others a line of the "normal force" is called "normal"
std::string title(const Measure& measure) {
  const std::string words = in_words(measure.name);
  return words.starts_with(std::string(measure.label) + " ") ? words : measure.label;
}

}  // namespace

namespace {

// Bodies of one colour, as copies are, have shades of it, from that nearest to the ink on; grey ones that are
// not to be looked at have one.
std::vector<Color> shades(const Measured& measured, const Palette& colours,
                          const std::function<Color(int body)>& line_color,
                          const std::function<bool(int body)>& quiet) {
  std::vector<Color> own, all;
  for (const int body : measured.bodies) own.push_back(line_color(body));
  for (std::size_t i = 0; i < own.size(); ++i) {
    const auto end = own.begin() + std::ptrdiff_t(i);
    const auto before = std::count(own.begin(), end, own[i]),
               many = std::count(own.begin(), own.end(), own[i]);
    const bool plain = many < 2 || (quiet && quiet(measured.bodies[i]));
    all.push_back(plain ? own[i] : shade(own[i], double(before) / double(many - 1), colours));
  }
  return all;
}

// whether two colours would be taken for one
bool alike(Color a, Color b) {
  constexpr int kApart = 60;  // of 255, all channels together
  return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b) < kApart;
}

// A line that is alone has the colour of its quantity; where that is another body's, of its own body.
Color color_of_only_line(const Measured& measured, const sim::SceneInfo& cast, Color of_quantity,
                         const std::function<Color(int body)>& line_color) {
  const int body = measured.bodies.size() == 1 ? measured.bodies[0] : -1;
  if (measured.measures().size() != 1 || body < 0 || !line_color || alike(line_color(body), of_quantity))
    return of_quantity;
  for (int i = 0; i < int(cast.bodies.size()); ++i)
    if (!cast.bodies[std::size_t(i)].fixed && i != body && alike(line_color(i), of_quantity))
      return line_color(body);
  return of_quantity;
}

}  // namespace

Plot empty_plot(const Measured& measured, const Palette& colours, const sim::SceneInfo& cast,
                const std::function<Color(int body)>& line_color,
                const std::function<std::string(int body)>& called,
                const std::function<bool(int body)>& quiet) {
  Plot plot;
  const std::vector<const Measure*> measures = measured.measures();
  const bool several = measured.bodies.size() > 1;
  const std::vector<Color> colors =
      several ? shades(measured, colours, line_color, quiet) : std::vector<Color>();
  for (const Measured::Line& line : measured.lines()) {
    const auto own = color(line.measure->color);
    Series series{line.measure->label, {}, own ? mix(*own, colours.ink, 0.2) : colours.ink};
    if (several && line.measure->of != Measure::Of::room) {
      const std::string name = called ? called(line.body) : spoken(cast.bodies[std::size_t(line.body)].name);
      series.label = measures.size() > 1 ? series.label + " " + name : name;
      const auto which = std::find(measured.bodies.begin(), measured.bodies.end(), line.body);
      series.color = colors[std::size_t(which - measured.bodies.begin())];
      series.quiet = quiet && quiet(line.body);
    }
    if (line.measure->of != Measure::Of::room)
      series.color = several ? series.color : color_of_only_line(measured, cast, series.color, line_color);
    // the sum of the others
    if (line.measure->name == "energy" && measures.size() > 1) series.weight = 1.5;
    plot.lines.push_back(std::move(series));
  }
  tell_apart(plot);
  if (!measures.empty()) {
    const std::string all = symbol(measures[0]->unit);
    const bool own = (measures.size() == 1 && measures[0]->name != "energy") || all.empty();
    plot.title = over_unit(own ? title(*measures[0]) : all, measures[0]->unit);
  }
  plot.range = measured.range;
  plot.placed = std::all_of(measures.begin(), measures.end(), [](const Measure* each) {
    return each->name == "x" || each->name == "y" || each->name == "z";
  });
  for (const Measure* each : measures)
    plot.negligible =
        std::max(plot.negligible, (each->unit == std::string_view("J") ? kOfRoundingOfSquares : kOfRounding) *
                                      negligible(each->unit, cast));
  if (const Measure* other = measure(measured.against)) plot.name = over_unit(title(*other), other->unit);
  return plot;
}

}  // namespace obscura::draw
