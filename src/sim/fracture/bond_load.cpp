// What bonds bear. For part i of a rigid body at d_i from its centre of mass, m_i, T_i (room's frame),
//   A = sum F / M,   alpha = I^-1 (sum (N_i + d_i x F_i) - w x I w)
//   f_i = m_i (A + alpha x d_i + w x (w x d_i)) - F_i         what its bonds give it
//   n_i = T_i alpha + w x T_i w - N_i
// A bond k of a and b at p gives a (f, (p - x_a) x f + tau) and b the opposite. With z = (f, tau / l),
//   G z = (f_i, n_i),   z = G' (G G')^-1 (f_i, n_i)           the least of all z that do
// one part of a free body left out: it follows from the others. Of an impact the same with impulses, and
// without w; it counts as a force for as long as the bond says that it lasts.

#include "sim/fracture/bond_load.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "sim/energy/energy.h"
#include "sim/force/spring.h"

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

}  // namespace

template <int D>
BondLoads<D>::BondLoads(const Model<D>& model, const std::vector<Path<D>>& paths)
    : model_(model), paths_(paths), blasts_(model), forces_(model), loads_(model.bonds.size(), 0.0) {}

// what comes from outside
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
  const auto velocity = [&](const End<D>& end) -> Vec<D> {
    if (end.body < 0) return Vec<D>::Zero();
    const BodyMotion<D> at = body_motion(state, end.body);
    return at.velocity(at.arm(end.local));
  };
  for (const Spring<D>& s : model_.springs) {
    const Vec<D> a = place(state, s.a), b = place(state, s.b);
    const Vec<D> force = pull<D>(law(s), a, velocity(s.a), b, velocity(s.b));
    add(steady_, s.a.body, a, force), add(steady_, s.b.body, b, -force);
  }
  for (int i = 0; i < int(state.grips.size()); ++i) {
    const End<D> held{state.grips[i].body, state.grips[i].local};
    if (held.body < 0) continue;
    const auto hand = paths_[i].at(t);
    const Vec<D> a = place(state, held);
    add(steady_, held.body, a, pull<D>(law(model_.mice[i]), a, velocity(held), hand.place, hand.velocity));
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
bool BondLoads<D>::snap(State<D>& state, const Model<D>& whole, const std::vector<int>& body, double t) {
  std::fill(loads_.begin(), loads_.end(), 0.0);
  std::vector<std::vector<int>> parts(whole.bodies.size()), bonds(whole.bodies.size());
  bool breakable = false;
  for (int k = 0; k < int(model_.bonds.size()); ++k) {
    if (!state.holds[k]) continue;
    bonds[body[model_.bonds[k].a]].push_back(k);
    breakable = breakable || model_.bonds[k].strength < 1e300;
  }
  if (!breakable) return false;
  for (int i = 0; i < int(body.size()); ++i) parts[body[i]].push_back(i);
  push(state, t);
  bool any = false;
  for (int i = 0; i < int(whole.bodies.size()); ++i) {
    if (bonds[i].empty()) continue;
    any = snap(state, whole.bodies[i], body_motion(state.whole[0], i), parts[i], bonds[i]) || any;
  }
  return any;
}

// one rigid body
template <int D>
bool BondLoads<D>::snap(State<D>& state, const Body<D>& whole, const BodyMotion<D>& at,
                        const std::vector<int>& parts, const std::vector<int>& bonds) {
  constexpr int kRows = D + kAngular<D>;
  const int n = int(parts.size());
  const bool fixed = whole.fixed, turns = whole.turns();

  // how it accelerates
  const Vec<D> x = at.x;
  const AngularVec<D> w = at.w;
  Wrench<D> force, blow;
  std::vector<SpinTensor<D>> own(n);
  for (int p = 0; p < n; ++p) {
    const int i = parts[p];
    own[p] = tensor(model_.bodies[i], body_motion(state, i));
    force += transformed_to_origin(steady_[i], Vec<D>(state.x[i] - x)),
        blow += transformed_to_origin(blows_[i], Vec<D>(state.x[i] - x));
  }
  AngularVec<D> alpha = AngularVec<D>::Zero(), dw = AngularVec<D>::Zero();
  Vec<D> A = Vec<D>::Zero(), dv = Vec<D>::Zero();
  if (!fixed) {
    A = force.f / whole.mass, dv = blow.f / whole.mass;
    if (turns) {
      const Rotation<D>& axes = at.room_from_body;
      const AngularVec<D> L = to_room<D>(axes, whole.inertia.cwiseProduct(from_room<D>(axes, w)));
      alpha = inverse_inertia_times<D>(whole.inertia, axes, AngularVec<D>(force.n - spin_cross<D>(w, L)));
      dw = inverse_inertia_times<D>(whole.inertia, axes, blow.n);
    }
  }

  // what the bonds of each part give it: steadily, and in the blow
  const int rows = turns ? kRows : D;
  std::vector<int> place(model_.bodies.size(), -1);
  int free = 0;
  for (int p = fixed ? 0 : 1; p < n; ++p) {
    if (!model_.bodies[parts[p]].fixed) place[parts[p]] = free++;
  }
  if (free == 0) return false;
  Eigen::MatrixXd want = Eigen::MatrixXd::Zero(rows * free, 2);
  double shortest = 1e300;
  for (const int k : bonds) shortest = std::min(shortest, model_.bonds[k].blow);
  double forces = 0, torques = 0, far = 0;
  for (int p = 0; p < n; ++p) {
    const int i = parts[p];
    const Body<D>& part = model_.bodies[i];
    const Vec<D> d = state.x[i] - x;
    const Vec<D> f =
        part.mass * (A + cross_velocity<D>(alpha, d) + cross_velocity<D>(w, cross_velocity<D>(w, d))) -
        steady_[i].f;
    const Vec<D> j = part.mass * (dv + cross_velocity<D>(dw, d)) - blows_[i].f;
    const AngularVec<D> nt = own[p] * alpha + spin_cross<D>(w, AngularVec<D>(own[p] * w)) - steady_[i].n;
    const AngularVec<D> jt = own[p] * dw - blows_[i].n;
    forces += f.norm() + j.norm() / shortest, torques += nt.norm() + jt.norm() / shortest;
    far = std::max(far, d.norm());
    if (place[i] < 0) continue;
    want.block(rows * place[i], 0, D, 1) = f, want.block(rows * place[i], 1, D, 1) = j;
    if (turns) {
      want.block(rows * place[i] + D, 0, kAngular<D>, 1) = nt;
      want.block(rows * place[i] + D, 1, kAngular<D>, 1) = jt;
    }
  }

  // no tree of bonds bears more than all of it on its longest lever; the least loads are no more together
  struct Lever {
    Vec<D> point;
    double l;
  };
  std::vector<Lever> levers;
  double least = 1e300, weakest = 1e300;
  for (const int k : bonds) {
    const Bond<D>& bond = model_.bonds[k];
    const Vec<D> other = bond.b < 0 ? state.x[bond.a] : state.x[bond.b];
    double l = (state.x[bond.a] - other).norm() / 2;
    if (l == 0) l = std::max(bounding_radius(model_.bodies[bond.a].shape), 1e-9 * model_.scale);
    levers.push_back({(state.x[bond.a] + other) / 2, l});
    least = std::min(least, l), weakest = std::min(weakest, bond.strength);
  }
  const double bent = turns ? (torques + 2 * far * forces) / least : 0;
  if (std::sqrt(double(bonds.size()) * (forces * forces + bent * bent)) <= weakest) return false;

  // G, a block of columns a bond
  std::vector<Eigen::Triplet<double>> entries;
  using Block = Eigen::Matrix<double, kRows, kRows>;
  const auto given = [&](int bond, int part, double sign) {
    Block g = Block::Zero();
    g.template topLeftCorner<D, D>().diagonal().setConstant(sign);
    g.template bottomLeftCorner<kAngular<D>, D>() =
        sign * lever<D>(Vec<D>(levers[bond].point - state.x[part])).transpose();
    g.template bottomRightCorner<kAngular<D>, kAngular<D>>().diagonal().setConstant(sign * levers[bond].l);
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < rows; ++c) {
        if (g(r, c) != 0) entries.emplace_back(rows * place[part] + r, rows * bond + c, g(r, c));
      }
    }
  };
  for (int b = 0; b < int(bonds.size()); ++b) {
    const Bond<D>& bond = model_.bonds[bonds[b]];
    if (place[bond.a] >= 0) given(b, bond.a, 1);
    if (bond.b >= 0 && place[bond.b] >= 0) given(b, bond.b, -1);
  }
  Eigen::SparseMatrix<double> G(rows * free, rows * int(bonds.size()));
  G.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseMatrix<double> GG = G * Eigen::SparseMatrix<double>(G.transpose());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(GG);
  const Eigen::MatrixXd give = factor.solve(want);
  // (G' give): a column of G has few entries; Eigen's own product adds them as its version likes
  const auto load = [&](int column, int of) {
    double sum = 0;
    for (Eigen::SparseMatrix<double>::InnerIterator it(G, column); it; ++it)
      sum += it.value() * give(it.row(), of);
    return sum;
  };

  bool any = false;
  for (int b = 0; b < int(bonds.size()); ++b) {
    const Bond<D>& bond = model_.bonds[bonds[b]];
    Eigen::VectorXd all(rows);
    for (int r = 0; r < rows; ++r) all[r] = load(rows * b + r, 0) + load(rows * b + r, 1) / bond.blow;
    loads_[bonds[b]] = std::sqrt(all.squaredNorm());
    if (loads_[bonds[b]] > bond.strength) state.holds[bonds[b]] = 0, any = true;
  }
  return any;
}

template class BondLoads<2>;
template class BondLoads<3>;

}  // namespace obscura::sim
