// Places back onto what joints keep, and what that makes of velocities: the end of a step by Rattle,
//   x'  = x + M^-1 J s           s: C(x') = 0, Newton with the factors at hand
//   v'  = v* + M^-1 (J (s / h - l / 2) + J' (s / h + l / 2) + J' m)     m: J' v' = 0

#include "sim/solve/iterate/joint_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace obscura::sim {

namespace {

constexpr std::size_t kMostTogether = 100;  // ends of one component: of more, one after another
constexpr double kSame = 1e-9;              // of one: what is left of another that says the same
constexpr int kRounds = 8;                  // of Newton's
constexpr int kAgain = 3;                   // ends that were put, after joints
constexpr int kSearches = 12;               // the same, with a search along each
constexpr double kStride = 0.1;             // rad, and of the scene's size: farther nothing is put in a step
constexpr double kLeastFraction = 1e-3;     // of a way, in it
constexpr double kHardlyMore = 1e-9;        // of what the free motion has given

}  // namespace

template <int D>
void JointSolver<D>::solve_positions() {
  for (std::size_t r = 0; r < rows_.size(); ++r) rhs_[r] = -speed(rows_[r], at_);
  factors_.solve(rhs_.data());
  for (std::size_t r = 0; r < rows_.size(); ++r) push(rows_[r], rhs_[r]);
}

// how far joints are off, at most, m, a radian as the size of the scene; into rhs_ what would bring each row
// back
template <int D>
double JointSolver<D>::position_error() {
  double worst = 0;
  for (int k = 0; k < int(held_.size()); ++k) {
    const Joint<D>& joint = model_.joints[held_[k]];
    rhs_[std::size_t(bounded_row(k))] = 0;
    if (one_sided(joint)) continue;
    Row<D> out[kMostHeld<D>];
    double off[kMostHeld<D>];
    const int n = rows(joint, side(joint.a.body), side(joint.b.body), turn_between(joint), out, off, at_);
    for (int i = 0; i < n; ++i) {
      rhs_[factors_.first(k) + i] = -off[i];
      worst = std::max(worst, std::fabs(off[i]) * sim::in_metres(out[i], model_.scale));
    }
  }
  return worst;
}

// whether all are near where they stood before they were put back
template <int D>
bool JointSolver<D>::near() const {
  for (const int i : bodies_) {
    if ((at_[i].x - begun_at_[i].x).norm() > kStride * model_.scale) return false;
    if ((at_[i].room_from_body - begun_at_[i].room_from_body).norm() > kStride) return false;
  }
  return true;
}

// Motors that hold their speed all through the step, to where it leads them: else what the forces change by
// within a step adds up.
template <int D>
void JointSolver<D>::put_motors() {
  for (std::size_t k = 0; k < active_; ++k) {
    Bounded& bounded = bounded_[k];
    if (bounded.load != motor || bounded.ends == kEndless || !within(bounded)) continue;
    const Joint<D>& joint = model_.joints[std::size_t(bounded.joint)];
    Row<D> row;
    double value = 0;
    free_row(joint, side(joint.a.body), side(joint.b.body), turn_between(joint), row, value);
    const double off = bounded.ends - value;
    if (std::fabs(off) < kStride * size(bounded.joint)) shift_bounded(bounded, off * bounded.effective_mass);
  }
}

// What the rows of together_ answer each other, of a component whose rows with bounds begin there.
template <int D>
void JointSolver<D>::couple_together(int begin) {
  const std::size_t n = together_.size();
  coupling_.resize(n * n), offs_.resize(n), sizes_.resize(n);
  // ways and angles have other units: each by its own size
  for (std::size_t p = 0; p < n; ++p) sizes_[p] = std::sqrt(together(p).effective_mass);
  for (std::size_t p = 0; p < n; ++p)
    for (std::size_t q = 0; q < n; ++q)
      coupling_[p * n + q] =
          sizes_[p] * sizes_[q] * yields_[std::size_t(together(p).first + together_[q] - begin)];
  ends_together_.symmetric(coupling_, int(n), kSame);
}

