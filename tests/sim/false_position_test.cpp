// Roots by false position: how many looks they take, from either side, and with an end that is infinite.

#include "sim/math/false_position.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace obscura::sim {
namespace {

// how many looks it takes to come so near to the root that |f| <= 1e-14
int looks_for(const std::function<double(double)>& f, double low, double high) {
  FalsePosition root(low, f(low), high, f(high));
  for (int n = 1; n < 100; ++n) {
    const double x = root.next(), value = f(x);
    EXPECT_GT(x, root.low());
    EXPECT_LT(x, root.high());
    if (std::fabs(value) <= 1e-14) return n;
    root.put(x, value);
    EXPECT_LE(f(root.low()) * f(root.high()), 0);
  }
  return 100;
}

TEST(FalsePosition, FindsTheRootOfAStraightLineAtOnce) {
  EXPECT_EQ(looks_for([](double x) { return 3 * x - 1; }, 0, 5), 1);
  EXPECT_EQ(looks_for([](double x) { return 1 - 3 * x; }, 0, 5), 1);
}

// One end of a convex curve stays: false position without its half weight takes over a hundred looks here.
TEST(FalsePosition, BothEndsComeToTheRoot) {
  EXPECT_LE(looks_for([](double x) { return std::exp(x) - 2; }, 0, 4), 12);
  EXPECT_LE(looks_for([](double x) { return 2 - std::exp(x); }, 0, 4), 12);
  EXPECT_LE(looks_for([](double x) { return x * x * x * x - 1e-4; }, 0, 1), 20);
}

TEST(FalsePosition, TriesTheMiddleWhereAnEndIsInfinite) {
  const double endless = std::numeric_limits<double>::infinity();
  FalsePosition root(0, -1, 2, endless);
  EXPECT_EQ(root.next(), 1);
  root.put(1, endless);
  EXPECT_EQ(root.next(), 0.5);
  // the lower end stays for the second time, and counts half: -0.5 at 0, 1 at 0.5
  root.put(0.5, 1);
  EXPECT_DOUBLE_EQ(root.next(), 0.5 / 3);
}

}  // namespace
}  // namespace obscura::sim
