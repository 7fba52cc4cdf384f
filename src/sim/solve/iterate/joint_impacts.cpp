// Joints where impacts find them: the ends that are reached there, limits and taut ropes, which push back in
// the same instant; and what the iterations after them keep.
//   J(t) dv = 0 of an impact at t    the speeds that rows of the substep's beginning keep grow by J(0) dv

#include <algorithm>

#include "sim/solve/iterate/joint_solver.h"

namespace obscura::sim {

template <int D>
std::span<const typename JointSolver<D>::JointResponse> JointSolver<D>::reached_ends(int component) {
  if (component < 0 || with_ends_[std::size_t(component)].empty()) return {};
  ReachedEnds& its = reached_[std::size_t(component)];
  if (!its.known) find_reached_ends(component);
  return {its.ends.data(), std::size_t(its.count)};
}

template <int D>
void JointSolver<D>::find_reached_ends(int component) {
  ReachedEnds& its = reached_[std::size_t(component)];
  its.known = true, its.count = 0, its.which.clear();
  for (const int block : with_ends_[std::size_t(component)]) {
    const int number = held_[std::size_t(block)];
    const Joint<D>& joint = model_.joints[std::size_t(number)];
    for (const Load load : {lower, upper}) {
      const bool has = one_sided(joint) ? load == upper
                       : load == lower  ? joint.lower > -1e299
                                        : joint.upper < 1e299;
      if (!has) continue;
      if (holds_[std::size_t(number)].load != load && left(number, load) > kTaut * size(number)) continue;
      if (its.count == int(its.ends.size())) its.ends.emplace_back();
      JointResponse& end = its.ends[std::size_t(its.count)];
      bounded_row(block, load, end.row);
      compute_response(end);
      if (!(effective_mass(end) > 0)) continue;
      ++its.count, its.which.emplace_back(block, load);
    }
  }
}

// the ends that another solver has reached, where bodies stand here
template <int D>
void JointSolver<D>::take_ends(const JointSolver& begun, int component, int count) {
  ReachedEnds& its = reached_[std::size_t(component)];
  its.known = true, its.count = count;
  if (int(its.ends.size()) < count) its.ends.resize(std::size_t(count));
  for (int i = 0; i < count; ++i) {
    const auto& [block, load] = begun.reached_[std::size_t(component)].which[std::size_t(i)];
    bounded_row(block, load, its.ends[std::size_t(i)].row);
    compute_response(its.ends[std::size_t(i)]);
  }
}

template <int D>
void JointSolver<D>::keep_struck_speeds(const JointSolver& struck, double h) {
  for (int component = 0; component < components(); ++component) {
    const double placed_at = struck.placed_at_[std::size_t(component)];
    const auto stays = [&](int body) {
      return at_[std::size_t(body)].v.isZero(0) && at_[std::size_t(body)].w.isZero(0);
    };
    const std::span<const int> its = members(component);
    if (placed_at < 0 || std::all_of(its.begin(), its.end(), stays)) continue;
    left_[std::size_t(component)] = 1 - placed_at / h;
    each_row(component, [&](int, int r) { targets_[std::size_t(r)] += speed(rows_[std::size_t(r)], at_); });
    // an end that has been struck may leave, but is not pulled back
    for (const int block : with_ends_[std::size_t(component)]) {
      Hold& hold = holds_[std::size_t(held_[std::size_t(block)])];
      if (hold.load != lower && hold.load != upper) continue;
      Row<D> row;
      bounded_row(block, hold.load, row);
      hold.target += std::min(speed(row, at_), 0.0);
    }
  }
}

#define OBSCURA_INSTANTIATE(D)                                                                        \
  template std::span<const typename JointSolver<D>::JointResponse> JointSolver<D>::reached_ends(int); \
  template void JointSolver<D>::take_ends(const JointSolver<D>&, int, int);                           \
  template void JointSolver<D>::keep_struck_speeds(const JointSolver<D>&, double)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim
