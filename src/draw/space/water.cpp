// The surface of a fluid at rest: level, as far as the walls of a room, without them a disc around what is
// looked at that fades towards its rim.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "draw/space/space.h"

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kWide = 0.62;           // of the width that is shown: the radius of the disc,
constexpr double kEven = 0.5;            // and how much of it is even
constexpr int kRim = 48;                 // its corners
constexpr double kNearest = 0.05;        // depth over the target's: nearer parts are cut off
constexpr int kSurfaceNumber = 1 << 28;  // its line's among those that hide: it hides nothing
constexpr std::uint8_t kPaperAlpha = 78, kScreenAlpha = 66;

// the part of a loop with `inside` at least 0, which is linear
template <class Inside>
std::vector<Vec3> cut_loop(const std::vector<Vec3>& loop, const Inside& inside) {
  std::vector<Vec3> left;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    const double p = inside(a), q = inside(b);
    if (p >= 0) left.push_back(a);
    if ((p >= 0) != (q >= 0)) left.push_back(a + p / (p - q) * (b - a));
  }
  return left;
}

// a square about `middle`, cut by the walls
std::vector<Vec3> within(const Polyhedron& room, const Vec3& middle, double reach) {
  std::vector<Vec3> loop;
  for (const auto& [x, z] : {std::pair(-1, -1), {-1, 1}, {1, 1}, {1, -1}})
    loop.push_back(middle + reach * Vec3(x, 0, z));
  for (const Polyhedron::Face& face : room.faces) {
    const Vec3& on = room.vertices[std::size_t(face.loop[0])];
    loop = cut_loop(loop, [&](const Vec3& p) { return -face.normal.dot(p - on); });
  }
  return loop;
}

}  // namespace

void add_water(SpaceFrame& s) {
  const SpaceStage& stage = s.stage;
  if (!stage.cast.surface) return;
  const double level = *stage.cast.surface;
  Color ink = *color("sky");
  ink.a = stage.look.theme == Theme::paper ? kPaperAlpha : kScreenAlpha;
  const auto add = [&](const Vec3& place, double strength) {
    Color own = ink;
    own.a = std::uint8_t(std::lround(own.a * strength));
    s.corners.push_back({place, Vec3::UnitY(), {own, own}, -1});
    return std::uint32_t(s.corners.size() - 1);
  };

  if (stage.closed) {
    double reach = 0;
    Vec3 middle = Vec3::Zero();
    for (const Vec3& v : stage.room.vertices) middle += v / double(stage.room.vertices.size());
    for (const Vec3& v : stage.room.vertices) reach = std::max(reach, (v - middle).norm());
    middle.y() = level;
    std::vector<Vec3> loop = within(stage.room, middle, reach);
    loop = cut_loop(loop, [&](const Vec3& p) { return s.lens.depth(p) - kNearest; });
    if (loop.size() < 3) return;
    const auto first = std::uint32_t(s.corners.size());
    for (const Vec3& p : loop) add(p, 1);
    for (std::uint32_t i = 2; i < loop.size(); ++i)
      for (const std::uint32_t k : {first, first + i - 1, first + i}) s.solids.water.push_back(k);
    return;
  }
  const Vec3 middle(s.lens.target.x(), level, s.lens.target.z());
  const double radius = kWide * s.lens.window.width / s.lens.scale;
  const auto center = add(middle, 1);
  for (int k = 0; k < kRim; ++k) {
    const double a = 2 * std::numbers::pi * k / kRim;
    const Vec3 out(std::cos(a), 0, std::sin(a));
    add(middle + kEven * radius * out, 1), add(middle + radius * out, 0);
  }
  for (std::uint32_t k = 0; k < kRim; ++k) {
    const std::uint32_t a = center + 1 + 2 * k, b = center + 1 + 2 * ((k + 1) % kRim);
    const std::array<std::uint32_t, 9> three{center, a, b, a, a + 1, b + 1, a, b + 1, b};
    // what passes the eye is left out
    for (std::size_t i = 0; i < three.size(); i += 3)
      if (std::all_of(three.begin() + std::ptrdiff_t(i), three.begin() + std::ptrdiff_t(i) + 3,
                      [&](std::uint32_t v) { return s.lens.depth(s.corners[v].place) > kNearest; }))
        s.solids.water.insert(s.solids.water.end(), three.begin() + std::ptrdiff_t(i),
                              three.begin() + std::ptrdiff_t(i) + 3);
  }
}

void trace_water(SpaceFrame& s) {
  const SpaceStage& stage = s.stage;
  if (s.solids.water.empty() || !stage.closed) return;
  std::vector<Vec3> loop;
  for (const Corner& c : s.corners)
    if (c.piece < 0 && c.color.lit.a > 0 && c.color.lit.a < 255) loop.push_back(c.place);
  trace(s, loop, true, kSurfaceNumber, -1, kSurfaceLine * stage.layout.weight, stage.colours.surface);
}

}  // namespace obscura::draw
