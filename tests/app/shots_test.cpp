#include "app/shots.h"

#include <gtest/gtest.h>

#include "app/exit.h"

namespace obscura::app {
namespace {

using sim::Rational;

TEST(Shots, TenSecondsHaveTheFramesThatTheRateSays) {
  // ceil(T fps), exact: loops that add up 1/fps film 557 or 501 of the 600
  const std::pair<Rational, int> rates[] = {{{24, 1}, 240}, {{25, 1}, 250}, {{30, 1}, 300},
                                            {{50, 1}, 500}, {{60, 1}, 600}, {{30000, 1001}, 300}};
  for (const auto& [fps, frames] : rates) {
    const Shots shots = Shots::film({10, 1}, fps);
    EXPECT_EQ(shots.size(), frames);
    EXPECT_EQ(shots[0].time, (Rational{0, 1}));
    EXPECT_EQ(shots[frames - 1].time, sim::rational(frames - 1) / fps);
  }
}

TEST(Shots, FromIsFilmedAndToIsNot) {
  Shots shots = Shots::film({10, 1}, {30, 1});
  shots.between({2, 1}, {3, 1});
  EXPECT_EQ(shots.size(), 30);
  EXPECT_EQ(shots[0].frame, 60);
  EXPECT_EQ(shots[29].frame, 89);
  EXPECT_THROW(shots.between({20, 1}, {30, 1}), UsageError);
}

TEST(Shots, AListNamesFramesOnceInTheOrderOfTime) {
  Shots shots = Shots::film({1, 1}, {30, 1});
  shots.only("5..9,1,3");
  ASSERT_EQ(shots.size(), 7);
  EXPECT_EQ(shots[0].frame, 1);
  EXPECT_EQ(shots[1].frame, 3);
  EXPECT_EQ(shots[6].frame, 9);
  EXPECT_EQ(shots.last_frame(), 9);
  for (const char* bad : {"30", "3..1", "a", "", "1,1", "2..4,3", "-1", "1..", "1.5"}) {
    Shots film = Shots::film({1, 1}, {30, 1});
    EXPECT_THROW(film.only(bad), UsageError) << bad;
  }
}

TEST(Shots, AStillShowsItsExactInstant) {
  const Shots still = Shots::still({5, 4}, {60, 1});
  ASSERT_EQ(still.size(), 1);
  EXPECT_EQ(still[0].time, (Rational{5, 4}));
  EXPECT_EQ(still[0].frame, 75);
}

TEST(Instants, ListsAndRangesAreExactAndForwards) {
  const auto range = instants("0:1:0.1");
  ASSERT_EQ(range.size(), 11u);
  EXPECT_EQ(range[3], (Rational{3, 10}));
  EXPECT_EQ(range[10], (Rational{1, 1}));
  EXPECT_EQ(instants("0,0.5,2").size(), 3u);
  for (const char* bad : {"", "x", "1,0", "-1", "0:1", "0:1:0", "0:1:-1"})
    EXPECT_THROW(instants(bad), UsageError) << bad;
}

}  // namespace
}  // namespace obscura::app