// offs_ -> K^-1 offs_; of rows that say the same, what is of least norm
template <int D>
void JointSolver<D>::solve_together() {
  for (std::size_t p = 0; p < together_.size(); ++p) offs_[p] *= sizes_[p];
  ends_together_.solve(offs_, offs_);
  for (std::size_t p = 0; p < together_.size(); ++p) offs_[p] *= sizes_[p];
}

// The rows of a component that are within their bounds, to their speeds at once, where that keeps them
// within: on something light a round over them leaves each a part of what the others did.
template <int D>
void JointSolver<D>::solve_within(int begin, int end) {
  together_.clear();
  for (int i = begin; i < end; ++i) {
    const Bounded& bounded = bounded_[std::size_t(by_component_[std::size_t(i)])];
    if (within(bounded) && bounded.effective_mass > 0) together_.push_back(i);
  }
  const std::size_t n = together_.size();
  if (n < 2 || n > kMostTogether) return;
  couple_together(begin);
  for (std::size_t p = 0; p < n; ++p) offs_[p] = -speeds_[std::size_t(together_[p])];
  solve_together();
  for (std::size_t p = 0; p < n; ++p) {
    const Bounded& bounded = together(p);
    const double next = bounded.impulse + offs_[p];
    if (!(next >= bounded.least && next <= bounded.most)) return;
  }
  for (std::size_t p = 0; p < n; ++p) {
    Bounded& bounded = together(p);
    bounded.impulse += offs_[p], changes_[std::size_t(together_[p])] += offs_[p];
    for (int j = begin; j < end; ++j)
      speeds_[std::size_t(j)] += yields_[std::size_t(bounded.first + j - begin)] * offs_[p];
  }
}

// Ropes and limits of a component that held to the end, together; also all that are beyond their ends; or
// `again` those that were. One after another those on something light would undo each other's work, and after
// some steps be taken for slack.
//   K s = -C     K: their coupling, with the joints' reaction; of ends that say the same s of least norm
template <int D>
void JointSolver<D>::put_ends(double h, PutEnds which) {
  if (active_ == 0) return;
  for (int component = -1; component < components(); ++component) {
    const int begin = component_first_[component + 1], end = component_first_[component + 2];
    together_.clear(), puts_.clear();
    for (int i = begin; i < end; ++i) {
      const Bounded& bounded = bounded_[std::size_t(by_component_[std::size_t(i)])];
      if (bounded.load > upper || !(bounded.effective_mass > 0)) continue;
      if (held_there(bounded, h) || (which == PutEnds::beyond && left(bounded.joint, bounded.load) < 0) ||
          (which == PutEnds::again && bounded.put_back &&
           std::fabs(left(bounded.joint, bounded.load)) <= kErrs * size(bounded.joint)))
        together_.push_back(i), puts_.push_back(bounded.put);
    }
    const std::size_t n = together_.size();
    if (n == 0 || n > kMostTogether) continue;
    couple_together(begin);
    // how far they are off, at most
    const auto error = [&] {
      double worst = 0;
      for (std::size_t p = 0; p < n; ++p) {
        offs_[p] = -left(together(p).joint, together(p).load);
        worst = std::max(worst, std::fabs(offs_[p]) * in_metres(together(p).joint));
      }
      return worst;
    };
    begun_at_ = at_, begun_turn_ = turn_;
    const double strayed = position_error(), begun = error(), close = 1e-15 * model_.scale;
    double worst = begun, before = kEndless;
    for (int round = 0; round < kRounds && worst > close && worst <= 0.9 * before; ++round) {
      before = worst;
      solve_together();
      for (std::size_t p = 0; p < n; ++p) shift_bounded(together(p), offs_[p]);
      worst = error();
    }
    const bool helped = near() && worst <= begun && position_error() <= strayed + begun;
    if (!helped) at_ = begun_at_, turn_ = begun_turn_;
    for (std::size_t p = 0; p < n; ++p) {
      const bool held = held_there(together(p), h);
      if (!helped || !held) together(p).put = puts_[p];
      if (helped && !held) together(p).put_back = true;
    }
  }
}

// places back onto what joints keep, and within what they let
template <int D>
void JointSolver<D>::project_positions(double h) {
  put_motors();
  put_ends(h, PutEnds::held);
  for (std::size_t k = 0; k < active_; ++k) {
    Bounded& bounded = bounded_[k];
    if (bounded.load > upper) continue;
    const double off = left(bounded.joint, bounded.load);
    // what held to the end keeps it to both sides
    const bool holds = held_there(bounded, h);
    if (!holds && off >= 0) continue;
    const double strayed = position_error();
    begun_at_ = at_, begun_turn_ = turn_;
    const double before = bounded.put;
    if (holds) {
      shift_bounded(bounded, -off * bounded.effective_mass);
      if (!near() || position_error() > strayed + std::fabs(off) * in_metres(bounded.joint))
        at_ = begun_at_, turn_ = begun_turn_, bounded.put = before;
      continue;
    }
    // what joints hardly let it do would throw them far: then only a part of it
    for (double fraction = 1; fraction > kLeastFraction; fraction /= 2) {
      shift_bounded(bounded, -fraction * off * bounded.effective_mass);
      const double rest = left(bounded.joint, bounded.load);
      if (near() && rest > (1 - fraction / 4) * off &&
          position_error() <= strayed - fraction * off * in_metres(bounded.joint))
        break;
      at_ = begun_at_, turn_ = begun_turn_;
    }
    // where it was far beyond its end it is put back, no more
    bounded.put = 0, bounded.put_back = true;
  }
  put_ends(h, PutEnds::beyond);
  begun_at_ = at_, begun_turn_ = turn_;
  std::fill(shifts_.begin(), shifts_.end(), 0.0);
  double worst = close_joints();
  // That turns what was put by the square of how far it was put. An end that is off by more than kTaut is
  // none to the next step, and a motor that presses there would strike it in each.
  for (int round = 0; round < kAgain && worst <= kPut * model_.scale && ends_strayed(); ++round) {
    again_at_ = at_, again_turn_ = turn_, ways_ = shifts_;
    const double closed = worst;
    put_ends(h, PutEnds::again);
    begun_at_ = at_, begun_turn_ = turn_;
    worst = close_joints();
    if (worst <= kPut * model_.scale && near()) continue;
    at_ = begun_at_ = again_at_, turn_ = begun_turn_ = again_turn_, shifts_ = ways_, worst = closed;
    break;
  }
  old_rows_ = rows_, begun_drive_works_ = drive_works_;
  if (worst <= kPut * model_.scale && near()) return;
  at_.swap(begun_at_), turn_.swap(begun_turn_);
  std::fill(shifts_.begin(), shifts_.end(), 0.0);
  damped_newton();
}

// Newton's, with the rows at hand. How far joints are off then, m.
template <int D>
double JointSolver<D>::close_joints() {
  double worst = position_error(), before = kEndless;
  for (int round = 0; round < kRounds && worst > 1e-15 * model_.scale && worst <= 0.9 * before; ++round) {
    before = worst;
    factors_.solve(rhs_.data());
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      shifts_[r] += rhs_[r];
      shift(rows_[r], rhs_[r]);
    }
    worst = position_error();
  }
  return worst;
}

