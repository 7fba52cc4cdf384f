// What holds bodies apart and together at one instant.
//   K f + b = w,   K = J M^-1 J',   b = J a + J' v        forces, w what the rows accelerate by
//                                   b = J v (+ e v_n)     impulses, w what they move with after
// with the laws of sim/solve/exact/cone.h for f and w.

#include <algorithm>
#include <cmath>

#include "sim/energy/energy.h"
#include "sim/math/lie_step.h"
#include "sim/solve/exact/exact.h"

namespace obscura::sim {

namespace {

constexpr double kLeastPart = 1e-3;  // of the way back to where joints belong
constexpr double kJam = 100;  // times what all bodies weigh and are pulled by: a stack's floor bears it once

}  // namespace

template <int D>
void ExactSolver<D>::stand(const State<D>& state) {
  for (const int body : active_.subset.bodies) stances_[body] = body_motion(state, body);
  free_.chains().stand(state);
}

template <int D>
AngularVec<D> ExactSolver<D>::turn_between(const State<D>& state, const Joint<D>& joint) const {
  AngularVec<D> turn = AngularVec<D>::Zero();
  if (const int k = joint.a.body < 0 ? -1 : turning(state, joint.a.body); k >= 0)
    turn += rounds<D>(state.turn[k]);
  if (const int k = joint.b.body < 0 ? -1 : turning(state, joint.b.body); k >= 0)
    turn -= rounds<D>(state.turn[k]);
  return turn;
}

// the rows of what is held, at the stances at hand
template <int D>
void ExactSolver<D>::lay_rows(Held& held, const AngularVec<D>& turn) {
  static const BodyMotion<D> room;
  held.first = int(rows_.size());
  const auto at = [&](int body) -> const BodyMotion<D>& { return body < 0 ? room : stances_[body]; };
  Row<D> out[kMostHeld<D>];
  if (held.kind == Held::Kind::contact) {
    const ContactCandidate<D>& gap = gaps_[held.of];
    const EvaluatedContact<D> now = sim::rows(gap, at(gap.key.a), at(gap.key.b), out);
    held.off = now.value, held.point = now.point, held.normal = now.normal;
    held.rows = D;
  } else {
    const Joint<D>& joint = model_.joints[held.of];
    const BodyMotion<D>&a = at(joint.a.body), &b = at(joint.b.body);
    if (held.kind == Held::Kind::joint || held.kind == Held::Kind::rope) {
      held.rows = sim::rows(joint, a, b, turn, out, held.offs);
      held.off = held.offs[0];
    } else {
      double way = 0;
      free_row(joint, a, b, turn, out[0], way);
      held.rows = 1;
      if (held.kind == Held::Kind::lower) held.off = way - joint.lower;
      if (held.kind == Held::Kind::upper) {
        held.off = joint.upper - way;
        out[0].reverse();
      }
    }
  }
  rows_.insert(rows_.end(), out, out + held.rows);
}

template <int D>
double ExactSolver<D>::moves(int row) const {
  return speed(rows_[row], stances_);
}

// what may hold in this state: `all`, or only what does not come apart already. What comes apart more slowly
// than rest may yet be held, if it would come back
template <int D>
void ExactSolver<D>::gather(const State<D>& state, bool all) {
  using Kind = typename Held::Kind;
  held_.clear(), rows_.clear();
  const auto add = [&](Kind kind, int of, const AngularVec<D>& turn, bool one_sided) {
    Held held{};
    held.kind = kind, held.of = of;
    lay_rows(held, turn);
    if (one_sided && (held.off > closed_ || (!all && moves(held.first) > rest_))) {
      rows_.resize(held.first);
      return;
    }
    held_.push_back(held);
  };
  for (const int i : active_.joints) {
    const Joint<D>& joint = model_.joints[i];
    if (state.broken[i] || (!response_.moves(joint.a.body) && !response_.moves(joint.b.body))) continue;
    const AngularVec<D> turn = turn_between(state, joint);
    if (!joint.linked) add(one_sided(joint) ? Kind::rope : Kind::joint, i, turn, one_sided(joint));
    if (!has_free_row(joint)) continue;
    if (joint.lower > -1e299) add(Kind::lower, i, turn, true);
    if (joint.upper < 1e299) add(Kind::upper, i, turn, true);
    if (joint.motor) add(Kind::motor, i, turn, false);
    if (joint.friction > 0) add(Kind::friction, i, turn, false);
  }
  for (int i = 0; i < int(gaps_.size()); ++i) add(Kind::contact, i, AngularVec<D>::Zero(), true);
  chain_response_.build(rows_, response_, free_.chains());
}

// blocks of what is held, at the stances at hand. Of impulses motors and friction in joints have none.
template <int D>
void ExactSolver<D>::lay_blocks(bool impulses) {
  using Kind = typename Held::Kind;
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  blocks_.clear();
  for (Held& held : held_) {
    held.block = int(blocks_.size());
    ConeBlock<D> block;
    switch (held.kind) {
      case Kind::contact: {
        block.mu = material(gaps_[held.of].key).friction;
        Tangent<D> slip;
        for (int i = 0; i < D - 1; ++i) slip[i] = moves(held.first + 1 + i);
        const double fast = std::sqrt(slip.squaredNorm());
        if (!impulses && fast > still_) block.sliding = true, block.direction = slip / fast;
        blocks_.push_back(block);
        break;
      }
      case Kind::joint:
        block.law = Law::equal;
        for (int i = 0; i < held.rows; ++i) blocks_.push_back(block);
        break;
      case Kind::rope:
      case Kind::lower:
      case Kind::upper:
        block.law = Law::bounded, block.lower = 0, block.upper = kEndless;
        blocks_.push_back(block);
        break;
      case Kind::motor:
      case Kind::friction: {
        const Joint<D>& joint = model_.joints[held.of];
        const double most = held.kind == Kind::motor ? joint.motor->most : joint.friction;
        const double slip = moves(held.first) - (held.kind == Kind::motor ? joint.motor->speed : 0);
        block.law = Law::bounded, block.lower = -most, block.upper = most;
        if (impulses)
          block.lower = block.upper = 0;
        else if (slip > still_)
          block.upper = -most;
        else if (slip < -still_)
          block.lower = most;
        blocks_.push_back(block);
        break;
      }
    }
  }
  modes_.assign(blocks_.size(), {});
}

// J a: what the rows accelerate by, of accelerations in the order of free_
template <int D>
double ExactSolver<D>::along(int number, std::span<const double> rate) const {
  const Row<D>& row = rows_[number];
  double sum = 0;
  const auto side = [&](int body, const AngularVec<D>& turn, double sign) {
    const int place = response_.free(body) ? free_.place(body) : -1;
    if (place < 0) return;
    sum += sign * row.along.dot(Eigen::Map<const Vec<D>>(rate.data() + D * place));
    if (const int at = free_.spin_start(place); at >= 0)
      sum += sign * turn.dot(to_room<D>(stances_[body].room_from_body,
                                        Eigen::Map<const AngularVec<D>>(rate.data() + at)));
  };
  side(row.a, row.angular_a, 1), side(row.b, row.angular_b, -1);
  if (!chain_response_.moves(number)) return sum;
  const auto J = chain_response_.jacobian(number);
  for (std::size_t i = 0; i < J.size(); ++i) sum += J[i] * rate[std::size_t(free_.chain_start()) + i];
  return sum;
}

// M^-1 J' f, onto accelerations in the order of free_
template <int D>
void ExactSolver<D>::push(int number, double f, std::span<double> rate) const {
  const auto side = [&](int body, const Vec<D>& dv, const AngularVec<D>& spin, double force) {
    const int place = free_.place(body);
    if (place < 0) return;
    Eigen::Map<Vec<D>>(rate.data() + D * place) += dv;
    if (const int at = free_.spin_start(place); at >= 0)
      Eigen::Map<AngularVec<D>>(rate.data() + at) +=
          force * from_room<D>(stances_[body].room_from_body, spin);
  };
  if (f == 0) return;
  each_response(rows_[number], response_.of(rows_[number], stances_), f, side);
  if (!chain_response_.moves(number)) return;
  const auto U = chain_response_.response(number);
  for (std::size_t i = 0; i < U.size(); ++i) rate[std::size_t(free_.chain_start()) + i] += f * U[i];
}

// M^-1 J' p onto the velocities of the free bodies of a state, or onto their places
template <int D>
void ExactSolver<D>::jump(State<D>& state, const Row<D>& row, double p, bool places) const {
  const auto side = [&](int body, const Vec<D>& dv, const AngularVec<D>& spin, double impulse) {
    (places ? state.x : state.v)[body] += dv;
    const int k = turning(state, body);
    if (k < 0) return;
    const AngularVec<D> by = impulse * spin;
    if (places)
      state.turn[k] = turned<D>(state.turn[k], by);
    else
      state.spin[k] += by;
  };
  if (p == 0) return;
  each_response(row, response_.of(row, stances_), p, side);
}

// what contacts did last is the first guess at what they do now; and so are their forces,
// times `h` where impulses are asked for
template <int D>
void ExactSolver<D>::guess(double h) {
  warm_.setZero(Eigen::Index(rows_.size()));
  for (const Held& held : held_) {
    if (held.kind != Held::Kind::contact) continue;
    const ContactKey& key = gaps_[held.of].key;
    const auto known = std::lower_bound(known_->begin(), known_->end(), key,
                                        [](const Contact<D>& c, const ContactKey& k) { return c.key < k; });
    if (known == known_->end() || known->key != key) continue;
    for (int i = 0; i < D; ++i) warm_[held.first + i] = h * known->force.dot(rows_[held.first + i].along);
    ConeMode<D>& mode = modes_[held.block];
    if (known->touching == ContactMode::open) mode.hold = Hold::open;
    if (known->touching != ContactMode::slide && known->touching != ContactMode::at_friction_limit) continue;
    Tangent<D> drag;
    for (int i = 0; i < D - 1; ++i) drag[i] = h * known->force.dot(rows_[held.first + 1 + i].along);
    const double size = std::sqrt(drag.squaredNorm());
    if (size > 0) mode.hold = Hold::slide, mode.along = -drag / size;
  }
}

// the forces of this instant, and what each contact does. False where there are none.
template <int D>
bool ExactSolver<D>::choose(State<D>& state, double t) {
  stand(state);
  gather(state, false);
  lay_blocks(false);
  if (held_.empty()) return true;
  split();
  b_.resize(Eigen::Index(rows_.size()));
  const auto rate = free_.accelerations(state, t);
  for (int i = 0; i < int(rows_.size()); ++i) b_[i] = along(i, rate) + rows_[i].velocity_product;
  guess(1);
  const bool found = solve();
  // what lets go, but would come closer by the change of the forces alone, is held
  for (const Held& held : held_) {
    if (forced_.empty() || held.kind != Held::Kind::contact) continue;
    const ContactKey& key = gaps_[held.of].key;
    ConeMode<D>& mode = modes_[held.block];
    if (mode.hold != Hold::open ||
        std::find(forced_.begin(), forced_.end(), std::pair(key.a, key.b)) == forced_.end())
      continue;
    const ConeBlock<D>& block = blocks_[held.block];
    mode.hold = Hold::slide, mode.along = block.sliding ? block.direction : Tangent<D>::Zero();
  }
  return found;
}

// Whether a slide presses what it rubs on out of all proportion to what there is to bear: near the angle at
// which it locks forces grow without bound, and what holds them as equalities throws bodies away. An impact
// ends that.
template <int D>
bool ExactSolver<D>::jammed() const {
  double most = 0, load = 0;
  for (const Held& held : held_) {
    if (held.kind != Held::Kind::contact || modes_[held.block].hold != Hold::slide) continue;
    most = std::max(most, f_[held.first]);
  }
  if (most == 0) return false;
  const double g = std::sqrt(model_.gravity.squaredNorm());
  for (const int body : active_.subset.bodies)
    load += response_.moves(body) ? g / response_.inverse_mass(body) : 0;
  for (int i = 0; i < int(rows_.size()); ++i) {
    if (const double k = answer(i); k > 0) load += std::fabs(b_[i]) / k;
  }
  return most > kJam * load;
}

template <int D>
bool ExactSolver<D>::acts(const Held& held) const {
  switch (held.kind) {
    case Held::Kind::joint:
      return true;
    case Held::Kind::contact:
      return modes_[held.block].hold != Hold::open;
    default:
      return modes_[held.block].hold == Hold::free;
  }
}

// What is lifted out of what it had sunk into pays for its height with its motion
template <int D>
void ExactSolver<D>::pay_for(State<D>& state) {
  const auto lifted = [&](int body) {
    return -model_.bodies[body].mass * model_.gravity.dot(state.x[body] - placed_[body]);
  };
  const auto left = [](double more, double has) { return std::sqrt(std::max(0.0, 1 - more / has)); };
  for (const int body : free_.bodies()) {
    const double more = lifted(body);
    const double has = more > 0 ? kinetic(model_, state, body) : 0;
    if (has <= 0) continue;
    state.v[body] *= left(more, has);
    if (const int k = turning(state, body); k >= 0) state.spin[k] *= left(more, has);
  }
  for (const int i : active_.subset.chains) {
    double more = 0, has = 0;
    for (const int body : model_.chains[i].bodies) more += lifted(body), has += kinetic(model_, state, body);
    if (more <= 0 || has <= 0) continue;
    for (double& v : state.postures[i].v) v *= left(more, has);
  }
  if (!active_.subset.chains.empty()) free_.chains().follow(state);
}

// puts what is held back to where it belongs: places first, then velocities. `impacts_follow`: contacts that
// approach as in an impact keep their velocities, for the impact to come
template <int D>
void ExactSolver<D>::project(State<D>& state, bool impacts_follow) {
  using Kind = typename Held::Kind;
  const auto again = [&] {
    stand(state);
    rows_.clear();
    for (Held& held : held_) {
      lay_rows(held, held.kind == Kind::contact ? AngularVec<D>::Zero().eval()
                                                : turn_between(state, model_.joints[held.of]));
    }
    chain_response_.build(rows_, response_, free_.chains());
  };
  // how far they are off, at most; into b_ what would bring each row back
  const auto astray = [&] {
    again();
    chosen_.clear();
    double worst = 0;
    b_.setZero(rows_.size());
    for (const Held& held : held_) {
      if (!acts(held) || held.kind == Kind::motor || held.kind == Kind::friction) continue;
      for (int i = 0; i < (held.kind == Kind::contact ? 1 : held.rows); ++i) {
        chosen_.push_back(held.first + i);
        b_[held.first + i] = -(held.kind == Kind::joint ? held.offs[i] : held.off);
        worst = std::max(worst, std::abs(b_[held.first + i]));
      }
    }
    return worst;
  };
  placed_.resize(state.x.size());
  for (const int body : active_.subset.bodies) placed_[body] = state.x[body];
  double moved = 0, worst = astray();
  for (int round = 0; round < 3 && worst > 1e-14 * model_.scale; ++round) {
    moved = std::max(moved, worst);
    least();
    if (worst <= 1e-9 * model_.scale) {
      jump(state, true);
      break;
    }
    // rows that turn far, or hardly move what they hold, lead astray: no farther than it helps
    keep(state, put_);
    ways_ = f_;
    double left = worst;
    for (double part = 1; part > kLeastPart; part /= 2) {
      f_ = part * ways_;
      jump(state, true);
      left = astray();
      if (left <= worst) break;
      restore(put_, state);
      again();
    }
    if (left > worst) break;
    worst = left;
  }
  if (moved > closed_ && !rough_) pay_for(state);

  again();
  chosen_.clear();
  worst = 0;
  b_.setZero(rows_.size());
  for (const Held& held : held_) {
    if (!acts(held)) continue;
    const Hold hold = modes_[held.block].hold;
    if (impacts_follow && held.kind == Kind::contact && moves(held.first) < -rest_) continue;
    const int n = held.kind != Kind::contact ? held.rows : hold == Hold::slide ? 1 : D;
    for (int i = 0; i < n; ++i) {
      const int row = held.first + i;
      const double aim = held.kind == Kind::motor ? model_.joints[held.of].motor->speed : 0;
      chosen_.push_back(row);
      b_[row] = aim - moves(row);
      worst = std::max(worst, std::abs(b_[row]));
    }
  }
  if (worst <= 1e-6 * still_) return;
  least();
  jump(state, false);
}

template class ExactSolver<2>;
template class ExactSolver<3>;

}  // namespace obscura::sim
