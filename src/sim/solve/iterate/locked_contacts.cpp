// Contacts along whose normals joints leave nothing to move: a top on a pivot at its tip that stands on the
// floor there, a crate on the floor that is welded to the room. No motion says which part of the load such a
// contact bears and which the joints, so iterations do without it. It bears, of all that comes to the same
// motion, what is of least norm with the forces of the joints:
//   min |l + a p|^2 + |p|^2,  p >= 0
//     l  forces of the joints' rows if it bears nothing, N; N m by the size of the scene
//     a  what they change by for a unit along each normal
// The rows of contacts are those of the middle of the substep, the joints' those of its beginning. They
// differ by what turns meanwhile, and were both iterated, each would add a push against the other's in each
// iteration and each substep: a top of 40 kg pressed the floor with 7500 N, and its pivot pulled it down with
// 7100 N.
//
// What rubs where it may slide keeps what iterations find: friction needs its force on the way. So does what
// kinematic bodies press.

#include <algorithm>
#include <cmath>

#include "sim/solve/iterate/iterative.h"

namespace obscura::sim {

namespace {

constexpr double kMovesBy = 1e-3;      // of the scene's size, 1/s: what has a speed of its own is not locked
constexpr double kStandsStill = 1e-9;  // likewise
constexpr double kGolden = 0.6180339887498949;
constexpr int kSharingRounds = 100;
constexpr double kShared = 1e-14;  // of the largest force

}  // namespace

template <int D>
void JointSolver<D>::try_motion() {
  // multiples of the golden mean, modulo 1, are all different, and far from any ratio that a scene has
  double number = 0;
  const auto next = [&] { return (number = std::fmod(number + kGolden, 1.0)) - 0.5; };
  for (const int body : bodies_) {
    BodyMotion<D>& at = at_[std::size_t(body)];
    at.v.setZero(), at.w.setZero();
    if (!response_.moves(body)) continue;
    for (int k = 0; k < D; ++k) at.v[k] = model_.scale * next();
    for (int k = 0; k < int(at.w.size()); ++k) at.w[k] = next();
  }
  solve_positions();
}

// By projected Gauss-Seidel; each diagonal has the one of |p|^2, so that it converges.
template <int D>
void JointSolver<D>::share_loads(std::span<const JointResponse> contacts, std::span<double> forces,
                                 double h) {
  for (std::size_t r = 0; r < rows_.size(); ++r) loads_[r] = end_forces_[r] + impulses_[r] / h;
  const auto each_answer = [&](const JointResponse& contact, auto&& act) {
    for (int s = 0; s < 2; ++s)
      each_row(contact.components[s],
               [&](int k, int r) { act(std::size_t(r), contact.answer[s][std::size_t(k)]); });
  };
  std::fill(forces.begin(), forces.end(), 0.0);
  double change = 1, most = 0;
  for (int round = 0; round < kSharingRounds && change > kShared * most; ++round) {
    change = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      double square = 0, along = 0;
      each_answer(contacts[i], [&](std::size_t r, double a) {
        const double per_size = 1 / sim::in_metres(rows_[r], model_.scale), as_force = a * per_size;
        square += as_force * as_force, along += as_force * per_size * loads_[r];
      });
      const double next = std::max(0.0, (square * forces[i] - along) / (square + 1));
      const double by = next - forces[i];
      forces[i] = next, change = std::max(change, std::fabs(by)), most = std::max(most, next);
      each_answer(contacts[i], [&](std::size_t r, double a) { loads_[r] += a * by, relief_[r] += a * by; });
    }
  }
}

// Finds them, and takes them out of the iterations.
template <int D>
void Iterative<D>::open_locked() {
  locked_.numbers.clear();
  if (joints_.components() == 0) return;
  std::vector<TouchEnds>& ends = locked_.ends;
  ends.clear(), list_touches(ends);
  const auto component = [&](int body) { return body < 0 || !moves(body) ? -1 : joints_.component(body); };
  const auto free = [&](int body) { return body >= 0 && moves(body) && component(body) < 0; };
  std::erase_if(ends, [&](const TouchEnds& touch) {
    return (component(touch.a) < 0 && component(touch.b) < 0) || free(touch.a) || free(touch.b);
  });
  if (ends.empty()) return;
  joints_.try_motion();
  std::erase_if(ends, [&](const TouchEnds& touch) {
    return std::fabs(joints_.row_speed(begun_rows(touch.number)[0])) > kMovesBy * model_.scale;
  });
  if (ends.empty()) return;
  velocities_to_joints();
  std::sort(ends.begin(), ends.end(), [](const auto& p, const auto& q) { return p.place < q.place; });
  begin_jointed();
  for (const TouchEnds& touch : ends) {
    std::size_t count = locked_.numbers.size();
    if (locked_.responses.size() == count) joints_.reserve(locked_.responses.emplace_back());
    if (locks(touch.number, locked_.responses[count]) && open_touch(touch.number))
      locked_.numbers.push_back(touch.number);
  }
  end_jointed(!locked_.numbers.empty());
}

// Whether joints hold what touches there: along the normal, and where it rubs across it too.
template <int D>
bool Iterative<D>::locks(int touch, typename JointSolver<D>::JointResponse& response) {
  const std::array<Row<D>, D> rows = begun_rows(touch);
  for (const int body : {rows[0].a, rows[0].b})
    if (body >= 0 && model_.bodies[std::size_t(body)].driven) return false;
  const bool rubs = read_touch(touch).mu > 0;
  for (std::size_t i = rubs ? D : 1; i-- > 0;) {
    response.row = rows[i];
    if (!joints_.locks(response)) return false;
  }
  return std::fabs(joints_.given(response)) <= kStandsStill * model_.scale;
}

template <int D>
void Iterative<D>::bear_locked(StepPart<D> part) {
  const std::size_t count = locked_.numbers.size();
  if (count == 0) return;
  locked_.forces.resize(count);
  joints_.share_loads(std::span(locked_.responses).first(count), locked_.forces, part.h);
  for (std::size_t i = 0; i < count; ++i) bear_touch(part, locked_.numbers[i], locked_.forces[i]);
}

template void JointSolver<2>::try_motion();
template void JointSolver<3>::try_motion();
template void JointSolver<2>::share_loads(std::span<const JointResponse>, std::span<double>, double);
template void JointSolver<3>::share_loads(std::span<const JointResponse>, std::span<double>, double);
template void Iterative<2>::open_locked();
template void Iterative<3>::open_locked();
template void Iterative<2>::bear_locked(StepPart<2>);
template void Iterative<3>::bear_locked(StepPart<3>);

}  // namespace obscura::sim
