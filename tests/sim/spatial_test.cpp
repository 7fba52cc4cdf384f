#include "sim/math/spatial.h"

#include <gtest/gtest.h>

#include "chain_cases.h"

namespace obscura::sim {
namespace {

template <class Dimension>
class Spatial : public ::testing::Test {};
using SpatialDimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(Spatial, SpatialDimensions);

// all tolerances here: a few roundings of numbers near 1
constexpr double kRounding = 4e-15;

template <int D>
Twist<D> any_twist(Dice& dice) {
  return {dice.vector<kAngular<D>>(2), dice.vector<D>(2)};
}

template <int D>
Wrench<D> any_wrench(Dice& dice) {
  return {dice.vector<kAngular<D>>(2), dice.vector<D>(2)};
}

TYPED_TEST(Spatial, PowerDoesNotDependOnTheOrigin) {
  constexpr int D = TypeParam::value;
  Dice dice(1);
  for (int trial = 0; trial < 100; ++trial) {
    const auto t = any_twist<D>(dice);
    const auto f = any_wrench<D>(dice);
    const Vec<D> r = dice.vector<D>(1);
    EXPECT_NEAR(power(transformed_to_origin(f, r), t), power(f, shifted(t, r)), 4 * kRounding);
  }
}

TYPED_TEST(Spatial, LeverIsSwing) {
  constexpr int D = TypeParam::value;
  Dice dice(2);
  const AngularVec<D> w = dice.vector<kAngular<D>>(1);
  const Vec<D> r = dice.vector<D>(1);
  EXPECT_LE((lever<D>(r) * w - cross_velocity<D>(w, r)).norm(), kRounding);
}

TYPED_TEST(Spatial, InertiaOfALinkGivesItsKineticEnergyFromAnyOrigin) {
  constexpr int D = TypeParam::value;
  Dice dice(3);
  for (int trial = 0; trial < 100; ++trial) {
    const Link<D> link = any_link<D>(dice, -1, JointType::free);
    const auto t = any_twist<D>(dice);
    const Vec<D> v = t.v + cross_velocity<D>(t.w, link.com);
    const double want = link.mass * v.squaredNorm() + t.w.dot(link.inertia * t.w);
    const auto inertia = rigid_inertia<D>(link.mass, link.com, link.inertia);
    EXPECT_NEAR(power(inertia * t, t), want, 10 * kRounding * want);

    // given about one origin and felt at another
    const Vec<D> r = dice.vector<D>(1);
    const auto there = rigid_inertia<D>(link.mass, link.com - r, link.inertia);
    EXPECT_NEAR(power(transformed_to_origin(there, r) * t, t), want, 10 * kRounding * want);
  }
}

TYPED_TEST(Spatial, AnInertiaFreedAlongADirectionDoesNotFeelIt) {
  constexpr int D = TypeParam::value;
  Dice dice(4);
  const Link<D> link = any_link<D>(dice, -1, JointType::free);
  const auto s = any_twist<D>(dice);
  auto inertia = rigid_inertia<D>(link.mass, link.com, link.inertia);
  const Wrench<D> u = inertia * s;
  eliminate_freedom(inertia, u, 1 / power(u, s));
  const Wrench<D> felt = inertia * s;
  EXPECT_LE(felt.n.norm() + felt.f.norm(), 2 * kRounding);
}

TYPED_TEST(Spatial, APoseAndItsInverseAreNothing) {
  constexpr int D = TypeParam::value;
  Dice dice(5);
  const Pose<D> a = {any_rotation<D>(dice), dice.vector<D>(1)},
                b = {any_rotation<D>(dice), dice.vector<D>(1)};
  const Vec<D> x = dice.vector<D>(1);
  EXPECT_LE(((a * b) * x - a * (b * x)).norm(), kRounding);
  EXPECT_LE(((a.inverse() * a) * x - x).norm(), kRounding);
}

}  // namespace
}  // namespace obscura::sim
