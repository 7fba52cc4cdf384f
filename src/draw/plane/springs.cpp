// A coil of n turns between its leads, s in [0, n] turns along it, phase 2 pi s:
//   along  = (s - k sin(4 pi s) / 4 pi) / n        k < 1: round crests, steep flanks, never backwards
//   across = A e(s) sin(2 pi s)                    e rises from 0 over the first turn's part, so leads join
//   smoothly
// At length l and rest length l0 the amplitude is A0 (l0 / l)^0.6, and at most half the length, and twice the
// way from one turn to the next: steeper flanks would be a grey patch.

#include "draw/plane/springs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "draw/plane/stage.h"

namespace obscura::draw {
namespace {

constexpr double kPitch = 20, kAmplitude = 13;  // at rest, page units
constexpr double kCrest = 0.22;                 // k
constexpr double kSteepest = 2;                 // amplitude over pitch
constexpr double kRise = 0.62;                  // turns over which the amplitude rises
constexpr int kNodes = 22;                      // a turn

double smooth(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

double lead(const Coil& coil, double length) {
  return std::min(std::clamp(0.085 * length, 2.2 * coil.line, 12 * coil.line), 0.2 * length);
}

bool holds_solid(const Stage& stage, const sim::SceneInfo::Spring& spring) {
  return stage.solid(spring.a) || stage.solid(spring.b);
}

Color color_of_spring(const Stage& stage, std::size_t i) {
  return link_color(stage.look, stage.colours, std::array{stage.cast.springs[i].a, stage.cast.springs[i].b});
}

}  // namespace

Coil coil(double rest, double weight) {
  const double pitch = kPitch * weight;
  const int turns = std::clamp(int(std::lround(0.85 * rest / pitch)), 4, 24);
  // a short spring is a slender one too
  const double slender = std::min(1.0, std::sqrt(rest / (6 * pitch)));
  return {turns, rest, kAmplitude * weight * std::max(0.5, slender), kSpringLine * weight};
}

double amplitude(const Coil& coil, double length, double zoom) {
  const double stretch = std::max(length, 1e-9) / std::max(coil.rest * zoom, 1e-9);
  const double free = coil.amplitude * std::min(1.25, std::pow(stretch, -0.6));
  const double pitch = length / std::max(coil.turns, 1);
  return std::min({free * std::clamp(zoom, 0.25, 3.0), 0.5 * length, kSteepest * pitch});
}

double line_width(const Coil& coil, double length, double zoom) {
  const double stretch = std::max(length, 1e-9) / std::max(coil.rest * zoom, 1e-9);
  const double thin = coil.line * kThinSpring / kSpringLine;
  const double wide = std::clamp(coil.line * std::pow(stretch, -0.6), thin, coil.line);
  const double pitch = length / std::max(coil.turns, 1);
  return std::clamp(0.34 * pitch, 0.45 * thin, wide);
}

std::vector<Point> coil_line(const Coil& coil, const Point& a, const Point& b, double zoom) {
  const double length = (b - a).norm();
  if (coil.turns == 0 || length < 1e-6) return {a, b};
  const Point along = (b - a) / length, across(-along.y(), along.x());
  const double ends = lead(coil, length), high = amplitude(coil, length, zoom), n = coil.turns;

  std::vector<Point> line;
  const int last = coil.turns * kNodes;
  line.reserve(last + 3);
  line.push_back(a);
  for (int i = 0; i <= last; ++i) {
    const double s = n * i / last, phase = 2 * std::numbers::pi * s;
    const double part = (s - kCrest * std::sin(2 * phase) / (4 * std::numbers::pi)) / n;
    const double rise = smooth(s / kRise) * smooth((n - s) / kRise);
    line.push_back(a + along * (ends + (length - 2 * ends) * part) +
                   across * (high * rise * std::sin(phase)));
  }
  line.push_back(b);
  return line;
}

Winding winding(const Coil& coil, double length, double zoom) {
  if (coil.turns == 0 || length < 1e-6) return {};
  return {coil.turns, lead(coil, length), amplitude(coil, length, zoom)};
}

void draw_springs(const Stage& stage, const View& view, const sim::Snapshot& now, bool solids, List& list) {
  const double zoom = view.scale / stage.layout.scale, weight = stage.layout.weight;
  std::vector<Node> nodes;
  for (std::size_t i = 0; i < now.springs.size(); ++i) {
    if (now.springs[i].loose || holds_solid(stage, stage.cast.springs[i]) != solids) continue;
    const Point a = view.page(now.springs[i].a), b = view.page(now.springs[i].b);
    const Coil& form = stage.coils[i];
    const Color color = color_of_spring(stage, i);
    nodes.clear();
    list.of({Subject::What::spring, int(i)});
    Winding winding;
    if (form.turns == 0) {
      const double width = std::min(kNetLine * weight, std::max(0.9 * weight, 0.09 * form.rest * zoom));
      nodes = {{a, width, color}, {b, width, color}};
    } else {
      const double width = line_width(form, (b - a).norm(), zoom);
      for (const Point& p : coil_line(form, a, b, zoom)) nodes.push_back({p, width, color});
      winding = draw::winding(form, (b - a).norm(), zoom);
    }
    list.add(nodes, Cap::round, Blend::over, false, winding);
  }

  // made fast to the room or a body that turns; a particle covers the end itself
  auto joint = [&](int body, const Point& at, const Coil& form, Color color) {
    if (body >= 0 && !stage.solid(body)) return;
    const double radius = (form.turns == 0 ? 0.75 : 1) * kJoint * weight;
    list.add(Disc{at, radius, 0, color, color});
  };
  for (std::size_t i = 0; i < now.springs.size(); ++i) {
    const sim::SceneInfo::Spring& spring = stage.cast.springs[i];
    if (now.springs[i].loose || holds_solid(stage, spring) != solids) continue;
    list.of({Subject::What::spring, int(i)});
    joint(spring.a, view.page(now.springs[i].a), stage.coils[i], color_of_spring(stage, i));
    joint(spring.b, view.page(now.springs[i].b), stage.coils[i], color_of_spring(stage, i));
  }
}

}  // namespace obscura::draw
