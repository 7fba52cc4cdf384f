#include "sim/multibody/articulated_body.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "chain_cases.h"
#include "sim/allocations.h"

namespace obscura::sim {
namespace {

template <class Dimension>
class ChainForces : public ::testing::Test {};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(ChainForces, Dimensions);

// A tree of up to twenty links, thrown about, with forces along its joints and on its links.
template <int D>
Swinging<D> any_swing(Dice& dice) {
  Swinging<D> tree(any_tree<D>(dice, 1 + dice.below(20)));
  tree.shake(dice, 2, 3);
  for (double& x : tree.tau) x = dice.between(-5, 5);
  for (auto& f : tree.dynamics.applied) f = {dice.vector<kAngular<D>>(5), dice.vector<D>(5)};
  return tree;
}

template <int D>
Eigen::VectorXd h_of(Swinging<D>& tree) {
  const std::vector<double> still(tree.chain.velocities());
  std::vector<double> h(tree.chain.velocities());
  inverse<D>(tree.chain, tree.stance, tree.v, still, tree.gravity, tree.dynamics, h);
  return vector(h);
}

TYPED_TEST(ChainForces, ArticulatedBodiesAgreeWithTheDenseMassMatrix) {
  constexpr int D = TypeParam::value;
  Dice dice(1);
  double worst = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Swinging<D> tree = any_swing<D>(dice);
    const std::vector<double> rate = tree.rate();
    const Eigen::VectorXd dense = tree.mass().ldlt().solve(vector(tree.tau) - h_of(tree));
    worst = std::max(worst, (vector(rate) - dense).norm() / dense.norm());
  }
  // both solve M x = b with M's condition up to some thousands
  EXPECT_LE(worst, 1e-12);
}

TYPED_TEST(ChainForces, InverseDynamicsGivesBackTheForces) {
  constexpr int D = TypeParam::value;
  Dice dice(2);
  for (int trial = 0; trial < 300; ++trial) {
    Swinging<D> tree = any_swing<D>(dice);
    const std::vector<double> rate = tree.rate();
    std::vector<double> tau(rate.size());
    inverse<D>(tree.chain, tree.stance, tree.v, rate, tree.gravity, tree.dynamics, tau);
    // the sums over twenty links that cancel to tau are a thousand times it
    const double size = std::max(1.0, (tree.mass() * vector(rate)).norm());
    EXPECT_LE((vector(tau) - vector(tree.tau)).norm(), 2e-13 * size);
  }
}

TYPED_TEST(ChainForces, MassMatrixIsSymmetricAndPositive) {
  constexpr int D = TypeParam::value;
  Dice dice(3);
  for (int trial = 0; trial < 100; ++trial) {
    Swinging<D> tree = any_swing<D>(dice);
    const Eigen::MatrixXd m = tree.mass();
    EXPECT_EQ(m, m.transpose());
    EXPECT_GT(m.ldlt().vectorD().minCoeff(), 1e-3);
  }
}

// M_jk = T(e_j + e_k) - T(e_j) - T(e_k), T the kinetic energy summed over the links
TYPED_TEST(ChainForces, MassMatrixIsTheSecondDifferenceOfKineticEnergy) {
  constexpr int D = TypeParam::value;
  Dice dice(4);
  for (int trial = 0; trial < 20; ++trial) {
    Swinging<D> tree = any_swing<D>(dice);
    const int n = tree.chain.velocities();
    const Eigen::MatrixXd m = tree.mass();
    const auto kinetic = [&](int j, int k) {
      std::fill(tree.v.begin(), tree.v.end(), 0.0);
      tree.v[j] = 1;
      tree.v[k] = 1;
      return tree.sums().kinetic;
    };
    for (int j = 0; j < n; ++j) {
      EXPECT_NEAR(m(j, j), 2 * kinetic(j, j), 1e-13 * m.norm());
      // quadratic, so exact but for rounding
      for (int k = 0; k < j; ++k)
        EXPECT_NEAR(m(j, k), kinetic(j, k) - kinetic(j, j) - kinetic(k, k), 1e-13 * m.norm());
    }
  }
}

TYPED_TEST(ChainForces, ResponseToAPushIsInverseMassTimesItsRow) {
  constexpr int D = TypeParam::value;
  Dice dice(5);
  for (int trial = 0; trial < 200; ++trial) {
    Swinging<D> tree = any_swing<D>(dice);
    const int n = tree.chain.velocities();
    const int link = dice.below(tree.chain.size());
    const Vec<D> point = tree.stance.joint[link].place + dice.vector<D>(1);
    const Wrench<D> push = wrench_at<D>(tree.stance, link, point, dice.vector<D>(1));
    std::vector<double> j(n), change(n), same(n);
    row<D>(tree.chain, tree.stance, link, push, j);
    const Eigen::VectorXd dense = tree.mass().ldlt().solve(vector(j));
    factor(tree.chain, tree.stance, tree.dynamics);
    respond<D>(tree.chain, tree.stance, link, push, tree.dynamics, change);
    EXPECT_LE((vector(change) - dense).norm(), 1e-12 * dense.norm());
    respond<D>(tree.chain, tree.stance, j, tree.dynamics, same);
    EXPECT_LE((vector(same) - dense).norm(), 1e-12 * dense.norm());
  }
}

// A contact's row knows only point velocities: an impulse changes them by its own effective mass, and energy
// by J . v_mean.
TYPED_TEST(ChainForces, APushGivesTheEnergyOfForceTimesMeanVelocity) {
  constexpr int D = TypeParam::value;
  Dice dice(6);
  for (int trial = 0; trial < 50; ++trial) {
    Swinging<D> tree = any_swing<D>(dice);
    const int n = tree.chain.velocities();
    const int link = tree.chain.size() - 1;
    const Vec<D> point = tree.stance.joint[link].place + dice.vector<D>(0.5), impulse = dice.vector<D>(1);
    const auto before = tree.sums();
    const Vec<D> v0 = point_velocity(tree.stance, link, point);
    std::vector<double> change(n);
    factor(tree.chain, tree.stance, tree.dynamics);
    respond<D>(tree.chain, tree.stance, link, wrench_at(tree.stance, link, point, impulse), tree.dynamics,
               change);
    for (int i = 0; i < n; ++i) tree.v[i] += change[i];
    const auto after = tree.sums();
    const Vec<D> v1 = point_velocity(tree.stance, link, point);
    EXPECT_NEAR(after.kinetic - before.kinetic, impulse.dot(0.5 * (v0 + v1)), 1e-13 * before.kinetic);
    if (tree.chain[0].joint.freedom == JointType::free) {
      EXPECT_LE((after.momentum - before.momentum - impulse).norm(), 1e-12 * before.momentum.norm());
    }
  }
}

TYPED_TEST(ChainForces, EnergyChangesByThePowerOfWhatActs) {
  constexpr int D = TypeParam::value;
  Dice dice(7);
  for (int trial = 0; trial < 50; ++trial) {
    Swinging<D> tree = any_swing<D>(dice);
    std::vector<Link<D>> damped;
    for (int i = 0; i < tree.chain.size(); ++i) {
      damped.push_back(tree.chain[i]);
      damped.back().joint.damping = 0.2;
    }
    tree.chain = Chain<D>(damped);
    const std::vector<double> rate = tree.rate();

    // dE/dt = sum over links of m v . (a - g) + w . (I a + w x I w) against what acts
    double gained = 0, given = vector(tree.tau).dot(vector(tree.v)) - 0.2 * vector(tree.v).squaredNorm();
    for (int i = 0; i < tree.chain.size(); ++i) {
      const Vec<D> x = tree.stance.joint[i].place + tree.stance.com[i];
      const Twist<D>& a = tree.dynamics.acceleration[i];
      gained +=
          tree.chain[i].mass *
          point_velocity(tree.stance, i, x).dot(point_acceleration(tree.stance, i, a, x) - tree.gravity);
      gained += tree.stance.twist[i].w.dot(tree.stance.inertia[i] * a.w);
      given += power(tree.dynamics.applied[i], tree.stance.twist[i]);
    }
    EXPECT_NEAR(gained, given, 1e-11 * std::max(1.0, std::abs(given)));
  }
}

TYPED_TEST(ChainForces, JointWrenchesCarryTheLinks) {
  constexpr int D = TypeParam::value;
  Dice dice(8);
  for (int trial = 0; trial < 50; ++trial) {
    Swinging<D> tree = any_swing<D>(dice);
    tree.rate();
    for (int i = 0; i < tree.chain.size(); ++i) {
      // Newton and Euler for one link about its centre of mass: its joint, its children's joints, what is
      // applied, gravity
      Wrench<D> sum = joint_wrench(tree.chain, tree.stance, tree.dynamics, i) + tree.dynamics.applied[i];
      for (int k = i + 1; k < tree.chain.size(); ++k) {
        if (tree.chain[k].parent == i) {
          sum -= transformed_to_origin(joint_wrench(tree.chain, tree.stance, tree.dynamics, k),
                                       tree.stance.arm[k]);
        }
      }
      const Vec<D>& com = tree.stance.com[i];
      const Twist<D>& a = tree.dynamics.acceleration[i];
      const double mass = tree.chain[i].mass;
      const Vec<D> acceleration = point_acceleration<D>(tree.stance, i, a, tree.stance.joint[i].place + com);
      const Vec<D> force = mass * (acceleration - tree.gravity);
      const AngularVec<D>& w = tree.stance.twist[i].w;
      const AngularVec<D> torque =
          tree.stance.inertia[i] * a.w + spin_cross<D>(w, tree.stance.inertia[i] * w);
      const double size = std::max({1.0, force.norm(), tree.dynamics.resistance[0].f.norm()});
      EXPECT_LE((sum.f - force).norm(), 1e-11 * size);
      EXPECT_LE((sum.n - moment<D>(com, sum.f) - torque).norm(), 1e-11 * size);

      // and along its freedoms the joint gives just its motor's force
      for (int j = tree.chain.v_start(i); j < tree.chain.v_start(i + 1); ++j) {
        EXPECT_NEAR(power(joint_wrench(tree.chain, tree.stance, tree.dynamics, i), tree.stance.freedom[j]),
                    tree.tau[j], 1e-11 * size);
      }
    }
  }
}

TYPED_TEST(ChainForces, NothingDependsOnHowFastTheWholeTravels) {
  constexpr int D = TypeParam::value;
  Dice dice(9);
  std::vector<Link<D>> links = {any_link<D>(dice, -1, JointType::free)};
  for (int i = 1; i < 6; ++i) links.push_back(any_link<D>(dice, i - 1, JointType::ball));
  Swinging<D> slow(Chain<D>{links});
  slow.shake(dice, 2, 3);
  Swinging<D> fast = slow;
  for (int k = 0; k < D; ++k) fast.v[kAngular<D> + k] += 1e4;
  // to the bit: the velocity of the whole enters nowhere
  EXPECT_EQ(slow.rate(), fast.rate());
}

TYPED_TEST(ChainForces, AFreeLinkFallsAsGravitySays) {
  constexpr int D = TypeParam::value;
  Dice dice(10);
  Link<D> link = any_link<D>(dice, -1, JointType::free);
  link.joint.on_parent = {};
  link.joint.on_link = {Rotation<D>::Identity(), link.com};  // origin at the centre of mass
  Swinging<D> body(Chain<D>{{link}});
  body.shake(dice, 2, 3);
  const std::vector<double> rate = body.rate();
  for (int k = 0; k < D; ++k) EXPECT_NEAR(rate[kAngular<D> + k], body.gravity[k], 1e-14);
}

TYPED_TEST(ChainForces, AWarmStepAllocatesNothing) {
  constexpr int D = TypeParam::value;
  Dice dice(11);
  Swinging<D> tree(any_tree<D>(dice, 15));
  tree.shake(dice, 1, 1);
  std::vector<double> change(tree.chain.velocities());
  Eigen::MatrixXd m(tree.chain.velocities(), tree.chain.velocities());
  const std::size_t before = allocations();
  tree.step(1e-3);
  respond<D>(tree.chain, tree.stance, 3, Wrench<D>{}, tree.dynamics, change);
  row<D>(tree.chain, tree.stance, 3, Wrench<D>{}, change);
  inverse<D>(tree.chain, tree.stance, tree.v, tree.v, tree.gravity, tree.dynamics, change);
  mass_matrix<D>(tree.chain, tree.stance, tree.dynamics, m);
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace obscura::sim
