#include "sim/rational.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace obscura::sim {
namespace {

TEST(Rational, IsKeptInLowestTerms) {
  EXPECT_EQ(rational(1200, 1001), (Rational{1200, 1001}));
  EXPECT_EQ(rational(60, -90), (Rational{-2, 3}));
  EXPECT_EQ(rational(0, 7), (Rational{0, 1}));
}

TEST(Rational, IsReadExactly) {
  EXPECT_EQ(parse_rational("30"), (Rational{30, 1}));
  EXPECT_EQ(parse_rational("29.97"), (Rational{2997, 100}));
  EXPECT_EQ(parse_rational("30000/1001"), (Rational{30000, 1001}));
  EXPECT_EQ(parse_rational("-1.25e-3"), (Rational{-1, 800}));
  EXPECT_EQ(parse_rational("+2.5E+2"), (Rational{250, 1}));
  EXPECT_EQ(parse_rational("1.5/0.5"), (Rational{3, 1}));
}

TEST(Rational, IsNotReadFromWhatIsNoNumber) {
  for (const char* text : {"", "-", ".", "1/0", "1/", "/2", "1e", "1e99", "0x10", "1 ", "nan", "1.2.3",
                           "99999999999999999999"}) {
    EXPECT_FALSE(parse_rational(text)) << '"' << text << '"';
  }
}

TEST(Rational, OfADoubleIsTheDecimalAPersonTyped) {
  EXPECT_EQ(from_double(0.1), (Rational{1, 10}));
  EXPECT_EQ(from_double(-12.625), (Rational{-101, 8}));
  EXPECT_EQ(from_double(1e15), (Rational{1000000000000000, 1}));
  EXPECT_FALSE(from_double(std::numeric_limits<double>::infinity()));
  EXPECT_FALSE(from_double(std::nan("")));
  EXPECT_FALSE(from_double(1e300));
}

TEST(Rational, ComputesExactly) {
  EXPECT_EQ((Rational{1, 3} + Rational{1, 6}), (Rational{1, 2}));
  EXPECT_EQ((Rational{1, 3} - Rational{1, 3}), (Rational{0, 1}));
  EXPECT_EQ((Rational{1001, 30000} * Rational{600, 1}), (Rational{1001, 50}));
  EXPECT_EQ((Rational{1, 2} / Rational{-1, 4}), (Rational{-2, 1}));
  // the products do not fit 64 bits
  EXPECT_TRUE((Rational{4611686018427387903, 4611686018427387905} <
               Rational{4611686018427387905, 4611686018427387907}));
}

TEST(Rational, ComputesNearlyWhatDoesNotFit) {
  const std::int64_t most = std::numeric_limits<std::int64_t>::max();
  const Rational tiny{1, most}, odd{most - 1, most}, large{most, 1};
  // 1/most + 1/2 is no fraction of 64 bits; a bit of 62 is lost
  EXPECT_NEAR(value(tiny + Rational{1, 2}), 0.5, 1e-17);
  EXPECT_NEAR(value(odd * odd), 1, 1e-17);
  EXPECT_NEAR(value(large / tiny), double(most), 1);
  EXPECT_NEAR(value(rational(-most) * large), -double(most), 1);
  EXPECT_EQ(value(tiny * tiny), 0);
  EXPECT_EQ(floor(tiny * Rational{60, 1}), 0);
}

TEST(Rational, RoundsDownAndUp) {
  EXPECT_EQ(floor(Rational{7, 2}), 3);
  EXPECT_EQ(floor(Rational{-7, 2}), -4);
  EXPECT_EQ(floor(Rational{4, 1}), 4);
  EXPECT_EQ(ceil(Rational{7, 2}), 4);
  EXPECT_EQ(ceil(Rational{-7, 2}), -3);
  EXPECT_EQ(ceil(Rational{-4, 1}), -4);
}

TEST(Rational, IsWrittenAsItIsRead) {
  EXPECT_EQ(text({30, 1}), "30");
  EXPECT_EQ(text({30000, 1001}), "30000/1001");
  EXPECT_EQ(value({1, 4}), 0.25);
}

}  // namespace
}  // namespace obscura::sim
