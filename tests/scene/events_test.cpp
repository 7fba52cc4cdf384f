// [[when]]: times against closed forms, one list however a run is looked at, and what is refused.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "scene/error.h"
#include "scene/run_marks.h"
#include "scene/scene.h"
#include "scene/text_run.h"
#include "sim/step/run.h"

namespace obscura::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kFalling = 9.81;
// the issue's bound on times under `event`, s; most are found to the rounding of the clock
constexpr double kInTime = 1e-9;

std::string wrong_with(const std::string& text, const std::vector<std::string>& sets = {}) {
  try {
    parse(text, "a.toml", sets);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::unique_ptr<sim::Run> run_of(const std::string& text, const std::vector<std::string>& sets = {}) {
  return parse(text, "a.toml", sets).run();
}

sim::Rational decimal(double t) { return *sim::from_double(t); }

sim::Snapshot snapshot_at(sim::Run& run, double t) {
  auto found = run.at(decimal(t));
  if (const auto* trouble = std::get_if<sim::Trouble>(&found)) {
    ADD_FAILURE() << trouble->what << ": " << trouble->likely;
    return {};
  }
  return std::get<sim::Snapshot>(found);
}

std::vector<sim::RunEvent> events_until(const std::string& text, double t,
                                        const std::vector<std::string>& sets = {}) {
  const auto run = run_of(text, sets);
  snapshot_at(*run, t);
  return run->events();
}

std::vector<double> times_until(const std::string& text, double t,
                                const std::vector<std::string>& sets = {}) {
  std::vector<double> times;
  for (const sim::RunEvent& event : events_until(text, t, sets)) times.push_back(sim::value(event.time));
  return times;
}

// a ball of radius 0.1 in an open room; `space`: with a third dimension
std::string open_room(const std::string& mode, bool space, const std::string& ball,
                      const std::string& more = "") {
  return fmt::format(
      "duration = 1000\n[room]\nsize = {}\nwalls = \"none\"\n{}\n[physics]\ncollision = \"{}\"\n"
      "[[{}]]\nname = \"ball\"\n{}\n",
      space ? "[8, 8, 8]" : "[8, 8]", more, mode, mode == "handout" && !space ? "particle" : "ball",
      (mode == "handout" && !space ? "" : "radius = 0.1\n") + ball);
}
std::string spot(bool space, double x, double y) {
  return space ? fmt::format("[{}, {}, 0]", x, y) : fmt::format("[{}, {}]", x, y);
}
std::string when(const std::string& condition, const std::string& actions = "{ mark = \"hit\" }",
                 const std::string& more = "") {
  return fmt::format("[[when]]\n{}\ndo = [{}]\n{}\n", condition, actions, more);
}

// A ball falls from h to y: t = sqrt(2 h / g). In both dimensions, by a value and through a line.
TEST(Events, AFallIsTimedAsItsClosedForm) {
  for (const bool space : {false, true}) {
    const std::string ball = "position = " + spot(space, 0, 3);
    const std::string line = space ? "from = [-1, 1, -1], to = [1, 1, 1]" : "from = [-1, 1], to = [1, 1]";
    const double t = std::sqrt(2 * 2 / kFalling);
    for (const std::string& condition :
         {std::string("value = \"ball.y < 1\""), "crosses = { body = \"ball\", " + line + " }",
          std::string("value = \"(ball.y < 1)*(ball.vy < 0)\""),
          std::string("value = \"if(ball.y > 1, 0, 1) > 0.5\"")}) {
      const std::string text = open_room("event", space, ball) + when(condition);
      const std::vector<double> times = times_until(text, 2);
      ASSERT_EQ(times.size(), 1u) << condition;
      EXPECT_NEAR(times[0], t, kInTime) << condition;
      EXPECT_NEAR(times[0], t, 1e-13) << condition;
      // in the other modes at the end of the step
      for (const char* mode : {"contact", "handout"}) {
        const std::vector<double> steps = times_until(open_room(mode, space, ball) + when(condition), 2);
        ASSERT_EQ(steps.size(), 1u) << condition << mode;
        EXPECT_NEAR(steps[0], std::ceil(t * 600) / 600, 1e-12) << condition << mode;
      }
    }
  }
}

// Where a step is no cubic: at the time that is told the motion is at the threshold, to its rounding.
TEST(Events, ATimeIsThatOfTheMotionItself) {
  for (const bool space : {false, true}) {
    const std::string text = open_room("event", space, "position = " + spot(space, 3, 2) + "\nmass = 1",
                                       space ? "gravity = [0, 0, 0]" : "gravity = [0, 0]") +
                             "[[spring]]\nbetween = [\"ball\", " + spot(space, 0, 2) +
                             "]\nstiffness = 50\nrest_length = 2\n" +
                             when("value = \"ball.x < 1.9\"", "{ mark = \"a\" }", "again = true") +
                             when("value = \"ball.vx > 1.1\"", "{ mark = \"b\" }", "again = true");
    const std::vector<std::string> coarse = {"physics.rate=60"};
    const auto events = events_until(text, 1, coarse);
    ASSERT_GE(events.size(), 2u) << space;
    const auto run = run_of(text, coarse);
    for (const sim::RunEvent& event : events) {
      const auto now = std::get<sim::Snapshot>(run->at(event.time));
      // 1e-12 of a step later, at 7 m/s and 50 m/s^2
      if (event.marks[0] == "a")
        EXPECT_NEAR(now.bodies[0].position.x(), 1.9, 1e-12) << space;
      else
        EXPECT_NEAR(now.bodies[0].velocity.x(), 1.1, 1e-12) << space;
    }
  }
}

// What is let go level on a rod, or a bar on a pin, has come to rest on the other side after half a period,
//   T / 2 = 2 K(1/2) / w,  K(1/2) = 1.8540746773013719   w^2 = g / L, of a bar m g d / I
// and turns back: its angle from there is d = w^2 s^2 / 2, its level speed L d d', which is u after
//   s = (2 u / (L w^4))^(1/3)
// The course of a step has velocities to the third order alone, and has it turn before, and at the start.
TEST(Events, AVelocityOfWhatSwingsIsReadOnTheMotionItself) {
  const double level = 2.0, thick = 0.05;
  const double bar = std::sqrt(kFalling * 0.5 / ((1 + thick * thick) / 12 + 0.25));
  for (const auto& [name, space, w, arm, sign] :
       {std::tuple("bob", false, std::sqrt(kFalling / level), level, -1),
        std::tuple("bob", true, std::sqrt(kFalling / level), level, -1),
        std::tuple("bar", false, bar, 0.5, 1)}) {
    const std::string body =
        sign < 0 ? "[[ball]]\nname = \"bob\"\nradius = 0.1\nmass = 1\nposition = " + spot(space, 1, 3) +
                       "\n[[joint]]\ntype = \"rod\"\nbetween = [" + spot(space, 3, 3) + ", \"bob\"]\n"
                 : "[[box]]\nname = \"bar\"\nsize = [1, 0.05]\nposition = [2.5, 3]\n[[joint]]\n"
                   "type = \"pin\"\nbetween = [\"bar\", \"room\"]\nat = [2, 3]\n";
    for (const int rate : {60, 600}) {
      for (const double u : {1e-6, 1e-5}) {
        const double t = 2 * 1.8540746773013719 / w + std::cbrt(2 * u / (arm * std::pow(w, 4)));
        const std::string condition =
            when(fmt::format("value = \"{}.vx {} {}\"", name, sign < 0 ? '<' : '>', sign * u));
        const auto text = [&](const char* mode) {
          return fmt::format(
              "duration = 1000\n[room]\nsize = {}\nwalls = \"none\"\n[physics]\ncollision = \"{}\"\n"
              "rate = {}\n{}{}",
              space ? "[8, 8, 8]" : "[8, 8]", mode, rate, body, condition);
        };
        const std::string where = fmt::format("{} {} {} {}", name, space, rate, u);
        const auto events = events_until(text("event"), 1.8);
        ASSERT_EQ(events.size(), 1u) << where;
        // the scheme's error of the swing
        EXPECT_NEAR(sim::value(events[0].time), t, rate == 60 ? 2e-6 : 1e-9) << where;
        const auto run = run_of(text("event"));
        const auto now = std::get<sim::Snapshot>(run->at(events[0].time));
        EXPECT_NEAR(now.bodies[0].velocity.x(), sign * u, 1e-12) << where;
        const std::vector<double> steps = times_until(text("contact"), 1.8);
        ASSERT_EQ(steps.size(), 1u) << where;
        EXPECT_NEAR(steps[0], std::ceil(sim::value(events[0].time) * rate) / rate, 1e-12) << where;
      }
    }
  }
}

// At 1,000 m/s a step is 1.7 m long: a line and a band of 2 cm are not missed.
TEST(Events, NothingIsMissedAtAThousandMetresASecond) {
  for (const bool space : {false, true}) {
    for (const char* mode : {"event", "contact", "handout"}) {
      const std::string ball =
          fmt::format("position = {}\nvelocity = {}", spot(space, 0.5, 4), spot(space, 1000, 0));
      const std::string text =
          open_room(mode, space, ball, space ? "gravity = [0, 0, 0]" : "gravity = [0, 0]") +
          when(fmt::format("crosses = {{ body = \"ball\", {} }}",
                           space ? "from = [7, 3, -1], to = [7, 5, 1]" : "from = [7, 3], to = [7, 5]")) +
          when("value = \"abs(ball.x - 5) < 0.01\"") + when("value = \"(ball.x > 5.5)*(ball.x < 5.51)\"") +
          when(fmt::format("crosses = {{ body = \"ball\", {} }}",
                           space ? "from = [7, 5, -1], to = [7, 6, 1]" : "from = [7, 5], to = [7, 6]"));
      const auto events = events_until(text, 0.02);
      ASSERT_EQ(events.size(), 3u) << mode << space;
      if (mode != std::string("event")) continue;
      EXPECT_NEAR(sim::value(events[0].time), 0.00449, 1e-13);
      EXPECT_NEAR(sim::value(events[1].time), 0.005, 1e-13);
      EXPECT_NEAR(sim::value(events[2].time), 0.0065, 1e-13);
    }
  }
}

// Wherever in its step a band of 2 cm lies.
TEST(Events, ABandIsSeenWhereverItLies) {
  for (const char* mode : {"event", "contact", "handout"}) {
    std::string text =
        open_room(mode, false, "position = [0.5, 4]\nvelocity = [1000, 0]", "gravity = [0, 0]");
    for (int k = 0; k < 100; ++k)
      text += when(fmt::format("value = \"abs(ball.x - {}) < 0.01\"", 1 + 0.0417 * k));
    const auto events = events_until(text, 0.02);
    ASSERT_EQ(events.size(), 100u) << mode;
    for (std::size_t k = 0; k < 100 && std::string(mode) == "event"; ++k)
      EXPECT_NEAR(sim::value(events[k].time), (0.49 + 0.0417 * double(k)) / 1000, 1e-13) << k;
  }
}

// Between two walls 1 m apart a ball at 1,000 m/s meets them more than once a step; each time counts.
TEST(Events, EachOfManyTouchesInAStepCounts) {
  const auto scene = [](const char* mode) {
    return fmt::format(
               "[room]\nsize = [1.2, 1]\ngravity = [0, 0]\n[physics]\ncollision = \"{}\"\n[[ball]]\nname = "
               "\"ball\"\n"
               "radius = 0.1\nposition = [0.6, 0.5]\nvelocity = [1000, 0]\nelasticity = 1\nfriction = 0\n",
               mode) +
           when("touches = [\"ball\", \"right\"]", "{ mark = \"hit\" }", "again = true") +
           when("crosses = { body = \"ball\", from = [0.3, 0], to = [0.3, 1] }", "{ mark = \"line\" }",
                "again = true");
  };
  std::vector<double> hits, lines;
  for (const auto& event : events_until(scene("event"), 0.02))
    (event.marks[0] == "hit" ? hits : lines).push_back(sim::value(event.time));
  ASSERT_EQ(hits.size(), 10u);
  for (std::size_t i = 0; i < hits.size(); ++i) EXPECT_NEAR(hits[i], 0.0005 + 0.002 * double(i), kInTime);
  ASSERT_EQ(lines.size(), 20u);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_NEAR(lines[2 * i], 0.0013 + 0.002 * double(i), kInTime);
    EXPECT_NEAR(lines[2 * i + 1], 0.0017 + 0.002 * double(i), kInTime);
  }
  std::size_t many = 0;
  for (const auto& event : events_until(scene("contact"), 0.02)) many += event.marks[0] == "hit";
  EXPECT_EQ(many, 10u);
}

// A rolls slowly upon b, and c drives b away, all in one step of a sixtieth: the touch of a and b is neither
// there at its end nor an impact. By the iterative solver, too, in both dimensions.
TEST(Events, ATouchThatBeginsAndEndsWithinAStepIsSeen) {
  for (const bool space : {false, true}) {
    for (const char* solver : {"direct", "iterative"}) {
      const double h = 1.0 / 60, slow = 0.05, fast = 10, along = -0.3, up = std::sqrt(1 - along * along);
      const auto ball = [&](const char* name, double x, double y, double vx, double vy) {
        return fmt::format(
            "[[ball]]\nname = \"{}\"\nradius = 0.1\nposition = {}\nvelocity = {}\nfriction = 0\nelasticity = "
            "0\n",
            name, spot(space, x, y), spot(space, vx, vy));
      };
      const double far = 0.2 + 0.75 * h * fast;
      const std::string text =
          fmt::format(
              "duration = 1\n[room]\nsize = {}\nfriction = 0\n[physics]\nrate = 60\nsolver = \"{}\"\n",
              space ? "[8, 3, 2]" : "[8, 3]", solver) +
          ball("a", 1.8 - 0.3 * h * slow, 0.1, slow, 0) + ball("b", 2, 0.1, 0, 0) +
          ball("c", 2 + along * far, 0.1 + up * far, -along * fast, -up * fast) +
          when("touches = [\"a\", \"b\"]", "{ mark = \"met\" }") +
          when("leaves = [\"a\", \"b\"]", "{ mark = \"left\" }") +
          when("touches = [\"b\", \"c\"]", "{ mark = \"struck\" }");
      std::vector<std::string> marks;
      for (const sim::RunEvent& event : events_until(text, h)) {
        EXPECT_NEAR(sim::value(event.time), h, 1e-12);
        marks.insert(marks.end(), event.marks.begin(), event.marks.end());
      }
      EXPECT_THAT(marks, ElementsAre("met", "left", "struck")) << solver << space;
    }
  }
}

// A bounce touches and leaves at sqrt(2 h / g), and again 2 e v / g later.
TEST(Events, ABounceTouchesAndLeaves) {
  for (const bool space : {false, true}) {
    const std::string text =
        fmt::format(
            "[room]\nsize = {}\nwalls = \"ground\"\n[physics]\ncollision = \"event\"\n[[ball]]\n"
            "name = \"ball\"\nradius = 0.1\nposition = {}\nelasticity = 0.5\n[[box]]\nname = \"box\"\n"
            "size = {}\nposition = {}\nfixed = true\nelasticity = 0.5\n",
            space ? "[8, 4, 8]" : "[8, 4]", spot(space, 1, 1.3), space ? "[1, 0.2, 1]" : "[1, 0.2]",
            spot(space, 1, 0.1)) +
        when("touches = [\"ball\", \"box\"]", "{ mark = \"hit\" }", "again = true") +
        when("leaves = [\"box\", \"ball\"]", "{ mark = \"up\" }", "again = true") +
        when("touches = [\"ball\", \"floor\"]", "{ mark = \"floor\" }");
    const auto events = events_until(text, 1.2);
    const double t = std::sqrt(2 * 1 / kFalling), v = kFalling * t;
    ASSERT_GE(events.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_NEAR(sim::value(events[i].time), i < 2 ? t : t + v / kFalling, kInTime) << i;
    EXPECT_THAT(events[0].marks, ElementsAre("hit"));
    EXPECT_THAT(events[1].marks, ElementsAre("up"));
    EXPECT_THAT(events[0].of, ElementsAre("ball", "box"));
  }
}

// What rests has touched once; what touches at the start has not come to touch, and leaves when it is let
// go of.
TEST(Events, RestIsOneTouch) {
  for (const char* solver : {"direct", "iterative"}) {
    for (const bool space : {false, true}) {
      const std::string text =
          fmt::format(
              "[room]\nsize = {}\nwalls = \"ground\"\n[physics]\nsolver = \"{}\"\n[[box]]\nname = \"low\"\n"
              "size = {}\nposition = {}\nelasticity = 0\n[[box]]\nname = \"high\"\nsize = {}\nposition = "
              "{}\nelasticity = "
              "0\n",
              space ? "[8, 4, 8]" : "[8, 4]", solver, space ? "[1, 1, 1]" : "[1, 1]", spot(space, 1, 0.5),
              space ? "[0.5, 0.5, 0.5]" : "[0.5, 0.5]", spot(space, 1, 1.5)) +
          when("touches = [\"low\", \"floor\"]", "{ mark = \"never\" }") +
          when("touches = [\"low\", \"high\"]", "{ mark = \"once\" }", "again = true");
      const auto events = events_until(text, 3);
      ASSERT_EQ(events.size(), 1u) << solver << space;
      EXPECT_NEAR(sim::value(events[0].time), std::sqrt(2 * 0.25 / kFalling), 2.0 / 600) << solver << space;
    }
  }
}

// A uniform ladder that slides down a smooth wall from 75 degrees leaves it at two thirds of its height, as
// the integral of its energy says after 0.698777 s: also where it stands a rounding off the wall at the
// start.
TEST(Events, ALadderLeavesItsWallOnce) {
  for (const double off : {0.0, 1e-11, 1e-10, 1e-9, 1e-8}) {
    const auto times = times_until(
        fmt::format(
            "[room]\nsize = [3.6, 2.4]\nfriction = 0\nelasticity = 0\n[physics]\ncollision = \"event\"\n"
            "[[box]]\nname = \"ladder\"\nsize = [2, 0.05]\nposition = [{:.17g}, 0.9723963024166313]\n"
            "angle = -75\nmass = 8\ncenter_of_mass = [0, -0.025]\ninertia = 2.6666666666666665\n",
            0.28296719075974747 + off) +
            when("leaves = [\"ladder\", \"left\"]", "{ mark = \"off\" }", "again = true"),
        0.8);
    ASSERT_EQ(times.size(), 1u) << off;
    EXPECT_NEAR(times[0], 0.698777341, 1e-6) << off;
  }
}

// A ball that rolls down a dome from rest leaves it where nothing presses: at cos = 2/(3 + k) of the cosine
// of its start, I = k m r^2. With friction mu it slips when the normal force has come down to some 1/mu of
// the weight, and then leaves in as small a part of the time; what its slip takes is of that order, too.
TEST(Events, ARollingBallLeavesADomeHoweverGreatTheFriction) {
  for (const bool space : {false, true}) {
    for (const std::string mode : {"event", "contact"}) {
      for (const double mu : {1e2, 1e3, 1e4, 5e4, 1e5, 1e6}) {
        const std::string text =
            fmt::format(
                "[room]\nsize = {0}\ncorner = {1}\nwalls = \"none\"\n"
                "[physics]\ncollision = \"{3}\"\n[[ball]]\nname = \"dome\"\nradius = 1\nposition = {4}\n"
                "fixed = true\nfriction = {2}\n[[ball]]\nname = \"ball\"\nradius = 0.2\nposition = "
                "{5}\nfriction = {2}\nelasticity = 0\n",
                space ? "[8, 8, 8]" : "[8, 8]", space ? "[-4, -4, -4]" : "[-4, -4]", mu, mode,
                spot(space, 0, 0), spot(space, 0.1, std::sqrt(1.43))) +
            when("leaves = [\"dome\", \"ball\"]", "{ mark = \"off\" }");
        const auto run = run_of(text);
        const auto begun = snapshot_at(*run, 0).energies.total();
        const double k = space ? 0.4 : 0.5, leaves = 2 / (3 + k) * std::sqrt(1.43);
        const auto times = times_until(text, 1.4);
        ASSERT_EQ(times.size(), 1u) << space << mode << mu;
        const sim::Snapshot off = snapshot_at(*run, times[0]);
        EXPECT_NEAR(off.energies.total(), begun, 1e-7 * begun + begun / (mu * mu)) << space << mode << mu;
        if (mode == "event")
          EXPECT_NEAR(off.bodies[1].position.y(), leaves, 1e-7 + 0.02 / mu) << space << mu;
        else
          EXPECT_NEAR(off.bodies[1].position.y(), leaves, 4e-3) << space << mu;
      }
    }
  }
}

// A ball that rolls over the edge of a box at v turns about the edge and leaves it where nothing presses, at
//   cos = (v^2 / g r + 2 / (1 + k)) / (1 + 2 / (1 + k)),   I = k m r^2
// of its height above it, and not where its centre passes the edge: there a face hands it on to an edge.
TEST(Events, ABallThatRollsOverAnEdgeLeavesItWhereNothingPresses) {
  for (const bool space : {false, true}) {
    const double k = space ? 0.4 : 0.5, way = 2 / (1 + k);
    const double leaves = (0.09 / (9.81 * 0.1) + way) / (1 + way);
    for (const auto& [mode, rate] : {std::pair("event", 60), std::pair("event", 600),
                                     std::pair("contact", 60), std::pair("contact", 2400)}) {
      const std::string text =
          fmt::format(
              "[room]\nsize = {}\ncorner = {}\nwalls = \"none\"\n[physics]\ncollision = \"{}\"\nrate = {}\n"
              "[[box]]\nname = \"t\"\nsize = {}\nposition = {}\nfixed = true\nfriction = 1e4\n"
              "[[ball]]\nname = \"b\"\nradius = 0.1\nposition = {}\nvelocity = {}\nspin = {}\nfriction = "
              "1e4\nelasticity = 0\n",
              space ? "[8, 8, 8]" : "[8, 8]", space ? "[-4, -4, -4]" : "[-4, -4]", mode, rate,
              space ? "[2, 1, 2]" : "[2, 1]", spot(space, -1, 0.5), spot(space, -0.3, 1.1),
              spot(space, 0.3, 0), space ? "[0, 0, -171.88733853924697]" : "-171.88733853924697") +
          when("leaves = [\"b\", \"t\"]", "{ mark = \"off\" }");
      const auto times = times_until(text, 1.5);
      ASSERT_EQ(times.size(), 1u) << space << mode << rate;
      const auto run = run_of(text);
      const double bound = mode == std::string("event") ? 1e-5 : 0.6 / rate;
      EXPECT_NEAR(snapshot_at(*run, times[0]).bodies[0].position.y(), 1 + 0.1 * leaves, bound)
          << space << mode << rate;
    }
  }
}

// What slides off a smooth dome by steps leaves it in the step in which it would, not where its straight
// steps part from the curve a little.
TEST(Events, ByStepsADomeIsLeftOnceAndInItsStep) {
  for (const std::string solver : {"iterative", "direct"}) {
    for (const bool space : {false, true}) {
      double exact = 0;
      for (const auto& [mode, rate] :
           {std::pair("event", 600), std::pair("contact", 30), std::pair("contact", 60),
            std::pair("contact", 240), std::pair("contact", 1200)}) {
        const std::string text =
            fmt::format(
                "[room]\nsize = {0}\ncorner = {1}\nwalls = \"none\"\n"
                "[physics]\ncollision = \"{2}\"\nrate = {3}\nsolver = \"{6}\"\n[[ball]]\nname = "
                "\"dome\"\nradius = 1\nposition = {4}\nfixed = true\nfriction = 0\n[[ball]]\nname = "
                "\"ball\"\nradius = 0.2\nposition = {5}\nfriction = 0\nelasticity = 0\n",
                space ? "[8, 8, 8]" : "[8, 8]", space ? "[-4, -4, -4]" : "[-4, -4]", mode, rate,
                spot(space, 0, 0), spot(space, 0.1, std::sqrt(1.43)), solver) +
            when("leaves = [\"dome\", \"ball\"]", "{ mark = \"off\" }", "again = true");
        const auto times = times_until(text, 1.3);
        ASSERT_EQ(times.size(), 1u) << space << solver << rate;
        if (exact == 0) exact = times[0];
        EXPECT_NEAR(times[0], exact, mode == std::string("event") ? 0 : 1.5 / rate)
            << space << solver << rate;
      }
    }
  }
}

// A gate lets a ball go when another comes by; it then falls as one that was let go at that time.
TEST(Events, AReleaseIsAtTheExactTime) {
  const std::string text = open_room("event", false, "position = [0, 3]") +
                           "[[ball]]\nname = \"other\"\nradius = 0.1\nposition = [3, 5]\nfixed = true\n" +
                           when("value = \"ball.y < 2\"", "{ release = \"other\" }");
  const double t = std::sqrt(2 / kFalling);
  const auto run = run_of(text);
  for (const double later : {0.6, 0.777, 1.0}) {
    const sim::Snapshot now = snapshot_at(*run, later);
    EXPECT_NEAR(now.bodies[1].position.y(), 5 - kFalling / 2 * (later - t) * (later - t), 1e-12);
    EXPECT_NEAR(now.bodies[0].position.y(), 3 - kFalling / 2 * later * later, 1e-12);
  }
  // what it has of energy then was given
  const sim::Snapshot start = snapshot_at(*run_of(text), 0.1), end = snapshot_at(*run, 1.0);
  EXPECT_NEAR(end.energies.total() - end.energies.work, start.energies.total(), 1e-11);
}

// Gravity turned around at a time, exactly, in every mode: v = -g T + g (t - T).
TEST(Events, ATimeAndASetAreExactInEveryMode) {
  for (const char* mode : {"event", "contact", "handout"}) {
    const std::string text = open_room(mode, false, "position = [0, 3]") +
                             when("time = 0.50123", "{ set = \"room.gravity\", to = [0, 9.81] }");
    const auto run = run_of(text);
    const sim::Snapshot now = snapshot_at(*run, 1);
    const double T = 0.50123, rest = 1 - T;
    EXPECT_NEAR(now.bodies[0].velocity.y(), -kFalling * T + kFalling * rest, 1e-12) << mode;
    EXPECT_NEAR(now.bodies[0].position.y(),
                3 - kFalling / 2 * T * T - kFalling * T * rest + kFalling / 2 * rest * rest, 1e-12)
        << mode;
    // what the potential is from then on beyond what it was is work of the hand that turned it
    const double start = snapshot_at(*run_of(text), 0.1).energies.total();
    EXPECT_NEAR(now.energies.total() - now.energies.work, start, 1e-10) << mode;
  }
}

// A motor is stopped where its wheel has turned half round; a force is switched on by another event.
TEST(Events, MotorsAndForcesAreSet) {
  for (const char* solver : {"direct", "iterative"}) {
    const std::string text =
        fmt::format(
            "[room]\nsize = [8, 8]\nwalls = \"none\"\ngravity = [0, 0]\n[physics]\nsolver = \"{}\"\n"
            "[[ball]]\nname = \"wheel\"\nradius = 0.5\nposition = [2, 2]\n[[joint]]\nname = \"axle\"\ntype = "
            "\"pin\"\n"
            "between = [\"wheel\", [2, 2]]\nmotor = {{ speed = 90, most = 1000 }}\n[[ball]]\nname = "
            "\"ball\"\n"
            "radius = 0.1\nmass = 2\nposition = [6, 6]\n[[force]]\nname = \"push\"\nof = \"ball\"\n"
            "components = [\"0\", \"0\"]\n",
            solver) +
        when("value = \"wheel.angle > pi/2\"", "{ set = \"axle.motor.speed\", to = 0 }") +
        when("time = 1.5", "{ set = \"push.components\", to = [\"3*t\", \"0\"] }");
    const auto run = run_of(text);
    const sim::Snapshot now = snapshot_at(*run, 2);
    EXPECT_NEAR(now.bodies[0].angle, 1.5708, 90 * 3.15 / 180 / 600 * 2) << solver;
    EXPECT_NEAR(now.bodies[0].spin.z(), 0, 1e-9) << solver;
    EXPECT_NEAR(now.bodies[1].velocity.x(), 1.5 / 2 * (4 - 2.25), 1e-9) << solver;
  }
}

// A piston on a spring is held and let go: it swings as x = 0.5 (1 - cos w t), w^2 = k / m.
TEST(Events, WhatIsHeldByAJointAndFixedIsLetGo) {
  for (const char* mode : {"event", "contact"}) {
    for (const char* solver : {"direct", "iterative"}) {
      const std::string text =
          fmt::format(
              "[room]\nsize = [8, 8]\nwalls = \"none\"\ngravity = [0, 0]\n[physics]\ncollision = \"{}\"\n"
              "solver = \"{}\"\n[[box]]\nname = \"piston\"\nsize = [1, 1]\nmass = 2\nposition = [2, 2]\n"
              "fixed = true\n[[joint]]\nname = \"rail\"\ntype = \"slider\"\nbetween = [\"piston\", "
              "\"room\"]\n"
              "axis = [1, 0]\nspring = {{ stiffness = 50, rest_position = 0.5 }}\n",
              mode, solver) +
          when("time = 0.501", "{ release = \"piston\" }");
      const auto run = run_of(text);
      EXPECT_EQ(snapshot_at(*run, 0.5).bodies[0].position.x(), 2) << mode << solver;
      for (const double t : {0.7, 1.3})
        EXPECT_NEAR(snapshot_at(*run, t).bodies[0].position.x(), 2.5 - 0.5 * std::cos(5 * (t - 0.501)),
                    std::string(solver) == "direct" ? 1e-6 : 2e-3)
            << mode << solver << t;
    }
  }
}

// A ball on a platform y = A sin w t leaves where that falls faster than g: sin w t = g / (A w^2).
TEST(Events, ALossOfContactIsTimedByItsForce) {
  const double A = 0.2, w = 10, t = std::asin(kFalling / (A * w * w)) / w;
  for (const bool space : {false, true}) {
    const std::string text =
        fmt::format(
            "[room]\nsize = {}\nwalls = \"none\"\n[physics]\ncollision = \"event\"\n[[box]]\n"
            "name = \"table\"\nsize = {}\nposition = {}\nmotion = {{ y = \"0.2*sin(10*t)\" }}\n"
            "[[ball]]\nname = \"ball\"\nradius = 0.1\nposition = {}\nvelocity = {}\nelasticity = 0\n",
            space ? "[8, 8, 8]" : "[8, 8]", space ? "[1, 0.2, 1]" : "[1, 0.2]", spot(space, 0, 1),
            spot(space, 0, 1.2), spot(space, 0, 2)) +
        when("leaves = [\"ball\", \"table\"]", "{ mark = \"off\" }", "again = true") +
        when("leaves = [\"ball\", \"table\"]", "{ set = \"room.gravity\", to = " + spot(space, 0, 0) + " }");
    const auto run = run_of(text);
    const sim::Snapshot now = snapshot_at(*run, t + 0.1);
    const auto events = run->events();
    ASSERT_EQ(events.size(), 2u) << space;
    EXPECT_NEAR(sim::value(events[0].time), t, kInTime) << space;
    EXPECT_NEAR(sim::value(events[1].time), t, kInTime) << space;
    const std::size_t ball =
        now.bodies[0].velocity.norm() < 1.95 && now.bodies[0].position.y() > 1.25 ? 0 : 1;
    EXPECT_NEAR(now.bodies[ball].velocity.y(), A * w * std::cos(w * t), 1e-6) << space;
  }
}

// What is moved goes on with its velocity; the wind that comes up carries a ball: v = u (1 - exp(-c t / m)).
TEST(Events, MovedBodiesAreLetGoAndWindComesUp) {
  for (const char* mode : {"event", "contact"}) {
    const std::string text =
        open_room(mode, false, "position = [6, 6]\nmass = 2\ndrag = 0.5", "gravity = [0, 0]") +
        "[[box]]\nname = \"cart\"\nposition = [1, 1]\nmotion = { x = \"t^2\" }\n" +
        when("value = \"cart.x > 1.49\"", "{ release = \"cart\" }") +
        when("time = 0.5", "{ set = \"room.wind\", to = [3, 0] }");
    const auto run = run_of(text);
    const sim::Snapshot now = snapshot_at(*run, 1.5);
    const bool first = run->scene_info().bodies[0].name == "cart";
    const double late = std::string(mode) == "event" ? 1e-9 : 1.0 / 600;
    EXPECT_NEAR(now.bodies[first ? 0 : 1].velocity.x(), 1.4, 2 * late) << mode;
    EXPECT_NEAR(now.bodies[first ? 0 : 1].position.x(), 1.49 + 1.4 * 0.8, 2 * late) << mode;
    EXPECT_NEAR(now.bodies[first ? 1 : 0].velocity.x(), 3 * (1 - std::exp(-0.25)), 1e-10) << mode;
  }
}

// An action may make another condition true at the same instant.
TEST(Events, ActionsMakeConditionsTrue) {
  const std::string text =
      open_room("event", false, "position = [0, 3]") +
      when("value = \"ball.speed > 1\"", "{ set = \"ball.fixed\", to = true }", "again = true") +
      when("value = \"ball.speed < 0.5\"", "{ release = \"ball\" }", "again = true");
  const auto run = run_of(text);
  // held at 1 m/s and let go at once, each g^-1 s: the same times in pairs
  snapshot_at(*run, 1);
  const auto events = run->events();
  ASSERT_EQ(events.size(), 18u);
  for (std::size_t i = 0; i < events.size(); ++i)
    EXPECT_NEAR(sim::value(events[i].time), double(i / 2 + 1) / kFalling, 1e-11) << i;
}

// A body is fixed where it is and let go again.
TEST(Events, ABodyIsHeldAndLetGo) {
  for (const char* mode : {"event", "contact"}) {
    const std::string text = open_room(mode, false, "position = [0, 3]") +
                             when("time = 0.4", "{ set = \"ball.fixed\", to = true }") +
                             when("time = 0.7", "{ release = \"ball\" }");
    const auto run = run_of(text);
    const double y = 3 - kFalling / 2 * 0.16;
    EXPECT_NEAR(snapshot_at(*run, 0.5).bodies[0].position.y(), y, 1e-12) << mode;
    EXPECT_EQ(snapshot_at(*run, 0.6).bodies[0].velocity.norm(), 0) << mode;
    EXPECT_NEAR(snapshot_at(*run, 0.9).bodies[0].position.y(), y - kFalling / 2 * 0.04, 1e-12) << mode;
  }
}

// After a stop nothing moves.
TEST(Events, AStopHoldsTheInstant) {
  const std::string text =
      open_room("event", false, "position = [0, 3]") + when("value = \"ball.y < 2\"", "{ stop = true }");
  const double t = std::sqrt(2 / kFalling);
  const auto run = run_of(text);
  for (const double later : {0.5, 0.77, 3.0}) {
    const sim::Snapshot now = snapshot_at(*run, later);
    EXPECT_NEAR(now.bodies[0].position.y(), 2, 1e-12);
    EXPECT_NEAR(now.bodies[0].velocity.y(), -kFalling * t, 1e-12);
  }
}

// Under `event` a rope breaks when its load, m g + F, is what it bears, and the ball falls from there. All
// pieces of a rope over a wheel break together.
TEST(Events, UnderEventABreakIsAtItsExactTime) {
  for (const bool space : {false, true}) {
    for (const double k : {0.0, 40.0}) {
      // F = 20 t + k t^2 / 2
      const std::string text = open_room("event", space, "mass = 1\nposition = " + spot(space, 2, 3)) +
                               "[[joint]]\nname = \"rope\"\ntype = \"rod\"\nbetween = [\"ball\", " +
                               spot(space, 2, 5) +
                               "]\nbreaks = 20\n[[force]]\nof = \"ball\"\ncomponents = [\"0\", " +
                               fmt::format("\"-20*t - {}*t^2/2\"{}]\n", k, space ? ", \"0\"" : "");
      const double F = 20 - kFalling, t = k == 0 ? F / 20 : (-20 + std::sqrt(400 + 2 * k * F)) / k;
      const auto events = events_until(text + when("breaks = \"rope\""), 2);
      ASSERT_EQ(events.size(), 1u) << space << k;
      EXPECT_NEAR(sim::value(events[0].time), t, kInTime) << space << k;
      // y'' = -(g + F), whether a condition looks at it or not
      const auto speed = [&](double s) { return kFalling * s + 10 * s * s + k * s * s * s / 6; };
      const auto way = [&](double s) {
        return kFalling * s * s / 2 + 10 * s * s * s / 3 + k * s * s * s * s / 24;
      };
      const double at = 1, fall = way(at) - way(t) - speed(t) * (at - t);
      for (const std::string& looks : {std::string(), when("breaks = \"rope\"")}) {
        const auto run = run_of(text + looks);
        EXPECT_NEAR(snapshot_at(*run, at).bodies[0].position.y(), 3 - fall, 1e-9) << space << k << looks;
      }
    }
  }
  const std::string rope =
      "[room]\nsize = [8, 8]\nwalls = \"none\"\n[physics]\ncollision = \"event\"\n[[particle]]\nname = "
      "\"a\"\nposition = [1, 2]\n[[particle]]\nname = \"b\"\nposition = [2, 2]\n"
      "[[ball]]\nname = \"w\"\nradius = 0.5\nposition = [1.5, 4]\n[[joint]]\ntype = \"pin\"\n"
      "between = [\"w\", \"room\"]\n[[joint]]\nname = \"rope\"\ntype = \"pulley\"\nbetween = [\"a\", "
      "\"b\"]\nover = [\"w\"]\nbreaks = 12\n[[force]]\nof = \"b\"\ncomponents = [\"0\", \"-20*t\"]\n";
  const auto events =
      events_until(rope + when("breaks = \"rope\"", "{ mark = \"snap\" }", "again = true"), 2);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].time, events[1].time);
}

// In other modes at the end of the step.
TEST(Events, ABreakIsSeen) {
  for (const char* solver : {"direct", "iterative"}) {
    const std::string text =
        fmt::format(
            "[room]\nsize = [8, 8]\nwalls = \"none\"\n[physics]\nsolver = \"{}\"\n[[ball]]\nname = \"ball\"\n"
            "radius = 0.1\nmass = 1\nposition = [2, 2]\n[[joint]]\nname = \"rope\"\ntype = \"rod\"\n"
            "between = [\"ball\", [2, 4]]\nbreaks = 20\n[[force]]\nof = \"ball\"\ncomponents = [\"0\", "
            "\"-20*t\"]\n",
            solver) +
        when("breaks = \"rope\"", "{ mark = \"snap\" }");
    const auto events = events_until(text, 1);
    ASSERT_EQ(events.size(), 1u) << solver;
    EXPECT_NEAR(sim::value(events[0].time), (20 - kFalling) / 20, 2.0 / 600) << solver;
    EXPECT_THAT(events[0].of, ElementsAre("rope"));
  }
}

// A joint is taken away: the pendulum flies off with its velocity.
TEST(Events, AJointIsReleased) {
  for (const char* solver : {"direct", "iterative"}) {
    const std::string text =
        fmt::format(
            "[room]\nsize = [8, 8]\nwalls = \"none\"\ngravity = [0, 0]\n[physics]\nsolver = "
            "\"{}\"\n[[ball]]\n"
            "name = \"ball\"\nradius = 0.1\nmass = 1\nposition = [3, 2]\nvelocity = [0, 1]\n[[joint]]\n"
            "name = \"rod\"\ntype = \"rod\"\nbetween = [\"ball\", [2, 2]]\n",
            solver) +
        when("value = \"ball.x < 2\"", "{ release = \"rod\" }");
    const auto run = run_of(text);
    EXPECT_NEAR(snapshot_at(*run, 3).bodies[0].velocity.x(), -1, 1e-2) << solver;
    EXPECT_NEAR(snapshot_at(*run, 4).bodies[0].position.x(), 2 - (4 - std::acos(-1) / 2), 1e-2) << solver;
  }
}

