#include "sim/math/exponential.h"

#include <gtest/gtest.h>

#include <cmath>

#include "chain_cases.h"

namespace obscura::sim {
namespace {

const Eigen::Vector4d kNoTurn = {0, 0, 0, 1};

TEST(Exponential, OfALogarithmIsTheSameTurn) {
  Dice dice(1);
  for (int trial = 0; trial < 2000; ++trial) {
    // of all sizes up to nearly half a turn, and next to it
    const double size = trial % 4 == 0 ? 3.141592653589 : std::pow(10, dice.between(-9, 0.49));
    const Vec3 turn = dice.vector<3>(1).normalized() * size;
    // a few roundings; near half a turn w is small beside the vector part, and its rounding is the angle's
    EXPECT_LE((logarithm(exponential(turn)) - turn).norm(), 4e-16 * (1 + 3 * size)) << size;
    const Eigen::Vector4d q = exponential(turn);
    EXPECT_LE((exponential(logarithm(-q)) - q).norm(), 1e-15);
  }
  EXPECT_EQ(logarithm(kNoTurn), Vec3::Zero());
  EXPECT_EQ(exponential(Vec3::Zero()), kNoTurn);
  EXPECT_NEAR(logarithm({0, 1, 0, 0})[1], 3.14159265358979324, 1e-15);
}

TEST(Exponential, AgreesWithTheMatrixOfAxisAndAngle) {
  Dice dice(2);
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 axis = dice.vector<3>(1).normalized();
    const double angle = dice.between(-6, 6);
    const Eigen::Matrix3d want = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    EXPECT_LE((matrix(exponential(axis * angle)) - want).norm(), 3e-15);
    EXPECT_LE((about(axis, std::sin(angle), std::cos(angle)) - want).norm(), 3e-15);
    // product: first the right, then the left
    const Eigen::Vector4d other = exponential(dice.vector<3>(2));
    EXPECT_LE((matrix(product(exponential(axis * angle), other)) - want * matrix(other)).norm(), 3e-15);
  }
}

TEST(Exponential, AboutAFixedAxisTurnsAddUp) {
  const Vec3 axis = Vec3(0.48, -0.6, 0.64);
  Eigen::Vector4d q = kNoTurn;
  // a thousand steps of 0.03 rad, 30 rad in all: as one, but for a rounding a step
  for (int i = 0; i < 1000; ++i) q = turned(q, axis * 0.03);
  const Eigen::Vector4d want = exponential(axis * 30);
  EXPECT_LE((q - want).norm(), 1e-14);
  // and the rate of the vector along the axis is the spin itself
  EXPECT_EQ(turn_rate(axis * 0.7, axis * 2), Vec3(axis * 2));
}

TEST(Exponential, OfNothingLeavesEveryBit) {
  const Eigen::Vector4d q = exponential({0.1, 0.2, 0.3}) * (1 + 1e-15);  // not quite unit
  EXPECT_EQ(turned(q, Vec3::Zero()), q);
}

TEST(Exponential, QuaternionStaysUnit) {
  Dice dice(3);
  Eigen::Vector4d q = kNoTurn;
  for (int i = 0; i < 100000; ++i) {
    q = turned(q, dice.vector<3>(0.1));
    ASSERT_NEAR(q.squaredNorm(), 1, 5e-16);
  }
}

// dexp from differences: exp(d + rate h) = exp(d) exp(w h)
TEST(TurnRate, IsTheInverseOfWhatDifferencesShow) {
  Dice dice(4);
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 d = dice.vector<3>(1).normalized() * dice.between(0.01, 5.5), w = dice.vector<3>(2);
    const Vec3 rate = turn_rate(d, w);
    const double h = 1e-5;
    const Eigen::Vector4d ahead = exponential(d + rate * h), behind = exponential(d - rate * h);
    const Eigen::Vector4d behind_conjugate = {-behind[0], -behind[1], -behind[2], behind[3]};
    // central difference: h^2 |rate|^3 and rounding over h, 1e-10 each; more where dexp^-1 nears its pole at
    // a whole turn
    const double large = std::max(1.0, std::pow(rate.norm(), 3));
    EXPECT_LE((logarithm(product(behind_conjugate, ahead)) / (2 * h) - w).norm(), 2e-9 * large);
    EXPECT_LE((spin_of(d, rate) - w).norm(), 1e-14 * std::max(1.0, rate.norm()));
  }
}

TEST(TurnRate, SeriesAndClosedFormMeet) {
  // two arguments a hair apart on both sides of |d|^2 = 1/4, where one gives way to the other: 2e-14 apart,
  // times |w|
  const Vec3 axis = Vec3(0.36, 0.48, 0.8), w = Vec3(1, -2, 0.5);
  const Vec3 under = axis * (0.5 - 1e-14), over = axis * (0.5 + 1e-14);
  EXPECT_LE((turn_rate(under, w) - turn_rate(over, w)).norm(), 6e-14);
  EXPECT_LE((exponential(under) - exponential(over)).norm(), 3e-14);
  EXPECT_LE((spin_of(under, w) - spin_of(over, w)).norm(), 6e-14);
}

}  // namespace
}  // namespace obscura::sim
