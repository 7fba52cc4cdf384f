// Shadows on each other. The light sees a body in a square of its own: with u, v across it and l towards it,
//   (x, y) = ((p.u, p.v) - low) / side,    z = (p.(-l) - near) / depth
// fitted to what is seen and may lie in a shadow, so that its steps stay small. Along a surface with normal
// n,
//   dz/dx = (n.u / n.l) side / depth,   and so in y
// which tells how deep the surface itself is beside a point, so that it throws no shadow on itself.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "draw/space/darkness.h"
#include "draw/space/space.h"

namespace obscura::draw {
namespace {

using sim::Vec3;

// of a body's thickness, and at most of the window: up to where the ground near it is darker
constexpr double kTouchReach = 1.4, kTouchMost = 0.06;
constexpr double kSoft =
    0.0065;                    // of the window's width in the world: what a soft edge may reach beyond a body
constexpr double kSteep = 12;  // slopes are cut off there
constexpr double kLightNear = 1e-3;
constexpr double kReach = 3;            // texels of the map that an edge reaches in addition
constexpr std::size_t kManyEdges = 30;  // of a body: more are not looked along

/// How the light sees: the first two across, the third away from it.
struct LightFrame {
  Vec3 u, v, away;
  Vec3 operator()(const Vec3& p) const { return {p.dot(u), p.dot(v), p.dot(away)}; }
};

/// The box around a thing in the light's view.
struct Extents {
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  void add(const Vec3& p) { low = low.cwiseMin(p), high = high.cwiseMax(p); }
};

/// Whether `caster` may throw a shadow on `receiver`: nearer to the light, and before it up to a soft edge.
bool over(const Extents& caster, const Extents& receiver, double soft) {
  return caster.low.z() < receiver.high.z() && caster.low.x() < receiver.high.x() + soft &&
         caster.high.x() > receiver.low.x() - soft && caster.low.y() < receiver.high.y() + soft &&
         caster.high.y() > receiver.low.y() - soft;
}

/// A convex body of flat faces as the light sees it: its vertices, and the directions of its edges across the
/// light.
struct Outline {
  std::vector<Vec3> corners;
  std::vector<Point> ways;  // across the edges
};

/// Whether a body may throw a shadow on a triangle that faces the light, its edge soft up to `soft`: a corner
/// of it lies before the triangle's plane, and no line across the light parts the two.
bool may_darken(const Outline& caster, const std::array<Vec3, 3>& triangle, double soft) {
  Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  const double length = normal.norm();
  if (!(length > 0)) return true;
  normal *= (normal.z() < 0 ? 1 : -1) / length;  // towards the light
  double before = -1e300;
  for (const Vec3& p : caster.corners) before = std::max(before, normal.dot(p - triangle[0]));
  if (before < 0) return false;
  const auto parted = [&](const Point& way) {
    double low = 1e300, high = -1e300, least = 1e300, most = -1e300;
    for (const Vec3& p : triangle) {
      const double at = way.dot(p.head<2>());
      low = std::min(low, at), high = std::max(high, at);
    }
    for (const Vec3& p : caster.corners) {
      const double at = way.dot(p.head<2>());
      least = std::min(least, at), most = std::max(most, at);
    }
    const double reach = soft * way.norm();
    return least > high + reach || most < low - reach;
  };
  for (int i = 0; i < 3; ++i) {
    const Point along = (triangle[(i + 1) % 3] - triangle[i]).head<2>();
    if (parted({-along.y(), along.x()})) return false;
  }
  return std::none_of(caster.ways.begin(), caster.ways.end(), parted);
}

/// For each thing, which others may throw a shadow on it.
std::vector<std::vector<int>> pair_up(const std::vector<Extents>& things, const std::vector<Chunk>& chunks,
                                      double soft) {
  std::vector<std::vector<int>> casters(things.size());
  std::vector<int> order(things.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return things[a].low.x() != things[b].low.x() ? things[a].low.x() < things[b].low.x() : a < b;
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const int a = order[i];
    for (std::size_t k = i + 1; k < order.size() && things[order[k]].low.x() < things[a].high.x() + soft;
         ++k) {
      const int b = order[k];
      for (const auto& [caster, receiver] : {std::pair(a, b), std::pair(b, a)}) {
        if (chunks[caster].piece >= 0 && chunks[receiver].begin < chunks[receiver].end &&
            over(things[caster], things[receiver], soft))
          casters[receiver].push_back(caster);
      }
    }
  }
  return casters;
}

/// The far side of a body from the light, as triangles.
template <class Emit>
void far_side(const SpaceFrame& s, const Chunk& chunk, const LightFrame& frame, Emit&& emit) {
  const auto& pieces = s.stage.pieces;
  if (chunk.piece >= int(pieces.size())) return;
  const Piece& piece = pieces[chunk.piece];
  if (piece.form == Piece::Form::polyhedron) {
    const Polyhedron& body = s.placed[chunk.piece];
    for (const Polyhedron::Face& face : body.faces) {
      if (face.normal.dot(frame.away) <= 0) continue;
      for (std::size_t i = 2; i < face.loop.size(); ++i)
        emit(body.vertices[face.loop[0]], body.vertices[face.loop[i - 1]], body.vertices[face.loop[i]]);
    }
    return;
  }
  // a ball: half of it; a capsule: the halves of its ends, and what lies between
  const sim::Snapshot::Body& at = s.now.bodies[piece.body];
  const Vec3 a = at.position + at.orientation * piece.a, b = at.position + at.orientation * piece.b;
  const double radius = piece.form == Piece::Form::ball ? chunk.reach : piece.radius;
  constexpr int kSectors = 16, kRings = 4;
  const auto half = [&](const Vec3& center) {
    const auto place = [&](int ring, int k) {
      const double polar = std::numbers::pi / 2 * ring / kRings, turn = 2 * std::numbers::pi * k / kSectors;
      return Vec3(center +
                  radius * (std::cos(polar) * frame.away +
                            std::sin(polar) * (std::cos(turn) * frame.u + std::sin(turn) * frame.v)));
    };
    for (int ring = 0; ring < kRings; ++ring) {
      for (int k = 0; k < kSectors; ++k) {
        emit(place(ring, k), place(ring + 1, k), place(ring + 1, k + 1));
        if (ring > 0) emit(place(ring, k), place(ring + 1, k + 1), place(ring, k + 1));
      }
    }
  };
  half(a);
  if (piece.form == Piece::Form::ball) return;
  half(b);
  const Vec3 axis = (b - a).normalized(), side = axis.cross(frame.away).norm() > 1e-9
                                                     ? Vec3(axis.cross(frame.away).normalized())
                                                     : axis.unitOrthogonal();
  const Vec3 under = side.cross(axis);
  for (int k = 0; k < 8; ++k) {
    const auto n = [&](int i) {
      const double turn = std::numbers::pi * i / 8;
      return Vec3(radius * (std::cos(turn) * side + std::sin(turn) * under));
    };
    emit(Vec3(a + n(k)), Vec3(b + n(k)), Vec3(b + n(k + 1)));
    emit(Vec3(a + n(k)), Vec3(b + n(k + 1)), Vec3(a + n(k + 1)));
  }
}

namespace {

// all things in the light's view
struct LightView {
  LightFrame frame;
  double soft;  // m: how far a soft edge reaches
  std::vector<Extents> things;
  std::vector<Outline> outlines;  // empty: a box around it is all that is known
};

LightView view_from_light(const SpaceFrame& s) {
  LightView view;
  LightFrame& frame = view.frame;
  frame.away = -s.stage.light.toward;
  frame.u = (std::abs(frame.away.y()) < 0.9 ? Vec3::UnitY() : Vec3::UnitX()).cross(frame.away).normalized();
  frame.v = frame.away.cross(frame.u);
  view.soft = kSoft * s.lens.window.width / s.lens.scale;
  std::vector<Extents>& things = view.things;
  std::vector<Outline>& outlines = view.outlines;
  things.resize(s.chunks.size()), outlines.resize(s.chunks.size());
  for (std::size_t i = 0; i < s.chunks.size(); ++i) {
    const Chunk& chunk = s.chunks[i];
    const bool flat =
        chunk.piece >= 0 && chunk.piece < int(s.placed.size()) && !s.placed[chunk.piece].empty();
    if (flat) {
      const Polyhedron& body = s.placed[chunk.piece];
      for (const Vec3& v : body.vertices) outlines[i].corners.push_back(frame(v));
      for (const Vec3& v : outlines[i].corners) things[i].add(v);
      if (body.edges.size() > kManyEdges) continue;
      for (const Polyhedron::Edge& e : body.edges) {
        const Vec3 along = outlines[i].corners[e.b] - outlines[i].corners[e.a];
        outlines[i].ways.push_back({-along.y(), along.x()});
      }
    } else {
      const Vec3 at = frame(chunk.center), reach = Vec3::Constant(chunk.reach);
      things[i].add(at - reach), things[i].add(at + reach);
    }
  }
  return view;
}

// indices of the things, the nearest first, since they hide others
std::vector<int> nearest_first(const SpaceFrame& s) {
  std::vector<int> order(s.chunks.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return s.lens.depth(s.chunks[a].center) - s.lens.per_distance * s.chunks[a].reach <
           s.lens.depth(s.chunks[b].center) - s.lens.per_distance * s.chunks[b].reach;
  });
  return order;
}

// how far a soft edge reaches: some texels of the map more, whose side is all that is seen at most
double reach_of_edges(const LightView& view) {
  Extents all;
  for (const Extents& thing : view.things) all.add(thing.low), all.add(thing.high);
  return view.things.empty()
             ? 0
             : view.soft + kReach / kMap *
                               (1.02 * std::max(all.high.x() - all.low.x(), all.high.y() - all.low.y()) +
                                2 * view.soft);
}

// the things that cast shadows on others, and what the map must hold, in the light's view
struct Cast {
  std::vector<char> casts;  // one a thing
  Extents darkened, casters;
};

// Divides the triangles into those that a shadow may fall on and the others, in the order in which they are
// drawn.
Cast divide_triangles(SpaceFrame& s, const LightView& view) {
  const auto& [frame, soft, things, outlines] = view;
  const auto casters = pair_up(things, s.chunks, soft);
  const double reach = reach_of_edges(view);
  Darkness darkness(s);
  Cast cast;
  cast.casts.resize(s.chunks.size(), 0);
  for (int i : nearest_first(s)) {
    const Chunk& chunk = s.chunks[i];
    for (std::size_t k = chunk.begin; k < chunk.end; k += 3) {
      Extents triangle;
      std::array<Vec3, 3> corners;
      bool lit = false, darkened = false;
      for (std::size_t c = k; c < k + 3 && !casters[i].empty(); ++c) {
        const Corner& corner = s.corners[s.triangles[c]];
        lit = lit || corner.normal.dot(frame.away) < 0;
        corners[c - k] = frame(corner.place);
        triangle.add(corners[c - k]);
      }
      for (int caster : casters[i]) {
        if (!lit || !over(things[caster], triangle, soft)) continue;
        if (!outlines[caster].corners.empty() && !may_darken(outlines[caster], corners, reach)) continue;
        darkened = true, cast.casts[caster] = 1;
        cast.casters.add(things[caster].low), cast.casters.add(things[caster].high);
      }
      if (darkened) cast.darkened.add(triangle.low), cast.darkened.add(triangle.high);
      darkness.lay(chunk, k, darkened ? s.solids.shadowed : s.solids.triangles);
    }
  }
  return cast;
}

// the shadow map: a box in the light's view
struct ShadowMap {
  const LightFrame& frame;
  bool any;
  double side = 1, depth = 1;
  Vec3 origin;

  std::array<float, 3> operator()(const Vec3& p) const {
    const Vec3 at = frame(p) - origin;
    return std::array<float, 3>{float(at.x() / side), float(at.y() / side), float(at.z() / depth)};
  }
};

ShadowMap fit_map(const LightView& view, const Cast& cast, bool any) {
  Extents fitted = cast.darkened;
  if (any) {
    // across the light: the range that both have; along the light: all of it
    fitted.low.head<2>() = fitted.low.cwiseMax(cast.casters.low).head<2>();
    fitted.high.head<2>() = fitted.high.cwiseMin(cast.casters.high).head<2>();
    fitted.low.z() = std::min(fitted.low.z(), cast.casters.low.z());
    fitted.high.z() = std::max(fitted.high.z(), cast.casters.high.z());
  }
  const Vec3 size = any ? Vec3(fitted.high - fitted.low) : Vec3::Zero();
  ShadowMap map{view.frame, any, 1, 1, Vec3::Zero()};
  if (any) map.side = 1.02 * std::max({size.x(), size.y(), 0.0}) + 2 * view.soft;
  if (any) map.depth = size.z() + 2 * view.soft;
  const Vec3 middle = any ? Vec3((fitted.low + fitted.high) / 2) : Vec3::Zero();
  map.origin = middle - Vec3(map.side, map.side, map.depth) / 2;
  return map;
}

// where a corner is in its material's pattern; a little below the surface, so that no face is on the edge
// of a cell
std::array<float, 4> grain(const SpaceFrame& s, const Corner& corner) {
  const Piece& piece = s.stage.pieces[std::size_t(corner.piece)];
  const Material material = s.stage.looks(piece.body).material;
  if (material != Material::wood && material != Material::checks && !piece.marked) return {};
  const sim::Snapshot::Body& body = s.now.bodies[std::size_t(piece.body)];
  const Vec3 below = corner.place - 0.02 * piece.least * corner.normal;
  Vec3 at = piece.grain * (body.orientation.conjugate() * (below - body.position));
  // no two boards are cut from one place of the tree
  if (material == Material::wood) at += std::fmod(0.618034 * piece.body, 1.0) * Vec3(11, 1.5, 2.5);
  const float which = piece.marked ? 3 : material == Material::wood ? 1 : 2;
  return {float(at.x()), float(at.y()), float(at.z()), which};
}

// all corners as the eye and the light see them
void add_vertices(SpaceFrame& s, const ShadowMap& lit) {
  const LightFrame& frame = lit.frame;
  // how near and far they are
  double near = 1e300, farthest = -1e300;
  std::vector<Eigen::Vector4d> at;
  at.reserve(s.corners.size());
  for (const Corner& c : s.corners) {
    at.push_back(s.lens.homogeneous(c.place));
    const double z = s.lens.perspective() ? at.back().w() : -at.back().z();
    near = std::min(near, z), farthest = std::max(farthest, z);
  }
  if (s.lens.perspective()) near = std::max(near, kLightNear);
  const double span = std::max(farthest - near, 1e-12 + 1e-9 * std::abs(near));
  s.solids.grained = s.stage.grained, s.solids.marked = s.stage.marked;
  s.solids.vertices.reserve(s.corners.size());
  for (std::size_t i = 0; i < s.corners.size(); ++i) {
    const Corner& c = s.corners[i];
    const Eigen::Vector4d& h = at[i];
    const double z = s.lens.perspective() ? 0.999 * near : 0.001 + 0.998 * (h.z() + farthest) / span;
    Solids::Vertex v{
        {float(h.x()), float(h.y()), float(z), float(h.w())}, c.color.lit, c.color.shaded, {}, {}};
    if (c.piece >= 0 && c.piece < int(s.stage.pieces.size())) v.grain = grain(s, c);
    if (lit.any) {
      v.light = lit(c.place);
      const double facing = std::max(-c.normal.dot(frame.away), 1e-3);
      const auto slope = [&](const Vec3& along) {
        return float(std::clamp(c.normal.dot(along) / facing, -kSteep, kSteep) * lit.side / lit.depth);
      };
      v.slope = {slope(frame.u), slope(frame.v)};
    }
    s.solids.vertices.push_back(v);
  }
}

}  // namespace

void cast_on_each_other(SpaceFrame& s) {
  const LightView view = view_from_light(s);
  const Cast cast = divide_triangles(s, view);
  const ShadowMap lit = fit_map(view, cast, !s.solids.shadowed.empty());
  for (std::size_t i = 0; i < s.chunks.size(); ++i) {
    if (!cast.casts[i]) continue;
    far_side(s, s.chunks[i], view.frame, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      for (const Vec3& p : {a, b, c}) s.solids.casters.push_back(lit(p));
    });
  }
  if (lit.any) s.solids.soft = {float(kSpread * lit.depth / lit.side), float(view.soft / lit.side)};
  add_vertices(s, lit);
}