// Marks change nothing: the states of a run with them are those without, to the bit.
TEST(Events, MarksChangeNothing) {
  const std::string plain =
      "[room]\nsize = [4, 3]\n[physics]\ncollision = \"event\"\n[[ball]]\nname = \"ball\"\nradius = 0.1\n"
      "position = [1, 2]\nvelocity = [2.3, 0]\n";
  const std::string marked = plain +
                             when("touches = [\"ball\", \"wall[*]\"]", "{ mark = \"hit\" }", "again = true") +
                             when("value = \"ball.vy > 0\"", "{ mark = \"up\" }", "again = true");
  const auto a = run_of(plain), b = run_of(marked);
  for (const double t : {0.31, 1.0, 2.71}) {
    const sim::Snapshot p = snapshot_at(*a, t), q = snapshot_at(*b, t);
    EXPECT_EQ(p.bodies[0].position, q.bodies[0].position);
    EXPECT_EQ(p.bodies[0].velocity, q.bodies[0].velocity);
  }
  EXPECT_GT(b->events().size(), 5u);
  EXPECT_NE(a->words(), b->words());
}

const char* const kMachine = R"(
[room]
size = [4, 3]
[physics]
collision = "%"
[[ball]]
name = "ball"
radius = 0.1
position = [1, 2]
velocity = [2.3, 0]
elasticity = 0.9
[[box]]
name = "gate"
size = [0.5, 0.5]
position = [3, 2.2]
fixed = true
[[when]]
touches = ["ball", "floor"]
again = true
do = [{ mark = "hit" }, { set = "room.gravity", to = [0, -5] }]
[[when]]
value = "ball.y > 0.5"
again = true
do = [{ set = "room.gravity", to = [0, -9.81] }]
[[when]]
crosses = { body = "ball", from = [2, 0], to = [2, 3] }
again = true
do = [{ mark = "line" }, { release = "gate" }]
[[when]]
leaves = ["ball", "wall[*]"]
again = true
do = [{ mark = "off" }]
)";

