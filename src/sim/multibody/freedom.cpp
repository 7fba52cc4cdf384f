// Joints of a chain: Featherstone, Rigid Body Dynamics Algorithms, 2008, table 4.1. Directions of freedom
// (spin, velocity):
//   revolute  (a, 0)     prismatic  (0, a)     ball  (1, 0)     free  (1, 0), (0, 1)
// a fixed in both frames, a ball's and free link's spins in the link's, a free link's velocities in the
// room's, where free flight is a parabola that Runge-Kutta meets exactly. Displacements d since a
// configuration q0, for Runge-Kutta-Munthe-Kaas:  turn = turn0 exp(d),  d' = dexp^-1(w).

#include "sim/multibody/freedom.h"

#include <algorithm>
#include <cassert>

#include "sim/math/exponential.h"
#include "sim/math/trig.h"

namespace obscura::sim {

namespace {

template <int D>
constexpr int kTurns = D == 2 ? 1 : 4;

// how many a joint has where any turn takes `turn` and any place `place`
int numbers(JointType freedom, int turn, int place) {
  switch (freedom) {
    case JointType::weld:
      return 0;
    case JointType::revolute:
    case JointType::prismatic:
      return 1;
    case JointType::ball:
      return turn;
    case JointType::free:
      return turn + place;
  }
  return 0;
}

bool turns_all_ways(JointType freedom) { return freedom == JointType::ball || freedom == JointType::free; }

// the turn at the head of a ball's or free link's q
template <int D>
Rotation<D> turn_of(std::span<const double> q) {
  if constexpr (D == 2) {
    return rotation<D>(Orientation<D>(q[0]));
  } else {
    return matrix({q[0], q[1], q[2], q[3]});
  }
}

}  // namespace

template <int D>
int positions(JointType freedom) {
  return numbers(freedom, kTurns<D>, D);
}

template <int D>
int velocities(JointType freedom) {
  return numbers(freedom, kAngular<D>, D);
}

template <int D>
void put_home(JointType freedom, std::span<double> q) {
  std::fill(q.begin(), q.end(), 0.0);
  if (D == 3 && turns_all_ways(freedom)) q[3] = 1;
}

template <int D>
Pose<D> pose(const LinkJoint<D>& joint, std::span<const double> q) {
  Pose<D> out;
  switch (joint.freedom) {
    case JointType::weld:
      break;
    case JointType::revolute:
      if constexpr (D == 2) {
        out.turn = turn_of<D>(q);
      } else {
        const auto [s, c] = sin_cos(q[0]);
        out.turn = about(joint.axis, s, c);
      }
      break;
    case JointType::prismatic:
      out.place = joint.axis * q[0];
      break;
    case JointType::ball:
      out.turn = turn_of<D>(q);
      break;
    case JointType::free:
      out.turn = turn_of<D>(q);
      for (int k = 0; k < D; ++k) out.place[k] = q[kTurns<D> + k];
      break;
  }
  return out;
}

template <int D>
void freedoms(const LinkJoint<D>& joint, [[maybe_unused]] const Rotation<D>& on_parent,
              [[maybe_unused]] const Rotation<D>& on_link, std::span<Twist<D>> out) {
  const auto spins = [&] {
    for (int k = 0; k < kAngular<D>; ++k) {
      if constexpr (D == 2) {
        out[k] = {AngularVec<D>::Ones(), Vec<D>::Zero()};
      } else {
        out[k] = {on_link.col(k), Vec<D>::Zero()};
      }
    }
  };
  switch (joint.freedom) {
    case JointType::weld:
      break;
    case JointType::revolute:
      if constexpr (D == 2) {
        spins();
      } else {
        out[0] = {on_parent * joint.axis, Vec<D>::Zero()};
      }
      break;
    case JointType::prismatic:
      out[0] = {AngularVec<D>::Zero(), on_parent * joint.axis};
      break;
    case JointType::ball:
      spins();
      break;
    case JointType::free:
      spins();
      for (int k = 0; k < D; ++k) out[kAngular<D> + k] = {AngularVec<D>::Zero(), on_parent.col(k)};
      break;
  }
}

template <int D>
void displace(JointType freedom, std::span<const double> q, std::span<const double> d,
              std::span<double> out) {
  assert(int(q.size()) == positions<D>(freedom) && int(d.size()) == velocities<D>(freedom));
  if (D == 3 && turns_all_ways(freedom)) {
    const Eigen::Vector4d to = turned({q[0], q[1], q[2], q[3]}, {d[0], d[1], d[2]});
    for (int k = 0; k < 4; ++k) out[k] = to[k];
    for (std::size_t k = 4; k < q.size(); ++k) out[k] = q[k] + d[k - 1];
  } else {
    for (std::size_t k = 0; k < q.size(); ++k) out[k] = q[k] + d[k];
  }
}

template <int D>
void displacement_rate(JointType freedom, std::span<const double> d, std::span<const double> v,
                       std::span<double> out) {
  std::size_t k = 0;
  if (D == 3 && turns_all_ways(freedom)) {
    const Vec3 rate = turn_rate({d[0], d[1], d[2]}, {v[0], v[1], v[2]});
    for (; k < 3; ++k) out[k] = rate[k];
  }
  for (; k < v.size(); ++k) out[k] = v[k];
}

#define OBSCURA_INSTANTIATE(D)                                                                               \
  template int positions<D>(JointType);                                                                      \
  template int velocities<D>(JointType);                                                                     \
  template void put_home<D>(JointType, std::span<double>);                                                   \
  template Pose<D> pose<D>(const LinkJoint<D>&, std::span<const double>);                                    \
  template void freedoms<D>(const LinkJoint<D>&, const Rotation<D>&, const Rotation<D>&,                     \
                            std::span<Twist<D>>);                                                            \
  template void displace<D>(JointType, std::span<const double>, std::span<const double>, std::span<double>); \
  template void displacement_rate<D>(JointType, std::span<const double>, std::span<const double>,            \
                                     std::span<double>);
OBSCURA_INSTANTIATE(2)
OBSCURA_INSTANTIATE(3)
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim
