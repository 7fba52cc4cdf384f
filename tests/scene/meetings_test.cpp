// Boxes that meet against all pairs of boxes, and how many are compared on the way.

#include "scene/meetings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

namespace obscura::scene {
namespace {

using Found = std::vector<std::pair<int, int>>;

template <int D>
struct BodyCounts {
  std::vector<sim::Bounds<D>> boxes;
  std::vector<int> kinds;

  void add(const sim::Vec<D>& center, const sim::Vec<D>& half, int kind = 0) {
    boxes.push_back({center - half, center + half});
    kinds.push_back(kind);
  }
};

// kinds matter to each other unless they are both odd
bool matter(int a, int b) { return a % 2 == 0 || b % 2 == 0; }

template <int D>
Found all_pairs(const BodyCounts<D>& crowd) {
  Found all;
  for (int a = 0; a < int(crowd.boxes.size()); ++a) {
    for (int b = a + 1; b < int(crowd.boxes.size()); ++b) {
      const int k = crowd.kinds[std::size_t(a)], l = crowd.kinds[std::size_t(b)];
      if (k >= 0 && l >= 0 && matter(k, l) && crowd.boxes[std::size_t(a)].meets(crowd.boxes[std::size_t(b)]))
        all.emplace_back(a, b);
    }
  }
  return all;
}

template <int D>
Found found(const BodyCounts<D>& crowd) {
  Found all;
  meetings<D>(crowd.boxes, crowd.kinds, matter, [&](int a, int b) {
    all.emplace_back(a, b);
    return true;
  });
  std::sort(all.begin(), all.end());
  return all;
}

template <int D>
std::int64_t compared(const BodyCounts<D>& crowd) {
  return meetings<D>(crowd.boxes, crowd.kinds, matter, [](int, int) { return true; });
}

template <int D>
void expect_all_and_no_other() {
  std::mt19937_64 dice(D);
  const auto between = [&](double low, double high) {
    return low + (high - low) * double(dice() >> 11) * 0x1p-53;
  };
  for (int round = 0; round < 60; ++round) {
    BodyCounts<D> crowd;
    const double room = between(1, 30), far = round % 3 == 0 ? 1e9 : round % 3 == 1 ? 0 : -3;
    const int n = 1 + int(dice() % 200);
    for (int i = 0; i < n; ++i) {
      sim::Vec<D> center, half;
      // some of them points, some much larger, all at a whole number now and then, where cells end
      const double size = dice() % 7 == 0 ? 0 : std::exp(between(-6, 3));
      for (int k = 0; k < D; ++k) {
        center[k] = far + (dice() % 4 == 0 ? std::round(between(-room, room)) : between(-room, room));
        half[k] = size * (dice() % 5 == 0 ? 1 : between(0, 1));
      }
      crowd.add(center, half, int(dice() % 5) - 1);
    }
    EXPECT_EQ(found(crowd), all_pairs(crowd)) << round;
  }
}

TEST(Meetings, AreAllPairsOfBoxesThatMeetAndNoOther) {
  expect_all_and_no_other<2>();
  expect_all_and_no_other<3>();
}

TEST(Meetings, OfNoBoxAndOfOneAreNone) {
  BodyCounts<2> crowd;
  EXPECT_EQ(compared(crowd), 0);
  crowd.add({1, 2}, {0, 0});
  EXPECT_EQ(compared(crowd), 0);
}

TEST(Meetings, EndWhenToldTo) {
  BodyCounts<2> crowd;
  for (int i = 0; i < 1000; ++i) crowd.add({0, 0}, {1, 1});
  int told = 0;
  meetings<2>(crowd.boxes, crowd.kinds, matter, [&](int, int) { return ++told < 10; });
  EXPECT_EQ(told, 10);
}

// twice as many cost twice as much, wherever they stand
TEST(Meetings, AreLinearInSheetsColumnsAndMixedSizes) {
  const auto sheet = [](int n) {  // on the floor of space
    BodyCounts<3> crowd;
    for (int i = 0; i < n; ++i) crowd.add({0.3 * (i % 50), 1, 0.3 * (i / 50)}, {0.1, 0.1, 0.1});
    return compared(crowd);
  };
  const auto column = [](int n) {
    BodyCounts<2> crowd;
    for (int i = 0; i < n; ++i) crowd.add({1, 0.3 * i}, {0.1, 0.1});
    return compared(crowd);
  };
  const auto mixed = [](int n) {  // one in a hundred is thirty times as large, beside the others
    BodyCounts<2> crowd;
    for (int i = 0; i < n; ++i)
      crowd.add({0.3 * i, i % 100 == 0 ? 4.0 : 0.0}, sim::Vec<2>::Constant(i % 100 == 0 ? 3 : 0.1));
    return compared(crowd);
  };
  for (const int n : {2000, 8000}) {
    EXPECT_LE(sheet(2 * n), 5 * sheet(n) / 2) << n;
    EXPECT_LE(column(2 * n), 5 * column(n) / 2) << n;
    EXPECT_LE(mixed(2 * n), 5 * mixed(n) / 2) << n;
    EXPECT_LE(sheet(n), 20 * n);
    EXPECT_LE(column(n), 20 * n);
    EXPECT_LE(mixed(n), 20 * n);
  }
}

TEST(Meetings, OfKindsThatDoNotMatterAreNotEvenCompared) {
  BodyCounts<2> crowd;
  for (int i = 0; i < 100'000; ++i) crowd.add({1, 2}, {0, 0}, i % 2 == 0 ? 1 : 3);
  EXPECT_EQ(compared(crowd), 0);
  crowd.add({1, 2}, {0.5, 0.5}, 0);
  EXPECT_EQ(compared(crowd), 100'000);
}

}  // namespace
}  // namespace obscura::scene