std::string machine(const char* mode) {
  std::string text = kMachine;
  text.replace(text.find('%'), 1, mode);
  return text;
}

// One list for every frame rate and for a run that goes on from a checkpoint, and one state.
TEST(Events, TheListIsOneHoweverARunIsSeen) {
  for (const char* mode : {"event", "contact"}) {
    const std::string text = machine(mode);
    const auto whole = run_of(text);
    snapshot_at(*whole, 3);
    const auto listed = [](const sim::Run& run) {
      std::string all;
      for (const auto& event : run.events()) all += fmt::format("{} {}\n", sim::text(event.time), event.name);
      return all;
    };
    const std::string list = listed(*whole);
    ASSERT_GT(whole->events().size(), 8u);
    for (const int fps : {24, 30, 60, 1000}) {
      const auto run = run_of(text);
      for (int i = 0; i <= 3 * fps; ++i) run->at(sim::rational(i, fps));
      EXPECT_EQ(listed(*run), list) << fps;
      EXPECT_EQ(run->words(), whole->words()) << fps;
    }
    const Scene scene = parse(text, "a.toml");
    for (const double t : {0.4, 1.0, 2.2}) {
      const auto before = scene.run();
      snapshot_at(*before, t);
      const auto after = scene.run(before->saved());
      ASSERT_TRUE(after);
      snapshot_at(*after, 3);
      EXPECT_EQ(listed(*after), list) << t;
      EXPECT_EQ(after->words(), whole->words()) << t;
    }
  }
}

// Mirror images have mirrored events at the same times.
TEST(Events, MirroredRunsFireTogether) {
  std::string text = machine("event"), mirrored = text;
  const auto put = [&](const std::string& a, const std::string& b) {
    mirrored.replace(mirrored.find(a), a.size(), b);
  };
  put("position = [1, 2]", "position = [3, 2]"), put("[2.3, 0]", "[-2.3, 0]"), put("[3, 2.2]", "[1, 2.2]");
  const auto a = times_until(text, 2), b = times_until(mirrored, 2);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-11);
}

// On a table with the acceleration -c t a block presses with m (g - c t), and friction takes it along with m
// c t. A pendulum of 1 m that starts level has 3 m g sin(phi) in its rod.
TEST(Events, ReadForces) {
  constexpr double c = 20, m = 2;
  const auto on_table = [&](const char* mode, bool space, const char* along, const std::string& condition) {
    return fmt::format(
               "duration = 2\n[room]\nsize = {0}\nwalls = \"none\"\n[physics]\ncollision = \"{1}\"\n"
               "[[box]]\nname = \"table\"\nsize = {2}\nposition = {3}\nmotion = {{ {4} = \"-{5}*t^3/6\" }}\n"
               "[[box]]\nname = \"block\"\nsize = {6}\nmass = {7}\nposition = {8}\nfriction = 1\n",
               space ? "[8, 8, 8]" : "[8, 8]", mode, space ? "[4, 0.2, 4]" : "[4, 0.2]", spot(space, 0, 2),
               along, c, space ? "[0.4, 0.4, 0.4]" : "[0.4, 0.4]", m, spot(space, 0, 2.3)) +
           when(condition);
  };
  for (const bool space : {false, true}) {
    for (const auto& [along, condition, t] :
         {std::tuple("y", fmt::format("value = \"block.normal_force < {}\"", m * kFalling / 2),
                     kFalling / 2 / c),
          std::tuple("y", fmt::format("value = \"block.contact < {}\"", m * kFalling / 4),
                     0.75 * kFalling / c),
          std::tuple("x", std::string("value = \"block.friction > 7.7\""), 7.7 / m / c)}) {
      const std::vector<double> exact = times_until(on_table("event", space, along, condition), 1);
      ASSERT_EQ(exact.size(), 1u) << condition << space;
      EXPECT_NEAR(exact[0], t, kInTime) << condition << space;
      const std::vector<double> steps = times_until(on_table("contact", space, along, condition), 1);
      ASSERT_EQ(steps.size(), 1u) << condition << space;
      EXPECT_NEAR(steps[0], std::ceil(t * 600) / 600, 1e-12) << condition << space;
    }
    for (const char* what : {"rod.force", "ball.joint_force"}) {
      const std::string text = open_room("event", space, "mass = 1\nposition = " + spot(space, 1, 3)) +
                               "[[joint]]\nname = \"rod\"\ntype = \"rod\"\nbetween = [\"ball\", " +
                               spot(space, 0, 3) + "]\n" +
                               when(fmt::format("value = \"{} > {}\"", what, 2 * kFalling));
      const auto events = events_until(text, 1);
      ASSERT_EQ(events.size(), 1u) << what << space;
      const auto run = run_of(text);
      const auto now = std::get<sim::Snapshot>(run->at(events[0].time));
      // the scheme's error of the swing
      EXPECT_NEAR(now.bodies[0].position.y(), 3 - 2.0 / 3, 1e-8) << what << space;
    }
    const std::string text = open_room("event", space, "mass = 1\nposition = " + spot(space, 0, 3)) +
                             "[[spring]]\nbetween = [\"ball\", " + spot(space, 0, 4) +
                             "]\nstiffness = 40\nrest_length = 1\n" +
                             when("value = \"ball.spring_force > 8\"");
    const std::vector<double> times = times_until(text, 1);
    ASSERT_EQ(times.size(), 1u);
    // 0.2 m = (m g / k) (1 - cos w t)
    EXPECT_NEAR(times[0], std::acos(1 - 0.2 * 40 / kFalling) / std::sqrt(40.0), kInTime);
  }
}

// Ties are served in the order of the file.
TEST(Events, TiesAreInTheOrderOfTheFile) {
  const std::string text =
      open_room("event", false, "position = [0, 3]") +
      when("value = \"ball.y < 2\"", "{ mark = \"b\" }", "name = \"b\"") +
      when("crosses = { body = \"ball\", from = [-1, 2], to = [1, 2] }", "{ mark = \"a\" }", "name = \"a\"");
  const auto events = events_until(text, 1);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].name, "b");
  EXPECT_EQ(events[0].time, events[1].time);
}

TEST(Events, MistakesAreToldWithTheirPlace) {
  const std::string ball = open_room("event", false, "position = [0, 3]");
  const auto with = [&](const std::string& condition, const std::string& actions = "{ mark = \"hit\" }") {
    return wrong_with(ball + when(condition, actions));
  };
  EXPECT_THAT(
      with("value = \"bal.y < 1\""),
      HasSubstr("a.toml:13:10: 'value', column 1: nothing is called 'bal.y' here; did you mean 'ball.y'?"));
  EXPECT_THAT(with("value = \"2 + ball.mass < 1\""),
              HasSubstr("column 5: 'ball.mass' is not what conditions read"));
  EXPECT_THAT(with("value = \"ball.force > 1\""),
              HasSubstr("'ball.force' is of a joint, and this is a body"));
  EXPECT_THAT(wrong_with(ball + "[[joint]]\nname = \"rod\"\ntype = \"rod\"\nbetween = [\"ball\", [0, 4]]\n" +
                         when("value = \"rod.length > 1\"")),
              HasSubstr("'rod.length' is not what conditions read of a joint: force"));
  EXPECT_THAT(with("value = \"ball.y\""), HasSubstr("compares nothing"));
  EXPECT_THAT(with("value = \"ball.y == 1\""), HasSubstr("== and != hold for an instant"));
  EXPECT_THAT(with("value = \"ball.z < 1\""), HasSubstr("is of space"));
  EXPECT_THAT(with("touches = [\"ball\", \"flor\"]"), HasSubstr("no body is called 'flor'"));
  EXPECT_THAT(with("touches = [\"ball\", \"floor\"]"), HasSubstr("the room has no 'floor'"));
  EXPECT_THAT(wrong_with("[room]\nsize = [4, 3]\n[[ball]]\nname = \"floor\"\nposition = [1, 1]\n[[ball]]\n"
                         "name = \"ball\"\nposition = [3, 1]\n" +
                         when("touches = [\"ball\", \"floor\"]")),
              HasSubstr("'floor' is a body, and a wall of the room, which is wall[0] too"));
  EXPECT_THAT(with("breaks = \"rope\""), HasSubstr("no joint or bond is called 'rope'"));
  EXPECT_THAT(with("time = 1", "{ release = \"ball\" }"), HasSubstr("'ball' is free"));
  EXPECT_THAT(with("time = 1", "{ set = \"ball.elasticity\", to = 2 }"),
              HasSubstr("'ball.elasticity' stays as it is while the room runs"));
  EXPECT_THAT(with("time = 1", "{ set = \"room.gravity\" }"), HasSubstr("needs 'to'"));
  EXPECT_THAT(with("time = 1", "{ set = \"room.gravity\", to = 3 }"), HasSubstr("'set': 'gravity'"));
  EXPECT_THAT(with("time = 1", "{ mark = \"max\" }"), HasSubstr("is a word of --measure"));
  EXPECT_THAT(with("time = 1\nvalue = \"ball.y < 1\""), HasSubstr("expected one"));
  EXPECT_THAT(with("time = 1", "{ }"), HasSubstr("an action does one thing"));
  EXPECT_THAT(wrong_with(ball + "[[film.point]]\nat = \"ball\"\nstart = \"hut\"\n" + when("time = 1")),
              HasSubstr("no [[when]] makes a mark 'hut'; did you mean 'hit'?"));
  EXPECT_THAT(wrong_with("[physics]\ncollision = \"handout\"\n[[particle]]\nname = \"a\"\n[[particle]]\nname "
                         "= \"b\"\nposition = [1, 1]\n" +
                         when("touches = [\"a\", \"b\"]")),
              HasSubstr("do not touch in collision = \"handout\""));
  // two on a joint that stays
  const std::string pair = ball +
                           "[[ball]]\nname = \"bob\"\nradius = 0.1\nposition = [1, 3]\n[[joint]]\nname = "
                           "\"rod\"\ntype = \"rod\"\nbetween = [\"ball\", \"bob\"]\n",
                    meet = when("touches = [\"ball\", \"bob\"]");
  EXPECT_THAT(wrong_with(pair + meet), HasSubstr("'touches': 'ball' and 'bob' are joined by 'rod'"));
  EXPECT_EQ(wrong_with(pair + "touching = true\n" + meet), "");
  EXPECT_EQ(wrong_with(pair + "breaks = 5\n" + meet), "");
  EXPECT_EQ(wrong_with(pair + meet + when("time = 1", "{ release = \"rod\" }")), "");
  EXPECT_EQ(wrong_with(ball + when("time = 1"), {"when[0].time=2"}), "");
}

