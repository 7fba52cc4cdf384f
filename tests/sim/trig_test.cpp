#include "sim/math/trig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <set>
#include <string>

#include "where.h"

namespace obscura::sim {
namespace {

// in units in the last place of the exact value, which x87's long double knows 11 bits better
double off(double got, long double exact) {
  const double near = double(std::fabs(exact));
  const double ulp = std::nextafter(near, std::numeric_limits<double>::infinity()) - near;
  return double(std::fabs(got - exact)) / ulp;
}

// every angle of a walk that visits all magnitudes
template <class F>
void walk(double most, F f) {
  std::uint64_t seed = 1;
  for (int i = 0; i < 400000; ++i) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    const double unit = double(seed >> 11) / 9007199254740992.0;
    const int exponent = int(seed % 41) - 20;
    const double x = std::ldexp(unit + 1, exponent);
    if (x <= most) f(x);
  }
}

TEST(Trig, IsOffByLessThanOneInTheLastPlace) {
  double worst = 0, at = 0;
  const auto look = [&](double x) {
    const auto [s, c] = sin_cos(x);
    const double here = std::max(off(s, std::sin((long double)x)), off(c, std::cos((long double)x)));
    if (here > worst) worst = here, at = x;
  };
  walk(1048576, look);
  for (int k = 1; k < 100000; ++k) {
    // beside the zeros, where the reduction cancels most
    const double x = k * 1.5707963267948966;
    look(x), look(std::nextafter(x, 0)), look(std::nextafter(x, 1e9));
  }
  EXPECT_LT(worst, 0.8) << "at " << at;
}

TEST(Trig, StaysWithinTheRoundingOfTheArgumentBeyondItsRange) {
  for (double x = 2e6; x < 1e15; x *= 1.37) {
    const double ulp = std::nextafter(x, 1e300) - x;
    const auto [s, c] = sin_cos(x);
    EXPECT_NEAR(s, double(std::sin((long double)x)), 0.5 * ulp + 1e-16) << x;
    EXPECT_NEAR(c, double(std::cos((long double)x)), 0.5 * ulp + 1e-16) << x;
  }
}

TEST(Trig, IsOddAndEvenToTheBit) {
  walk(1e6, [](double x) {
    const auto a = sin_cos(x), b = sin_cos(-x);
    ASSERT_EQ(a.sin, -b.sin) << x;
    ASSERT_EQ(a.cos, b.cos) << x;
  });
  EXPECT_EQ(sin_cos(0).sin, 0);
  EXPECT_EQ(sin_cos(0).cos, 1);
}

TEST(Trig, OfWhatIsNotFiniteIsNotANumber) {
  EXPECT_TRUE(std::isnan(sin_cos(std::numeric_limits<double>::infinity()).sin));
  EXPECT_TRUE(std::isnan(sin_cos(std::numeric_limits<double>::quiet_NaN()).cos));
}

// glibc's sin, cos, exp, pow give other last bits on processors without fused multiply-add
TEST(CoreShape, CallsNoTranscendentalOfTheLibrary) {
  const auto library = std::filesystem::path(OBSCURA_BINARY).parent_path() / "src" / "libobscura_sim.a";
  ASSERT_TRUE(std::filesystem::exists(library)) << library;
  std::FILE* pipe = popen(("nm -u '" + library.string() + "'").c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  static const std::set<std::string> banned = {
      "sin",   "cos",   "tan",   "sincos", "asin",  "acos", "atan",  "atan2",  "sinh",   "cosh",
      "tanh",  "asinh", "acosh", "atanh",  "exp",   "exp2", "exp10", "expm1",  "log",    "log2",
      "log10", "log1p", "pow",   "cbrt",   "hypot", "erf",  "erfc",  "lgamma", "tgamma", "fma"};
  int symbols = 0;
  char line[4096];
  while (std::fgets(line, sizeof line, pipe)) {
    std::string text(line);
    text.erase(text.find_last_not_of(" \n") + 1);
    const auto space = text.rfind(' ');
    if (space == std::string::npos) continue;
    std::string symbol = text.substr(space + 1);
    symbol = symbol.substr(0, symbol.find('@'));
    ++symbols;
    for (const std::string& name : banned) {
      EXPECT_FALSE(symbol == name || symbol == name + "f" || symbol == name + "l") << symbol;
    }
  }
  EXPECT_EQ(pclose(pipe), 0);
  EXPECT_GT(symbols, 10) << "nm saw nothing";
}

}  // namespace
}  // namespace obscura::sim
