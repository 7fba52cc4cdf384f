// The loads on bonds. For part i of a rigid body at d_i from its centre of mass, m_i, T_i (room's frame),
//   A = sum F / M,   alpha = I^-1 (sum (N_i + d_i x F_i) - w x I w)
//   f_i = m_i (A + alpha x d_i + w x (w x d_i)) - F_i         force of its bonds on it
//   n_i = T_i alpha + w x T_i w - N_i                         torque of its bonds on it
// A bond k of a and b at p gives a (f, (p - x_a) x f + tau) and b the opposite. With z = (f, tau / l),
//   G z = (f_i, n_i),   z = G' (G G')^-1 (f_i, n_i)           the solution of least norm
// without one part of a free body, whose equation follows from the others. For an impact the same with
// impulses and without w; an impulse counts as a force of that over the
// duration that the bond has for impacts.
// Couples that joints transmit, as a weld does, are what the change of the body's spin in the step tells:
//   C = I (dw / h - alpha)                                    shared out evenly where there are several

#include "sim/fracture/bond_load.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "sim/force/spring.h"
#include "sim/model/body_motion.h"

namespace obscura::sim {

namespace {

template <int D>
SpinTensor<D> tensor(const Body<D>& body, const BodyMotion<D>& at) {
  if constexpr (D == 2) {
    return SpinTensor<D>(body.inertia);
  } else {
    return at.room_from_body * body.inertia.asDiagonal() * at.room_from_body.transpose();
  }
}

// whether a joint may transmit more than a force at its ends
template <int D>
bool bears_couple(const Joint<D>& joint) {
  const bool point = joint.kind == JointKind::pin || (D == 2 && joint.kind == JointKind::hinge);
  const bool straight = joint.kind == JointKind::rod || joint.kind == JointKind::rope ||
                        (joint.kind == JointKind::pulley && joint.on_a.offset == 0 && joint.on_b.offset == 0);
  const bool turned =
      joint.motor || joint.coil || joint.friction > 0 || joint.lower > -1e299 || joint.upper < 1e299;
  return !straight && !(point && !turned);
}

}  // namespace

template <int D>
BondLoads<D>::BondLoads(const Model<D>& model, const std::vector<Path<D>>& paths)
    : model_(model), paths_(paths), blasts_(model), forces_(model), loads_(model.bonds.size(), 0.0) {}

// forces and torques from outside
template <int D>
void BondLoads<D>::push(const State<D>& state, double t) {
  const int n = int(model_.bodies.size());
  steady_.assign(n, {}), blows_.assign(n, {});
  const auto add = [&](std::vector<Wrench<D>>& to, int body, const Vec<D>& place, const Vec<D>& force) {
    if (body >= 0) to[body] += Wrench<D>{moment<D>(place - state.x[body], force), force};
  };
  for (int i = 0; i < n; ++i) {
    const Body<D>& body = model_.bodies[i];
    steady_[i].f = body.mass * model_.gravity - body.drag * state.v[i];
    for (int k = 0; k < int(state.blasts.size()); ++k) {
      if (state.blasts[k].on) steady_[i] += blasts_.push(model_.explosions[k], i, body_motion(state, i));
    }
  }
  if (forces_.any()) {
    forces_.gather(state);
    stand(state, motions_);
    forces_.apply(t, motions_, steady_);
  }
  for (const Spring<D>& s : model_.springs) {
    const Vec<D> a = place(state, s.a), b = place(state, s.b);
    const Vec<D> force = pull<D>(law(s), a, velocity(state, s.a), b, velocity(state, s.b));
    add(steady_, s.a.body, a, force), add(steady_, s.b.body, b, -force);
  }
  for (int i = 0; i < int(state.grips.size()); ++i) {
    const End<D> held{state.grips[i].body, state.grips[i].local};
    if (held.body < 0) continue;
    const auto hand = paths_[i].at(t);
    const Vec<D> a = place(state, held);
    add(steady_, held.body, a,
        pull<D>(law(model_.mice[i]), a, velocity(state, held), hand.place, hand.velocity));
  }
  for (int i = 0; i < int(state.joint_forces.size()); ++i) {
    const Joint<D>& joint = model_.joints[i];
    add(steady_, joint.a.body, place(state, joint.a), state.joint_forces[i]);
    add(steady_, joint.b.body, place(state, joint.b), -state.joint_forces[i]);
  }
  for (const Contact<D>& contact : state.contacts) {
    add(steady_, contact.key.a, contact.point, contact.force);
    add(steady_, contact.key.b, contact.point, -contact.force);
    add(blows_, contact.key.a, contact.point, contact.impulse);
    add(blows_, contact.key.b, contact.point, -contact.impulse);
  }
  for (const Touch<D>& touch : state.touches) add(blows_, touch.body, touch.point, touch.impulse);
}

template <int D>
bool BondLoads<D>::snap(State<D>& state, const Model<D>& whole, const std::vector<int>& body,
                        const std::vector<AngularVec<D>>& before, double t, double h) {
  std::fill(loads_.begin(), loads_.end(), 0.0);
  std::vector<std::vector<int>> parts(whole.bodies.size()), bonds(whole.bodies.size());
  bool breakable = false;
  for (int k = 0; k < int(model_.bonds.size()); ++k) {
    if (!state.intact[k]) continue;
    bonds[body[model_.bonds[k].a]].push_back(k);
    breakable = breakable || model_.bonds[k].strength < 1e300;
  }
  if (!breakable) return false;
  for (int i = 0; i < int(body.size()); ++i) parts[body[i]].push_back(i);
  push(state, t);
  bool any = false;
  for (int i = 0; i < int(whole.bodies.size()); ++i) {
    if (bonds[i].empty()) continue;
    const Composite it{whole.bodies[i], body_motion(state.bonded[0], i), parts[i], bonds[i], before[i], h};
    any = snap(state, it) || any;
  }
  return any;
}

template <int D>
struct BondLoads<D>::Equations {
  Eigen::SparseMatrix<double> G;
};

// one rigid body
template <int D>
bool BondLoads<D>::snap(State<D>& state, const Composite& it) {
  const Unknown parts = number_parts(it);
  if (parts.count == 0) return false;
  add_couples(state, it);
  const Required want = required(state, it, accelerate(state, it), parts);
  const std::vector<Lever> arms = levers(state, it);
  if (!may_break(it, want, arms)) return false;

  // z = G' (G G')^-1 (f_i, n_i)
  const Equations system = equations(state, it, parts, arms);
  const Eigen::SparseMatrix<double>& G = system.G;
  const Eigen::SparseMatrix<double> GG = G * Eigen::SparseMatrix<double>(G.transpose());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(GG);
  return break_overloaded(state, it, system, factor.solve(want.loads));
}

template <int D>
typename BondLoads<D>::Rates BondLoads<D>::accelerate(const State<D>& state, const Composite& it) const {
  Rates rates;
  if (it.body.fixed) return rates;
  Wrench<D> force, blow;
  for (const int i : it.parts) {
    force += transformed_to_origin(steady_[i], Vec<D>(state.x[i] - it.at.x));
    blow += transformed_to_origin(blows_[i], Vec<D>(state.x[i] - it.at.x));
  }
  rates.A = force.f / it.body.mass, rates.dv = blow.f / it.body.mass;
  if (!it.body.turns()) return rates;
  const Rotation<D>& axes = it.at.room_from_body;
  const AngularVec<D>& w = it.at.w;
  const AngularVec<D> L = to_room<D>(axes, it.body.inertia.cwiseProduct(from_room<D>(axes, w)));
  rates.alpha = inverse_inertia_times<D>(it.body.inertia, axes, AngularVec<D>(force.n - spin_cross<D>(w, L)));
  rates.dw = inverse_inertia_times<D>(it.body.inertia, axes, blow.n);
  return rates;
}

// couples of joints, on the parts that they hold
template <int D>
void BondLoads<D>::add_couples(const State<D>& state, const Composite& it) {
  if (it.body.fixed || !it.body.turns()) return;
  const auto within = [&](int part) {
    return part >= 0 && std::find(it.parts.begin(), it.parts.end(), part) != it.parts.end();
  };
  std::vector<int> held;
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    const Joint<D>& joint = model_.joints[i];
    if (state.broken[i] || !bears_couple(joint) || within(joint.a.body) == within(joint.b.body)) continue;
    held.push_back(within(joint.a.body) ? joint.a.body : joint.b.body);
  }
  if (held.empty()) return;
  const Rates rates = accelerate(state, it);
  const bool struck = std::any_of(it.parts.begin(), it.parts.end(),
                                  [&](int i) { return !blows_[i].f.isZero(0) || !blows_[i].n.isZero(0); });
  const AngularVec<D> missing =
      inertia_times<D>(it.body.inertia, it.at.room_from_body,
                       AngularVec<D>(it.at.w - it.before - rates.dw - it.h * rates.alpha));
  for (const int part : held) {
    if (struck) {
      blows_[part].n += missing / double(held.size());
    } else {
      steady_[part].n += missing / (it.h * double(held.size()));
    }
  }
}

// all parts that are not fixed, but for one if the body is free: its equation follows from the others
template <int D>
typename BondLoads<D>::Unknown BondLoads<D>::number_parts(const Composite& it) const {
  Unknown parts;
  parts.place.assign(model_.bodies.size(), -1);
  for (int p = it.body.fixed ? 0 : 1; p < int(it.parts.size()); ++p) {
    if (!model_.bodies[it.parts[p]].fixed) parts.place[it.parts[p]] = parts.count++;
  }
  return parts;
}

// force and torque that the bonds of each part exert on it: steadily, and in the impact
template <int D>
typename BondLoads<D>::Required BondLoads<D>::required(const State<D>& state, const Composite& it,
                                                       const Rates& rates, const Unknown& parts) const {
  const auto& [A, dv, alpha, dw] = rates;
  const AngularVec<D>& w = it.at.w;
  const int rows = it.rows();
  double shortest = 1e300;
  for (const int k : it.bonds) shortest = std::min(shortest, model_.bonds[k].impact_duration);
  Required want;
  want.loads = Eigen::MatrixXd::Zero(rows * parts.count, 2);
  for (const int i : it.parts) {
    const Body<D>& part = model_.bodies[i];
    const SpinTensor<D> own = tensor(part, body_motion(state, i));
    const Vec<D> d = state.x[i] - it.at.x;
    const Vec<D> f =
        part.mass * (A + cross_velocity<D>(alpha, d) + cross_velocity<D>(w, cross_velocity<D>(w, d))) -
        steady_[i].f;
    const Vec<D> j = part.mass * (dv + cross_velocity<D>(dw, d)) - blows_[i].f;
    const AngularVec<D> nt = own * alpha + spin_cross<D>(w, AngularVec<D>(own * w)) - steady_[i].n;
    const AngularVec<D> jt = own * dw - blows_[i].n;
    want.forces += f.norm() + j.norm() / shortest, want.torques += nt.norm() + jt.norm() / shortest;
    want.far = std::max(want.far, d.norm());
    if (parts.place[i] < 0) continue;
    const int first = rows * parts.place[i];
    want.loads.block(first, 0, D, 1) = f, want.loads.block(first, 1, D, 1) = j;
    if (it.body.turns()) {
      want.loads.block(first + D, 0, kAngular<D>, 1) = nt;
      want.loads.block(first + D, 1, kAngular<D>, 1) = jt;
    }
  }
  return want;
}

template <int D>
std::vector<typename BondLoads<D>::Lever> BondLoads<D>::levers(const State<D>& state,
                                                               const Composite& it) const {
  std::vector<Lever> arms;
  for (const int k : it.bonds) {
    const Bond<D>& bond = model_.bonds[k];
    const Vec<D> other = bond.b < 0 ? state.x[bond.a] : state.x[bond.b];
    double l = (state.x[bond.a] - other).norm() / 2;
    if (l == 0) l = std::max(bounding_radius(model_.bodies[bond.a].shape), 1e-9 * model_.scale);
    arms.push_back({(state.x[bond.a] + other) / 2, l});
  }
  return arms;
}

// A cheap bound: no tree of bonds bears more than all forces and torques on its longest lever, and the norm
// of the least-norm loads is no larger.
template <int D>
bool BondLoads<D>::may_break(const Composite& it, const Required& want,
                             const std::vector<Lever>& arms) const {
  double least = 1e300, weakest = 1e300;
  for (const Lever& arm : arms) least = std::min(least, arm.l);
  for (const int k : it.bonds) weakest = std::min(weakest, model_.bonds[k].strength);
  const double bent = it.body.turns() ? (want.torques + 2 * want.far * want.forces) / least : 0;
  return std::sqrt(double(it.bonds.size()) * (want.forces * want.forces + bent * bent)) > weakest;
}

// G, a block of columns a bond
template <int D>
typename BondLoads<D>::Equations BondLoads<D>::equations(const State<D>& state, const Composite& it,
                                                         const Unknown& parts,
                                                         const std::vector<Lever>& arms) const {
  constexpr int kRows = D + kAngular<D>;
  using Block = Eigen::Matrix<double, kRows, kRows>;
  const int rows = it.rows();
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int bond, int part, double sign) {
    Block g = Block::Zero();
    g.template topLeftCorner<D, D>().diagonal().setConstant(sign);
    g.template bottomLeftCorner<kAngular<D>, D>() =
        sign * lever<D>(Vec<D>(arms[bond].point - state.x[part])).transpose();
    g.template bottomRightCorner<kAngular<D>, kAngular<D>>().diagonal().setConstant(sign * arms[bond].l);
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < rows; ++c) {
        if (g(r, c) != 0) entries.emplace_back(rows * parts.place[part] + r, rows * bond + c, g(r, c));
      }
    }
  };
  for (int b = 0; b < int(it.bonds.size()); ++b) {
    const Bond<D>& bond = model_.bonds[it.bonds[b]];
    if (parts.place[bond.a] >= 0) add(b, bond.a, 1);
    if (bond.b >= 0 && parts.place[bond.b] >= 0) add(b, bond.b, -1);
  }
  Eigen::SparseMatrix<double> G(rows * parts.count, rows * int(it.bonds.size()));
  G.setFromTriplets(entries.begin(), entries.end());
  return {std::move(G)};
}

// breaks the bonds whose loads G' y, y = (G G')^-1 (f_i, n_i), are beyond their strength
template <int D>
bool BondLoads<D>::break_overloaded(State<D>& state, const Composite& it, const Equations& system,
                                    const Eigen::MatrixXd& y) {
  const Eigen::SparseMatrix<double>& G = system.G;
  // a column of G has few entries; the order of Eigen's own product depends on its version
  const auto load = [&](int column, int of) {
    double sum = 0;
    for (Eigen::SparseMatrix<double>::InnerIterator entry(G, column); entry; ++entry)
      sum += entry.value() * y(entry.row(), of);
    return sum;
  };
  const int rows = it.rows();
  bool any = false;
  for (int b = 0; b < int(it.bonds.size()); ++b) {
    const int k = it.bonds[b];
    const Bond<D>& bond = model_.bonds[k];
    Eigen::VectorXd all(rows);
    for (int r = 0; r < rows; ++r)
      all[r] = load(rows * b + r, 0) + load(rows * b + r, 1) / bond.impact_duration;
    loads_[k] = std::sqrt(all.squaredNorm());
    if (loads_[k] > bond.strength) state.intact[k] = 0, any = true;
  }
  return any;
}

template class BondLoads<2>;
template class BondLoads<3>;

}  // namespace obscura::sim
