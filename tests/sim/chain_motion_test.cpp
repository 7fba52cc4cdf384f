// What a chain keeps as it moves.

#include <gtest/gtest.h>

#include "chain_cases.h"

namespace obscura::sim {
namespace {

// A trunk with a head and four limbs of two parts each: balls at neck, shoulders and hips, hinges at elbows
// and knees.
Chain<3> figure() {
  const auto part = [](int parent, JointType freedom, Vec3 at, Vec3 half, double mass) {
    Link<3> link;
    link.parent = parent;
    link.joint.freedom = freedom;
    link.joint.on_parent.place = at;
    link.joint.axis = Vec3::UnitX();
    link.com = parent < 0 ? Vec3(0, 0, 0) : Vec3(0, 0, at[2] > 0.3 ? half[2] : -half[2]);
    link.mass = mass;
    link.inertia = ((half.squaredNorm() - half.array().square()).matrix() * (mass / 3)).asDiagonal();
    return link;
  };
  std::vector<Link<3>> links = {part(-1, JointType::free, {0, 0, 1.2}, {0.15, 0.1, 0.3}, 35),
                                part(0, JointType::ball, {0, 0, 0.32}, {0.1, 0.1, 0.12}, 5)};
  for (const double side : {-1.0, 1.0}) {
    links.push_back(part(0, JointType::ball, {0.22 * side, 0, 0.28}, {0.05, 0.05, 0.15}, 2));
    links.push_back(part(int(links.size()) - 1, JointType::revolute, {0, 0, -0.3}, {0.04, 0.04, 0.14}, 1.5));
    links.push_back(part(0, JointType::ball, {0.1 * side, 0, -0.3}, {0.07, 0.07, 0.22}, 8));
    links.push_back(part(int(links.size()) - 1, JointType::revolute, {0, 0, -0.44}, {0.05, 0.05, 0.22}, 4));
  }
  return Chain<3>(links);
}

// Thrown, tumbling and with every joint moving.
Swinging<3> thrown() {
  Swinging<3> body(figure());
  Dice dice(7);
  body.shake(dice, 0.4, 0.5);
  body.v[3] = 3;
  body.v[4] = -1;
  body.v[5] = 4;
  return body;
}

TEST(ChainMotion, AThrownFigureKeepsItsMomenta) {
  Swinging<3> body = thrown();
  body.gravity.setZero();
  const auto start = body.sums();
  for (int i = 0; i < 10000; ++i) body.step(1e-3);
  const auto end = body.sums();
  // some 370 of each; Runge-Kutta's error at 1/1000 s is all there is
  EXPECT_LE((end.momentum - start.momentum).norm(), 1e-10);
  EXPECT_LE((end.angular_momentum - start.angular_momentum).norm(), 1e-10 * start.angular_momentum.norm());
  EXPECT_NEAR(end.kinetic, start.kinetic, 1e-12 * start.kinetic);
  const Vec<3> want = start.centre + 10 * start.momentum / start.mass;
  EXPECT_LE((end.centre - want).norm(), 1e-11);
  for (int i = 0; i < body.chain.size(); ++i) {
    const JointType freedom = body.chain[i].joint.freedom;
    if (freedom != JointType::ball && freedom != JointType::free) continue;
    const auto q = body.chain.q_of(i, std::span<const double>(body.q));
    EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 5e-16);
  }
}

TEST(ChainMotion, AThrownFigureFliesAParabola) {
  Swinging<3> body = thrown();
  const auto start = body.sums();
  for (int i = 0; i < 2000; ++i) body.step(1e-3);
  const auto end = body.sums();
  const Vec<3> want = start.centre + 2 * start.momentum / start.mass + 2 * body.gravity;
  EXPECT_LE((end.centre - want).norm(), 1e-11);
  EXPECT_LE((end.momentum - start.momentum - 2 * start.mass * body.gravity).norm(), 1e-10);
}

// The same configuration and velocity for a planar tree and its twin in space.
void copy_in_space(const Swinging<2>& flat, Swinging<3>& deep) {
  for (int i = 0; i < flat.chain.size(); ++i) {
    const auto q = flat.chain.q_of(i, std::span<const double>(flat.q));
    const auto v = flat.chain.v_of(i, std::span<const double>(flat.v));
    const auto tau = flat.chain.v_of(i, std::span<const double>(flat.tau));
    const auto q3 = deep.chain.q_of(i, std::span<double>(deep.q));
    const auto v3 = deep.chain.v_of(i, std::span<double>(deep.v));
    const auto tau3 = deep.chain.v_of(i, std::span<double>(deep.tau));
    const JointType freedom = deep.chain[i].joint.freedom;
    if (freedom == JointType::ball || freedom == JointType::free) {
      q3[2] = std::sin(0.5 * q[0]);
      q3[3] = std::cos(0.5 * q[0]);
      v3[2] = v[0];
      tau3[2] = tau[0];
      for (std::size_t k = 1; k < q.size(); ++k) {
        q3[3 + k] = q[k];
        v3[2 + k] = v[k];
        tau3[2 + k] = tau[k];
      }
    } else if (!q.empty()) {
      q3[0] = q[0];
      v3[0] = v[0];
      tau3[0] = tau[0];
    }
  }
}

TEST(ChainMotion, APlanarTreeInSpaceMovesAsInThePlane) {
  Dice dice(3);
  for (const bool balls : {false, true}) {
    for (int trial = 0; trial < 10; ++trial) {
      Swinging<2> flat(any_tree<2>(dice, 6));
      flat.shake(dice, 2, 1);
      for (double& x : flat.tau) x = dice.between(-1, 1);
      std::vector<Link<2>> links;
      for (int i = 0; i < flat.chain.size(); ++i) links.push_back(flat.chain[i]);
      Swinging<3> deep{Chain<3>(in_space(links, balls))};
      deep.gravity = {0, -9.81, 0};
      copy_in_space(flat, deep);

      for (int i = 0; i < 100; ++i) {
        flat.step(2e-3);
        deep.step(2e-3);
      }
      flat.refresh();
      deep.refresh();
      for (int i = 0; i < flat.chain.size(); ++i) {
        const Vec<2> x = flat.stance.joint[i].place, v = flat.stance.twist[i].v;
        const double w = flat.stance.twist[i].w[0];
        // the same scheme: rounding alone parts them
        EXPECT_LE((deep.stance.joint[i].place - Vec3(x[0], x[1], 0)).norm(), 1e-12 * std::max(1.0, x.norm()));
        EXPECT_LE((deep.stance.twist[i].v - Vec3(v[0], v[1], 0)).norm(), 1e-12 * std::max(1.0, v.norm()));
        EXPECT_LE((deep.stance.twist[i].w - Vec3(0, 0, w)).norm(), 1e-12 * std::max(1.0, std::abs(w)));
      }
    }
  }
}

}  // namespace
}  // namespace obscura::sim
