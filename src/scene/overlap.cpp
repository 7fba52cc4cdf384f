#include "scene/overlap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "scene/meetings.h"
#include "sim/collide/may_touch.h"
#include "sim/collide/narrow_phase.h"
#include "sim/collide/rails.h"
#include "sim/model/body_motion.h"
#include "sim/shape/convex_polygon.h"
#include "sim/shape/shape.h"

namespace obscura::scene {

namespace {

constexpr std::int64_t kMostCounted = 100'000;    // overlaps that are counted, at most
constexpr std::int64_t kMostLooked = 20'000'000;  // pairs that are near each other: each takes 500 bytes

std::pair<int, int> ordered(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

struct OverlapsFound {
  int a = -1, b = -1;  // the first pair
  double depth = 0;
  int more = 0;
};

// the properties of a body that decide which others it may overlap
struct Kind {
  bool point = false, fixed = false;
  int group = 0;

  auto operator<=>(const Kind&) const = default;
};

// how deep the balls of a shape are in a rail, m; zero: not, or wholly behind it
template <int D>
double depth_in_rail(const sim::Shape<D>& shape, const sim::BodyMotion<D>& at, const sim::Rail<D>& rail,
                     const sim::BodyMotion<D>& rail_at) {
  double most = 0;
  std::vector<typename sim::Curve<D>::Foot> feet;
  for (const sim::SupportVertex<D>& tip : sim::support_vertices(shape)) {
    if (tip.radius == 0) continue;
    const sim::Vec<D> p = rail_at.room_from_body.transpose() * (at.x + at.arm(tip.at) - rail_at.x);
    feet.clear();
    rail.curve->feet(p, tip.radius, feet);
    for (const auto& foot : feet) {
      const sim::Vec<D> e = p - foot.at.x;
      if constexpr (D == 2) {
        const double left = foot.at.tangent[0] * e[1] - foot.at.tangent[1] * e[0];
        if (!(left >= 0 ? rail.left : rail.right)) continue;
      }
      most = std::max(most, tip.radius - e.norm());
    }
  }
  if constexpr (D == 2) {
    // places of the curve within a polygon that stands in front of it
    const sim::RelativePose lies = sim::inverse(sim::relative_pose(at, rail_at));
    const double size = sim::bounding_radius(shape);
    const auto middle = rail.curve->nearest(rail_at.room_from_body.transpose() * (at.x - rail_at.x));
    const sim::Vec<2> e = rail_at.room_from_body.transpose() * (at.x - rail_at.x) - middle.at.x;
    const double left = middle.at.tangent[0] * e[1] - middle.at.tangent[1] * e[0];
    if (!(left >= 0 ? rail.left : rail.right) || e.norm() > size) return most;
    for (int i = 0; i < sim::parts(shape); ++i) {
      const sim::ConvexPolygon polygon(sim::part(shape, i));
      if (polygon.faces() == 0) continue;
      const auto depth = [&](const sim::Vec<2>& x) {
        double least = 1e300;
        for (int k = 0; k < polygon.faces(); ++k)
          least = std::min(least, polygon.normal(k).dot(polygon.corner(k) - x));
        return least;
      };
      for (int piece = 0; piece < rail.curve->size(); ++piece) {
        const auto& its = rail.curve->piece(piece);
        const int looks = std::clamp(int(std::ceil(20 * its.length / size)), 2, 1000);
        for (int k = 0; k <= looks; ++k)
          most = std::max(most, depth(lies * rail.curve->at(piece, its.end * k / looks).x));
      }
    }
  }
  return most;
}

std::string more_text(int more, bool counted) {
  if (more == 0) return "";
  if (more == 1 && counted) return ", and another pair does";
  return fmt::format(", and {}{} more pairs do", counted ? "" : "at least ", more);
}

}  // namespace

template <int D>
void refuse_overlaps(const NameTable& roster, const sim::World<D>& world, Diagnostics& complaints) {
  const sim::Model<D>& model = world.model;
  const bool refuse = model.overlap == sim::Overlap::refuse;
  const sim::MayTouch<D> may_touch(model);

  // kinds of bodies, the first body of each, and the boxes around them
  const int n = int(model.bodies.size());
  std::vector<int> kinds;
  std::map<Kind, int> index;
  std::vector<int> kind_of(static_cast<std::size_t>(n), -1), group_of(static_cast<std::size_t>(n), 0);
  std::vector<sim::Bounds<D>> boxes;
  for (int i = 0; i < n; ++i) {
    const sim::Body<D>& body = model.bodies[std::size_t(i)];
    boxes.push_back(sim::bounds(body.shape, sim::body_motion(world.state, i)));
    if (body.handout || body.bare) continue;
    const Kind kind{sim::is_point(body.shape), body.fixed, body.group};
    const auto [known, fresh] = index.emplace(kind, int(kinds.size()));
    if (fresh) kinds.push_back(i);
    kind_of[std::size_t(i)] = known->second;
  }
  for (std::size_t g = 0; g < roster.groups.size(); ++g)
    std::fill_n(group_of.begin() + roster.groups[g].first, roster.groups[g].count, int(g));
  const auto keep_apart = [&](int k, int l) {
    return may_touch.but_for_joints(kinds[std::size_t(k)], kinds[std::size_t(l)]);
  };

  std::vector<OverlapsFound> found(roster.groups.size());
  std::int64_t looked = 0, overlapping = 0;
  meetings<D>(boxes, kind_of, keep_apart, [&](int a, int b) {
    if (++looked > kMostLooked) return false;
    if (!refuse) return true;
    if (!may_touch(a, b)) return true;
    const sim::Shape<D>&one = model.bodies[std::size_t(a)].shape, &other = model.bodies[std::size_t(b)].shape;
    const double depth =
        -sim::separation(one, sim::body_motion(world.state, a), other, sim::body_motion(world.state, b));
    const double size = 2 * std::max(std::min(sim::bounding_radius(one), sim::bounding_radius(other)),
                                     1e-3 * std::max(sim::bounding_radius(one), sim::bounding_radius(other)));
    if (!(depth > kAllowedOverlap * size)) return true;
    ++overlapping;
    OverlapsFound& its = found[std::size_t(group_of[std::size_t(b)])];
    if (its.a < 0 || ordered(b, a) < ordered(its.b, its.a)) {
      its = {a, b, depth, its.a < 0 ? 0 : its.more + 1};
    } else {
      ++its.more;
    }
    return overlapping < kMostCounted;
  });

  // bodies in tracks
  for (const sim::Rail<D>& rail : model.rails) {
    const sim::BodyMotion<D> at = sim::body_motion(world.state, rail.body);
    for (int i = 0; refuse && i < n; ++i) {
      const sim::Body<D>& body = model.bodies[std::size_t(i)];
      if (i == rail.body || body.fixed || !sim::touches_rails<D>(body.shape) || !may_touch(i, rail.body))
        continue;
      const double depth = depth_in_rail(body.shape, sim::body_motion(world.state, i), rail, at);
      if (!(depth > kAllowedOverlap * 2 * sim::bounding_radius(body.shape))) continue;
      complaints.add(roster.groups[std::size_t(group_of[std::size_t(i)])].at,
                     fmt::format("'{}' overlaps the track '{}' by {:.3g} m at the start; move it away",
                                 body.name, rail.name, depth));
      break;
    }
  }

  for (std::size_t g = 0; g < found.size(); ++g) {
    const OverlapsFound& its = found[g];
    if (its.a < 0) continue;
    complaints.add(
        roster.groups[g].at,
        fmt::format(
            "'{}' and '{}' overlap by {:.3g} m at the start{}; move them apart, or let them be pushed: "
            "[physics] overlap = \"separate\"",
            model.bodies[std::size_t(its.a)].name, model.bodies[std::size_t(its.b)].name, its.depth,
            more_text(its.more, overlapping < kMostCounted)));
  }
  if (looked > kMostLooked)
    complaints.add({}, fmt::format("more than {} pairs of bodies are near each other at the start, too many "
                                   "to be simulated; move them apart",
                                   kMostLooked));
}

template void refuse_overlaps<2>(const NameTable&, const sim::World<2>&, Diagnostics&);
template void refuse_overlaps<3>(const NameTable&, const sim::World<3>&, Diagnostics&);

}  // namespace obscura::scene