// The times of marks stand where a film and a figure name them; what waits for one that is not made is left
// out, and a stop shortens the film.
TEST(Events, MarksStandForTimes) {
  const std::string text =
      open_room("event", false, "position = [0, 3]") + when("value = \"ball.y < 2\"") +
      when("time = 3", "{ stop = true }") +
      "[figure]\nmark = \"hit\"\n[[film.label]]\nat = [0, 0]\ntext = \"a\"\nstart = \"hit\"\n"
      "end = { time = \"hit\", after = 0.5 }\n[[film.label]]\nat = [0, 0]\ntext = \"b\"\nstart = "
      "\"hit[2]\"\nend = 2\n"
      "[film]\nspeed = [{ time = 0 }, { time = \"hit\", freeze = 1 }]\n";
  std::string ordered = text;
  const Scene first = parse(ordered, "a.toml");
  EXPECT_THAT(first.marks, testing::UnorderedElementsAre("hit", "hit[2]"));
  EXPECT_FALSE(first.marked);
  RunMarks marks;
  marks.instants["hit"] = {sim::rational(451524, 1'000'000)};
  marks.stop = sim::rational(3);
  const Scene put = parse(ordered, "a.toml", {}, &marks);
  EXPECT_EQ(put.duration, sim::rational(3));
  ASSERT_EQ(put.figure.at.size(), 1u);
  EXPECT_EQ(put.figure.at[0], sim::rational(451524, 1'000'000));
  ASSERT_EQ(put.film.marks.labels.size(), 2u);
  EXPECT_NEAR(put.film.marks.labels[0].shown.start->time, 0.451524, 1e-12);
  EXPECT_NEAR(put.film.marks.labels[0].shown.end->film, 0.951524, 1e-9);
  EXPECT_GT(put.film.marks.labels[1].shown.start->time, 1e5);
  ASSERT_EQ(put.film.speed.frozen().size(), 1u);
  EXPECT_EQ(put.film.speed.frozen()[0].world, sim::rational(451524, 1'000'000));
}

// A value that is zero at rest, and true from the first moment on, fires once.
TEST(Events, AValueThatBecomesTrueFromRestFiresOnce) {
  for (const char* collision : {"event", "contact"}) {
    const Scene scene =
        parse(std::string("[room]\nsize = [8, 30]\n[physics]\ncollision = \"") + collision +
                  "\"\n[[particle]]\nname = \"p\"\nposition = [4, 20]\n[[when]]\nvalue = \"p.vy < 0\"\n"
                  "again = true\ndo = [{ set = \"room.gravity\", to = [0, -9.81] }]\n",
              "a.toml");
    const auto run = scene.run();
    ASSERT_TRUE(std::holds_alternative<sim::Snapshot>(run->at(sim::rational(1)))) << collision;
    EXPECT_EQ(run->events().size(), 1u) << collision;
  }
}

// What sleeps on the floor touches it when it is struck, too, and before.
TEST(Events, WhatSleepsIsNotLostAndFoundWhenItIsStruck) {
  for (const char* collision : {"event", "contact"}) {
    const Scene scene =
        parse(std::string("[room]\nsize = [6, 4]\n[physics]\ncollision = \"") + collision +
                  "\"\n[[box]]\nname = \"a\"\nsize = [0.4, 0.4]\nposition = [3, 0.2]\nelasticity = 0\n"
                  "[[box]]\nname = \"b\"\nsize = [0.4, 0.4]\nposition = [3, 2]\nelasticity = 0\n"
                  "[[when]]\ntouches = [\"a\", \"floor\"]\nagain = true\ndo = [{ mark = \"floor\" }]\n"
                  "[[when]]\nleaves = [\"a\", \"floor\"]\nagain = true\ndo = [{ mark = \"up\" }]\n"
                  "[[when]]\ntouches = [\"a\", \"b\"]\ndo = [{ mark = \"ab\" }]\n",
              "a.toml");
    const auto run = scene.run();
    ASSERT_TRUE(std::holds_alternative<sim::Snapshot>(run->at(sim::rational(9, 10)))) << collision;
    const auto all = run->events();
    ASSERT_EQ(all.size(), 1u) << collision;
    EXPECT_EQ(all[0].marks, std::vector<std::string>{"ab"});
  }
}

// A run may end within a step: what fires in it until then is told.
TEST(Events, OfTheLastPartOfAStepAreListed) {
  const Scene scene = parse(
      "[room]\nsize = [8, 30]\n[physics]\ncollision = \"event\"\nrate = 10\n[[particle]]\nname = \"p\"\n"
      "position = [4, 20]\nvelocity = [1, 0]\n[[when]]\nvalue = \"p.x > 4.63\"\ndo = [{ mark = \"a\" }]\n"
      "[[when]]\nvalue = \"p.x > 4.67\"\ndo = [{ mark = \"b\" }]\n",
      "a.toml");
  const auto run = scene.run();
  const sim::Rational end = sim::rational(65, 100);
  run->at(end);
  const auto all = sim::events_until(*run, end);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_NEAR(sim::value(all[0].time), 0.63, 1e-12);
}

// An impact on bonded bodies counts as a force of its impulse over the bond's impact_duration. A cube that a
// bond holds on another is stopped with it from v = 3 m/s: m v / T.
TEST(Events, ABondBreaksByAnImpactOfItsDuration) {
  const double m = 2, v = 3;
  for (const int dimension : {2, 3}) {
    const std::string deep = dimension == 2 ? "" : ", 0.2", z = dimension == 2 ? "" : ", 0";
    for (const double lasts : {0.001, 0.02}) {
      for (const double share : {0.999, 1.001}) {
        std::string text =
            fmt::format("duration = 0.2\n[room]\nwalls = \"ground\"\nsize = [4, 4{}]\ngravity = [0, 0{}]\n",
                        dimension == 2 ? "" : ", 4", z);
        for (int i = 0; i < 2; ++i)
          text += fmt::format(
              "[[box]]\nname = \"b{}\"\nsize = [0.2, 0.2{}]\nmass = {}\nposition = [1, {}{}]\n"
              "velocity = [0, -{}{}]\nelasticity = 0\n",
              i, deep, m, 0.4 + 0.2 * i, z, v, z);
        text += fmt::format(
            "[[bond]]\nname = \"glue\"\nof = [\"b0\", \"b1\"]\nbreaks = {}\n{}[[when]]\nbreaks = "
            "\"glue\"\ndo = "
            "[{{ mark = \"broke\" }}]\n",
            share * m * v / lasts, lasts == 0.001 ? "" : fmt::format("impact_duration = {}\n", lasts));
        const TextRun run(text);
        run.at(0.2);
        EXPECT_EQ(run.run->events().size(), share < 1 ? 1u : 0u) << dimension << " " << lasts << " " << share;
      }
    }
  }
}

// `event` promises exact times, and bonded bodies are known at the ends of steps.
TEST(Events, OfBondsAreRefusedWhereTimesAreExact) {
  const std::string pieces =
      "[[box]]\nname = \"piece\"\nsize = [0.2, 0.2]\nposition = [1, 1]\ncopies = { count = 2, offset = [0.2, "
      "0] }\n[[bond]]\nname = \"glue\"\nof = [\"piece[*]\"]\nbreaks = 30\n";
  const std::string snaps = "[[when]]\nbreaks = \"glue\"\ndo = [{ mark = \"snap\" }]\n";
  EXPECT_THAT(wrong_with("[physics]\ncollision = \"event\"\n" + pieces + snaps),
              HasSubstr("at the end of a step"));
  EXPECT_EQ(wrong_with("[physics]\ncollision = \"contact\"\n" + pieces + snaps), "");
  EXPECT_EQ(wrong_with("[physics]\ncollision = \"event\"\n" + pieces +
                       "[[when]]\ntime = 0.5\ndo = [{ stop = true }]\n"),
            "");
}

// Under `event` what slides over the edge of a table leaves it when its last corner does, whatever the rate;
// and one that tips about the edge does so from where its middle is over it.
TEST(Events, OverAnEdgeComeInTheirTime) {
  for (const bool space : {false, true}) {
    for (const bool turns : {false, true}) {
      const std::string z = space ? ", 0" : "", wide = space ? ", 2" : "", deep = space ? ", 0.2" : "";
      const auto run = [&](int rate) {
        return TextRun((space ? space_without_walls(kManners[1], "gravity = [0, -9.81, 0]")
                              : plane_without_walls(kManners[1])) +
                           "[[box]]\nname = \"table\"\nsize = [2, 1" + wide + "]\nposition = [-1, -0.5" + z +
                           "]\nfixed = true\nfriction = 0\n[[box]]\nname = \"b\"\nsize = [0.2, 0.2" + deep +
                           "]\nposition = [-0.5, 0.1" + z + "]\nvelocity = [1.3, 0" + z +
                           "]\nfriction = 0\nelasticity = 0\nrotation = " + (turns ? "true" : "false") +
                           "\n[[when]]\nleaves = [\"b\", \"table\"]\ndo = [{ mark = \"off\" }]\n",
                       {fmt::format("physics.rate={}", rate)});
      };
      double spin[3];
      int k = 0;
      for (const int rate : {100, 173, 600}) {
        const TextRun one = run(rate);
        const sim::Snapshot now = one.at(0.7);
        const auto events = one.run->events();
        ASSERT_EQ(events.size(), 1u) << space << turns << rate;
        if (!turns) {
          EXPECT_NEAR(sim::value(events[0].time), 0.6 / 1.3, 1e-9) << space << rate;
        }
        spin[k++] = std::max(now.bodies[0].spin.norm(), now.bodies[1].spin.norm());
      }
      EXPECT_NEAR(spin[0], spin[2], 3e-5) << space;
      EXPECT_NEAR(spin[1], spin[2], 3e-5) << space;
      if (turns) {
        EXPECT_NEAR(spin[2], 2.4716, 4e-4) << space;
      }
    }
  }
}

// What a belt carries beyond its end leaves it there, though it does not slip.
TEST(Events, ABeltIsLeftAtItsEnd) {
  for (const int side : {1, -1}) {
    for (const int rate : {100, 600}) {
      const TextRun run(
          plane_without_walls(kManners[1]) +
              fmt::format(
                  "[[box]]\nname = \"belt\"\nsize = [2, 1]\nposition = [0, -0.5]\nfixed = true\n"
                  "surface_speed = {}\n[[box]]\nname = \"b\"\nsize = [0.2, 0.2]\nposition = [{}, 0.1]\n"
                  "velocity = [{}, 0]\nelasticity = 0\nrotation = false\n"
                  "[[when]]\nleaves = [\"b\", \"belt\"]\ndo = [{{ mark = \"off\" }}]\n",
                  1.3 * side, 0.5 * side, 1.3 * side),
          {fmt::format("physics.rate={}", rate)});
      run.at(0.7);
      const auto events = run.run->events();
      ASSERT_EQ(events.size(), 1u) << side << rate;
      EXPECT_NEAR(sim::value(events[0].time), 0.6 / 1.3, 1e-9) << side << rate;
    }
  }
}

// A table that swings faster than things fall is left where its acceleration is -g, told in that step.
TEST(Events, AShakenTableIsLeftWhereItFallsFasterThanG) {
  const double A = 0.1, w = 12;  // A w^2 = 14.4
  const double leaves = std::asin(9.81 / (A * w * w)) / w;
  for (const Manner& manner : kManners) {
    for (const bool space : {false, true}) {
      for (const int rate : {300, 600}) {
        const std::string z = space ? ", 0" : "", wide = space ? ", 2" : "", deep = space ? ", 0.2" : "";
        const TextRun run(
            (space ? space_without_walls(manner, "gravity = [0, -9.81, 0]") : plane_without_walls(manner)) +
                "[[box]]\nname = \"table\"\nsize = [2, 0.2" + wide + "]\nposition = [0, -0.1" + z +
                "]\nmotion = { y = \"0.1*sin(12*t)\" }\n[[box]]\nname = \"b\"\nsize = [0.2, 0.2" + deep +
                "]\nposition = [0, 0.1" + z + "]\nvelocity = [0, 1.2" + z +
                "]\nelasticity = 0\n[[when]]\nleaves = [\"b\", \"table\"]\ndo = [{ mark = \"off\" }]\n",
            {fmt::format("physics.rate={}", rate)});
        run.at(0.2);
        const auto events = run.run->events();
        ASSERT_GE(events.size(), 1u) << manner.name << space << rate;
        const double late = sim::value(events[0].time) - leaves;
        EXPECT_GT(late, -1e-9) << manner.name << space << rate;
        EXPECT_LT(late, manner.name == "event" ? 1e-6 : 2.0 / rate) << manner.name << space << rate;
      }
    }
  }
}

// A box's corner clips another's so that both are apart at all steps: found wherever the steps fall, by
// events and by the direct solver. e = 1 and no friction: energy stays, and the box turns afterwards.
TEST(Events, ACornerThatClipsAnotherBetweenTwoStepsIsFound) {
  for (const int dimension : {2, 3}) {
    const char *size = dimension == 3 ? ", 0.5" : "", *z = dimension == 3 ? ", 0" : "";
    for (const std::string& manner : {std::string("collision = 'event'"), std::string("solver = 'direct'")}) {
      for (const int rate : {60, 240}) {
        double turned = 0;
        for (int shift = 0; shift < 8; ++shift) {
          const double back = 10.0 * shift / 8 / rate;
          const TextRun run(
              fmt::format(
                  "duration = 1\n[room]\nsize = [40, 40{}]\ncorner = [-20, -20{}]\nwalls = 'none'\ngravity = "
                  "[0, 0{}]\n[physics]\n{}\nrate = {}\n",
                  dimension == 3 ? ", 40" : "", dimension == 3 ? ", -20" : "", z, manner, rate) +
              fmt::format(
                  "[[box]]\nname = 'f'\nfixed = true\nsize = [2, 2{0}]\nposition = [0, 0{1}]\nelasticity = "
                  "1\nfriction = 0\n[[box]]\nname = 'b'\nsize = [0.4, 0.4{0}]\nposition = [{2:.15g}, "
                  "{3:.15g}{1}]\nvelocity = [10, -10{1}]\nmass = 1\nelasticity = 1\nfriction = 0\n",
                  size, z, 0.151262265521468 - back, 2.234595598854802 + back));
          const sim::Snapshot::Body now = run.at(0.25).bodies[std::size_t(number_of(run, "b"))];
          const double inertia = 0.4 * 0.4 / 6;
          EXPECT_NEAR(now.velocity.squaredNorm() + inertia * now.spin.squaredNorm(), 200, 1e-6)
              << dimension << manner << rate << " " << shift;
          EXPECT_GT(now.spin.norm(), 10) << dimension << manner << rate << " " << shift;
          if (shift == 0) turned = now.spin.z();
          EXPECT_NEAR(now.spin.z(), turned, 1e-6) << dimension << manner << rate << " " << shift;
        }
      }
    }
  }
}

}  // namespace
}  // namespace obscura::scene
