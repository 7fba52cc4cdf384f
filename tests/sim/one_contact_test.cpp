#include "sim/solve/cone/one_contact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sim/solve/cone/cone.h"

namespace obscura::sim {
namespace {

// a contact of two bodies, anywhere on them, and how they meet
struct Meeting {
  Eigen::Matrix3d K = Eigen::Matrix3d::Zero();
  Vec3 b;
  double mu;

  explicit Meeting(unsigned seed) {
    std::mt19937 random(seed);
    const auto number = [&](double low, double high) {
      return low + (high - low) * double(random() >> 5) / double(1u << 27);
    };
    for (int body = 0; body < 2; ++body) {
      const double mass = std::exp(number(-3, 3));
      const Vec3 arm(number(-1, 1), number(-1, 1), number(-1, 1)),
          half(number(0.3, 1), number(0.3, 1), number(0.3, 1));
      Eigen::Matrix3d cross;
      cross << 0, -arm[2], arm[1], arm[2], 0, -arm[0], -arm[1], arm[0], 0;
      const Vec3 h2 = half.cwiseProduct(half);
      const Vec3 inertia = mass / 3 * Vec3(h2[1] + h2[2], h2[0] + h2[2], h2[0] + h2[1]);
      K += Eigen::Matrix3d::Identity() / mass - cross * inertia.cwiseInverse().asDiagonal() * cross;
    }
    b = {number(-3, 0.5), number(-2, 2), number(-2, 2)};
    mu = seed % 5 == 0 ? 0 : number(0, 1.5);
  }
};

TEST(OneContact, ObeysTheLawAndIsWhatTheConeSolverFinds) {
  int slides = 0, sticks = 0, opens = 0, left = 0;
  Cone<3> cone;
  for (unsigned seed = 0; seed < 3000; ++seed) {
    const Meeting at(seed);
    Vec3 p;
    if (!solve_one_contact(at.K, at.b, at.mu, p)) {
      ++left;
      continue;
    }
    const Vec3 w = at.K * p + at.b;
    const double size = at.b.norm(), push = size / at.K(0, 0);
    const double rubs = std::hypot(p[1], p[2]), slip = std::hypot(w[1], w[2]);
    if (p[0] == 0) {
      ++opens;
      EXPECT_GE(w[0], 0) << seed;
      EXPECT_EQ(rubs, 0) << seed;
      continue;
    }
    EXPECT_GT(p[0], 0) << seed;
    EXPECT_NEAR(w[0], 0, 1e-13 * size) << seed;
    EXPECT_LE(rubs, at.mu * p[0] + 1e-13 * push) << seed;
    if (slip > 1e-10 * size) {
      // most friction, against the slip
      ++slides;
      EXPECT_NEAR(rubs, at.mu * p[0], 1e-13 * push) << seed;
      EXPECT_NEAR(p[1] * w[1] + p[2] * w[2], -rubs * slip, 1e-12 * size * push) << seed;
    } else {
      ++sticks;
    }
    ConeBlock<3> block;
    block.mu = at.mu;
    ConeMode<3> mode;
    Eigen::VectorXd f = Eigen::VectorXd::Zero(3);
    ASSERT_TRUE(cone.solve(at.K, at.b, {&block, 1}, {&mode, 1}, f).found) << seed;
    EXPECT_LE((f - p).norm(), 1e-9 * push) << seed;
  }
  EXPECT_GT(slides, 500);
  EXPECT_GT(sticks, 500);
  EXPECT_GT(opens, 200);
  EXPECT_LT(left, 300);
}

}  // namespace
}  // namespace obscura::sim
