// Joints where impacts find them: the ends that are reached there, limits and taut ropes, which push back in
// the same instant; and what the iterations after them keep.
//   J(t) dv = 0 of an impact at t    the speeds that rows of the substep's beginning keep grow by J(0) dv

#include <algorithm>

#include "sim/solve/iterate/closing_time.h"
#include "sim/solve/iterate/joint_solver.h"

namespace obscura::sim {

namespace {

constexpr int kMostReturns = 16;  // to an end, in a substep: what has come back so often rests on it
constexpr double kSoon = 1e-3;  // of what is left of a substep: what has not come nearer by then leaves

}  // namespace

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
    for (const Load load : {lower, upper}) {
      if (!has_end(block, load)) continue;
      if (holds_[std::size_t(number)].load != load && left(number, load) > kTaut * size(number)) continue;
      add_end(component, block, load);
    }
  }
}

// false where joints leave it nothing to move
template <int D>
bool JointSolver<D>::add_end(int component, int block, Load load) {
  ReachedEnds& its = reached_[std::size_t(component)];
  if (its.count == int(its.ends.size())) its.ends.emplace_back();
  JointResponse& end = its.ends[std::size_t(its.count)];
  bounded_row(block, load, end.row);
  compute_response(end);
  if (!(effective_mass(end) > 0)) return false;
  ++its.count, its.which.emplace_back(block, load);
  return true;
}

template <int D>
double JointSolver<D>::next_end(JointSolver& begun, int component, double from, double until,
                                const Place& place, End& which) {
  if (with_ends_[std::size_t(component)].empty()) return kNeverCloses;
  (void)begun.reached_ends(component);
  const ReachedEnds& known = begun.reached_[std::size_t(component)];
  placed_at_[std::size_t(component)] = -1;
  const auto place_all = [&](double time) {
    place_as(begun, component,
             [&](int body, BodyMotion<D>& at, Orientation<D>& turn) { place(time, body, at, turn); });
  };
  ways_to_ends_.clear();
  place_all(from);
  for (const int block : with_ends_[std::size_t(component)]) {
    for (const Load load : {lower, upper}) {
      if (!has_end(block, load) || known.has(block, load)) continue;
      if (begun.times_reached(block, load) >= kMostReturns) continue;
      ways_to_ends_.push_back({{block, load}, left(End{block, load})});
    }
  }
  if (ways_to_ends_.empty()) return kNeverCloses;
  place_all(until);
  // what is beyond its end goes there only if it comes deeper
  std::erase_if(ways_to_ends_,
                [&](const WayToEnd& way) { return !(left(way.end) < std::min(way.left, 0.0)); });
  double first = kNeverCloses;
  for (const WayToEnd& way : ways_to_ends_) {
    const auto passed = [&](double time) {
      model_.joints[std::size_t(held_[std::size_t(way.end.block)])].each_body([&](int body) {
        if (body < 0) return;
        at_[std::size_t(body)] = begun.at_[std::size_t(body)];
        turn_[std::size_t(body)] = begun.turn_[std::size_t(body)];
        place(time, body, at_[std::size_t(body)], turn_[std::size_t(body)]);
      });
      return !(left(way.end) > 0);
    };
    double low = from, high = std::min(first, until);
    if (way.left <= kMet * size(held_[std::size_t(way.end.block)])) {
      // it is there, and may just leave
      (void)passed(from + kSoon * (until - from));
      if (!(left(way.end) < way.left)) continue;
      high = low;
    } else if (high < until && !passed(high)) {
      continue;  // not before one that is known
    }
    while (high - low > kInTime * until) {
      const double mid = 0.5 * (low + high);
      (passed(mid) ? high : low) = mid;
    }
    first = high, which = way.end;
  }
  return first;
}

template <int D>
void JointSolver<D>::reach(JointSolver& begun, int component, const End& end) {
  int& times = begun.times_reached(end.block, Load(end.load));
  times = begun.add_end(component, end.block, Load(end.load)) ? times + 1 : kMostReturns;
  placed_at_[std::size_t(component)] = -1;
}

template <int D>
void JointSolver<D>::leave(JointSolver& begun, int component, int i) {
  ReachedEnds& its = begun.reached_[std::size_t(component)];
  const auto [block, load] = its.which[std::size_t(i)];
  if (begun.times_reached(block, load) >= kMostReturns) return;
  const auto last = std::size_t(--its.count);
  std::swap(its.ends[std::size_t(i)], its.ends[last]), std::swap(its.which[std::size_t(i)], its.which[last]);
  its.which.pop_back();
  placed_at_[std::size_t(component)] = -1;
}

// the ends that another solver has reached, where bodies stand here, and those that they have come to
template <int D>
void JointSolver<D>::take_ends(JointSolver& begun, int component) {
  (void)begun.reached_ends(component);
  const ReachedEnds& there = begun.reached_[std::size_t(component)];
  for (const int block : with_ends_[std::size_t(component)]) {
    for (const Load load : {lower, upper}) {
      if (has_end(block, load) && left(End{block, load}) <= kMet * size(held_[std::size_t(block)]) &&
          !there.has(block, load))
        begun.add_end(component, block, load);
    }
  }
  ReachedEnds& its = reached_[std::size_t(component)];
  its.known = true, its.count = there.count;
  if (int(its.ends.size()) < its.count) its.ends.resize(std::size_t(its.count));
  for (int i = 0; i < its.count; ++i) {
    const auto& [block, load] = there.which[std::size_t(i)];
    bounded_row(block, load, its.ends[std::size_t(i)].row);
    compute_response(its.ends[std::size_t(i)]);
  }
}

template <int D>
void JointSolver<D>::keep_struck_speeds(const JointSolver& struck, double h) {
  for (int component = 0; component < components(); ++component) {
    const double struck_at = struck.struck_at_[std::size_t(component)];
    const auto stays = [&](int body) {
      return at_[std::size_t(body)].v.isZero(0) && at_[std::size_t(body)].w.isZero(0);
    };
    const std::span<const int> its = members(component);
    if (struck_at < 0 || std::all_of(its.begin(), its.end(), stays)) continue;
    left_[std::size_t(component)] = 1 - struck_at / h;
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
  template void JointSolver<D>::reach(JointSolver<D>&, int, const End&);                              \
  template void JointSolver<D>::leave(JointSolver<D>&, int, int);                                     \
  template double JointSolver<D>::next_end(JointSolver<D>&, int, double, double, const Place&, End&); \
  template void JointSolver<D>::take_ends(JointSolver<D>&, int);                                      \
  template void JointSolver<D>::keep_struck_speeds(const JointSolver<D>&, double)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim
