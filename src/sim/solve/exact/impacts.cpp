// Impacts: Newton's law of restitution with Coulomb's friction, all that touches solved together,
//   w = K p + J v,   p_n >= 0,   w_n + e v_n >= 0,   p_n (w_n + e v_n) = 0,   w_t against p_t on the cone
// or one pair after another, the fastest first, until none approaches. Newton's law with friction can raise
// the energy: then e is scaled down until it does not; with e = 0 it never does.
// Source: Moreau, Unilateral contact and dry friction in finite freedom dynamics (1988); handout §3.5.

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/energy/energy.h"
#include "sim/solve/exact/exact.h"
#include "sim/solve/restitution.h"

namespace obscura::sim {

namespace {

constexpr int kRounds = 200;        // of pairs in turn
constexpr int kJamSweeps = 100;     // where no impulses obey the laws
constexpr double kGain = 1e-13;     // of the energy: rounding
constexpr double kRounding = 1000;  // of what is still: what a solve leaves
constexpr double kNearEnd = 1e-7;   // of the scene's size: so near to its end a step leaves a joint

}  // namespace

// how fast what touches comes closer, or a joint comes apart
template <int D>
double ExactSolver<D>::closing_speed(const Constraint& constraint) const {
  double most = 0;
  switch (constraint.kind) {
    case Constraint::Kind::motor:
    case Constraint::Kind::friction:
      return 0;
    case Constraint::Kind::joint:
      for (int i = 0; i < constraint.rows; ++i)
        most = std::max(most, in_metres(constraint.first + i, std::abs(row_velocity(constraint.first + i))));
      return most;
    default:
      return std::max(0.0, in_metres(constraint.first, -row_velocity(constraint.first)));
  }
}

// the fastest of them
template <int D>
double ExactSolver<D>::closing_speed() const {
  double most = 0;
  for (const Constraint& constraint : constraints_) most = std::max(most, closing_speed(constraint));
  return most;
}

// whether anything that is held from now on comes apart yet
template <int D>
bool ExactSolver<D>::coming_apart() const {
  for (const Constraint& constraint : constraints_) {
    const bool one_sided = constraint.kind != Constraint::Kind::joint &&
                           constraint.kind != Constraint::Kind::motor &&
                           constraint.kind != Constraint::Kind::friction;
    if (one_sided && active(constraint) &&
        in_metres(constraint.first, row_velocity(constraint.first)) > still_speed_)
      return true;
  }
  return false;
}

// impacts of this instant
template <int D>
void ExactSolver<D>::resolve_contact_impacts(State<D>& state) {
  double before = 0;
  for (int round = 0; round < kRounds; ++round) {
    update_poses(state);
    collect_constraints(state);
    // a second time only for what the first has set off, not for its rounding
    const double fast = closing_speed();
    if (fast <= (round == 0 ? still_speed_ : kRounding * still_speed_)) return;
    if (round == 0 && wake_struck(state)) update_poses(state);
    // A joint that its friction holds at its limit may be as far from it as steps err: a blow meets it there.
    // Were it open, it would be struck at its limit right after, and what flies on would be another.
    collect_constraints(state, 1e300, 0, kNearEnd * model_.scale);
    const bool in_turn = model_.impacts == Impacts::sequential && round + 1 < kRounds;
    if (!in_turn && round > 0 && fast > 0.5 * before) return;
    before = fast;
    if (in_turn) keep_fastest_pair(state);
    solve_impacts(state, round + 1 == kRounds ? 0 : 1);
  }
}

// keeps only the contacts of the pair with the greatest approach speed
template <int D>
void ExactSolver<D>::keep_fastest_pair(const State<D>& state) {
  const Constraint* worst = nullptr;
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind == Constraint::Kind::contact &&
        (!worst || row_velocity(constraint.first) < row_velocity(worst->first)))
      worst = &constraint;
  }
  if (!worst || row_velocity(worst->first) >= -still_speed_) return;
  const ContactKey pair = candidates_[worst->of].key;
  std::erase_if(constraints_, [&](const Constraint& constraint) {
    if (constraint.kind != Constraint::Kind::contact) return false;
    const ContactKey& key = candidates_[constraint.of].key;
    return key.a != pair.a || key.b != pair.b;
  });
  rebuild_rows(state);
}

// All impacts of this instant. Contacts that only lie beside take part where what else is struck makes them
// close: those that it leaves as they are have no impulse, and that is the law for all of them together. So
// what strikes one tile of a floor need not know of the others.
template <int D>
void ExactSolver<D>::solve_impacts(State<D>& state, double bounce) {
  const auto beside = [&](const Constraint& one, double still) {
    return one.kind == Constraint::Kind::contact && closing_speed(one) <= still;
  };
  const std::vector<Constraint> all = constraints_;
  std::vector<char> takes;
  for (const Constraint& one : all) takes.push_back(!beside(one, still_speed_));
  save(state, scratch_.struck_from);
  for (bool more = true; more;) {
    constraints_.clear();
    for (std::size_t i = 0; i < all.size(); ++i)
      if (takes[i]) constraints_.push_back(all[i]);
    rebuild_rows(state);
    attempt_impacts(state, bounce);
    // the same as impulses of all, and which of the others close by them
    const Eigen::VectorXd impulses = f_;
    constraints_ = all;
    rebuild_rows(state);
    f_.setZero(Eigen::Index(rows_.size()));
    more = false;
    Eigen::Index at = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Constraint& one = constraints_[i];
      if (takes[i]) {
        f_.segment(one.first, one.rows) = impulses.segment(at, one.rows);
        at += one.rows;
      } else if (!beside(one, kRounding * still_speed_)) {
        takes[i] = 1, more = true;
      }
    }
    if (more) restore(scratch_.struck_from, state);
  }
  for (int i = 0; i < int(rows_.size()); ++i) progress_.given += f_[i] * given(i);
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind != Constraint::Kind::contact || f_[constraint.first] == 0) continue;
    Vec<D> p = Vec<D>::Zero();
    for (int i = 0; i < D; ++i) p += f_[constraint.first + i] * rows_[constraint.first + i].along;
    record_impulse(candidates_[constraint.of].key, constraint, p);
  }
}

// Newton's law with Coulomb's friction for constraints_; `bounce` scales e. If energy would rise, e is scaled
// down further.
template <int D>
void ExactSolver<D>::attempt_impacts(State<D>& state, double bounce) {
  build_blocks(true);
  find_islands();
  b_.resize(Eigen::Index(rows_.size()));
  save(state, scratch_.saved);
  const double before = kinetic_energy(state);
  const Eigen::VectorXd velocities = [&] {
    Eigen::VectorXd all(rows_.size());
    for (int i = 0; i < int(rows_.size()); ++i) all[i] = row_velocity(i);
    return all;
  }();
  restitution_share(bounce, [&](double share) {
    restore(scratch_.saved, state);
    b_ = velocities;
    for (const Constraint& constraint : constraints_) {
      const double vn = velocities[constraint.first];
      if (constraint.kind == Constraint::Kind::contact && vn < -progress_.rest_speed)
        b_[constraint.first] += share * material(candidates_[constraint.of].key).elasticity * vn;
    }
    modes_.assign(blocks_.size(), {}), warm_.setZero(Eigen::Index(rows_.size()));
    bool found = solve();
    for (int i = 0; i < kMostRubs && rub(i); ++i) found = solve();
    if (!found && model_.collision != Collision::event)
      progress_.rough = progress_.limited = true, found = solve();
    // what jams, as between a belt and what stands before it, does not bounce, and is left as near as it
    // comes
    if (!found && share == 0) solve_roughly(kJamSweeps);
    // what bodies that are moved give is theirs
    double gives = 0;
    for (int i = 0; i < int(rows_.size()); ++i) gives += f_[i] * given(i);
    apply_impulses(state, false);
    const double size = before + std::fabs(gives), rises = kinetic_energy(state) - gives - before;
    return !found ? std::numeric_limits<double>::infinity() : size > 0 ? rises / size - kGain : 0;
  });
}

// adds an impulse to those of this step
template <int D>
void ExactSolver<D>::record_impulse(const ContactKey& key, const Constraint& constraint,
                                    const Vec<D>& impulse) {
  if (course_ && (course_->watches(key.a) || course_->watches(key.b)))
    course_->meetings.push_back({key.a, key.b, stepped_, stepped_});
  for (Contact<D>& known : outcome_.impulses) {
    if (known.key != key) continue;
    known.impulse += impulse;
    return;
  }
  Contact<D> contact;
  contact.key = key;
  contact.point = constraint.point, contact.normal = constraint.normal, contact.gap = constraint.off;
  contact.impulse = impulse;
  outcome_.impulses.push_back(contact);
}

template double ExactSolver<2>::closing_speed(const Constraint&) const;
template double ExactSolver<2>::closing_speed() const;
template bool ExactSolver<2>::coming_apart() const;
template void ExactSolver<2>::resolve_contact_impacts(State<2>&);
template double ExactSolver<3>::closing_speed(const Constraint&) const;
template double ExactSolver<3>::closing_speed() const;
template bool ExactSolver<3>::coming_apart() const;
template void ExactSolver<3>::resolve_contact_impacts(State<3>&);

}  // namespace obscura::sim