// whether an end that was put back, where a motor presses, is off by so much that the next step finds nothing
// there
template <int D>
bool JointSolver<D>::ends_strayed() const {
  return std::any_of(bounded_.begin(), bounded_.begin() + std::ptrdiff_t(active_), [&](const Bounded& it) {
    if (!it.put_back || !model_.joints[std::size_t(it.joint)].motor) return false;
    const double off = std::fabs(left(it.joint, it.load)), its = size(it.joint);
    return off > kTaut * its && off <= kErrs * its;
  });
}

// Position projection by damped Newton iterations, with new rows and factors in each, where the simple one
// with old factors fails, as on levers that turn far in a step. Velocities stay as they are.
template <int D>
void JointSolver<D>::damped_newton() {
  double worst = position_error();
  for (int round = 0; round < kSearches && worst > kPut * model_.scale; ++round) {
    compute_rows();
    position_error();
    factors_.solve(rhs_.data());
    begun_at_ = at_, begun_turn_ = turn_, ways_ = rhs_;
    const double before = worst;
    bool helped = false;
    for (double fraction = 1; !helped && fraction > kLeastFraction; fraction /= 2) {
      at_ = begun_at_, turn_ = begun_turn_;
      for (std::size_t r = 0; r < rows_.size(); ++r) shift(rows_[r], fraction * ways_[r]);
      worst = position_error();
      helped = worst < (1 - fraction / 4) * before && near();
    }
    if (!helped) at_ = begun_at_, turn_ = begun_turn_;
    if (!helped || worst > 0.9 * before) break;
  }
}

template <int D>
void JointSolver<D>::finish(double h, double least) {
  work_ = 0;
  const double within = std::max(h, least);
  if (bodies_.empty()) return;
  for (const int i : bodies_) unprojected_[i] = at_[i].x;
  project_positions(h);
  for (double& s : shifts_) s /= within;
  // what is put elsewhere has moved there, s / h of Rattle's: angular momentum stays
  for (std::size_t k = 0; k < active_; ++k) {
    const Bounded& bounded = bounded_[k];
    if (bounded.put == 0) continue;
    each_push(bounded, bounded.put / within,
              [&](int body, const Vec<D>& v, const AngularVec<D>& w) { at_[body].v += v, at_[body].w += w; });
  }
  compute_rows();
  std::fill(targets_.begin(), targets_.end(), 0.0);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    push(old_rows_[r], shifts_[r] - 0.5 * impulses_[r]);
    const double half = 0.5 * impulses_[r] + shifts_[r];
    push(rows_[r], half);
    totals_[r] = 2 * half;
  }
  // The same of rows with bounds: half of each impulse where the step began, half where it ends. Where they
  // are put keeps their speed.
  for (std::size_t k = 0; k < active_; ++k) {
    Bounded& bounded = bounded_[k];
    if (bounded.impulse == 0 && bounded.put == 0) continue;
    push(bounded.row, -0.5 * bounded.impulse);
    renew(bounded);
    push(bounded.row, 0.5 * bounded.impulse - bounded.put / within);
  }
  if (update_bounded(h)) {
    for (int component = -1; component < components(); ++component) iterate(component, true);
  } else {
    solve_positions();
    for (std::size_t r = 0; r < rows_.size(); ++r) totals_[r] += rhs_[r];
  }
  for (std::size_t k = 0; k < active_; ++k) bounded_[k].at_end += bounded_[k].impulse;
  book(h);
  for (std::size_t k = 0; k < active_; ++k) {
    const Bounded& bounded = bounded_[k];
    const double given = h * std::fabs(holds_[std::size_t(bounded.joint)].given[bounded.load]);
    if (std::fabs(bounded.impulse) <= kHardlyMore * given) continue;
    any_pushed_ = true;
    for (const int component : bounded.components) {
      if (component < 0) continue;
      for (const int body : members_[std::size_t(component)]) pushed_[std::size_t(body)] = 1;
    }
  }
}

