#include "sim/math/elementary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <map>
#include <sstream>
#include <string>

#include "sim/reference.h"

namespace obscura::sim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double ulp(double x) { return std::nextafter(std::fabs(x), kInfinity) - std::fabs(x); }

double evaluate(const std::string& name, double x, double y) {
  return name == "exp"     ? elementary::exp(x)
         : name == "log"   ? elementary::log(x)
         : name == "pow"   ? elementary::pow(x, y)
         : name == "tan"   ? elementary::tan(x)
         : name == "asin"  ? elementary::asin(x)
         : name == "acos"  ? elementary::acos(x)
         : name == "atan"  ? elementary::atan(x)
         : name == "atan2" ? elementary::atan2(x, y)
         : name == "sinh"  ? elementary::sinh(x)
         : name == "cosh"  ? elementary::cosh(x)
                           : elementary::tanh(x);
}

// the bounds that the header tells, in units in the last place
const std::map<std::string, double> kBounds = {{"exp", 0.8},  {"log", 0.9},  {"pow", 0.8},  {"tan", 2.2},
                                               {"asin", 2.2}, {"acos", 2.2}, {"atan", 1.1}, {"atan2", 1.5},
                                               {"sinh", 2},   {"cosh", 1.7}, {"tanh", 2.7}};

// tests/reference/elementary.csv: values by arithmetic of 1200 bits, as the sum of two doubles
TEST(Elementary, AgreesWithAHundredDigits) {
  std::ifstream table = open_reference("elementary.csv");
  std::string line;
  std::getline(table, line);
  std::map<std::string, double> worst;
  int rows = 0;
  while (std::getline(table, line)) {
    std::stringstream cells(line);
    std::string name, x, y, high, low;
    std::getline(cells, name, ','), std::getline(cells, x, ','), std::getline(cells, y, ',');
    std::getline(cells, high, ','), std::getline(cells, low, ',');
    const auto number = [](const std::string& text) { return std::strtod(text.c_str(), nullptr); };
    const double got = evaluate(name, number(x), y.empty() ? 0 : number(y));
    const double off = std::fabs((got - number(high)) - number(low)) / ulp(number(high));
    worst[name] = std::max(worst[name], off);
    ++rows;
    EXPECT_LT(off, kBounds.at(name)) << line;
  }
  EXPECT_GT(rows, 700);
  EXPECT_EQ(worst.size(), kBounds.size());
}

// a walk of many arguments against the library's long double, and the bits that all of them have together:
// another processor or compiler must find the same
TEST(Elementary, KeepsItsBoundsAndItsBitsOnAWalk) {
  const std::map<std::string, std::uint64_t> bits = {
      {"exp", 5469653693073820119u},  {"log", 11270689738678875693u},  {"pow", 9636965427108167626u},
      {"tan", 6808358580134960638u},  {"asin", 4131759096317561707u},  {"acos", 6060497367790924366u},
      {"atan", 40219218362079972u},   {"atan2", 7884775182540792698u}, {"sinh", 15630990434970966548u},
      {"cosh", 6876754321789896981u}, {"tanh", 10254812809870675759u}};
  for (const auto& [name, bound] : kBounds) {
    std::uint64_t seed = 1, hash = 14695981039346656037u;
    double worst = 0, at = 0;
    for (int i = 0; i < 60000; ++i) {
      const auto unit = [&] {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        return double(seed >> 11) / 9007199254740992.0;
      };
      double x = (2 * unit() - 1) * (i % 2 ? 1 : 30), y = (2 * unit() - 1) * 20;
      if (name == "log" || name == "pow") x = std::fabs(x);
      if (name == "asin" || name == "acos") x = i % 2 ? x : x / 30;
      const double got = evaluate(name, x, y);
      hash = (hash ^ std::bit_cast<std::uint64_t>(got)) * 1099511628211u;
      const long double z = x, w = y;
      const long double exact = name == "exp"     ? std::exp(z)
                                : name == "log"   ? std::log(z)
                                : name == "pow"   ? std::pow(z, w)
                                : name == "tan"   ? std::tan(z)
                                : name == "asin"  ? std::asin(z)
                                : name == "acos"  ? std::acos(z)
                                : name == "atan"  ? std::atan(z)
                                : name == "atan2" ? std::atan2(z, w)
                                : name == "sinh"  ? std::sinh(z)
                                : name == "cosh"  ? std::cosh(z)
                                                  : std::tanh(z);
      const double off = double(std::fabs(got - exact)) / ulp(double(exact));
      if (off > worst) worst = off, at = x;
    }
    EXPECT_LT(worst, bound) << name << " at " << at;
    EXPECT_EQ(hash, bits.at(name)) << name;
  }
}

TEST(Elementary, HasTheSpecialValuesOfTheStandard) {
  EXPECT_EQ(elementary::exp(0), 1);
  EXPECT_EQ(elementary::exp(-kInfinity), 0);
  EXPECT_EQ(elementary::exp(1000), kInfinity);
  EXPECT_EQ(elementary::exp(-745.2), 0);
  EXPECT_GT(elementary::exp(-745), 0);
  EXPECT_EQ(elementary::log(1), 0);
  EXPECT_EQ(elementary::log(0), -kInfinity);
  EXPECT_TRUE(std::isnan(elementary::log(-1)));
  EXPECT_EQ(elementary::pow(2, 10), 1024);
  EXPECT_EQ(elementary::pow(-2, 3), -8);
  EXPECT_EQ(elementary::pow(10, -2), 0.01);
  EXPECT_EQ(elementary::pow(0, 0), 1);
  EXPECT_EQ(elementary::pow(0, -1), kInfinity);
  EXPECT_TRUE(std::isnan(elementary::pow(-1, 0.5)));
  EXPECT_EQ(elementary::pow(4, 0.5), 2);
  EXPECT_EQ(elementary::pow(kInfinity, -1), 0);
  EXPECT_EQ(elementary::pow(0.5, 1e300), 0);
  EXPECT_EQ(elementary::atan2(0, -1), 3.141592653589793);
  EXPECT_EQ(elementary::atan2(1, 0), 1.5707963267948966);
  EXPECT_EQ(elementary::atan2(0, 0), 0);
  EXPECT_EQ(elementary::atan2(-3, -kInfinity), -3.141592653589793);
  EXPECT_EQ(elementary::asin(1), 1.5707963267948966);
  EXPECT_EQ(elementary::acos(1), 0);
  EXPECT_TRUE(std::isnan(elementary::acos(1.5)));
  EXPECT_EQ(elementary::sinh(0), 0);
  EXPECT_EQ(elementary::cosh(0), 1);
  EXPECT_EQ(elementary::tanh(800), 1);
}

}  // namespace
}  // namespace obscura::sim
