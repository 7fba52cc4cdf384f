// Impacts: Newton's law of restitution with Coulomb's friction, all that touches solved together,
//   w = K p + J v,   p_n >= 0,   w_n + e v_n >= 0,   p_n (w_n + e v_n) = 0,   w_t against p_t on the cone
// or one pair after another, the fastest first, until none approaches. Newton's law with friction can raise
// the energy: then e is scaled down until it does not; with e = 0 it never does.

#include <algorithm>
#include <cmath>

#include "sim/energy/energy.h"
#include "sim/solve/exact/exact.h"

namespace obscura::sim {

namespace {

constexpr int kRounds = 200;        // of pairs in turn
constexpr double kRounding = 1000;  // of what is still: what a solve leaves

}  // namespace

// how fast what touches comes closer, or joints come apart, at most
template <int D>
double ExactSolver<D>::approach() const {
  double most = 0;
  for (const Held& held : held_) {
    switch (held.kind) {
      case Held::Kind::motor:
      case Held::Kind::friction:
        break;
      case Held::Kind::joint:
        for (int i = 0; i < held.rows; ++i) most = std::max(most, std::abs(moves(held.first + i)));
        break;
      default:
        most = std::max(most, -moves(held.first));
    }
  }
  return most;
}

// whether anything that is held from now on comes apart yet
template <int D>
bool ExactSolver<D>::coming_apart() const {
  for (const Held& held : held_) {
    const bool one_sided =
        held.kind != Held::Kind::joint && held.kind != Held::Kind::motor && held.kind != Held::Kind::friction;
    if (one_sided && acts(held) && moves(held.first) > still_) return true;
  }
  return false;
}

// impacts of this instant
template <int D>
void ExactSolver<D>::resolve_impacts(State<D>& state) {
  double before = 0;
  for (int round = 0; round < kRounds; ++round) {
    stand(state);
    gather(state, true);
    // a second time only for what the first has set off, not for its rounding
    const double fast = approach();
    if (fast <= (round == 0 ? still_ : kRounding * still_)) return;
    const bool in_turn = model_.impacts == Impacts::sequential && round + 1 < kRounds;
    if (!in_turn && round > 0 && fast > 0.5 * before) return;
    before = fast;
    if (in_turn) only_worst_pair();
    strike(state, round + 1 == kRounds ? 0 : 1);
  }
}

// of the contacts only those of the pair that comes together fastest
template <int D>
void ExactSolver<D>::only_worst_pair() {
  const Held* worst = nullptr;
  for (const Held& held : held_) {
    if (held.kind == Held::Kind::contact && (!worst || moves(held.first) < moves(worst->first)))
      worst = &held;
  }
  if (!worst || moves(worst->first) >= -still_) return;
  const ContactKey pair = gaps_[worst->of].key;
  std::erase_if(held_, [&](const Held& held) {
    if (held.kind != Held::Kind::contact) return false;
    const ContactKey& key = gaps_[held.of].key;
    return key.a != pair.a || key.b != pair.b;
  });
  rows_.clear();
  for (Held& held : held_) lay_rows(held, AngularVec<D>::Zero());
  chain_response_.build(rows_, response_, free_.chains());
}

// Newton's law with Coulomb's friction for all that is held; `bounce` scales e. Where energy would rise e is
// scaled down further.
template <int D>
void ExactSolver<D>::strike(State<D>& state, double bounce) {
  lay_blocks(true);
  split();
  b_.resize(Eigen::Index(rows_.size()));
  keep(state, saved_);
  const double before = motion(state);
  double low = 0, high = bounce;
  for (int tries = 0; tries < 30; ++tries) {
    for (int i = 0; i < int(rows_.size()); ++i) b_[i] = moves(i);
    for (const Held& held : held_) {
      const double vn = moves(held.first);
      if (held.kind == Held::Kind::contact && vn < -rest_)
        b_[held.first] += bounce * material(gaps_[held.of].key).elasticity * vn;
    }
    modes_.assign(blocks_.size(), {}), warm_.setZero(Eigen::Index(rows_.size()));
    bool found = solve();
    if (!found && model_.collision != Collision::event) rough_ = true, found = solve();
    jump(state, false);
    const double after = motion(state);
    if ((found && after <= before * (1 + 1e-13)) || bounce == 0) break;
    // too much: less of e, at most half as often as it takes to know how much to 1e-6
    high = bounce;
    if (tries > 20) low = 0;
    bounce = tries > 20 || !found ? 0 : 0.5 * (low + high);
    if (bounce < 1e-6) bounce = 0;
    restore(saved_, state);
  }
  for (const Held& held : held_) {
    if (held.kind != Held::Kind::contact || f_[held.first] == 0) continue;
    Vec<D> p = Vec<D>::Zero();
    for (int i = 0; i < D; ++i) p += f_[held.first + i] * rows_[held.first + i].along;
    note(gaps_[held.of].key, held, p);
  }
}

// adds an impulse to those of this step
template <int D>
void ExactSolver<D>::note(const ContactKey& key, const Held& held, const Vec<D>& impulse) {
  for (Contact<D>& known : impulses_) {
    if (known.key != key) continue;
    known.impulse += impulse;
    return;
  }
  Contact<D> contact;
  contact.key = key;
  contact.point = held.point, contact.normal = held.normal, contact.gap = held.off;
  contact.impulse = impulse;
  impulses_.push_back(contact);
}

template double ExactSolver<2>::approach() const;
template bool ExactSolver<2>::coming_apart() const;
template void ExactSolver<2>::resolve_impacts(State<2>&);
template double ExactSolver<3>::approach() const;
template bool ExactSolver<3>::coming_apart() const;
template void ExactSolver<3>::resolve_impacts(State<3>&);

}  // namespace obscura::sim
