#pragma once

#include <span>
#include <vector>

#include "sim/multibody/freedom.h"

namespace obscura::sim {

/// One rigid link of an articulated body.
template <int D>
struct Link {
  int parent = -1;                                // before its own index; -1: the room
  LinkJoint<D> joint;                             // to the parent
  double mass = 1;                                // kg
  Vec<D> com = Vec<D>::Zero();                    // centre of mass in the link's frame, m
  SpinTensor<D> inertia = SpinTensor<D>::Zero();  // about the centre of mass, link's axes, kg m^2
};

/// The constant properties of a tree of links in reduced coordinates. The configuration is flat, q and v,
/// link after link, of positions() and velocities() numbers; the caller keeps both.
template <int D>
class Chain {
 public:
  Chain() = default;
  explicit Chain(std::vector<Link<D>> links);

  int size() const { return int(links_.size()); }
  int positions() const { return q_start_.back(); }
  int velocities() const { return v_start_.back(); }
  const Link<D>& operator[](int link) const { return links_[link]; }

  /// The index of a link's first number in q and in v; for size(), one past the last.
  int q_start(int link) const { return q_start_[link]; }
  int v_start(int link) const { return v_start_[link]; }

  /// A link's own part of q or of v.
  template <class T>
  std::span<T> q_of(int link, std::span<T> q) const {
    return q.subspan(q_start_[link], q_start_[link + 1] - q_start_[link]);
  }
  template <class T>
  std::span<T> v_of(int link, std::span<T> v) const {
    return v.subspan(v_start_[link], v_start_[link + 1] - v_start_[link]);
  }

  /// The configuration in which the two frames of every joint agree.
  std::vector<double> home() const;

  /// q displaced by d (velocities() numbers). `out` may be `q`.
  void displace(std::span<const double> q, std::span<const double> d, std::span<double> out) const;

  /// d' of a displacement d under the velocity v.
  void displacement_rate(std::span<const double> d, std::span<const double> v, std::span<double> out) const;

  /// A link as its joint sees it: frames and mass about the joint's own frame on the link.
  struct LinkInJointFrame {
    Pose<D> on_parent;  // joint's frame on the parent, seen from the parent's joint's frame
    Pose<D> link;       // the link's frame, seen from its joint's frame
    Vec<D> com;
    SpinTensor<D> inertia;
  };
  const LinkInJointFrame& hung(int link) const { return hung_[link]; }

 private:
  std::vector<Link<D>> links_;
  std::vector<int> q_start_ = {0}, v_start_ = {0};
  std::vector<LinkInJointFrame> hung_;
};

}  // namespace obscura::sim
