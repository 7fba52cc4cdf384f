// Dynamics of a chain: Featherstone, Rigid Body Dynamics Algorithms, 2008.
//
// Articulated bodies, table 7.1. Backward, I_a the articulated inertia of a link, p_a its bias force (that at
// zero acceleration):
//   U = I_a S    D = S . U    u = tau - S . p_a
//   I_a -= U U' / D           p_a += U u / D + (I_a - U U'/D) c         shifted and added to the parent's
// Forward, from the acceleration of the parent:
//   a = a_p shifted + c       v' = (u - U . a) / D                      a += S v'
// The freedoms of one joint are eliminated one after the other, as if massless links lay between them: D is a
// number.
//
// For one link, its centre of mass at r:  f = m w x (w x r),  p = ( w x (I w) + r x f,  f ), less the applied
// force.
//
// Newton-Euler, table 5.1:       f = I a + p + sum of f of the children,  tau = S . f
// Composite bodies, table 6.2:   M_jk = S_k . (I_c S_j carried down to k)

#include "sim/multibody/articulated_body.h"

namespace obscura::sim {

namespace {

// the force that a link by itself needs to keep its velocity, less the forces applied
template <int D>
Wrench<D> own_resistance(const Chain<D>& chain, const ChainKinematics<D>& stance,
                         const ChainDynamics<D>& dynamics, const Vec<D>& gravity, int i) {
  const AngularVec<D>& w = stance.twist[i].w;
  const Vec<D>& com = stance.com[i];
  const Vec<D> f = chain[i].mass * (cross_velocity<D>(w, cross_velocity<D>(w, com)) - gravity);
  const AngularVec<D> gyroscopic = spin_cross<D>(w, stance.inertia[i] * w);
  return Wrench<D>{gyroscopic + moment<D>(com, f), f} - dynamics.applied[i];
}

template <int D>
ArticulatedInertia<D> own_inertia(const Chain<D>& chain, const ChainKinematics<D>& stance, int i) {
  return rigid_inertia<D>(chain[i].mass, stance.com[i], stance.inertia[i]);
}

// one link's share of the forward sweep, from its origin's acceleration without the freedoms' own
template <int D>
void let_go(const Chain<D>& chain, const ChainKinematics<D>& stance, const ChainDynamics<D>& dynamics, int i,
            Twist<D>& a, std::span<double> rate) {
  for (int j = chain.v_start(i); j < chain.v_start(i + 1); ++j) {
    rate[j] = (dynamics.push[j] - power(dynamics.U[j], a)) * dynamics.over_D[j];
    a += stance.freedom[j] * rate[j];
  }
}

// the forward sweep of an impulse: no bias, no velocity
template <int D>
void spread(const Chain<D>& chain, const ChainKinematics<D>& stance, ChainDynamics<D>& dynamics,
            std::span<double> change) {
  for (int i = 0; i < chain.size(); ++i) {
    const int p = chain[i].parent;
    Twist<D> a;
    if (p >= 0) a = shifted(dynamics.jump[p], stance.arm[i]);
    let_go(chain, stance, dynamics, i, a, change);
    dynamics.jump[i] = a;
  }
}

}  // namespace

template <int D>
ChainDynamics<D>::ChainDynamics(const Chain<D>& chain)
    : applied(chain.size()),
      inertia(chain.size()),
      U(chain.velocities()),
      over_D(chain.velocities()),
      resistance(chain.size()),
      acceleration(chain.size()),
      jump(chain.size()),
      push(chain.velocities()),
      impulses(chain.size()) {}

template <int D>
void factor(const Chain<D>& chain, const ChainKinematics<D>& stance, ChainDynamics<D>& dynamics) {
  for (int i = 0; i < chain.size(); ++i) dynamics.inertia[i] = own_inertia(chain, stance, i);
  for (int i = chain.size() - 1; i >= 0; --i) {
    ArticulatedInertia<D>& inertia = dynamics.inertia[i];
    for (int j = chain.v_start(i + 1) - 1; j >= chain.v_start(i); --j) {
      dynamics.U[j] = inertia * stance.freedom[j];
      dynamics.over_D[j] = 1 / power(dynamics.U[j], stance.freedom[j]);
      eliminate_freedom(inertia, dynamics.U[j], dynamics.over_D[j]);
    }
    const int p = chain[i].parent;
    if (p >= 0) dynamics.inertia[p] += transformed_to_origin(inertia, stance.arm[i]);
  }
}

template <int D>
void accelerate(const Chain<D>& chain, const ChainKinematics<D>& stance, std::span<const double> v,
                std::span<const double> tau, const Vec<D>& gravity, ChainDynamics<D>& dynamics,
                std::span<double> rate) {
  for (int i = 0; i < chain.size(); ++i)
    dynamics.resistance[i] = own_resistance(chain, stance, dynamics, gravity, i);

  // from the tips to the roots
  for (int i = chain.size() - 1; i >= 0; --i) {
    Wrench<D>& p = dynamics.resistance[i];
    for (int j = chain.v_start(i + 1) - 1; j >= chain.v_start(i); --j) {
      dynamics.push[j] = tau[j] - chain[i].joint.damping * v[j] - power(p, stance.freedom[j]);
      p += dynamics.U[j] * (dynamics.push[j] * dynamics.over_D[j]);
    }
    const int up = chain[i].parent;
    if (up < 0) continue;
    dynamics.resistance[up] += transformed_to_origin(p + dynamics.inertia[i] * stance.bias[i], stance.arm[i]);
  }

  // and back
  for (int i = 0; i < chain.size(); ++i) {
    const int up = chain[i].parent;
    Twist<D> a;
    if (up >= 0) a = shifted(dynamics.acceleration[up], stance.arm[i]) + stance.bias[i];
    let_go(chain, stance, dynamics, i, a, rate);
    dynamics.acceleration[i] = a;
  }
}

template <int D>
void respond(const Chain<D>& chain, const ChainKinematics<D>& stance, int link, const Wrench<D>& wrench,
             ChainDynamics<D>& dynamics, std::span<double> change) {
  for (double& x : dynamics.push) x = 0;
  Wrench<D> p = wrench * -1;
  for (int i = link; i >= 0; i = chain[i].parent) {
    for (int j = chain.v_start(i + 1) - 1; j >= chain.v_start(i); --j) {
      dynamics.push[j] = -power(p, stance.freedom[j]);
      p += dynamics.U[j] * (dynamics.push[j] * dynamics.over_D[j]);
    }
    p = transformed_to_origin(p, stance.arm[i]);
  }
  spread(chain, stance, dynamics, change);
}

template <int D>
void respond(const Chain<D>& chain, const ChainKinematics<D>& stance, std::span<const double> along,
             ChainDynamics<D>& dynamics, std::span<double> change) {
  for (Wrench<D>& p : dynamics.impulses) p = {};
  for (int i = chain.size() - 1; i >= 0; --i) {
    Wrench<D>& p = dynamics.impulses[i];
    for (int j = chain.v_start(i + 1) - 1; j >= chain.v_start(i); --j) {
      dynamics.push[j] = along[j] - power(p, stance.freedom[j]);
      p += dynamics.U[j] * (dynamics.push[j] * dynamics.over_D[j]);
    }
    const int up = chain[i].parent;
    if (up >= 0) dynamics.impulses[up] += transformed_to_origin(p, stance.arm[i]);
  }
  spread(chain, stance, dynamics, change);
}

template <int D>
Wrench<D> joint_wrench(const Chain<D>& chain, const ChainKinematics<D>& stance,
                       const ChainDynamics<D>& dynamics, int link) {
  const int up = chain[link].parent;
  Twist<D> a;
  if (up >= 0) a = shifted(dynamics.acceleration[up], stance.arm[link]) + stance.bias[link];
  return dynamics.inertia[link] * a + dynamics.resistance[link];
}

template <int D>
void inverse(const Chain<D>& chain, const ChainKinematics<D>& stance, std::span<const double> v,
             std::span<const double> rate, const Vec<D>& gravity, ChainDynamics<D>& dynamics,
             std::span<double> tau) {
  // accelerations outward
  for (int i = 0; i < chain.size(); ++i) {
    const int up = chain[i].parent;
    Twist<D> a;
    if (up >= 0) a = shifted(dynamics.acceleration[up], stance.arm[i]) + stance.bias[i];
    for (int j = chain.v_start(i); j < chain.v_start(i + 1); ++j) a += stance.freedom[j] * rate[j];
    dynamics.acceleration[i] = a;
    dynamics.resistance[i] =
        own_inertia(chain, stance, i) * a + own_resistance(chain, stance, dynamics, gravity, i);
  }

  // forces inward
  for (int i = chain.size() - 1; i >= 0; --i) {
    const Wrench<D>& f = dynamics.resistance[i];
    for (int j = chain.v_start(i); j < chain.v_start(i + 1); ++j) {
      tau[j] = power(f, stance.freedom[j]) + chain[i].joint.damping * v[j];
    }
    const int up = chain[i].parent;
    if (up >= 0) dynamics.resistance[up] += transformed_to_origin(f, stance.arm[i]);
  }
}

template <int D>
void mass_matrix(const Chain<D>& chain, const ChainKinematics<D>& stance, ChainDynamics<D>& dynamics,
                 Eigen::Ref<Eigen::MatrixXd> m) {
  m.setZero();
  for (int i = 0; i < chain.size(); ++i) dynamics.inertia[i] = own_inertia(chain, stance, i);
  for (int i = chain.size() - 1; i >= 0; --i) {
    // all from here on, as one rigid body
    const int up = chain[i].parent;
    if (up >= 0) dynamics.inertia[up] += transformed_to_origin(dynamics.inertia[i], stance.arm[i]);
    for (int j = chain.v_start(i); j < chain.v_start(i + 1); ++j) {
      Wrench<D> f = dynamics.inertia[i] * stance.freedom[j];
      for (int k = chain.v_start(i); k <= j; ++k) m(k, j) = m(j, k) = power(f, stance.freedom[k]);
      for (int below = i, over = up; over >= 0; below = over, over = chain[over].parent) {
        f = transformed_to_origin(f, stance.arm[below]);
        for (int k = chain.v_start(over); k < chain.v_start(over + 1); ++k)
          m(k, j) = m(j, k) = power(f, stance.freedom[k]);
      }
    }
  }
}

#define OBSCURA_INSTANTIATE(D)                                                                               \
  template struct ChainDynamics<D>;                                                                          \
  template void factor<D>(const Chain<D>&, const ChainKinematics<D>&, ChainDynamics<D>&);                    \
  template void accelerate<D>(const Chain<D>&, const ChainKinematics<D>&, std::span<const double>,           \
                              std::span<const double>, const Vec<D>&, ChainDynamics<D>&, std::span<double>); \
  template void respond<D>(const Chain<D>&, const ChainKinematics<D>&, int, const Wrench<D>&,                \
                           ChainDynamics<D>&, std::span<double>);                                            \
  template void respond<D>(const Chain<D>&, const ChainKinematics<D>&, std::span<const double>,              \
                           ChainDynamics<D>&, std::span<double>);                                            \
  template Wrench<D> joint_wrench<D>(const Chain<D>&, const ChainKinematics<D>&, const ChainDynamics<D>&,    \
                                     int);                                                                   \
  template void inverse<D>(const Chain<D>&, const ChainKinematics<D>&, std::span<const double>,              \
                           std::span<const double>, const Vec<D>&, ChainDynamics<D>&, std::span<double>);    \
  template void mass_matrix<D>(const Chain<D>&, const ChainKinematics<D>&, ChainDynamics<D>&,                \
                               Eigen::Ref<Eigen::MatrixXd>);
OBSCURA_INSTANTIATE(2)
OBSCURA_INSTANTIATE(3)
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim
