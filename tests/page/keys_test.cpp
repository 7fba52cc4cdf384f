#include "page/keys.h"

#include <gtest/gtest.h>

#include <cmath>

namespace obscura::page {
namespace {

// reads what Numbers writes
struct Reading {
  const std::string& bytes;
  std::size_t at = 0;
  std::int64_t next() {
    std::uint64_t bits = 0;
    for (int shift = 0;; shift += 7) {
      const auto byte = std::uint8_t(bytes[at++]);
      bits |= std::uint64_t(byte & 127) << shift;
      if (byte < 128) break;
    }
    return std::int64_t(bits >> 1) ^ -std::int64_t(bits & 1);
  }
};

// the values that keys stand for, as page/player/keys.js reads them
std::vector<double> read(const KeyStreams& keys, std::size_t count, double bound) {
  Reading starts{keys.starts.bytes()}, gaps{keys.gaps.bytes()}, ends{keys.ends.bytes()},
      bends{keys.bends.bytes()};
  const double step = bound / kKeySteps;
  double p = step * double(starts.next());
  std::vector<double> values{p};
  while (values.size() < count) {
    const std::int64_t gap = gaps.next();
    const double q = p + step * double(ends.next());
    const double a = gap > 1 ? step * double(bends.next()) : 0, b = gap > 1 ? step * double(bends.next()) : 0;
    for (std::int64_t k = 1; k <= gap; ++k) {
      const double u = double(k) / double(gap), v = 1 - u;
      values.push_back(p + u * (q - p) + 3 * u * v * (v * a + u * b));
    }
    p = q;
  }
  return values;
}

double farthest(const std::vector<double>& values, double bound, KeyStreams& keys) {
  write_keys(values, bound, keys);
  const std::vector<double> back = read(keys, values.size(), bound);
  EXPECT_EQ(back.size(), values.size());
  double most = 0;
  for (std::size_t i = 0; i < values.size(); ++i) most = std::max(most, std::abs(back[i] - values[i]));
  return most;
}

TEST(Keys, AreNowhereFartherThanTheirBound) {
  // flights between bounces, noise, and a jump
  std::vector<double> values;
  std::uint32_t noise = 1;
  for (int i = 0; i < 900; ++i) {
    const double t = std::fmod(i / 60.0, 1.3);
    noise = noise * 1664525u + 1013904223u;
    values.push_back(300 + 900 * t - 800 * t * t + (i > 600 ? double(noise >> 20) / 100 : 0) +
                     (i > 300 ? 5000 : 0));
  }
  for (const double bound : {1.0 / 16, 0.3, 1e-4}) {
    KeyStreams keys;
    EXPECT_LE(farthest(values, bound, keys), bound * (1 + 1e-9));
  }
}

TEST(Keys, OfAFlightAreOnePiece) {
  std::vector<double> values;
  for (int i = 0; i < 240; ++i) values.push_back(900 * i / 60.0 - 800 * i / 60.0 * i / 60.0);
  KeyStreams keys;
  EXPECT_LE(farthest(values, 1.0 / 16, keys), 1.0 / 16);
  EXPECT_LE(keys.gaps.bytes().size(), 2u) << "one gap";
}

TEST(Keys, OfWhatStandsStillAreNearlyNothing) {
  KeyStreams keys;
  EXPECT_EQ(farthest(std::vector<double>(5000, 48.5), 1.0 / 16, keys), 0);
  EXPECT_LE(keys.gaps.bytes().size() + keys.ends.bytes().size() + keys.bends.bytes().size(), 8u);
}

TEST(Keys, NumbersOfAllSizesComeBack) {
  Numbers numbers;
  const std::vector<std::int64_t> all{0, 1, -1, 63, -64, 64, 1'000'000, -123'456'789'012};
  for (const std::int64_t n : all) numbers.add(n);
  Reading reading{numbers.bytes()};
  for (const std::int64_t n : all) EXPECT_EQ(reading.next(), n);
}

}  // namespace
}  // namespace obscura::page
