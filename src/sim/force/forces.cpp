// Forces on bodies, and between them.
//   formula       f = its components, or -grad V; between two f2 = -f1; tau = its torque, or -dV/d(angle)
//   gravitation   f2 = -G m1 m2 d / (d^2 + s^2)^(3/2)      V = -G m1 m2 / sqrt(d^2 + s^2)
//   coulomb       f2 =  k q1 q2 d / (d^2 + s^2)^(3/2)      V =  k q1 q2 / sqrt(d^2 + s^2)
//   buoyancy      f  =  rho g A up, at the centroid c of A   V = rho g A (level - c_y)
//   function      f, tau = what a program computes of all bodies; no potential
// A is what of the body lies below the level; V is the work against the pressure of the fluid.

#include "sim/force/forces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sim/force/force_coupling.h"
#include "sim/force/force_trouble.h"
#include "sim/force/formula.h"
#include "sim/math/elementary.h"
#include "sim/math/limits.h"
#include "sim/shape/submerged.h"

namespace obscura::sim {

namespace {

constexpr int kLanes = Program::kLanes;
constexpr double kFullTurn = 6.283185307179586;

template <int D>
bool offset(const Subject<D>& subject) {
  return !subject.local.isZero(0);
}

template <int D>
bool formula_of(const Force<D>& force) {
  return force.law == Force<D>::Law::formula;
}

}  // namespace

template <int D>
Forces<D>::Forces(const Model<D>& model)
    : model_(model), pushed_(pushed_by_forces(model)), flying_(model), drives_(model) {
  for (const Force<D>& force : model.forces) {
    potentials_ = potentials_ || force.has_potential();
    Active& it = active_.emplace_back();
    it.force = &force;
    if (!force.formula) continue;
    it.evaluations.emplace_back(force.formula->force);
    if (force.formula->potential) it.evaluations.emplace_back(force.formula->energy);
    reads_angle_ =
        reads_angle_ || (force.on == Force<D>::On::each &&
                         (force.formula->force.reads(each_slot::angle) ||
                          (force.formula->potential && force.formula->energy.reads(each_slot::angle))));
  }
  lanes_.resize(std::size_t(kLanes) * 16);
}

template <int D>
int Forces<D>::member_of(const State<D>& state, const Subject<D>& subject, std::span<const int> member) {
  if (subject.body >= 0 && member[std::size_t(subject.body)] >= 0) return member[std::size_t(subject.body)];
  BodyMotion<D> at;
  at.x = subject.local;
  if (subject.body >= 0) {
    at = body_motion(state, subject.body);
    at.v.setZero(), at.w.setZero();
    if (const int drive = drives_.number(subject.body); drive >= 0)
      driven_.emplace_back(int(still_.size()), drive);
  }
  still_.push_back(at);
  return -int(still_.size());
}

template <int D>
void Forces<D>::gather(const State<D>& state) {
  std::vector<int> member(model_.bodies.size());
  for (int i = 0; i < int(member.size()); ++i)
    member[std::size_t(i)] = model_.bodies[std::size_t(i)].fixed ? -1 : i;
  gather(state, member);
}

template <int D>
void Forces<D>::gather(const State<D>& state, std::span<const int> member) {
  using On = typename Force<D>::On;
  refer(state);
  // what stands still has not moved where the same bodies do
  if (!gathered_.empty() && std::equal(member.begin(), member.end(), gathered_.begin(), gathered_.end()))
    return;
  gathered_.assign(member.begin(), member.end());
  still_.clear(), driven_.clear();
  std::size_t most = 0;
  for (Active& it : active_) {
    const Force<D>& force = *it.force;
    it.subjects.clear(), it.members.clear(), it.fixed.resize(16);
    for (std::vector<double>& slot : it.fixed) slot.clear();
    const auto moves = [&](int k) {
      const int body = force.subjects[std::size_t(k)].body;
      return body >= 0 && member[std::size_t(body)] >= 0;
    };
    const int n = int(force.subjects.size());
    bool any = false;
    for (int k = 0; k < n; ++k) any = any || moves(k);
    if (force.center && force.center->body >= 0) any = any || member[std::size_t(force.center->body)] >= 0;
    for (int k = 0; any && k < n; ++k) {
      if (force.on == On::each && !moves(k) && !(force.center && force.center->body >= 0)) continue;
      if (force.on == On::between && !moves(k) && !moves(k ^ 1)) continue;
      it.subjects.push_back(k);
      it.members.push_back(member_of(state, force.subjects[std::size_t(k)], member));
    }
    if (it.subjects.empty()) continue;
    if (force.center) it.center = member_of(state, *force.center, member);
    most = std::max(most, it.subjects.size());

    // what stays the same
    const auto keep = [&](int slot, auto&& value, int first = 0, int step = 1) {
      for (std::size_t k = std::size_t(first); k < it.subjects.size(); k += std::size_t(step))
        it.fixed[std::size_t(slot)].push_back(value(force.subjects[std::size_t(it.subjects[k])]));
    };
    const auto mass = [](const Subject<D>& s) { return s.mass; };
    const auto charge = [](const Subject<D>& s) { return s.charge; };
    if (force.law == Force<D>::Law::function) {
      stage_.x.resize(it.subjects.size()), stage_.v.resize(it.subjects.size());
      stage_.w.resize(it.subjects.size()), stage_.room_from_body.resize(it.subjects.size());
    } else if (force.on == On::each) {
      using namespace each_slot;
      keep(each_slot::mass, mass), keep(each_slot::charge, charge);
      keep(copy, [](const Subject<D>& s) { return double(s.copy); });
      keep(drag, [](const Subject<D>& s) { return s.drag; });
      keep(quadratic_drag, [](const Subject<D>& s) { return s.quadratic_drag; });
    } else {
      using namespace pair_slot;
      const int step = force.on == On::between ? 2 : 1;
      keep(mass1, mass, 0, step), keep(charge1, charge, 0, step);
      keep(mass2, mass, step - 1, step), keep(charge2, charge, step - 1, step);
    }
  }
  places_.resize(most * 2 * D), pairs_.resize(most * D);
}

template <int D>
void Forces<D>::refer(const State<D>& state) {
  if (D == 3 || !reads_angle_) return;
  angles_.resize(state.x.size());
  for (int i = 0; i < int(state.x.size()); ++i) {
    const int k = turning(state, i);
    angles_[std::size_t(i)] = k < 0 ? 0 : state.turn[std::size_t(k)][0];
  }
}

// of a body that has turned by less than half a turn since refer()
template <int D>
double Forces<D>::angle(const Subject<D>& subject, const BodyMotion<D>& at) const {
  if constexpr (D == 3) {
    return 0;
  } else {
    const double before = angles_.empty() ? 0 : angles_[std::size_t(subject.body)];
    const double now = elementary::atan2(at.room_from_body(1, 0), at.room_from_body(0, 0));
    return now + kFullTurn * std::floor((before - now) / kFullTurn + 0.5) + subject.turn;
  }
}

template <int D>
BodyMotion<D> Forces<D>::point(const Subject<D>& subject, int member,
                               const std::vector<BodyMotion<D>>& motions) const {
  const BodyMotion<D>& body = motion(member, motions);
  if (subject.body < 0 || !offset(subject)) return body;
  BodyMotion<D> at = body;
  const Vec<D> arm = body.arm(subject.local);
  at.x += arm, at.v = body.velocity(arm);
  return at;
}

// --- on each body

template <int D>
template <class Found>
void Forces<D>::each_force(Active& it, double t, const std::vector<BodyMotion<D>>& motions, bool energies,
                           Found&& found) {
  using namespace each_slot;
  const Force<D>& force = *it.force;
  Evaluation& evaluation = it.evaluations[energies];
  const Program& program = energies ? force.formula->energy : force.formula->force;
  std::array<double, std::size_t(each_slot::end)> uniform{};
  uniform[each_slot::time] = t;
  if (force.center) {
    const BodyMotion<D> at = point(*force.center, it.center, motions);
    for (int k = 0; k < D; ++k)
      uniform[std::size_t(center + k)] = at.x[k], uniform[std::size_t(center_velocity + k)] = at.v[k];
  }
  evaluation.begin(uniform);
  const int n = int(it.subjects.size());
  bool reads[each_slot::time];
  for (int slot = 0; slot < each_slot::time; ++slot) reads[slot] = program.reads(slot);
  std::array<const double*, std::size_t(each_slot::time)> inputs{};
  Vec<D> opposite = Vec<D>::Zero();
  for (int first = 0; first < n; first += kLanes) {
    const int count = std::min(kLanes, n - first);
    for (const int slot : {int(mass), int(charge), int(copy), int(drag), int(quadratic_drag)})
      inputs[std::size_t(slot)] = it.fixed[std::size_t(slot)].data() + first;
    const auto fill = [&](int slot, auto&& value) {
      if (!reads[slot]) return;
      double* const row = lanes_.data() + std::size_t(slot) * kLanes;
      inputs[std::size_t(slot)] = row;
      for (int k = 0; k < count; ++k) {
        const Subject<D>& subject = force.subjects[std::size_t(it.subjects[std::size_t(first + k)])];
        row[k] = value(subject, motion(it.members[std::size_t(first + k)], motions));
      }
    };
    for (int axis = 0; axis < D; ++axis) {
      fill(x + axis, [&](const Subject<D>& subject, const BodyMotion<D>& at) {
        return offset(subject) ? Vec<D>(at.x + at.arm(subject.local))[axis] : at.x[axis];
      });
      fill(vx + axis, [&](const Subject<D>& subject, const BodyMotion<D>& at) {
        return offset(subject) ? at.velocity(at.arm(subject.local))[axis] : at.v[axis];
      });
    }
    fill(each_slot::angle,
         [&](const Subject<D>& subject, const BodyMotion<D>& at) { return angle(subject, at); });
    fill(spin, [&](const Subject<D>&, const BodyMotion<D>& at) { return at.w[0]; });
    if constexpr (D == 3) {
      fill(spin_y, [&](const Subject<D>&, const BodyMotion<D>& at) { return at.w[1]; });
      fill(spin_z, [&](const Subject<D>&, const BodyMotion<D>& at) { return at.w[2]; });
    }
    evaluation.run(count, inputs);

    const double* out[D + kAngular<D>];
    const int outputs = energies ? 1 : force.formula->torque ? D + kAngular<D> : D;
    for (int axis = 0; axis < outputs; ++axis) out[axis] = evaluation.output(axis);
    if (energies) {
      for (int k = 0; k < count; ++k) found(first + k, Vec<D>(Vec<D>::Zero()), out[0][k]);
      continue;
    }
    std::int64_t finite = 0;
    for (int axis = 0; axis < outputs; ++axis) finite |= within(out[axis], count, kLargestForce);
    for (int k = 0; k < count; ++k) {
      Vec<D> f;
      AngularVec<D> torque = AngularVec<D>::Zero();
      for (int axis = 0; axis < D; ++axis) f[axis] = out[axis][k];
      for (int axis = D; axis < outputs; ++axis) torque[axis - D] = out[axis][k];
      if (finite < 0 &&
          (within(f.data(), D, kLargestForce) < 0 || within(torque.data(), kAngular<D>, kLargestForce) < 0)) {
        const Subject<D>& subject = force.subjects[std::size_t(it.subjects[std::size_t(first + k)])];
        refuse_force(model_, force, subject.body, t, f,
                     point(subject, it.members[std::size_t(first + k)], motions).x, torque);
      }
      found(first + k, f, 0, std::optional<Vec<D>>(), torque);
      opposite -= f;
    }
  }
  if (force.center && force.center->body >= 0 && !energies) found(-1, opposite, 0);
}

// --- between two

template <int D>
template <class Found>
void Forces<D>::each_pair(Active& it, double t, const std::vector<BodyMotion<D>>& motions, bool energies,
                          Found&& found) {
  using namespace pair_slot;
  const Force<D>& force = *it.force;
  Evaluation& evaluation = it.evaluations[energies];
  std::array<double, std::size_t(pair_slot::end)> uniform{};
  uniform[pair_slot::time] = t;
  evaluation.begin(uniform);
  const int n = int(it.subjects.size());
  // places and velocities side by side: D rows of each
  for (int k = 0; k < n; ++k) {
    const BodyMotion<D> at =
        point(force.subjects[std::size_t(it.subjects[std::size_t(k)])], it.members[std::size_t(k)], motions);
    for (int axis = 0; axis < D; ++axis) {
      places_[std::size_t(axis * n + k)] = at.x[axis];
      places_[std::size_t((D + axis) * n + k)] = at.v[axis];
    }
  }
  std::array<const double*, std::size_t(pair_slot::time)> inputs{};
  const auto row = [&](int slot) { return lanes_.data() + std::size_t(slot) * kLanes; };
  for (const int slot : {int(dx), int(dvx)}) {
    for (int axis = 0; axis < D; ++axis) inputs[std::size_t(slot + axis)] = row(slot + axis);
  }
  const auto give = [&](int count, auto&& first, auto&& second) {
    evaluation.run(count, inputs);
    const double* out[D];
    for (int axis = 0; axis < (energies ? 1 : D); ++axis) out[axis] = evaluation.output(axis);
    for (int k = 0; k < count; ++k) {
      if (energies) {
        found(first(k), Vec<D>(Vec<D>::Zero()), 0.5 * out[0][k]),
            found(second(k), Vec<D>(Vec<D>::Zero()), 0.5 * out[0][k]);
        continue;
      }
      Vec<D> f;
      for (int axis = 0; axis < D; ++axis) f[axis] = out[axis][k];
      if (within(f.data(), D, kLargestForce) < 0) {
        const int which = second(k);
        const Subject<D>& subject = force.subjects[std::size_t(it.subjects[std::size_t(which)])];
        refuse_force(model_, force, subject.body, t, f,
                     point(subject, it.members[std::size_t(which)], motions).x);
      }
      found(first(k), Vec<D>(-f), 0), found(second(k), f, 0);
    }
  };
  if (force.on == Force<D>::On::between) {
    for (int from = 0; from < n; from += 2 * kLanes) {
      const int count = std::min(kLanes, (n - from) / 2);
      for (int axis = 0; axis < 2 * D; ++axis) {
        const int slot = axis < D ? dx + axis : dvx + axis - D;
        for (int k = 0; k < count; ++k)
          row(slot)[k] = places_[std::size_t(axis * n + from + 2 * k + 1)] -
                         places_[std::size_t(axis * n + from + 2 * k)];
      }
      for (const int slot : {int(mass1), int(mass2), int(charge1), int(charge2)})
        inputs[std::size_t(slot)] = it.fixed[std::size_t(slot)].data() + from / 2;
      give(
          count, [&](int k) { return from + 2 * k; }, [&](int k) { return from + 2 * k + 1; });
    }
    return;
  }
  for (int i = 0; i + 1 < n; ++i) {
    for (const int slot : {int(mass1), int(charge1)}) {
      std::fill_n(row(slot), kLanes, it.fixed[std::size_t(slot)][std::size_t(i)]);
      inputs[std::size_t(slot)] = row(slot);
    }
    for (int from = i + 1; from < n; from += kLanes) {
      const int count = std::min(kLanes, n - from);
      for (int axis = 0; axis < 2 * D; ++axis) {
        const int slot = axis < D ? dx + axis : dvx + axis - D;
        const double* const all = places_.data() + std::size_t(axis * n);
        for (int k = 0; k < count; ++k) row(slot)[k] = all[from + k] - all[i];
      }
      for (const int slot : {int(mass2), int(charge2)})
        inputs[std::size_t(slot)] = it.fixed[std::size_t(slot)].data() + from;
      give(
          count, [&](int) { return i; }, [&](int k) { return from + k; });
    }
  }
}

// --- gravitation and Coulomb's force among all

template <int D>
template <class Found>
void Forces<D>::attract(Active& it, double t, const std::vector<BodyMotion<D>>& motions, bool energies,
                        Found&& found) {
  const Force<D>& force = *it.force;
  const bool masses = force.law == Force<D>::Law::gravitation;
  const int n = int(it.subjects.size());
  const double c = masses ? -force.strength : force.strength, s2 = force.softening * force.softening;
  const double* const w = it.fixed[std::size_t(masses ? pair_slot::mass2 : pair_slot::charge2)].data();
  for (int k = 0; k < n; ++k) {
    const BodyMotion<D> at =
        point(force.subjects[std::size_t(it.subjects[std::size_t(k)])], it.members[std::size_t(k)], motions);
    for (int axis = 0; axis < D; ++axis)
      places_[std::size_t(axis * n + k)] = at.x[axis], pairs_[std::size_t(axis * n + k)] = 0;
  }
  if (energies) {
    for (int i = 0; i < n; ++i) {
      for (int j = i + 1; j < n; ++j) {
        double r2 = s2;
        for (int axis = 0; axis < D; ++axis) {
          const double d = places_[std::size_t(axis * n + j)] - places_[std::size_t(axis * n + i)];
          r2 += d * d;
        }
        const double half = 0.5 * c * w[i] * w[j] / std::sqrt(r2);
        found(i, Vec<D>(Vec<D>::Zero()), half), found(j, Vec<D>(Vec<D>::Zero()), half);
      }
    }
    return;
  }
  const double* at[D];
  double* sums[D];
  for (int axis = 0; axis < D; ++axis)
    at[axis] = places_.data() + std::size_t(axis * n), sums[axis] = pairs_.data() + std::size_t(axis * n);
  for (int i = 0; i < n; ++i) {
    double here[D], own[D][4] = {};
    for (int axis = 0; axis < D; ++axis) here[axis] = at[axis][i];
    const double strength = c * w[i];
    // four sums in turn, so that four pairs go side by side
    int j = i + 1;
    for (; j + 4 <= n; j += 4) {
      double d[D][4], k[4];
      for (int lane = 0; lane < 4; ++lane) {
        double r2 = s2;
        for (int axis = 0; axis < D; ++axis) {
          d[axis][lane] = at[axis][j + lane] - here[axis];
          r2 += d[axis][lane] * d[axis][lane];
        }
        k[lane] = strength * w[j + lane] / (r2 * std::sqrt(r2));
      }
      for (int axis = 0; axis < D; ++axis) {
        for (int lane = 0; lane < 4; ++lane) {
          const double f = k[lane] * d[axis][lane];
          sums[axis][j + lane] += f;
          own[axis][lane] -= f;
        }
      }
    }
    for (int lane = 0; j < n; ++j, ++lane) {
      double d[D], r2 = s2;
      for (int axis = 0; axis < D; ++axis) d[axis] = at[axis][j] - here[axis], r2 += d[axis] * d[axis];
      const double k = strength * w[j] / (r2 * std::sqrt(r2));
      for (int axis = 0; axis < D; ++axis) {
        const double f = k * d[axis];
        sums[axis][j] += f;
        own[axis][lane] -= f;
      }
    }
    Vec<D> f;
    for (int axis = 0; axis < D; ++axis)
      f[axis] = sums[axis][i] + ((own[axis][0] + own[axis][1]) + (own[axis][2] + own[axis][3]));
    if (within(f.data(), D, kLargestForce) < 0) {
      const Subject<D>& subject = force.subjects[std::size_t(it.subjects[std::size_t(i)])];
      refuse_force(model_, force, subject.body, t, f, point(subject, it.members[std::size_t(i)], motions).x);
    }
    found(i, f, 0);
  }
}

// --- a fluid

template <int D>
template <class Found>
void Forces<D>::float_up(Active& it, const std::vector<BodyMotion<D>>& motions, bool energies,
                         Found&& found) {
  const Force<D>& force = *it.force;
  const double weight = force.density * std::sqrt(model_.gravity.squaredNorm());
  for (int k = 0; k < int(it.subjects.size()); ++k) {
    const Subject<D>& subject = force.subjects[std::size_t(it.subjects[std::size_t(k)])];
    const BodyMotion<D>& at = motion(it.members[std::size_t(k)], motions);
    const Displaced<D> wet = displaced(model_.bodies[std::size_t(subject.body)].shape, at, force.level);
    if (energies)
      found(k, Vec<D>(Vec<D>::Zero()), weight * wet.content * (force.level - wet.center[1]), wet.center);
    else
      found(k, Vec<D>(Vec<D>::Unit(1) * (weight * wet.content)), 0, wet.center);
  }
}

// --- of a program

// found(k, f, 0, {}, torque); all subjects at once, still ones among them
template <int D>
template <class Found>
void Forces<D>::call(Active& it, double t, const std::vector<BodyMotion<D>>& motions, Found&& found) {
  const std::size_t n = it.subjects.size();
  stage_.time = t;
  for (std::size_t k = 0; k < n; ++k) {
    const BodyMotion<D>& at = motion(it.members[k], motions);
    stage_.x[k] = at.x, stage_.v[k] = at.v, stage_.w[k] = at.w, stage_.room_from_body[k] = at.room_from_body;
  }
  answered_forces_.assign(n, Vec<D>::Zero()), answered_torques_.assign(n, AngularVec<D>::Zero());
  (*it.force->function)(stage_, answered_forces_, answered_torques_);
  for (std::size_t k = 0; k < n; ++k) {
    const Vec<D>& f = answered_forces_[k];
    const AngularVec<D>& torque = answered_torques_[k];
    if (within(f.data(), D, kLargestForce) < 0 ||
        within(torque.data(), int(torque.size()), kLargestForce) < 0)
      refuse_force(model_, *it.force, it.force->subjects[std::size_t(it.subjects[k])].body, t, f, stage_.x[k],
                   torque);
    found(int(k), f, 0, std::optional<Vec<D>>(), torque);
  }
}

// found(k, f, e): the subject at place k of the list has the force f, or the energy e; -1: the centre
template <int D>
template <class Found>
void Forces<D>::all(Active& it, double t, const std::vector<BodyMotion<D>>& motions, bool energies,
                    Found&& found) {
  if (it.subjects.empty()) return;
  switch (it.force->law) {
    case Force<D>::Law::formula:
      return it.force->on == Force<D>::On::each ? each_force(it, t, motions, energies, found)
                                                : each_pair(it, t, motions, energies, found);
    case Force<D>::Law::gravitation:
    case Force<D>::Law::coulomb:
      return attract(it, t, motions, energies, found);
    case Force<D>::Law::buoyancy:
      return float_up(it, motions, energies, found);
    case Force<D>::Law::function:
      return energies ? void() : call(it, t, motions, found);
  }
}

template <int D>
void Forces<D>::apply(Active& it, double t, const std::vector<BodyMotion<D>>& motions,
                      std::vector<Wrench<D>>& wrenches) {
  const bool potential = it.force->has_potential();
  const auto found = [&](int k, const Vec<D>& f, double, const std::optional<Vec<D>>& at = {},
                         const AngularVec<D>& torque = AngularVec<D>::Zero()) {
    const int member = k < 0 ? it.center : it.members[std::size_t(k)];
    const Subject<D>& subject =
        k < 0 ? *it.force->center : it.force->subjects[std::size_t(it.subjects[std::size_t(k)])];
    if (member < 0) {
      if (potential && !driven_.empty()) driven_power_ -= f.dot(point(subject, member, motions).v);
      if (potential && !driven_.empty() && it.force->turns())
        driven_power_ -= torque.dot(motion(member, motions).w);
      return;
    }
    Wrench<D>& wrench = wrenches[std::size_t(member)];
    wrench.f += f;
    if (it.force->turns()) wrench.n += torque;
    if (at)
      wrench.n += moment<D>(Vec<D>(*at - motions[std::size_t(member)].x), f);
    else if (offset(subject))
      wrench.n += moment<D>(motions[std::size_t(member)].arm(subject.local), f);
  };
  all(it, t, motions, false, found);
}

template <int D>
void Forces<D>::apply(double t, const std::vector<BodyMotion<D>>& motions, std::vector<Wrench<D>>& wrenches) {
  move_driven(t);
  driven_power_ = 0;
  for (Active& it : active_) apply(it, t, motions, wrenches);
}

template <int D>
void Forces<D>::apply_drag(double t, bool drag, const std::vector<BodyMotion<D>>& motions,
                           std::vector<Wrench<D>>& wrenches) {
  move_driven(t);
  for (Active& it : active_)
    if (it.force->drag == drag) apply(it, t, motions, wrenches);
}

template <int D>
double Forces<D>::energy(double t, const std::vector<BodyMotion<D>>& motions, std::vector<double>* each) {
  move_driven(t);
  double sum = 0;
  for (Active& it : active_) {
    if (!it.force->has_potential()) continue;
    const auto found = [&](int k, const Vec<D>&, double e, const std::optional<Vec<D>>& = {},
                           const AngularVec<D>& = AngularVec<D>::Zero()) {
      sum += e;
      const int member = k < 0 ? it.center : it.members[std::size_t(k)];
      if (each && member >= 0) (*each)[std::size_t(member)] += e;
    };
    all(it, t, motions, true, found);
  }
  return sum;
}

template <int D>
double Forces<D>::energy_of(const State<D>& state, int body, const BodyMotion<D>& at, double t) {
  using namespace each_slot;
  double sum = 0;
  for (Active& it : active_) {
    const Force<D>& force = *it.force;
    if (force.on != Force<D>::On::each || !force.has_potential()) continue;
    for (const Subject<D>& subject : force.subjects) {
      if (subject.body != body) continue;
      if (!formula_of(force)) {
        const Displaced<D> wet = displaced(model_.bodies[std::size_t(body)].shape, at, force.level);
        sum += force.density * std::sqrt(model_.gravity.squaredNorm()) * wet.content *
               (force.level - wet.center[1]);
        continue;
      }
      std::array<double, std::size_t(each_slot::end)> uniform{};
      uniform[each_slot::time] = t;
      if (force.center) {
        Vec<D> middle = force.center->local;
        if (force.center->body >= 0) {
          const BodyMotion<D> its = body_motion(state, force.center->body);
          middle = its.x + its.arm(force.center->local);
        }
        for (int k = 0; k < D; ++k) uniform[std::size_t(center + k)] = middle[k];
      }
      const Vec<D> place = at.x + at.arm(subject.local);
      std::array<double, std::size_t(each_slot::time)> values{};
      for (int k = 0; k < D; ++k) values[std::size_t(x + k)] = place[k];
      if (force.formula->energy.reads(each_slot::angle)) values[each_slot::angle] = angle(subject, at);
      values[mass] = subject.mass, values[charge] = subject.charge, values[copy] = subject.copy;
      std::array<const double*, std::size_t(each_slot::time)> inputs;
      for (std::size_t k = 0; k < inputs.size(); ++k) inputs[k] = &values[k];
      it.evaluations[1].begin(uniform);
      it.evaluations[1].run(1, inputs);
      sum += it.evaluations[1].output(0)[0];
    }
  }
  return sum;
}

template <int D>
double Forces<D>::power(double t, const std::vector<BodyMotion<D>>& motions) {
  move_driven(t);
  double sum = 0;
  for (Active& it : active_) {
    if (!it.force->does_work()) continue;
    const auto found = [&](int k, const Vec<D>& f, double, const std::optional<Vec<D>>& = {},
                           const AngularVec<D>& torque = AngularVec<D>::Zero()) {
      const Subject<D>& subject =
          k < 0 ? *it.force->center : it.force->subjects[std::size_t(it.subjects[std::size_t(k)])];
      const int member = k < 0 ? it.center : it.members[std::size_t(k)];
      if (member < 0) return;
      sum += f.dot(point(subject, member, motions).v);
      if (it.force->turns()) sum += torque.dot(motions[std::size_t(member)].w);
    };
    all(it, t, motions, false, found);
  }
  return sum;
}

template <int D>
void stand(const State<D>& state, std::vector<BodyMotion<D>>& motions) {
  motions.resize(state.x.size());
  for (int i = 0; i < int(state.x.size()); ++i) motions[std::size_t(i)] = body_motion(state, i);
}

template class Forces<2>;
template class Forces<3>;
template void stand<2>(const State<2>&, std::vector<BodyMotion<2>>&);
template void stand<3>(const State<3>&, std::vector<BodyMotion<3>>&);

}  // namespace obscura::sim
