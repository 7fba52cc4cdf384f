// Bodies that fly:  x' = v,  v' = f(t, x, v)/m, each on its own. 64 of them are evaluated at a time, from
// rows of components, so that nothing is moved between the stages of a step.

#include "sim/force/flying_forces.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sim/force/force_coupling.h"
#include "sim/force/force_trouble.h"
#include "sim/force/formula.h"
#include "sim/math/lanes.h"
#include "sim/math/limits.h"

namespace obscura::sim {

namespace {

// One axis: adds f/m to the rates of n bodies side by side, or f times `mass` where that is its inverse. Adds
// the powers f v to four sums, unless v is null. Negative where a force is not finite.
template <bool kInverse>
OBSCURA_INLINE std::int64_t give(int n, const double* __restrict f, const double* __restrict mass,
                                 const double* __restrict v, double* __restrict rates,
                                 double* __restrict powers) {
  for (int k = 0; k < n; ++k) rates[k] += kInverse ? f[k] * mass[k] : f[k] / mass[k];
  if (v) {
    double sums[4] = {powers[0], powers[1], powers[2], powers[3]};
    for (int k = 0; k + 4 <= n; k += 4) {
      for (int lane = 0; lane < 4; ++lane) sums[lane] += f[k + lane] * v[k + lane];
    }
    for (int k = n & ~3; k < n; ++k) sums[0] += f[k] * v[k];
    std::copy_n(sums, 4, powers);
  }
  return within(f, n, kLargestForce);
}

// the same bits by two lanes and by four
std::int64_t give_by_two(bool inverse, int n, const double* f, const double* mass, const double* v,
                         double* rates, double* powers) {
  return inverse ? give<true>(n, f, mass, v, rates, powers) : give<false>(n, f, mass, v, rates, powers);
}
OBSCURA_WIDE std::int64_t give_by_four(bool inverse, int n, const double* f, const double* mass,
                                       const double* v, double* rates, double* powers) {
  return inverse ? give<true>(n, f, mass, v, rates, powers) : give<false>(n, f, mass, v, rates, powers);
}

// acts on each body alone, without a torque, and asks for its place and velocity only
template <int D>
bool alone(const Force<D>& force) {
  return force.on == Force<D>::On::each && force.law == Force<D>::Law::formula &&
         !(force.center && force.center->body >= 0) && !force.formula->torque &&
         !force.formula->force.reads(each_slot::angle) && !force.formula->force.reads(each_slot::spin) &&
         !force.formula->force.reads(each_slot::spin_y) && !force.formula->force.reads(each_slot::spin_z);
}

}  // namespace

template <int D>
FlyingForces<D>::FlyingForces(const Model<D>& model) : model_(model), flies_(model.bodies.size(), 0) {
  lanes_.resize(std::size_t(Program::kLanes) * 16);
  find();
}

template <int D>
void FlyingForces<D>::find() {
  const std::vector<char> pushed = pushed_by_forces(model_);
  flies_ = pushed;
  for (const Force<D>& force : model_.forces) {
    for (const Subject<D>& subject : force.subjects) {
      if (!alone(force) || !subject.local.isZero(0)) flies_[std::size_t(subject.body)] = 0;
    }
    if (force.center && force.center->body >= 0) flies_[std::size_t(force.center->body)] = 0;
  }
  for (std::size_t i = 0; i < flies_.size(); ++i) {
    if (model_.bodies[i].linked || model_.bodies[i].ground_drag != 0) flies_[i] = 0;
  }
  for (const Spring<D>& spring : model_.springs) {
    for (const int body : {spring.a.body, spring.b.body})
      if (body >= 0) flies_[std::size_t(body)] = 0;
  }
  for (const Force<D>& force : model_.forces) {
    if (alone(force)) gather({&force, {}, {}, Evaluation(force.formula->force), {}, {}, false});
  }
  all_ = !model_.forces.empty();
  bool drag = false;
  for (std::size_t i = 0; i < flies_.size(); ++i) {
    const Body<D>& body = model_.bodies[i];
    all_ = all_ && !body.turns() && !body.linked && (body.fixed || !pushed[i] || flies_[i]);
    drag = drag || body.drag != 0;
  }
  if (!drag) return;
  for (const Body<D>& body : model_.bodies) drags_.push_back(body.fixed ? 0 : body.drag);
}

// a force, with what stays the same of those of its bodies that fly
template <int D>
void FlyingForces<D>::gather(const One& one) {
  const Force<D>& force = *one.force;
  std::vector<const Subject<D>*> all;
  for (const Subject<D>& subject : force.subjects) {
    if (flies_[std::size_t(subject.body)]) all.push_back(&subject);
  }
  if (all.empty()) return;
  std::sort(all.begin(), all.end(), [](const auto* a, const auto* b) { return a->body < b->body; });
  One& it = forces_.emplace_back(one);
  it.fixed.resize(16);
  for (int slot = 0; slot < each_slot::time; ++slot)
    it.reads[std::size_t(slot)] = force.formula->force.reads(slot);
  it.booked = !force.formula->potential && force.formula->works;
  for (const Subject<D>* subject : all) {
    it.bodies.push_back(subject->body);
    it.fixed[each_slot::mass].push_back(subject->mass),
        it.fixed[each_slot::charge].push_back(subject->charge);
    it.fixed[each_slot::copy].push_back(subject->copy), it.fixed[each_slot::drag].push_back(subject->drag);
    it.fixed[each_slot::quadratic_drag].push_back(subject->quadratic_drag);
  }
  // a product with 1/m is the quotient to the bit where 1/m is exact
  const std::vector<double>& masses = it.fixed[each_slot::mass];
  int exponent = 0;
  if (std::all_of(masses.begin(), masses.end(), [&](double m) { return std::frexp(m, &exponent) == 0.5; }))
    for (const double m : masses) it.inverse.push_back(1 / m);
}

template <int D>
double FlyingForces<D>::accelerate(double t, int first, int count, const double* x, const double* d,
                                   const double* v, double* rates) {
  using namespace each_slot;
  double power = 0;
  if (!drags_.empty()) {
    for (int i = 0; i < count; ++i) {
      double v2 = 0;
      for (int axis = 0; axis < D; ++axis) v2 += v[axis * count + i] * v[axis * count + i];
      power -= drags_[std::size_t(first + i)] * v2;
    }
  }
  for (One& it : forces_) {
    // without gaps there is nothing to search
    const bool whole = it.bodies.back() - it.bodies.front() + 1 == int(it.bodies.size());
    const auto number = [&](int body) {
      if (whole) return std::clamp(body - it.bodies[0], 0, int(it.bodies.size()));
      return int(std::lower_bound(it.bodies.begin(), it.bodies.end(), body) - it.bodies.begin());
    };
    const int begin = number(first), last = number(first + count);
    if (begin == last) continue;
    const Force<D>& force = *it.force;
    std::array<double, std::size_t(each_slot::end)> uniform{};
    uniform[each_slot::time] = t;
    if (force.center) {
      for (int k = 0; k < D; ++k) uniform[std::size_t(center + k)] = force.center->local[k];
    }
    it.evaluation.begin(uniform);
    std::array<const double*, std::size_t(each_slot::time)> inputs{};
    for (int at = begin; at < last; at += Program::kLanes) {
      const int n = std::min(Program::kLanes, last - at);
      const int* const bodies = it.bodies.data() + at;
      // side by side they are read and written where they are
      const bool dense = bodies[n - 1] - bodies[0] == n - 1;
      const auto of = [&](int axis, int k) { return axis * count + bodies[k] - first; };
      for (const int slot : {int(mass), int(charge), int(copy), int(drag), int(quadratic_drag)})
        inputs[std::size_t(slot)] = it.fixed[std::size_t(slot)].data() + at;
      for (int axis = 0; axis < D; ++axis) {
        double* const place = lanes_.data() + std::size_t(each_slot::x + axis) * Program::kLanes;
        double* const speed = lanes_.data() + std::size_t(vx + axis) * Program::kLanes;
        const int from = of(axis, 0);
        inputs[std::size_t(each_slot::x + axis)] = place;
        inputs[std::size_t(vx + axis)] = dense ? v + from : speed;
        if (it.reads[std::size_t(each_slot::x + axis)]) {
          if (dense)
            for (int k = 0; k < n; ++k) place[k] = x[from + k] + d[from + k];
          else
            for (int k = 0; k < n; ++k) place[k] = x[of(axis, k)] + d[of(axis, k)];
        }
        if (!dense && (it.reads[std::size_t(vx + axis)] || it.booked))
          for (int k = 0; k < n; ++k) speed[k] = v[of(axis, k)];
      }
      it.evaluation.run(n, inputs);
      const bool inverse = !it.inverse.empty();
      const double* const masses = inverse ? it.inverse.data() + at : inputs[mass];
      std::int64_t finite = 0;
      double row[Program::kLanes], powers[4] = {};
      for (int axis = 0; axis < D; ++axis) {
        double* to = rates + of(axis, 0);
        if (!dense) {
          for (int k = 0; k < n; ++k) row[k] = rates[of(axis, k)];
          to = row;
        }
        finite |= (lanes::four_lanes ? give_by_four : give_by_two)(
            inverse, n, it.evaluation.output(axis), masses,
            it.booked ? inputs[std::size_t(vx + axis)] : nullptr, to, powers);
        if (dense) continue;
        for (int k = 0; k < n; ++k) rates[of(axis, k)] = row[k];
      }
      power += (powers[0] + powers[1]) + (powers[2] + powers[3]);
      if (finite >= 0) continue;
      for (int k = 0; k < n; ++k) {
        Vec<D> f, place;
        for (int axis = 0; axis < D; ++axis)
          f[axis] = it.evaluation.output(axis)[k], place[axis] = x[of(axis, k)] + d[of(axis, k)];
        if (within(f.data(), D, kLargestForce) < 0) refuse_force(model_, force, bodies[k], t, f, place);
      }
    }
  }
  return power;
}

template class FlyingForces<2>;
template class FlyingForces<3>;

}  // namespace obscura::sim