void cast_on_ground(SpaceFrame& s, const Ground& ground) {
  GroundShadow fall(ground, s.stage.light, s.lens);
  const auto& pieces = s.stage.pieces;
  const bool many = pieces.size() > 64;
  constexpr std::uint32_t all = ~0u;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Piece& piece = pieces[i];
    const sim::Snapshot::Body& body = s.now.bodies[piece.body];
    const double near = std::min(kTouchReach * piece.least, kTouchMost * s.lens.window.width / s.lens.scale);
    if (piece.form == Piece::Form::polyhedron) {
      fall.cast(s.placed[i].vertices, 0, many, all, s.solids);
      fall.touch(s.placed[i].vertices, 0, near, many, s.solids);
      continue;
    }
    const double radius =
        s.stage.dots[piece.body] > 0 ? s.stage.dots[piece.body] / s.lens.scale : piece.radius;
    const std::array<Vec3, 2> ends{body.position + body.orientation * piece.a,
                                   body.position + body.orientation * piece.b};
    const auto places = std::span(ends).first(piece.form == Piece::Form::capsule ? 2 : 1);
    fall.cast(places, radius, many, all, s.solids);
    fall.touch(places, radius, near, many, s.solids);
  }
  for (const Rod& rod : s.rods)
    fall.cast_fine(std::array{rod.a, rod.b}, rod.radius, many || s.rods.size() > 64, stopped(rod.share),
                   s.solids);
}

}  // namespace

void add_shadows(SpaceFrame& s) {
  cast_on_each_other(s);
  const auto above = [&](const Ground& ground) {
    return ground.normal.dot(s.lens.perspective() ? Vec3(s.lens.eye() - ground.point) : s.lens.back) > 0;
  };
  if (!s.stage.ground || !above(*s.stage.ground)) return;
  s.solids.shade = s.stage.look.theme == Theme::paper ? Color{0x14, 0x1A, 0x24, 62} : Color{0, 0, 0, 132};
  s.solids.touch = s.stage.look.theme == Theme::paper ? Color{0x14, 0x1A, 0x24, 90} : Color{0, 0, 0, 150};
  cast_on_ground(s, *s.stage.ground);
  for (const Ground& slope : s.stage.slopes)
    if (above(slope)) cast_on_ground(s, slope);
}

}  // namespace obscura::draw
