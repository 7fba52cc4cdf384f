#include "sim/math/rational.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
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

TEST(Rational, OfADecimalAsADoubleIsPrintedIsTheFractionThatItWas) {
  EXPECT_EQ(parse_rational("0.016666666666666666"), (Rational{1, 60}));
  EXPECT_EQ(parse_rational("0.0033333333333333335"), (Rational{1, 300}));
  EXPECT_EQ(parse_rational("0.10000000000000001"), (Rational{1, 10}));
  EXPECT_EQ(parse_rational("-5.016666666666667"), (Rational{-301, 60}));
  EXPECT_EQ(parse_rational("6.6666666666666669e-06"), (Rational{1, 150000}));
  EXPECT_EQ(from_double(59.94005994005994), (Rational{60000, 1001}));
  // every frame and every step of an hour, as states prints them
  for (const Rational rate : {Rational{60, 1}, Rational{30000, 1001}, Rational{600, 1}, Rational{6000, 7}}) {
    for (std::int64_t n = 1; n < 2'000'000; n += 997) {
      const Rational t = rational(n) / rate;
      char text[40];
      std::snprintf(text, sizeof text, "%.17g", value(t));
      ASSERT_EQ(parse_rational(text), t) << text;
    }
  }
  // digits beyond what a double has, and fewer, as they stand
  EXPECT_EQ(parse_rational("0.1000000000000000055511151231257827"), (Rational{1, 10}));
  EXPECT_EQ(parse_rational("0.33333"), (Rational{33333, 100000}));
  EXPECT_EQ(parse_rational("9007199254740993"), (Rational{9007199254740993, 1}));
  EXPECT_EQ(parse_rational("1234567890123456789/1000000000000000007"),
            (Rational{1234567890123456789, 1000000000000000007}));
  EXPECT_FALSE(parse_rational("1.2345678901234567e-300"));
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
