#include "sim/energy/energy.h"

#include "sim/constraint/joints/joint.h"
#include "sim/force/forces.h"
#include "sim/force/spring.h"
#include "sim/math/lie_step.h"

namespace obscura::sim {

template <int D>
double kinetic(const Model<D>& model, const State<D>& state, int body) {
  const Body<D>& b = model.bodies[body];
  double energy = 0.5 * b.mass * state.v[body].squaredNorm();
  if (const int k = turning(state, body); k >= 0) {
    energy += spin_energy<D>(b.inertia, rotation<D>(state.turn[k]), state.spin[k]);
  }
  return energy;
}

template <int D>
double kinetic(const Model<D>& model, const State<D>& state) {
  double sum = 0;
  for (int body = 0; body < int(model.bodies.size()); ++body) {
    if (!model.bodies[body].fixed) sum += kinetic(model, state, body);
  }
  return sum;
}

template <int D>
double gravity_energy(const Model<D>& model, const State<D>& state, int body) {
  return -model.bodies[body].mass * model.gravity.dot(state.x[body]);
}

template <int D>
double spring_energy(const Model<D>& model, const State<D>& state, int spring) {
  const Spring<D>& s = model.springs[spring];
  return spring_energy<D>(law(s), place(state, s.a), place(state, s.b));
}

template <int D>
double joint_spring_energy(const Model<D>& model, const State<D>& state, int joint) {
  const Joint<D>& it = model.joints[std::size_t(joint)];
  const bool broken = std::size_t(joint) < state.broken.size() && state.broken[std::size_t(joint)];
  if (!it.coil || broken) return 0;
  const auto motion = [&](int body) { return body < 0 ? BodyMotion<D>{} : body_motion(state, body); };
  Row<D> row;
  double c = 0;
  free_row(it, motion(it.a.body), motion(it.b.body), turn_between(it, state), row, c);
  return 0.5 * it.coil->stiffness * (c - it.coil->rest) * (c - it.coil->rest);
}

template <int D>
double spring_energy(const Model<D>& model, const State<D>& state, const std::vector<Path<D>>& paths,
                     int mouse, double t) {
  const Grip<D>& grip = state.grips[mouse];
  if (grip.body < 0) return 0;
  return spring_energy<D>(law(model.mice[mouse]), place(state, End<D>{grip.body, grip.local}),
                          paths[mouse].place(t));
}

template <int D>
double field_energy(const Model<D>& model, const State<D>& state, double t, std::vector<double>* each) {
  if (model.forces.empty()) return 0;
  Forces<D> forces(model);
  forces.gather(state);
  std::vector<BodyMotion<D>> motions;
  stand(state, motions);
  return forces.energy(t, motions, each);
}

template <int D>
Energies energies(const Model<D>& model, const State<D>& state, const std::vector<Path<D>>& paths, double t) {
  Energies sum;
  for (int body = 0; body < int(model.bodies.size()); ++body) {
    if (model.bodies[body].fixed) continue;
    sum.kinetic += kinetic(model, state, body);
    sum.gravity += gravity_energy(model, state, body);
  }
  for (int spring = 0; spring < int(model.springs.size()); ++spring)
    sum.springs += spring_energy(model, state, spring);
  for (int joint = 0; joint < int(model.joints.size()); ++joint)
    if (model.joints[std::size_t(joint)].coil) sum.springs += joint_spring_energy(model, state, joint);
  for (int mouse = 0; mouse < int(model.mice.size()); ++mouse)
    sum.hand += spring_energy(model, state, paths, mouse, t);
  sum.fields = field_energy(model, state, t);
  for (const double work : state.work) sum.work += work;
  sum.displacement = state.ledger.displacement;
  sum.impacts = state.ledger.impacts;
  return sum;
}

template <int D>
Vec<D> momentum(const Model<D>& model, const State<D>& state) {
  Vec<D> sum = Vec<D>::Zero();
  for (int body = 0; body < int(model.bodies.size()); ++body) {
    if (!model.bodies[body].fixed) sum += model.bodies[body].mass * state.v[body];
  }
  return sum;
}

template <int D>
AngularVec<D> angular_momentum(const Model<D>& model, const State<D>& state) {
  AngularVec<D> sum = AngularVec<D>::Zero();
  for (int body = 0; body < int(model.bodies.size()); ++body) {
    const Body<D>& b = model.bodies[body];
    if (b.fixed) continue;
    sum += b.mass * moment<D>(state.x[body], state.v[body]);
    if (const int k = turning(state, body); k >= 0) {
      const Rotation<D> axes = D == 2 ? Rotation<D>(Rotation<D>::Identity()) : rotation<D>(state.turn[k]);
      sum += inertia_times<D>(b.inertia, axes, state.spin[k]);
    }
  }
  return sum;
}

template double kinetic<2>(const Model<2>&, const State<2>&, int);
template double kinetic<2>(const Model<2>&, const State<2>&);
template double gravity_energy<2>(const Model<2>&, const State<2>&, int);
template double spring_energy<2>(const Model<2>&, const State<2>&, int);
template double joint_spring_energy<2>(const Model<2>&, const State<2>&, int);
template double joint_spring_energy<3>(const Model<3>&, const State<3>&, int);
template double spring_energy<2>(const Model<2>&, const State<2>&, const std::vector<Path<2>>&, int, double);
template double field_energy<2>(const Model<2>&, const State<2>&, double, std::vector<double>*);
template Energies energies<2>(const Model<2>&, const State<2>&, const std::vector<Path<2>>&, double);
template Vec<2> momentum<2>(const Model<2>&, const State<2>&);
template AngularVec<2> angular_momentum<2>(const Model<2>&, const State<2>&);
template double kinetic<3>(const Model<3>&, const State<3>&, int);
template double kinetic<3>(const Model<3>&, const State<3>&);
template double gravity_energy<3>(const Model<3>&, const State<3>&, int);
template double spring_energy<3>(const Model<3>&, const State<3>&, int);
template double spring_energy<3>(const Model<3>&, const State<3>&, const std::vector<Path<3>>&, int, double);
template double field_energy<3>(const Model<3>&, const State<3>&, double, std::vector<double>*);
template Energies energies<3>(const Model<3>&, const State<3>&, const std::vector<Path<3>>&, double);
template Vec<3> momentum<3>(const Model<3>&, const State<3>&);
template AngularVec<3> angular_momentum<3>(const Model<3>&, const State<3>&);

}  // namespace obscura::sim
