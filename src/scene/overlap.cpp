#include "scene/overlap.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "sim/gap.h"
#include "sim/shape.h"
#include "sim/turning.h"

namespace obscura::scene {

namespace {

constexpr double kAllowed = 1e-6;  // of the smaller body's size: what the first step puts right

std::pair<int, int> ordered(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

struct Found {
  int a = -1, b = -1;  // the first pair
  double depth = 0;
  int more = 0;
};

}  // namespace

template <int D>
void refuse_overlaps(const Roster& roster, const sim::World<D>& world, Complaints& complaints) {
  const sim::Model<D>& model = world.model;
  std::set<std::pair<int, int>> joined, ignored;
  for (const sim::Joint<D>& joint : model.joints)
    if (!joint.touching) joined.insert(ordered(joint.a.body, joint.b.body));
  for (const auto& [a, b] : model.ignore) ignored.insert(ordered(a, b));
  const auto keep_apart = [&](int a, int b) {
    const sim::Body<D>&one = model.bodies[std::size_t(a)], &other = model.bodies[std::size_t(b)];
    const bool points = one.shape.kind == sim::ShapeKind::point && other.shape.kind == sim::ShapeKind::point;
    return !points && !one.handout && !other.handout && !(one.fixed && other.fixed) &&
           !ignored.contains(ordered(one.group, other.group)) && !joined.contains(ordered(a, b));
  };

  // neighbours by sweeping along x
  const int n = int(model.bodies.size());
  std::vector<sim::Bounds<D>> boxes;
  for (int i = 0; i < n; ++i)
    boxes.push_back(sim::bounds(model.bodies[std::size_t(i)].shape, sim::stance(world.state, i)));
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::pair(boxes[std::size_t(a)].lower.x(), a) < std::pair(boxes[std::size_t(b)].lower.x(), b);
  });
  std::vector<Found> found(roster.groups.size());
  std::vector<int> group_of(static_cast<std::size_t>(n), 0);
  for (std::size_t g = 0; g < roster.groups.size(); ++g)
    std::fill_n(group_of.begin() + roster.groups[g].first, roster.groups[g].count, int(g));
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t k = i + 1; k < order.size(); ++k) {
      const auto [a, b] = ordered(order[i], order[k]);
      if (boxes[std::size_t(order[k])].lower.x() > boxes[std::size_t(order[i])].upper.x()) break;
      if (!boxes[std::size_t(a)].meets(boxes[std::size_t(b)]) || !keep_apart(a, b)) continue;
      const sim::Shape<D>&one = model.bodies[std::size_t(a)].shape,
            &other = model.bodies[std::size_t(b)].shape;
      const double depth =
          -sim::separation(one, sim::stance(world.state, a), other, sim::stance(world.state, b));
      const double size = 2 * std::max(std::min(sim::reach(one), sim::reach(other)),
                                       1e-3 * std::max(sim::reach(one), sim::reach(other)));
      if (!(depth > kAllowed * size)) continue;
      Found& its = found[std::size_t(group_of[std::size_t(b)])];
      if (its.a < 0 || ordered(b, a) < ordered(its.b, its.a)) {
        its = {a, b, depth, its.a < 0 ? 0 : its.more + 1};
      } else {
        ++its.more;
      }
    }
  }
  for (std::size_t g = 0; g < found.size(); ++g) {
    const Found& its = found[g];
    if (its.a < 0) continue;
    complaints.add(
        roster.groups[g].at,
        fmt::format(
            "'{}' and '{}' overlap by {:.3g} m at the start{}; move them apart, or let them be pushed: "
            "[physics] overlap = \"separate\"",
            model.bodies[std::size_t(its.a)].name, model.bodies[std::size_t(its.b)].name, its.depth,
            its.more == 0   ? ""
            : its.more == 1 ? ", and another pair does"
                            : fmt::format(", and {} more pairs do", its.more)));
  }
}

template void refuse_overlaps<2>(const Roster&, const sim::World<2>&, Complaints&);
template void refuse_overlaps<3>(const Roster&, const sim::World<3>&, Complaints&);

}  // namespace obscura::scene
