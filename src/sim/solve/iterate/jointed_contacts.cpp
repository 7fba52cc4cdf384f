// Few contacts of what hangs together on joints, where iterations do not settle them: exactly, all contacts
// of such an island at once, with the answer of its joints,
//   w = K p + u,   K = J A J',   A = M^-1 - M^-1 G' (G M^-1 G')^-1 G M^-1      G  rows of the joints
// so that a light wheel bears a heavy car from the first substep on. A contact that sees the mass of its own
// body alone, in turns with the joints, would find what it has to bear by that body's share of all that hangs
// on it. What limits, ropes and motors give follows from joint iterations in between.

#include <algorithm>
#include <cmath>

#include "sim/solve/iterate/iterative.h"

namespace obscura::sim {

namespace {

constexpr int kJointedRounds = 4;         // of joints and contacts in turns
constexpr int kFewJointed[] = {24, 12};   // contacts of an island: in the plane, in space
constexpr double kSettledJointed = 1e-9;  // widths, 1/s

}  // namespace

template <int D>
void Iterative<D>::solve_jointed() {
  if (joints_.components() == 0) return;
  const int n = int(model_.bodies.size());
  std::vector<TouchEnds>& ends = jointed_.ends;
  ends.clear(), list_touches(ends);
  std::erase_if(ends, [](const TouchEnds& touch) { return touch.passes; });
  if (ends.empty()) return;
  Islands& sets = jointed_.sets;
  sets.reset(n);
  for (int c = 0; c < joints_.components(); ++c) {
    for (const int body : joints_.members(c)) sets.join(joints_.members(c)[0], body);
  }
  const auto of_moving = [&](const TouchEnds& touch) {
    return touch.a >= 0 && moves(touch.a) ? touch.a : touch.b >= 0 && moves(touch.b) ? touch.b : -1;
  };
  for (const TouchEnds& touch : ends) {
    if (touch.a >= 0 && touch.b >= 0 && moves(touch.a) && moves(touch.b)) sets.join(touch.a, touch.b);
  }
  // contacts of each island, at its root; none where nothing hangs on joints
  std::vector<int>& counts = jointed_.counts;
  counts.assign(std::size_t(n), -1);
  for (int c = 0; c < joints_.components(); ++c) {
    if (!joints_.members(c).empty()) counts[std::size_t(sets.root(joints_.members(c)[0]))] = 0;
  }
  const auto count = [&](const TouchEnds& touch) -> int* {
    const int body = of_moving(touch);
    int* const its = body < 0 ? nullptr : &counts[std::size_t(sets.root(body))];
    return its && *its >= 0 ? its : nullptr;
  };
  for (const TouchEnds& touch : ends)
    if (int* its = count(touch)) ++*its;
  std::vector<std::tuple<int, int, int>>& few = jointed_.few;
  few.clear();
  for (const TouchEnds& touch : ends) {
    const int* its = count(touch);
    if (its && *its <= kFewJointed[D - 2])
      few.emplace_back(sets.root(of_moving(touch)), touch.place, touch.number);
  }
  if (few.empty()) return;
  std::sort(few.begin(), few.end());
  bool changed = false;
  begin_jointed();
  for (int round = 0; round < kJointedRounds; ++round) {
    solve_joint_velocities();
    bool unsettled = false;
    for (std::size_t first = 0, last = 0; first < few.size(); first = last) {
      while (last < few.size() && std::get<0>(few[last]) == std::get<0>(few[first])) ++last;
      if (solve_jointed(std::span(few).subspan(first, last - first))) unsettled = true;
    }
    if (!unsettled) break;
    changed = true;
  }
  end_jointed(changed);
}

// one island; false where it has settled, or no impulses are found
template <int D>
bool Iterative<D>::solve_jointed(std::span<const std::tuple<int, int, int>> island) {
  using JointResponse = typename JointSolver<D>::JointResponse;
  const int contacts = int(island.size()), rows = D * contacts;
  std::vector<TouchRows>& touches = jointed_.touches;
  touches.resize(std::size_t(contacts));
  bool settled = true;
  for (int i = 0; i < contacts; ++i) {
    TouchRows& touch = touches[std::size_t(i)];
    touch = read_touch(std::get<2>(island[std::size_t(i)]));
    const double wrong = touch.impulse[0] > 0 ? std::fabs(touch.speed[0]) : -touch.speed[0];
    settled = settled && wrong * touch.per_width <= kSettledJointed;
  }
  if (settled) return false;
  for (const TouchRows& touch : touches) {
    for (const int body : {touch.rows[0].a, touch.rows[0].b})
      if (body >= 0 && !joints_.has(body)) joints_.body_motion(body) = begun(body);
  }
  std::vector<JointResponse>& responses = jointed_.responses;
  ExactIsland<D>& exact = jointed_.island;
  if (responses.empty()) {
    // for all that there may be, so that later steps allocate nothing
    responses.resize(std::size_t(D * kFewJointed[D - 2]));
    for (JointResponse& response : responses) joints_.reserve(response);
    touches.reserve(std::size_t(kFewJointed[D - 2])), exact.reserve();
  }
  exact.resize(contacts);
  for (int i = 0; i < rows; ++i) {
    const TouchRows& touch = touches[std::size_t(i / D)];
    JointResponse& response = responses[std::size_t(i)];
    response.row = touch.rows[std::size_t(i % D)];
    joints_.compute_response(response);
    if (i % D == 0) {
      // what joints leave nothing to move is not to be found so
      if (joints_.holds(response)) return false;
      exact.blocks[std::size_t(i / D)] = {.mu = touch.mu};
    }
    exact.speeds[i] = touch.speed[i % D], exact.p[i] = touch.impulse[i % D];
    for (int j = 0; j <= i; ++j)
      exact.K(i, j) = exact.K(j, i) = joints_.response_between(response, responses[std::size_t(j)]);
  }
  if (!exact.solve()) return false;
  for (int i = 0; i < rows; ++i) {
    TouchRows& touch = touches[std::size_t(i / D)];
    const double change = exact.p[i] - touch.impulse[i % D];
    touch.impulse[i % D] = exact.p[i];
    if (change == 0) continue;
    joints_.answer(responses[std::size_t(i)], change);
    joints_.each_push(responses[std::size_t(i)], change,
                      [&](int body, const Vec<D>& v, const AngularVec<D>& w) {
                        if (body < 0 || !moves(body)) return;
                        MovingBody<D>& m = moving_[std::size_t(body)];
                        set_velocity(m, velocity(m) + v, spin(m) + w);
                      });
  }
  for (int i = 0; i < contacts; ++i)
    write_touch(std::get<2>(island[std::size_t(i)]), touches[std::size_t(i)]);
  return true;
}

template void Iterative<2>::solve_jointed();
template void Iterative<3>::solve_jointed();

}  // namespace obscura::sim
