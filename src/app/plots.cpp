#include "app/plots.h"

#include <algorithm>
#include <array>
#include <functional>
#include <string_view>

#include "app/interrupt.h"
#include "app/trouble.h"
#include "sim/run.h"

namespace obscura::app {

namespace {

constexpr std::int64_t kPoints = 480;  // of a line
constexpr double kDegrees = 57.29577951308232;

/// What the scene calls it, what it is called beside its line, its unit and its value.
struct Traced {
  std::string_view word;
  const char *label, *unit, *color;
  double (*value)(const sim::Snapshot& now, const sim::Snapshot::Body& body);
};

using Now = const sim::Snapshot&;
using Body = const sim::Snapshot::Body&;

constexpr std::array<Traced, 12> kTraced{{
    {"energy", "total", "J", "", [](Now now, Body) { return now.energies.total(); }},
    {"kinetic", "kinetic", "J", "vermilion", [](Now now, Body) { return now.energies.kinetic; }},
    {"potential", "potential", "J", "blue", [](Now now, Body) { return now.energies.potential(); }},
    {"gravity", "gravity", "J", "blue", [](Now now, Body) { return now.energies.gravity; }},
    {"springs", "springs", "J", "green", [](Now now, Body) { return now.energies.springs; }},
    {"x", "x", "m", "blue", [](Now, Body body) { return body.position.x(); }},
    {"height", "height", "m", "blue", [](Now, Body body) { return body.position.y(); }},
    {"speed", "speed", "m/s", "green", [](Now, Body body) { return body.velocity.norm(); }},
    {"vx", "v_x", "m/s", "blue", [](Now, Body body) { return body.velocity.x(); }},
    {"vy", "v_y", "m/s", "vermilion", [](Now, Body body) { return body.velocity.y(); }},
    {"angle", "\\theta", "°", "purple", [](Now, Body body) { return kDegrees * body.angle; }},
    {"spin", "\\omega", "rad/s", "purple", [](Now, Body body) { return body.spin.z(); }},
}};

}  // namespace

std::vector<draw::Plot> plots(const scene::Scene& scene, const std::vector<double>& marks) {
  const draw::Palette colours = draw::palette(scene.look.theme);
  std::vector<draw::Plot> all;
  for (const draw::Figure::Plot& wanted : scene.figure.plots) {
    draw::Plot plot;
    plot.marks = marks;
    std::vector<const Traced*> traced;
    for (const std::string& word : wanted.quantities) {
      const auto found =
          std::find_if(kTraced.begin(), kTraced.end(), [&](const Traced& each) { return each.word == word; });
      if (found == kTraced.end()) continue;
      traced.push_back(&*found);
      const auto color = draw::color(found->color);
      plot.lines.push_back({found->label, {}, color ? draw::mix(*color, colours.ink, 0.2) : colours.ink});
      if (traced.size() == 1 || plot.unit == found->unit)
        plot.unit = found->unit;
      else
        plot.unit.clear();
    }

    const auto run = scene.run();
    run->heed(interrupted);
    const sim::Rational stride = (wanted.to - wanted.from) / sim::rational(kPoints);
    for (std::int64_t i = 0; i <= kPoints; ++i) {
      const sim::Rational t = i < kPoints ? wanted.from + sim::rational(i) * stride : wanted.to;
      auto found = run->at(t);
      if (const auto* trouble = std::get_if<sim::Trouble>(&found))
        throw TroubleError(scene.file, *trouble, "");
      if (std::holds_alternative<sim::Stopped>(found)) throw Interrupted();
      const sim::Snapshot& now = std::get<sim::Snapshot>(found);
      plot.times.push_back(now.time);
      static const sim::Snapshot::Body nobody;
      const sim::Snapshot::Body& body = wanted.body < 0 ? nobody : now.bodies[std::size_t(wanted.body)];
      for (std::size_t k = 0; k < traced.size(); ++k)
        plot.lines[k].values.push_back(traced[k]->value(now, body));
    }
    all.push_back(std::move(plot));
  }
  return all;
}

}  // namespace obscura::app
