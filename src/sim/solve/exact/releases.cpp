// Releases: where within an interval what holds lets go, because a contact no longer presses, its friction is
// used up, a motor or the friction of a joint gives all that it can, or a rope no longer pulls.
//
// Of a contact that bears alone its own force tells. Where several bear the same load what each of them bears
// is not determined, and only the laws of all together tell: they are solved at the end of the interval as
// they are at its start, and what they let go of has left where the acceleration that they give it began.

#include <algorithm>
#include <cmath>

#include "sim/math/false_position.h"
#include "sim/solve/exact/exact.h"

namespace obscura::sim {

namespace {

constexpr double kNoRelease = 2;  // a part of the interval
constexpr double kSlight = 1e-6;  // of the largest force: a contact may pull so much before it is released
constexpr double kWild = 8;       // times all loads: a contact that pulls so much let go long before
constexpr double kFar = 4;        // a ratio of two lengths, of which the geometric mean is tried
constexpr int kMostSecants = 100;
constexpr double kDoubt =
    1e-11;  // of the largest force: the laws are solved where it is beyond them by so much
constexpr double kSoon = 1e-7;             // of the interval: how exactly is known where the laws let go
constexpr double kNoAcceleration = 1e-11;  // of the fastest there is

}  // namespace

// How far the forces f of a contact are from its release: the normal force. In event mode, of a sticking
// contact, how far they are from slipping.
template <int D>
double ExactSolver<D>::force_reserve(const Constraint& constraint, const Eigen::VectorXd& f) const {
  const double pressed = f[constraint.first];
  if (model_.collision != Collision::event || interval_.modes[constraint.block].kind != ModeKind::stick)
    return pressed;
  return blocks_[constraint.block].mu * pressed -
         std::sqrt(f.segment(constraint.first + 1, D - 1).squaredNorm());
}

// The fraction of the interval at which the first contact separates or slips, by linear interpolation of the
// forces. Slightly after the force has left the law, so that the contact is then found open or slipping. Much
// later would be wrong: until then it pulls, or friction drives the slip.
template <int D>
double ExactSolver<D>::release_time(const Constraint*& which) {
  double most = 0, first = kNoRelease;
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind == Constraint::Kind::contact)
      most = std::max(most, interval_.forces[constraint.first]);
  }
  interval_.slight = kSlight * most;
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind != Constraint::Kind::contact || !active(constraint)) continue;
    if (std::find(progress_.unclear.begin(), progress_.unclear.end(), candidates_[constraint.of].key) !=
        progress_.unclear.end())
      continue;
    const double begun = force_reserve(constraint, interval_.forces), now = force_reserve(constraint, f_);
    if (begun <= interval_.slight || now >= -interval_.slight) continue;
    const double part = (begun + 0.5 * interval_.slight) / (begun - now);
    if (part < first) first = part, which = &constraint;
  }
  return first;
}

// Whether a contact pulls by far more than anything bears: it let go long before. Where friction is great and
// bodies slide along a curve, normal forces fall, or grow, exponentially:
//   f_n' = -a + (2 mu v / R) f_n                       R  radius of the curve, a  by how the load turns
// and stages far beyond their end answer numbers of any size.
template <int D>
bool ExactSolver<D>::pulls_wildly() const {
  double most = interval_.loads;
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind == Constraint::Kind::contact)
      most = std::max(most, interval_.forces[constraint.first]);
  }
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind == Constraint::Kind::contact && active(constraint) &&
        f_[constraint.first] < -kWild * most)
      return true;
  }
  return false;
}

// the contact of that key where no other bears what it bears, so that its force is determined; nullptr: none
template <int D>
const typename ExactSolver<D>::Constraint* ExactSolver<D>::bears_alone(const ContactKey& key) const {
  for (int part = 0; part < islands_; ++part) {
    const Constraint* found = nullptr;
    int others = 0;
    for (const int i : island_members_[std::size_t(part)]) {
      const Constraint& one = constraints_[std::size_t(i)];
      if (one.kind != Constraint::Kind::contact || !active(one)) continue;
      if (candidates_[one.of].key == key)
        found = &one;
      else
        ++others;
    }
    if (found) return others == 0 ? found : nullptr;
  }
  return nullptr;
}

// The length of the interval after which the reserve of a contact is used up: it is not yet after `low`, and
// was before `high`. Where the lengths are far apart their geometric mean is tried, then false
// position. Leaves the state at the end of some length.
template <int D>
double ExactSolver<D>::release_length(State<D>& state, double t, const Constraint& which, double low,
                                      double high) {
  const double slight = 0.5 * interval_.slight;
  const auto reserve_after = [&](double length) {
    begin_again(state, t);
    const double reserve = integrates(state, t, length) ? force_reserve(which, f_) : -1e300;
    return std::isfinite(reserve) ? reserve + slight : -1e300;
  };
  const double at_low = force_reserve(which, f_) + slight;
  FalsePosition root(low, at_low, high, reserve_after(high));
  for (int i = 0; i < kMostSecants && root.high() - root.low() > 1e-15 * root.high(); ++i) {
    const double length = root.high() > kFar * root.low() ? std::sqrt(root.low() * root.high()) : root.next();
    const double value = reserve_after(length);
    if (std::abs(value) <= slight) return length;
    root.put(length, value);
  }
  return root.high();
}

// What the laws, solved at the end of the interval, let go of that it held: the largest acceleration that
// they give it, m/s^2; 0 where they let go of nothing, or have no solution. What is at hand of the
// interval stays as it is.
template <int D>
double ExactSolver<D>::let_go_at(State<D>& state, double t) {
  if (constraints_.empty()) return 0;
  using Kind = typename Constraint::Kind;
  const auto mode_of = [&](const Constraint& one) { return interval_.modes[std::size_t(one.block)].kind; };
  double most = 0;
  for (int i = 0; i < int(rows_.size()); ++i)
    most = std::max({most, in_newtons(i, std::abs(f_[i])), in_newtons(i, std::abs(interval_.forces[i]))});
  // by how much a force is beyond its law
  const auto beyond = [&](const Constraint& one) {
    const double f = f_[one.first];
    const ConeBlock<D>& block = blocks_[one.block];
    if (one.kind == Kind::joint || !holds(one, mode_of(one))) return 0.0;
    if (one.kind != Kind::contact) return in_newtons(one.first, std::max(f - block.upper, block.lower - f));
    const double drag = std::sqrt(f_.segment(one.first + 1, D - 1).squaredNorm());
    return std::max(-f, mode_of(one) == ModeKind::stick ? drag - block.mu * f : 0.0);
  };
  const bool ends_there = model_.integrator == Integrator::rk4;  // f_ is that of the last stage
  if (ends_there && std::none_of(constraints_.begin(), constraints_.end(),
                                 [&](const Constraint& one) { return beyond(one) > kDoubt * most; }))
    return 0;

  scratch_.blocks = blocks_, scratch_.modes = modes_, scratch_.f = f_;
  build_rows(state, t);
  for (const Constraint& one : constraints_)
    if (one.kind == Kind::contact && blocks_[one.block].sliding)
      blocks_[one.block].direction = interval_.modes[std::size_t(one.block)].along;
  chain_response_.build(rows_, response_, dynamics_.chains());
  modes_.assign(blocks_.size(), {});
  const auto rate = dynamics_.accelerations(state, t);
  const bool found = solve_laws(rate);

  double fastest = 0;
  if (found) {
    std::vector<double> ends(rate.begin(), rate.end());
    for (int i = 0; i < int(rows_.size()); ++i) add_accelerations(i, f_[i], ends);
    double swiftest = 0;  // m/s^2, before and with the forces
    for (std::size_t i = 0; i < D * dynamics_.bodies().size(); ++i)
      swiftest = std::max({swiftest, std::abs(rate[i]), std::abs(ends[i])});
    for (const Constraint& one : constraints_) {
      const ModeKind now = modes_[std::size_t(one.block)].kind;
      const bool slips = mode_of(one) == ModeKind::stick && now == ModeKind::slide;
      if (one.kind == Kind::joint || !holds(one, mode_of(one)) || (holds(one, now) && !slips)) continue;
      for (int i = 0; i < one.rows; ++i) {
        const int row = one.first + i;
        fastest = std::max(fastest,
                           in_metres(row, std::abs(row_acceleration(row, ends) + rows_[row].velocity_product -
                                                   (i == 0 ? aim(one).rate : 0))));
      }
    }
    if (fastest < kNoAcceleration * swiftest) fastest = 0;
  }
  blocks_.swap(scratch_.blocks), modes_.swap(scratch_.modes), f_.swap(scratch_.f);
  return fastest;
}

// The length of the interval, at most `length`, after which the laws let go of something, found by where its
// acceleration began: a secant, kept between lengths after which they do and do not. A little later, so that
// it is then found to be so. Leaves the state at the end of that length.
template <int D>
double ExactSolver<D>::lawful_length(State<D>& state, double t, double length) {
  double high = length, at_high = let_go_at(state, t + length);
  if (at_high == 0) return length;
  const double soon = kSoon * length;
  const auto let_go_after = [&](double part) {
    begin_again(state, t);
    return integrates(state, t, part) ? let_go_at(state, t + part) : 0;
  };
  double low = 0, later = 0, at_later = 0;
  for (int i = 0; i < kMostSecants && high - low > soon; ++i) {
    double next = at_later > at_high ? high - at_high * (later - high) / (at_later - at_high) + 0.5 * soon
                                     : 0.5 * (low + high);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const double value = let_go_after(next);
    if (value > 0) {
      later = high, at_later = at_high;
      high = next, at_high = value;
    } else {
      low = next, at_later = 0;
    }
  }
  begin_again(state, t);
  integrate(state, t, high);
  return high;
}

#define OBSCURA_INSTANTIATE(D)                                                                              \
  template double ExactSolver<D>::force_reserve(const Constraint&, const Eigen::VectorXd&) const;           \
  template double ExactSolver<D>::release_time(const Constraint*&);                                         \
  template bool ExactSolver<D>::pulls_wildly() const;                                                       \
  template const typename ExactSolver<D>::Constraint* ExactSolver<D>::bears_alone(const ContactKey&) const; \
  template double ExactSolver<D>::release_length(State<D>&, double, const Constraint&, double, double);     \
  template double ExactSolver<D>::lawful_length(State<D>&, double, double)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim
