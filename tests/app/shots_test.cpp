#include "app/run/shots.h"

#include <gtest/gtest.h>

#include "app/console/exit.h"
#include "app/film/subtitles.h"
#include "app/run/origin.h"
#include "app/run/variation.h"

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

TEST(Subtitles, AnEmptyLineEndsNoCue) {
  EXPECT_EQ(webvtt({{0, 1, "one\n\nthree"}}),
            "WEBVTT\n\n00:00:00.000 --> 00:00:01.000\none\n\u00a0\nthree\n");
}

TEST(Variations, KeysOfOneNameAreToldApart) {
  const Variations masses({"a.mass=1,2", "b.mass=3,4"});
  EXPECT_EQ(masses.words(1), "a.mass = 1, b.mass = 4");
  const Variations ways({"a.velocity.y=0,1", "physics.integrator=rk4"});
  EXPECT_EQ(ways.words(1), "velocity.y = 1, Runge-Kutta");
  EXPECT_EQ(ways.keys[0].symbol(false), "v_y");
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

TEST(Shots, TenSecondsAtHalfSpeedAreTwenty) {
  const Shots shots = Shots::film({10, 1}, {60, 1}, draw::Pace({1, 2}));
  EXPECT_EQ(shots.size(), 1200);
  EXPECT_EQ(shots[600].time, (Rational{5, 1}));
  EXPECT_EQ(shots[1199].time, sim::rational(1199, 120));
  EXPECT_EQ(Shots::still({5, 1}, {60, 1}, draw::Pace({1, 2}))[0].frame, 600);
}

TEST(Shots, APartOfASlowFilmIsNamedByTheRunsTime) {
  const draw::Pace pace({{{0, 1}, {1, 1}},
                         {{2, 1}, {1, 10}, draw::CameraKey::Ease::hold},
                         {{3, 1}, {1, 1}, draw::CameraKey::Ease::hold}});
  Shots shots = Shots::film({5, 1}, {30, 1}, pace);
  EXPECT_EQ(shots.size(), 14 * 30);
  shots.between({2, 1}, {3, 1});
  EXPECT_EQ(shots.size(), 300);
  EXPECT_EQ(shots[0].frame, 60);
  EXPECT_EQ(shots[0].time, (Rational{2, 1}));
  EXPECT_EQ(shots[299].time, sim::rational(2) + sim::rational(299, 300));
}

TEST(Shots, OfAFilmThatChangesItsSpeedAllFramesAndNoOthersLieWithin) {
  const draw::Pace pace({{{1, 1}, {1, 1}}, {{2, 1}, {1, 7}}, {{3, 1}, {3, 1}}});
  const Shots all = Shots::film({4, 1}, {30000, 1001}, pace);
  EXPECT_LT(all[all.size() - 1].time, (Rational{4, 1}));
  EXPECT_LE((Rational{4, 1}), pace.world(sim::rational(all.size()) / all.fps()));
  Shots part = all;
  part.between({3, 2}, {5, 2});
  EXPECT_LE((Rational{3, 2}), part[0].time);
  EXPECT_LT(all[part[0].frame - 1].time, (Rational{3, 2}));
  EXPECT_LT(part[part.size() - 1].time, (Rational{5, 2}));
  EXPECT_LE((Rational{5, 2}), all[part[part.size() - 1].frame + 1].time);
}

TEST(Instants, ListsAndRangesAreExactAndForwards) {
  EXPECT_THROW(instants("1:0:0.1"), UsageError);
  const auto range = instants("0:1:0.1");
  ASSERT_EQ(range.size(), 11u);
  EXPECT_EQ(range[3], (Rational{3, 10}));
  EXPECT_EQ(range[10], (Rational{1, 1}));
  EXPECT_EQ(instants("0,0.5,2").size(), 3u);
  for (const char* bad : {"", "x", "1,0", "-1", "0:1", "0:1:0", "0:1:-1", "9223372036854775807"})
    EXPECT_THROW(instants(bad), UsageError) << bad;
}

TEST(Instants, OfTooManyDigitsFindAFrame) {
  const auto odd = instants("1/9223372036854775807");
  EXPECT_EQ(Shots::stills(odd, {60, 1})[0].frame, 0);
}

TEST(Origin, ThatNoFileOfOursHasIsNone) {
  Origin origin;
  origin.width = 64, origin.height = 36, origin.fps = "30";
  origin.shot = Shot{};
  const media::Tags tags = origin.tags("");
  ASSERT_TRUE(origin_in(tags));
  // each would be divided by, counted to, or asked for as memory
  for (const auto& [right, wrong] : {std::pair{"\"30\"", "\"0\""},
                                     {"\"30\"", "\"-1\""},
                                     {"[64,36]", "[0,36]"},
                                     {"[64,36]", "[64,1e300]"},
                                     {"[64,36]", "[64,18446744073709551615]"},
                                     {"\"frame\":0", "\"frame\":-1"},
                                     {"\"frame\":0", "\"frame\":0,\"frames\":9000000000000000000"},
                                     {"\"time\":\"0\"", "\"time\":\"-1\""}}) {
    std::string json = tags.at("obscura");
    const auto at = json.find(right);
    ASSERT_NE(at, std::string::npos) << right << json;
    EXPECT_FALSE(origin_in({{"obscura", json.replace(at, std::string(right).size(), wrong)}})) << wrong;
  }
}

}  // namespace
}  // namespace obscura::app
