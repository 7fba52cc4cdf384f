#pragma once

#include <cmath>
#include <vector>

#include "sim/dice.h"
#include "sim/motion/integrator.h"
#include "sim/multibody/articulated_body.h"

namespace obscura::sim {

inline Eigen::Map<const Eigen::VectorXd> vector(const std::vector<double>& x) {
  return {x.data(), Eigen::Index(x.size())};
}

/// Any rotation.
template <int D>
Rotation<D> any_rotation(Dice& dice) {
  if constexpr (D == 2) {
    return Eigen::Rotation2Dd(dice.between(-3, 3)).toRotationMatrix();
  } else {
    return Eigen::AngleAxisd(dice.between(-3, 3), dice.vector<3>(1).normalized()).toRotationMatrix();
  }
}

/// A link of any shape on any joint; those of real solids, no moment above the sum of the others.
template <int D>
Link<D> any_link(Dice& dice, int parent, JointType freedom) {
  Link<D> link;
  link.parent = parent;
  link.joint.freedom = freedom;
  link.joint.on_parent = {any_rotation<D>(dice), dice.vector<D>(0.5)};
  link.joint.on_link = {any_rotation<D>(dice), dice.vector<D>(0.5)};
  link.joint.axis = dice.vector<D>(1).normalized();
  link.mass = dice.between(0.5, 2);
  link.com = dice.vector<D>(0.3);
  if constexpr (D == 2) {
    link.inertia << link.mass * dice.between(0.02, 0.1);
  } else {
    const Vec3 half = {dice.between(0.2, 0.5), dice.between(0.2, 0.5), dice.between(0.2, 0.5)};
    const Vec3 moments = (half.squaredNorm() - half.array().square()).matrix() * (link.mass / 3);
    const Rotation<D> turn = any_rotation<D>(dice);
    link.inertia = turn * moments.asDiagonal() * turn.transpose();
  }
  return link;
}

/// A branching tree of n links of all joints; the first is free for every second seed.
template <int D>
Chain<D> any_tree(Dice& dice, int n) {
  std::vector<Link<D>> links;
  const bool flies = dice.below(2) == 0;
  for (int i = 0; i < n; ++i) {
    // mostly off one of the last three links, so that the tree is deep and branches
    const int parent = i == 0 ? -1 : std::max(0, i - 1 - dice.below(3));
    constexpr JointType kinds[] = {JointType::revolute, JointType::prismatic, JointType::ball,
                                   JointType::revolute, JointType::weld};
    links.push_back(
        any_link<D>(dice, parent, i == 0 && flies ? JointType::free : kinds[dice.below(i == 0 ? 4 : 5)]));
  }
  return Chain<D>(std::move(links));
}

/// A chain with its configuration and the room its dynamics need.
template <int D>
struct Swinging {
  Chain<D> chain;
  Vec<D> gravity = Vec<D>::Unit(D - 1) * -9.81;
  std::vector<double> q, v, tau;
  ChainKinematics<D> stance;
  ChainDynamics<D> dynamics;

  explicit Swinging(Chain<D> from)
      : chain(std::move(from)),
        q(chain.home()),
        v(chain.velocities()),
        tau(chain.velocities()),
        stance(chain),
        dynamics(chain),
        d(chain.velocities()),
        held(chain.positions()) {
    stages.reserve(chain.velocities());
    refresh();
  }

  void refresh() {
    place(chain, q, stance);
    move(chain, v, stance);
  }

  /// Any configuration and velocity.
  void shake(Dice& dice, double most_q, double most_v) {
    std::vector<double> by(chain.velocities());
    for (double& x : by) x = dice.between(-most_q, most_q);
    chain.displace(q, by, q);
    for (double& x : v) x = dice.between(-most_v, most_v);
    refresh();
  }

  std::vector<double> rate() {
    std::vector<double> out(chain.velocities());
    refresh();
    factor(chain, stance, dynamics);
    accelerate<D>(chain, stance, v, tau, gravity, dynamics, out);
    return out;
  }

  ChainTotals<D> sums() {
    refresh();
    return totals(chain, stance, gravity);
  }

  Eigen::MatrixXd mass() {
    Eigen::MatrixXd m(chain.velocities(), chain.velocities());
    place(chain, q, stance);
    mass_matrix<D>(chain, stance, dynamics, m);
    return m;
  }

  /// One step of classical Runge-Kutta on (d, v), d the displacement since the step began:
  /// Runge-Kutta-Munthe-Kaas.
  void step(double h) {
    std::fill(d.begin(), d.end(), 0.0);
    Rates rates(*this);
    rk4(rates, 0, h, d, v, stages);
    chain.displace(q, d, q);
  }

 private:
  class Rates final : public System {
   public:
    explicit Rates(Swinging& of) : of_(of) {}
    void rates(double, std::span<const double> d, std::span<const double> v, std::span<double> d_rate,
               std::span<double> v_rate) override {
      of_.chain.displace(of_.q, d, of_.held);
      place<D>(of_.chain, of_.held, of_.stance);
      move<D>(of_.chain, v, of_.stance);
      factor(of_.chain, of_.stance, of_.dynamics);
      of_.chain.displacement_rate(d, v, d_rate);
      accelerate<D>(of_.chain, of_.stance, v, of_.tau, of_.gravity, of_.dynamics, v_rate);
    }

   private:
    Swinging& of_;
  };

  std::vector<double> d, held;
  Stages stages;
};

/// n links end to end in the plane, each a rod (or a point at its end) that hangs along -y where q is zero.
inline std::vector<Link<2>> pendulum(int n, double length, double mass, bool rods) {
  std::vector<Link<2>> links(n);
  for (int i = 0; i < n; ++i) {
    links[i].parent = i - 1;
    if (i > 0) links[i].joint.on_parent.place = {0, -length};
    links[i].mass = mass;
    links[i].com = {0, rods ? -0.5 * length : -length};
    if (rods) links[i].inertia << mass * length * length / 12;
  }
  return links;
}

/// The same links in space, in the plane z = 0, every turn about z; revolute as hinges or as balls.
inline std::vector<Link<3>> in_space(const std::vector<Link<2>>& flat, bool balls) {
  const auto deep = [](const Pose<2>& p) {
    Pose<3> out;
    out.turn.topLeftCorner<2, 2>() = p.turn;
    out.place.head<2>() = p.place;
    return out;
  };
  std::vector<Link<3>> links;
  for (const Link<2>& from : flat) {
    Link<3> link;
    link.parent = from.parent;
    link.joint.freedom =
        from.joint.freedom == JointType::revolute && balls ? JointType::ball : from.joint.freedom;
    link.joint.on_parent = deep(from.joint.on_parent);
    link.joint.on_link = deep(from.joint.on_link);
    const Vec<2>& slide = from.joint.axis;
    link.joint.axis =
        from.joint.freedom == JointType::prismatic ? Vec3(slide[0], slide[1], 0) : Vec3::UnitZ();
    link.joint.damping = from.joint.damping;
    link.mass = from.mass;
    link.com = {from.com[0], from.com[1], 0};
    link.inertia.diagonal() << 0.03, 0.04, from.inertia(0, 0);
    links.push_back(link);
  }
  return links;
}

}  // namespace obscura::sim
