#include "sim/math/lcp.h"

#include <gtest/gtest.h>

#include <random>

namespace obscura::sim {
namespace {

// A = J J^T of random rows, b in the range of J as impacts are, or anywhere
struct Problem {
  Square A;
  SmallVector b;
};
Problem random_problem(std::mt19937& random, int n, int rank) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Eigen::MatrixXd J(n, rank);
  Eigen::VectorXd v(rank);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < rank; ++j) J(i, j) = unit(random);
  }
  for (int j = 0; j < rank; ++j) v[j] = unit(random);
  return {J * J.transpose(), J * v};
}

TEST(Complementary, HoldsForRandomRows) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 20000; ++trial) {
    const int n = 1 + trial % 8;
    const auto [A, b] = random_problem(random, n, 3);
    SmallVector p;
    ASSERT_TRUE(solve_lcp(A, b, 3, p)) << trial;
    const SmallVector w = A * p + b;
    const double scale = 1 + p.maxCoeff() * 3;
    ASSERT_GE(p.minCoeff(), 0);
    ASSERT_GE(w.minCoeff(), -1e-11 * scale) << trial;
    for (int i = 0; i < n; ++i) ASSERT_LT(p[i] * w[i], 1e-9 * scale * scale) << trial;
  }
}

TEST(Complementary, SharesAlikeWhereRowsAreRedundant) {
  // three rows that say the same
  const Square A = Square::Constant(3, 3, 2.0);
  const SmallVector b = SmallVector::Constant(3, -3.0);
  SmallVector p;
  ASSERT_TRUE(solve_lcp(A, b, 3, p));
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(p[i], 0.5, 1e-14);
}

TEST(Complementary, IsZeroWhereNothingPushes) {
  const Square A = Square::Identity(2, 2);
  const SmallVector b = SmallVector::Constant(2, 1.0);
  SmallVector p;
  ASSERT_TRUE(solve_lcp(A, b, 2, p));
  EXPECT_EQ(p.norm(), 0);
}

TEST(Complementary, SaysWhereThereIsNone) {
  // two walls face to face, too near: x >= 1 and x <= -1
  Square A(2, 2);
  A << 1, -1, -1, 1;
  const SmallVector b = SmallVector::Constant(2, -1.0);
  SmallVector p;
  EXPECT_FALSE(solve_lcp(A, b, 2, p));
}

}  // namespace
}  // namespace obscura::sim