// The work of kinematic bodies and motors: half of each impulse where the step began, half where it ends, but
// those that the end itself gave. What motors gave in the free motion is booked by its rates: here what
// contacts change of them, which is half of it in the mean.
template <int D>
void JointSolver<D>::book(double h) {
  work_ = 0;
  each_motor([&](std::size_t i, const Coordinate& its) {
    work_ += 0.5 * h * holds_[i].given[motor] * (its.rate - free_motors_[i]);
  });
  for (std::size_t r = 0; r < rows_.size() && driven_; ++r)
    work_ += 0.5 * totals_[r] * (begun_drive_works_[r] + drive_works_[r]);
  for (std::size_t k = 0; k < active_; ++k) {
    const Bounded& b = bounded_[k];
    if (driven_) work_ += 0.5 * b.impulse * (b.begun_drive_work + given(b.row));
    if (b.load != motor) continue;
    const double ends = speed(b.row, at_);
    work_ += 0.5 * (b.impulse - b.at_end) * (begun_motors_[std::size_t(b.joint)].rate + ends) +
             0.5 * b.at_end * (b.rate_there + ends);
  }
}

// the row where bodies now stand
template <int D>
void JointSolver<D>::renew(Bounded& bounded) {
  const Joint<D>& joint = model_.joints[std::size_t(bounded.joint)];
  const BodyMotion<D>&a = side(joint.a.body), &b = side(joint.b.body);
  Row<D> out[kMostHeld<D>];
  double offs[kMostHeld<D>];
  if (one_sided(joint)) {
    rows(joint, a, b, turn_between(joint), out, offs, at_);
  } else {
    free_row(joint, a, b, turn_between(joint), out[0], offs[0]);
    if (bounded.load == upper) out[0].reverse();
  }
  bounded.row = out[0];
}

// Rows with bounds where bodies now stand: motors with what they have left to give, ropes and limits that
// pushed until they are at rest there; what else has bounds has done its part. False where there are none.
template <int D>
bool JointSolver<D>::update_bounded(double h) {
  bool any = false;
  for (std::size_t k = 0; k < active_; ++k) {
    Bounded& b = bounded_[k];
    const bool done = b.load == motor      ? false
                      : b.load == friction ? !holding(b) && !(b.impulse != 0 && within(b))
                                           : b.impulse == 0 && !holding(b);
    b.at_end = -b.impulse;
    if (done) {
      b.least = b.most = b.impulse;
      continue;
    }
    any = true;
    const Joint<D>& joint = model_.joints[b.joint];
    renew(b);
    if (b.load == motor) {
      Row<D> row;
      double way = 0;
      free_row(joint, side(joint.a.body), side(joint.b.body), turn_between(joint), row, way);
      b.target = motors_.at(b.joint, ends_, way, speed(b.row, at_)).speed;
      b.rate_there = speed(b.row, at_);
    } else {
      b.target = b.load == friction ? 0 : -std::max(left(b.joint, b.load), 0.0) / h;
    }
    compute_response(b);
    b.effective_mass = effective_mass(b);
  }
  if (any) couple_bounded();
  return any;
}

#define OBSCURA_INSTANTIATE(D)                             \
  template void JointSolver<D>::solve_positions();         \
  template double JointSolver<D>::position_error();        \
  template bool JointSolver<D>::near() const;              \
  template void JointSolver<D>::put_motors();              \
  template void JointSolver<D>::couple_together(int);      \
  template void JointSolver<D>::solve_together();          \
  template void JointSolver<D>::solve_within(int, int);    \
  template void JointSolver<D>::put_ends(double, PutEnds); \
  template double JointSolver<D>::close_joints();          \
  template bool JointSolver<D>::ends_strayed() const;      \
  template void JointSolver<D>::project_positions(double); \
  template void JointSolver<D>::damped_newton();           \
  template void JointSolver<D>::finish(double, double);    \
  template void JointSolver<D>::book(double);              \
  template void JointSolver<D>::renew(Bounded&);           \
  template bool JointSolver<D>::update_bounded(double)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim
