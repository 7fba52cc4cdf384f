#include "draw/page/measure.h"

#include <algorithm>
#include <array>

namespace obscura::draw {
namespace {

constexpr double kDegrees = 57.29577951308232;

using Now = const sim::Snapshot&;

const sim::Snapshot::Body& of(Now now, int body) {
  static const sim::Snapshot::Body nobody;
  return body < 0 ? nobody : now.bodies[std::size_t(body)];
}

/// The first spring that holds it; one of no length where none does.
const sim::Snapshot::Spring& spring(Now now, int body) {
  static const sim::Snapshot::Spring none;
  for (const sim::Snapshot::Spring& each : now.springs)
    if (body >= 0 && (each.holds_a == body || each.holds_b == body)) return each;
  return none;
}

constexpr std::array<Measure, 16> kMeasures{{
    {"energy", "total", "J", "", false, [](Now now, int) { return now.energies.total(); }},
    {"kinetic", "kinetic", "J", "vermilion", false, [](Now now, int) { return now.energies.kinetic; }},
    {"potential", "potential", "J", "blue", false, [](Now now, int) { return now.energies.potential(); }},
    {"gravity", "gravity", "J", "blue", false, [](Now now, int) { return now.energies.gravity; }},
    {"springs", "springs", "J", "green", false, [](Now now, int) { return now.energies.springs; }},
    {"fields", "fields", "J", "purple", false, [](Now now, int) { return now.energies.fields; }},
    {"work", "work", "J", "orange", false, [](Now now, int) { return now.energies.work; }},
    {"x", "x", "m", "blue", true, [](Now now, int body) { return of(now, body).position.x(); }},
    {"height", "height", "m", "blue", true, [](Now now, int body) { return of(now, body).position.y(); }},
    {"speed", "speed", "m/s", "green", true, [](Now now, int body) { return of(now, body).velocity.norm(); }},
    {"vx", "v_x", "m/s", "blue", true, [](Now now, int body) { return of(now, body).velocity.x(); }},
    {"vy", "v_y", "m/s", "vermilion", true, [](Now now, int body) { return of(now, body).velocity.y(); }},
    {"angle", "\\theta", "°", "purple", true,
     [](Now now, int body) { return kDegrees * of(now, body).angle; }},
    {"spin", "\\omega", "rad/s", "purple", true, [](Now now, int body) { return of(now, body).spin.z(); }},
    {"length", "l", "m", "blue", true,
     [](Now now, int body) { return (spring(now, body).b - spring(now, body).a).norm(); }},
    {"push", "f", "N", "vermilion", true, [](Now now, int body) { return spring(now, body).push; }},
}};

}  // namespace

double Measure::at(const sim::Snapshot& now, int body) const { return read(now, body); }

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

Plot empty_plot(const Measured& measured, const Palette& colours) {
  Plot plot;
  for (const Measure* each : measured.measures()) {
    const auto own = color(each->color);
    plot.unit = plot.lines.empty() || plot.unit == each->unit ? each->unit : "";
    plot.lines.push_back({each->label, {}, own ? mix(*own, colours.ink, 0.2) : colours.ink});
  }
  return plot;
}

}  // namespace obscura::draw
