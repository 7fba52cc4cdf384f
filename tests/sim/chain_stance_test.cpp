#include "sim/multibody/forward_kinematics.h"

#include <gtest/gtest.h>

#include "chain_cases.h"

namespace obscura::sim {
namespace {

template <class Dimension>
class ChainStances : public ::testing::Test {};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(ChainStances, Dimensions);

TEST(Chain, HasAsManyNumbersAsItsJointsHaveFreedoms) {
  std::vector<Link<3>> links(5);
  const JointType kinds[] = {JointType::free, JointType::weld, JointType::revolute, JointType::prismatic,
                             JointType::ball};
  for (int i = 0; i < 5; ++i) {
    links[i].parent = i - 1;
    links[i].joint.freedom = kinds[i];
  }
  const Chain<3> chain(links);
  EXPECT_EQ(chain.positions(), 7 + 0 + 1 + 1 + 4);
  EXPECT_EQ(chain.velocities(), 6 + 0 + 1 + 1 + 3);
  EXPECT_EQ(chain.home()[3], 1);  // quaternions (0, 0, 0, 1)
  EXPECT_EQ(chain.home()[12], 1);
  EXPECT_EQ(positions<2>(JointType::free), 3);
  EXPECT_EQ(velocities<2>(JointType::ball), 1);
}

TEST(Chain, APendulumHangsWhereItsAnglesSay) {
  Swinging<2> two(Chain<2>(pendulum(2, 1.5, 1, true)));
  two.q = {0.3, 0.5};
  two.v = {2, -3};
  two.refresh();
  const Vec<2> elbow = 1.5 * Vec<2>(std::sin(0.3), -std::cos(0.3));
  const Vec<2> tip = elbow + 1.5 * Vec<2>(std::sin(0.8), -std::cos(0.8));
  EXPECT_LE((link_pose(two.chain, two.stance, 1) * Vec<2>(0, -1.5) - tip).norm(), 1e-15);
  // spins 2 and -1
  const Vec<2> v =
      2 * 1.5 * Vec<2>(std::cos(0.3), std::sin(0.3)) - 1.5 * Vec<2>(std::cos(0.8), std::sin(0.8));
  EXPECT_LE((point_velocity(two.stance, 1, tip) - v).norm(), 4e-15);
}

TYPED_TEST(ChainStances, JointsHoldTheirFramesTogether) {
  constexpr int D = TypeParam::value;
  Dice dice(1);
  for (int trial = 0; trial < 50; ++trial) {
    Swinging<D> tree(any_tree<D>(dice, 8));
    tree.shake(dice, 1.5, 2);
    for (int i = 0; i < tree.chain.size(); ++i) {
      const Link<D>& link = tree.chain[i];
      const Pose<D> parent = link.parent < 0 ? Pose<D>() : link_pose(tree.chain, tree.stance, link.parent);
      const Pose<D> above = parent * link.joint.on_parent;
      const Pose<D> below = link_pose(tree.chain, tree.stance, i) * link.joint.on_link;
      const Vec<D> apart = above.turn.transpose() * (below.place - above.place);
      const double turned = (above.turn.transpose() * below.turn - Rotation<D>::Identity()).norm();
      const double q =
          tree.chain.q_of(i, std::span<const double>(tree.q)).empty() ? 0 : tree.q[tree.chain.q_start(i)];
      // roundings pile up over the eight links
      switch (link.joint.freedom) {
        case JointType::weld:
          EXPECT_LE(turned, 2e-14);
          [[fallthrough]];
        case JointType::revolute:
        case JointType::ball:
          EXPECT_LE(apart.norm(), 2e-14);
          break;
        case JointType::prismatic:
          EXPECT_LE(turned, 2e-14);
          EXPECT_LE((apart - link.joint.axis * q).norm(), 2e-14);
          break;
        case JointType::free:
          break;
      }
    }
  }
}

// The place of a point of the last link, as q is displaced along v by t.
template <int D>
Vec<D> place_after(const Swinging<D>& from, const Vec<D>& local, double t) {
  Swinging<D> moved = from;
  std::vector<double> by = from.v;
  for (double& x : by) x *= t;
  moved.chain.displace(from.q, by, moved.q);
  moved.refresh();
  return link_pose(moved.chain, moved.stance, moved.chain.size() - 1) * local;
}

TYPED_TEST(ChainStances, VelocityDriftAndRowAgreeWithDifferences) {
  constexpr int D = TypeParam::value;
  Dice dice(2);
  for (int trial = 0; trial < 100; ++trial) {
    Swinging<D> tree(any_tree<D>(dice, 2 + dice.below(8)));
    tree.shake(dice, 1.5, 1);
    const int last = tree.chain.size() - 1;
    const Vec<D> local = dice.vector<D>(1);
    const Vec<D> point = link_pose(tree.chain, tree.stance, last) * local;

    // displaced at a steady rate, v' = 0: of joints with one freedom and of turns about a steady axis
    const double h = 1e-4;
    const Vec<D> ahead = place_after(tree, local, h), behind = place_after(tree, local, -h);
    const Vec<D> v = point_velocity(tree.stance, last, point);
    // h^2/6 times the third derivative, some 10 links at 1 rad/s each; then 1e-15/h^2 for the second
    EXPECT_LE(((ahead - behind) / (2 * h) - v).norm(), 1e-5);
    const Vec<D> a = point_drift(tree.stance, last, point);
    EXPECT_LE(((ahead - 2 * point + behind) / (h * h) - a).norm(), 1e-4 * std::max(1.0, a.norm()));

    // J v is the velocity along any direction
    const Vec<D> along = dice.vector<D>(1).normalized();
    std::vector<double> j(tree.chain.velocities());
    row<D>(tree.chain, tree.stance, last, wrench_at(tree.stance, last, point, along), j);
    EXPECT_NEAR(vector(j).dot(vector(tree.v)), along.dot(v), 1e-13);
  }
}

TYPED_TEST(ChainStances, ARowOfTheSpinGivesTheSpin) {
  constexpr int D = TypeParam::value;
  Dice dice(3);
  Swinging<D> tree(any_tree<D>(dice, 9));
  tree.shake(dice, 1.5, 1);
  const AngularVec<D> axis = dice.vector<kAngular<D>>(1);
  std::vector<double> j(tree.chain.velocities());
  row<D>(tree.chain, tree.stance, 7, Wrench<D>{axis, Vec<D>::Zero()}, j);
  EXPECT_NEAR(vector(j).dot(vector(tree.v)), axis.dot(tree.stance.twist[7].w), 1e-14);
}

TYPED_TEST(ChainStances, TotalsOfAFreeLinkAreThoseOfARigidBody) {
  constexpr int D = TypeParam::value;
  Dice dice(4);
  const Link<D> link = any_link<D>(dice, -1, JointType::free);
  Swinging<D> body(Chain<D>({link}));
  body.shake(dice, 2, 3);
  const auto sum = body.sums();
  const Pose<D> at = link_pose(body.chain, body.stance, 0);
  const Vec<D> x = at * link.com, v = point_velocity(body.stance, 0, x);
  const AngularVec<D> w = body.stance.twist[0].w;
  SpinTensor<D> inertia = link.inertia;
  if constexpr (D == 3) inertia = at.turn * link.inertia * at.turn.transpose();
  EXPECT_LE((sum.centre - x).norm(), 1e-14);
  EXPECT_LE((sum.momentum - link.mass * v).norm(), 4e-14);
  EXPECT_LE((sum.angular_momentum - inertia * w - moment<D>(x, link.mass * v)).norm(), 1e-13);
  EXPECT_NEAR(sum.kinetic, 0.5 * link.mass * v.squaredNorm() + 0.5 * w.dot(inertia * w), 1e-13);
  EXPECT_NEAR(sum.potential, link.mass * 9.81 * x[D - 1], 1e-13);
}

}  // namespace
}  // namespace obscura::sim
