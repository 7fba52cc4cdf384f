// Forward kinematics of a chain: Featherstone, Rigid Body Dynamics Algorithms, 2008, §4.4 and table 5.1, with
// the accelerations of moving points. p the parent, r from its origin to the link's, S the directions of
// freedom:
//   w = w_p + S_w v        v = v_p + w_p x r + S_v v
//   a = (a_p shifted by r) + S v' + c,     c = ( w_p x (S_w v),  w_p x (w_p x r) + 2 w_p x (S_v v) )
// The room has w_p = 0: no c for its children.

#include "sim/multibody/forward_kinematics.h"

namespace obscura::sim {

template <int D>
ChainKinematics<D>::ChainKinematics(const Chain<D>& chain)
    : joint(chain.size()),
      arm(chain.size(), Vec<D>::Zero()),
      com(chain.size(), Vec<D>::Zero()),
      inertia(chain.size(), SpinTensor<D>::Zero()),
      freedom(chain.velocities()),
      twist(chain.size()),
      bias(chain.size()),
      velocity_product(chain.size()) {}

template <int D>
void place(const Chain<D>& chain, std::span<const double> q, ChainKinematics<D>& stance) {
  for (int i = 0; i < chain.size(); ++i) {
    const Link<D>& link = chain[i];
    const auto& hung = chain.hung(i);
    const bool rooted = link.parent < 0;

    // the joint's frame on the parent, then on the link
    const Rotation<D> up = rooted ? Rotation<D>::Identity() : stance.joint[link.parent].turn;
    const Rotation<D> seat = rooted ? hung.on_parent.turn : Rotation<D>(up * hung.on_parent.turn);
    const Pose<D> moved = pose(link.joint, chain.q_of(i, q));
    Vec<D> arm = rooted ? hung.on_parent.place : Vec<D>(up * hung.on_parent.place);
    arm += seat * moved.place;
    stance.arm[i] = arm;
    stance.joint[i].turn = seat * moved.turn;
    stance.joint[i].place = rooted ? arm : Vec<D>(stance.joint[link.parent].place + arm);

    // mass in the room's axes
    const Rotation<D>& turn = stance.joint[i].turn;
    stance.com[i] = turn * hung.com;
    if constexpr (D == 2) {
      stance.inertia[i] = hung.inertia;
    } else {
      stance.inertia[i] = turn * hung.inertia * turn.transpose();
    }

    freedoms(link.joint, seat, turn, chain.v_of(i, std::span<Twist<D>>(stance.freedom)));
  }
}

template <int D>
void move(const Chain<D>& chain, std::span<const double> v, ChainKinematics<D>& stance) {
  for (int i = 0; i < chain.size(); ++i) {
    // by its own joint
    Twist<D> own;
    for (int j = chain.v_start(i); j < chain.v_start(i + 1); ++j) own += stance.freedom[j] * v[j];

    const int p = chain[i].parent;
    if (p < 0) {
      stance.twist[i] = own;
      stance.bias[i] = stance.velocity_product[i] = {};
      continue;
    }
    const Vec<D>& r = stance.arm[i];
    const AngularVec<D>& w = stance.twist[p].w;
    stance.twist[i] = shifted(stance.twist[p], r) + own;
    stance.bias[i] = {spin_cross<D>(w, own.w),
                      cross_velocity<D>(w, cross_velocity<D>(w, r)) + 2 * cross_velocity<D>(w, own.v)};
    stance.velocity_product[i] = shifted(stance.velocity_product[p], r) + stance.bias[i];
  }
}

template <int D>
Pose<D> link_pose(const Chain<D>& chain, const ChainKinematics<D>& stance, int link) {
  return stance.joint[link] * chain.hung(link).link;
}

template <int D>
Vec<D> point_velocity(const ChainKinematics<D>& stance, int link, const Vec<D>& point) {
  return shifted<D>(stance.twist[link], point - stance.joint[link].place).v;
}

template <int D>
Vec<D> point_drift(const ChainKinematics<D>& stance, int link, const Vec<D>& point) {
  return point_acceleration(stance, link, stance.velocity_product[link], point);
}

template <int D>
Vec<D> point_acceleration(const ChainKinematics<D>& stance, int link, const Twist<D>& a,
                          const Vec<D>& point) {
  const Vec<D> r = point - stance.joint[link].place;
  const AngularVec<D>& w = stance.twist[link].w;
  return shifted(a, r).v + cross_velocity<D>(w, cross_velocity<D>(w, r));
}

template <int D>
Wrench<D> wrench_at(const ChainKinematics<D>& stance, int link, const Vec<D>& point, const Vec<D>& force) {
  return transformed_to_origin(Wrench<D>{AngularVec<D>::Zero(), force},
                               Vec<D>(point - stance.joint[link].place));
}

template <int D>
void row(const Chain<D>& chain, const ChainKinematics<D>& stance, int link, const Wrench<D>& wrench,
         std::span<double> out) {
  for (double& x : out) x = 0;
  Wrench<D> f = wrench;
  for (int i = link; i >= 0; i = chain[i].parent) {
    for (int j = chain.v_start(i); j < chain.v_start(i + 1); ++j) out[j] = power(f, stance.freedom[j]);
    f = transformed_to_origin(f, stance.arm[i]);
  }
}

template <int D>
ChainTotals<D> totals(const Chain<D>& chain, const ChainKinematics<D>& stance, const Vec<D>& gravity) {
  ChainTotals<D> sum;
  for (int i = 0; i < chain.size(); ++i) {
    const double mass = chain[i].mass;
    const Vec<D> x = stance.joint[i].place + stance.com[i];
    const AngularVec<D>& w = stance.twist[i].w;
    const Vec<D> v = stance.twist[i].v + cross_velocity<D>(w, stance.com[i]);
    const AngularVec<D> spin = stance.inertia[i] * w;
    sum.mass += mass;
    sum.centre += mass * x;
    sum.kinetic += 0.5 * mass * v.squaredNorm() + 0.5 * w.dot(spin);
    sum.potential -= mass * gravity.dot(x);
    sum.momentum += mass * v;
    sum.angular_momentum += spin + moment<D>(x, mass * v);
  }
  if (sum.mass > 0) sum.centre /= sum.mass;
  return sum;
}

#define OBSCURA_INSTANTIATE(D)                                                                           \
  template struct ChainKinematics<D>;                                                                    \
  template void place<D>(const Chain<D>&, std::span<const double>, ChainKinematics<D>&);                 \
  template void move<D>(const Chain<D>&, std::span<const double>, ChainKinematics<D>&);                  \
  template Pose<D> link_pose<D>(const Chain<D>&, const ChainKinematics<D>&, int);                        \
  template Vec<D> point_velocity<D>(const ChainKinematics<D>&, int, const Vec<D>&);                      \
  template Vec<D> point_drift<D>(const ChainKinematics<D>&, int, const Vec<D>&);                         \
  template Vec<D> point_acceleration<D>(const ChainKinematics<D>&, int, const Twist<D>&, const Vec<D>&); \
  template Wrench<D> wrench_at<D>(const ChainKinematics<D>&, int, const Vec<D>&, const Vec<D>&);         \
  template void row<D>(const Chain<D>&, const ChainKinematics<D>&, int, const Wrench<D>&,                \
                       std::span<double>);                                                               \
  template ChainTotals<D> totals<D>(const Chain<D>&, const ChainKinematics<D>&, const Vec<D>&);
OBSCURA_INSTANTIATE(2)
OBSCURA_INSTANTIATE(3)
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim
