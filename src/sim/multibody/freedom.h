#pragma once

#include <limits>
#include <optional>
#include <span>

#include "sim/math/spatial.h"

namespace obscura::sim {

/// The joint type of a link: its motion relative to the parent. In the plane a ball is a revolute.
enum class JointType {
  weld,       // nothing
  revolute,   // turn about an axis: q = angle, rad
  prismatic,  // slide along an axis: q = m
  ball,       // turn about a point: q = quaternion (x, y, z, w)
  free        // fly: q = angle or quaternion, then place. Only where the parent is the room
};

/// The joint between a link and its parent. Its velocities: the angular velocity about or the speed along
/// `axis`; for a ball the D(D-1)/2 components of the angular velocity, in the axes of the joint's frame on
/// the link; for a free link those and then the velocity of the joint's origin, in the axes of the joint's
/// frame on the parent.
template <int D>
struct LinkJoint {
  struct Motor {
    double speed = 0;  // rad/s or m/s it wants
    double most = 0;   // the largest torque (N m) or force (N) it has
  };

  JointType freedom = JointType::revolute;
  Pose<D> on_parent;                  // the joint's frame, seen from the parent's (from the room for -1)
  Pose<D> on_link;                    // the same frame where q is zero, seen from the link's
  Vec<D> axis = Vec<D>::Unit(D - 1);  // unit, in the joint's frame; the plane's revolute has none
  double damping = 0;                 // c of tau = -c v on each freedom, N m s or N s/m
  double friction = 0;                // dry: the largest torque (N m) or force (N); for rows
  double lower = -std::numeric_limits<double>::infinity();  // of q, one freedom; for rows
  double upper = std::numeric_limits<double>::infinity();   // of q; of a ball, of the whole angle, rad
  std::optional<Motor> motor;                               // for rows
  double breaks = std::numeric_limits<double>::infinity();  // N
};

/// How many numbers of q and of v a joint has.
template <int D>
int positions(JointType freedom);
template <int D>
int velocities(JointType freedom);

/// Writes the q of a joint whose two frames agree: zeros, and the quaternion (0, 0, 0, 1).
template <int D>
void put_home(JointType freedom, std::span<double> q);

/// The joint's frame on the link, seen from the joint's frame on the parent.
template <int D>
Pose<D> pose(const LinkJoint<D>& joint, std::span<const double> q);

/// The directions of freedom, one a velocity, at the joint's origin on the link; the turns bring the joint's
/// frames on the parent and on the link into the axes of the answer.
template <int D>
void freedoms(const LinkJoint<D>& joint, const Rotation<D>& on_parent, const Rotation<D>& on_link,
              std::span<Twist<D>> out);

/// q displaced by d, one number for each velocity: rotations by the exponential, all else by addition. `out`
/// may be `q`.
template <int D>
void displace(JointType freedom, std::span<const double> q, std::span<const double> d, std::span<double> out);

/// d' of such a displacement under the velocity v: v itself but for turns in space, where it is dexp^-1.
template <int D>
void displacement_rate(JointType freedom, std::span<const double> d, std::span<const double> v,
                       std::span<double> out);

}  // namespace obscura::sim
