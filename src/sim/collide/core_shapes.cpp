// Two convex polygons are apart by the largest of the gaps that the faces of each see (separating axes). The
// face that sees it is the reference, the other's face that looks most against it the incident one; the
// stretch where both lie over each other ends at a corner of one or of the other.

#include "sim/collide/core_shapes.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sim/collide/narrow_phase.h"
#include "sim/shape/convex_polygon.h"
#include "sim/shape/shape.h"

namespace obscura::sim::plane {

namespace {

struct CorePoint {
  double x, y;
};

CorePoint corner_at(const CoreShapes& cores, const CoreShape& core, const Pose& at, int i) {
  const double x = cores.x[core.first + i], y = cores.y[core.first + i];
  return {at.x + (at.c * x - at.s * y), at.y + (at.s * x + at.c * y)};
}
CorePoint normal(const CoreShapes& cores, const CoreShape& core, const Pose& at, int face) {
  const double x = cores.nx[core.first + face], y = cores.ny[core.first + face];
  return {at.c * x - at.s * y, at.s * x + at.c * y};
}

// the face of a from which b is farthest
struct Reference {
  int face = 0;
  double gap = -1e300;
};
Reference reference(const CoreShapes& cores, const CoreShape& a, const Pose& at_a, const CoreShape& b,
                    const Pose& at_b) {
  // b's corners in a's frame
  const double c = at_a.c * at_b.c + at_a.s * at_b.s, s = at_a.c * at_b.s - at_a.s * at_b.c;
  const double wx = at_b.x - at_a.x, wy = at_b.y - at_a.y;
  const double x = at_a.c * wx + at_a.s * wy, y = at_a.c * wy - at_a.s * wx;
  Reference best;
  if (a.wide > 0 && b.wide > 0) {
    const double ac = std::fabs(c), as = std::fabs(s);
    const double gap_x = std::fabs(x) - a.wide - (ac * b.wide + as * b.high);
    const double gap_y = std::fabs(y) - a.high - (as * b.wide + ac * b.high);
    return gap_x > gap_y ? Reference{x > 0 ? 1 : 3, gap_x} : Reference{y > 0 ? 2 : 0, gap_y};
  }
  for (int i = a.first; i < a.first + a.count; ++i) {
    const double nx = cores.nx[i], ny = cores.ny[i];
    // the normal in b's frame
    const double mx = c * nx + s * ny, my = c * ny - s * nx;
    double least = 1e300;
    for (int j = b.first; j < b.first + b.count; ++j)
      least = std::min(least, mx * cores.x[j] + my * cores.y[j]);
    const double gap = nx * x + ny * y - cores.d[i] + least;
    if (gap > best.gap) best = {i - a.first, gap};
  }
  return best;
}

// polygon a's face against polygon b; `swapped` where a is the contact's b
double clip(const CoreShapes& cores, const CoreShape& a, const Pose& at_a, int face, const CoreShape& b,
            const Pose& at_b, bool swapped, Feature out[2]) {
  const CorePoint n = normal(cores, a, at_a, face);
  int incident = 0;
  double least = 1e300, askew = 0;
  for (int i = 0; i < b.count; ++i) {
    const CorePoint m = normal(cores, b, at_b, i);
    const double along = n.x * m.x + n.y * m.y;
    if (along < least) least = along, incident = i, askew = std::fabs(n.x * m.y - n.y * m.x);
  }

  // along the reference face, counter-clockwise: the incident one runs backwards
  const int a0 = face, a1 = face + 1 == a.count ? 0 : face + 1;
  const int b0 = incident + 1 == b.count ? 0 : incident + 1, b1 = incident;
  const double tx = -n.y, ty = n.x;
  const CorePoint pa0 = corner_at(cores, a, at_a, a0), pa1 = corner_at(cores, a, at_a, a1);
  const CorePoint pb0 = corner_at(cores, b, at_b, b0), pb1 = corner_at(cores, b, at_b, b1);
  const double sa0 = tx * pa0.x + ty * pa0.y, sa1 = tx * pa1.x + ty * pa1.y;
  const double sb0 = tx * pb0.x + ty * pb0.y, sb1 = tx * pb1.x + ty * pb1.y;

  const auto of_a = [&](int i) {
    return Feature{swapped ? Feature::corner_of_b : Feature::corner_of_a, i, incident};
  };
  const auto of_b = [&](int i) {
    return Feature{swapped ? Feature::corner_of_a : Feature::corner_of_b, i, face};
  };
  const auto both = [&](int i, int j) { return Feature{Feature::corners, swapped ? j : i, swapped ? i : j}; };
  const double gap = n.x * (pb0.x - pa0.x) + n.y * (pb0.y - pa0.y);
  const double other = n.x * (pb1.x - pa0.x) + n.y * (pb1.y - pa0.y);
  const double low = std::min(gap, other);

  // in line with each other's ends: with either's normal, the contact would stop a body that may pass
  const double shared = std::min(sa1, sb1) - std::max(sa0, sb0);
  if (askew < kParallel && std::fabs(shared) <= cores.passing * std::min(sa1 - sa0, sb1 - sb0)) {
    out[0] = out[1] = {};
    return low;
  }
  // beside each other: corner to corner, if they are apart at all
  if (low > 0 && (sb0 > sa1 || sb1 < sa0)) {
    out[0] = sb0 > sa1 ? both(a1, b0) : both(a0, b1), out[1] = {};
    return low;
  }
  const bool over0 = sb0 >= sa0, over1 = sb1 <= sa1;
  out[0] = over0 ? of_b(b0) : of_a(a0), out[1] = over1 ? of_b(b1) : of_a(a1);
  // a corner touches alone where the faces are askew
  if (askew > kAskew && over0 != over1 && (over0 ? gap <= other : other <= gap)) {
    if (over1) out[0] = out[1];
    out[1] = {};
  }
  return low;
}

double at_corner(const CoreShapes& cores, const CoreShape& round, const Pose& at_round,
                 const CoreShape& polygon, const Pose& at, bool swapped, Feature out[2]) {
  // the round one's corner in the polygon's frame
  const CorePoint p = corner_at(cores, round, at_round, 0);
  const double wx = p.x - at.x, wy = p.y - at.y;
  const double x = at.c * wx + at.s * wy, y = at.c * wy - at.s * wx;
  int face = 0;
  double most = -1e300;
  for (int i = 0; i < polygon.count; ++i) {
    const int k = polygon.first + i;
    const double gap = cores.nx[k] * x + cores.ny[k] * y - cores.d[k];
    if (gap > most) most = gap, face = i;
  }
  out[1] = {};
  const int next = face + 1 == polygon.count ? 0 : face + 1;
  const int k0 = polygon.first + face, k1 = polygon.first + next;
  const double tx = -cores.ny[k0], ty = cores.nx[k0];
  const double along = tx * x + ty * y;
  int beyond = -1;
  if (along < tx * cores.x[k0] + ty * cores.y[k0]) beyond = face;
  if (along > tx * cores.x[k1] + ty * cores.y[k1]) beyond = next;
  if (most > 0 && beyond >= 0) {
    out[0] = {Feature::corners, swapped ? beyond : 0, swapped ? 0 : beyond};
    const double dx = x - cores.x[polygon.first + beyond], dy = y - cores.y[polygon.first + beyond];
    return std::sqrt(dx * dx + dy * dy) - round.radius - polygon.radius;
  }
  out[0] = {swapped ? Feature::corner_of_b : Feature::corner_of_a, 0, face};
  return most - round.radius - polygon.radius;
}

}  // namespace

CoreShapes::CoreShapes(const Model<2>& model, double passing_part) : passing(passing_part) {
  const auto add = [&](int body, int part, const Shape<2>& shape) {
    CoreShape core;
    core.body = body, core.part = part, core.first = int(x.size());
    const ConvexPolygon outline(shape);
    core.radius = outline.radius();
    if (outline.is_box() && outline.middle() == Vec<2>::Zero())
      core.wide = outline.half()[0], core.high = outline.half()[1];
    for (int i = 0; i < outline.corners(); ++i) {
      const Vec<2> at = outline.corner(i);
      x.push_back(at[0]), y.push_back(at[1]);
    }
    core.count = int(x.size()) - core.first;
    assert(core.count <= Feature::kMostCorners && part <= Feature::kMostParts);
    for (int i = core.first; i < core.first + core.count; ++i) {
      const int next = i + 1 == core.first + core.count ? core.first : i + 1;
      const double tx = x[next] - x[i], ty = y[next] - y[i], l = std::sqrt(tx * tx + ty * ty);
      nx.push_back(l > 0 ? ty / l : 0), ny.push_back(l > 0 ? -tx / l : 1);
      d.push_back(nx[i] * x[i] + ny[i] * y[i]);
    }
    core.bounding_radius = sim::bounding_radius(shape), core.half_thickness = sim::half_thickness(shape);
    all.push_back(core);
  };
  for (int body = 0; body < int(model.bodies.size()); ++body) {
    begin.push_back(int(all.size()));
    const Shape<2>& shape = model.bodies[body].shape;
    for (int i = 0; i < parts(shape); ++i) add(body, i, part(shape, i));
    bounding_radius.push_back(sim::bounding_radius(shape));
    half_thickness.push_back(sim::half_thickness(shape));
  }
  begin.push_back(int(all.size()));
}

double find_features(const CoreShapes& cores, const CoreShape& a, const Pose& at_a, const CoreShape& b,
                     const Pose& at_b, Feature out[2], double margin) {
  if (a.count == 1 && b.count == 1) {
    const CorePoint p = corner_at(cores, a, at_a, 0), q = corner_at(cores, b, at_b, 0);
    out[0] = {Feature::corners, 0, 0}, out[1] = {};
    return std::sqrt((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y)) - a.radius - b.radius;
  }
  if (a.count == 1) return at_corner(cores, a, at_a, b, at_b, false, out);
  if (b.count == 1) return at_corner(cores, b, at_b, a, at_a, true, out);
  const Reference ra = reference(cores, a, at_a, b, at_b);
  if (ra.gap >= margin) return ra.gap;
  const Reference rb = reference(cores, b, at_b, a, at_a);
  if (rb.gap >= margin) return rb.gap;
  // on a near tie a's face, so that rounding does not choose
  if (rb.gap > ra.gap + 1e-6 * std::min(a.half_thickness, b.half_thickness))
    return clip(cores, b, at_b, rb.face, a, at_a, true, out);
  return clip(cores, a, at_a, ra.face, b, at_b, false, out);
}

ContactPoint evaluate_feature(const CoreShapes& cores, const CoreShape& a, const Pose& at_a,
                              const CoreShape& b, const Pose& at_b, Feature feature) {
  ContactPoint at;
  if (feature.kind == Feature::corners) {
    const CorePoint p = corner_at(cores, a, at_a, feature.corner),
                    q = corner_at(cores, b, at_b, feature.face);
    double nx = p.x - q.x, ny = p.y - q.y;
    const double l = std::sqrt(nx * nx + ny * ny);
    if (l > 1e-12 * (a.bounding_radius + b.bounding_radius)) {
      nx /= l, ny /= l;
    } else {
      nx = 0, ny = 1;
    }
    at.nx = nx, at.ny = ny, at.gap = l - a.radius - b.radius;
    const double along = b.radius + 0.5 * at.gap;
    at.x = q.x + nx * along, at.y = q.y + ny * along;
    return at;
  }
  const bool of_a = feature.kind == Feature::corner_of_a;
  const CoreShape &pointed = of_a ? a : b, &flat = of_a ? b : a;
  const Pose &at_pointed = of_a ? at_a : at_b, &at_flat = of_a ? at_b : at_a;
  const CorePoint p = corner_at(cores, pointed, at_pointed, feature.corner);
  const CorePoint n = normal(cores, flat, at_flat, feature.face);
  at.gap = n.x * (p.x - at_flat.x) + n.y * (p.y - at_flat.y) - cores.d[flat.first + feature.face] - a.radius -
           b.radius;
  const double back = pointed.radius + 0.5 * at.gap;
  at.x = p.x - n.x * back, at.y = p.y - n.y * back;
  at.nx = of_a ? n.x : -n.x, at.ny = of_a ? n.y : -n.y;
  return at;
}

double find_features(const CoreShapes& cores, const CoreShape& a, const Pose& at_a, const Wall<2>& wall,
                     Feature out[2]) {
  const double nx = wall.normal[0], ny = wall.normal[1];
  int low[2] = {0, -1};
  double gap[2] = {1e300, 1e300};
  for (int i = 0; i < a.count; ++i) {
    const CorePoint p = corner_at(cores, a, at_a, i);
    const double g = nx * (p.x - wall.point[0]) + ny * (p.y - wall.point[1]) - a.radius;
    if (g < gap[0]) {
      gap[1] = gap[0], low[1] = low[0], gap[0] = g, low[0] = i;
    } else if (g < gap[1]) {
      gap[1] = g, low[1] = i;
    }
  }
  if (a.count > 1 && low[1] < low[0]) std::swap(low[0], low[1]);
  out[0] = {Feature::corner_of_a, low[0], 0};
  out[1] = a.count > 1 ? Feature{Feature::corner_of_a, low[1], 0} : Feature{};
  return gap[0];
}

ContactPoint evaluate_feature(const CoreShapes& cores, const CoreShape& a, const Pose& at_a,
                              const Wall<2>& wall, Feature feature) {
  const CorePoint p = corner_at(cores, a, at_a, feature.corner);
  ContactPoint at;
  at.nx = wall.normal[0], at.ny = wall.normal[1];
  at.gap = at.nx * (p.x - wall.point[0]) + at.ny * (p.y - wall.point[1]) - a.radius;
  const double back = a.radius + 0.5 * at.gap;
  at.x = p.x - at.nx * back, at.y = p.y - at.ny * back;
  return at;
}

}  // namespace obscura::sim::plane
