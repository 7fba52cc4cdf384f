// Everything that can be wrong with a scene, each with its line: place, what was expected, what was probably
// meant.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "scene/error.h"
#include "scene/scene.h"

namespace obscura::scene {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

// the complaints of a scene, one line each
std::vector<std::string> wrong(const std::string& text, const std::vector<std::string>& sets = {}) {
  try {
    parse(text, "a.toml", sets);
  } catch (const Error& error) {
    std::vector<std::string> lines;
    for (const Complaint& complaint : error.complaints) lines.push_back(complaint.text());
    return lines;
  }
  return {};
}

// `text` is refused in one line and no other
void refused(const std::string& text, const std::string& line) {
  EXPECT_THAT(wrong(text), ElementsAre(line)) << text;
}

TEST(Diagnostics, UnknownKeysSayWhatWasMeant) {
  refused("duratoin = 3", "a.toml:1:1: unknown key 'duratoin'; did you mean 'duration'?");
  refused("[[box]]\nelastcity = 1",
          "a.toml:2:1: unknown key 'elastcity' in [[box]]; did you mean 'elasticity'?");
  refused("[[spring]]\nlength = 1\nbetween = [\"particle[0]\", [1, 1]]\n[[particle]]",
          "a.toml:2:1: unknown key 'length' in [[spring]]; did you mean 'rest_length'?");
  refused("[sprng]\n", "a.toml:1:2: unknown key 'sprng'; did you mean 'spring'?");
  refused("[[rod]]\n", "a.toml:1:3: unknown key 'rod'; did you mean [[joint]], type = \"rod\"?");
  refused("[[box]]\ncopies = { count = 2, jiter = 1 }",
          "a.toml:2:23: unknown key 'jiter' in 'copies'; did you mean 'jitter'?");
}

TEST(Diagnostics, TablesNobodyKnowsAreToldWhichThereAre) {
  refused("[[wall]]", "a.toml:1:3: unknown key 'wall'; 'walls': it belongs in [room]");
  refused(
      "[[wheel]]",
      "a.toml:1:3: unknown key 'wheel'; there are [[particle]], [[ball]], [[box]], [[polygon]], [[body]], "
      "[[spring]], [[net]], [[joint]], [[chain]], [[bond]], [[explosion]], [[track]], [[force]], "
      "[[attractor]], [[when]], [[mouse]]");
}

TEST(Diagnostics, KeysThatCanDoNothingAreTold) {
  const std::string ball = "[[ball]]\n", none = "[room]\nwalls = \"none\"\n";
  const auto all_told = [](const std::string& text, const std::string& told) {
    const auto lines = wrong(text);
    EXPECT_EQ(lines.size(), 1u) << text;
    if (!lines.empty()) {
      EXPECT_THAT(lines[0], HasSubstr(told)) << text;
    }
  };
  all_told(ball + "[room]\nwind = [1, 0]", "'wind' does nothing");
  EXPECT_TRUE(wrong(ball + "[room]\nwind = [1, 0]\ndrag = 0").empty()) << "given, and none is meant";
  EXPECT_TRUE(wrong(ball + "drag = 1\n[room]\nwind = [1, 0]").empty());
  EXPECT_TRUE(wrong(ball + "[room]\nwind = [0, 0]").empty());
  all_told(ball + "[room]\nsoftening = 1", "'softening' does nothing");
  for (const std::string key : {"electric = [1, 0]", "magnetic = 1", "coulomb = 1"}) {
    all_told(ball + "[room]\n" + key, "no body has a 'charge'");
    EXPECT_TRUE(wrong(ball + "charge = 0\n[room]\n" + key).empty());
    EXPECT_TRUE(wrong(ball + "name = \"a\"\n[room]\n" + key +
                      "\n[[when]]\ntime = 1\ndo = [{ set = \"a.charge\", to = 1 }]")
                    .empty());
  }
  EXPECT_TRUE(
      wrong("[[ball]]\nname = \"a\"\ncopies = { count = 2, offset = [0.5, 0] }\n[room]\nelectric = [1, 0]",
            {"a[1].charge=1"})
          .empty());
  all_told(none + "ground_drag = 1\n" + ball, "'ground_drag' does nothing");
  all_told(none + ball + "ground_drag = 1", "'ground_drag' does nothing");
  all_told("[[box]]\ninertia = 1\nrotation = false", "'inertia' does nothing");
  all_told("[[box]]\ninertia = 1\n[physics]\nrotation = false", "'inertia' does nothing");
  for (const std::string key : {"velocity = [1, 0]", "spin = 5"}) {
    all_told("[[box]]\nfixed = true\n" + key, "stands still");
    EXPECT_TRUE(wrong("[[box]]\nname = \"a\"\n" + key, {"a.fixed=true"}).empty());
  }
  all_told("duration = 1\n[[box]]\nfixed = true\nrelease = 2", "a release at 2 s never comes");
  all_told("duration = 1\n[[box]]\n[[explosion]]\nstrength = 1\nstart = 2",
           "an explosion at 2 s never comes");
  const std::string event = "[[box]]\n[[when]]\ntime = 2\ndo = [{ mark = \"k\" }]\n";
  all_told("duration = 1\n[[box]]\n[[when]]\ntime = \"4/3\"\ndo = [{ mark = \"k\" }]",
           "an event at 1.33333 s");
  all_told("duration = 1\n" + event, "an event at 2 s never comes: the scene ends at 1 s");
  EXPECT_TRUE(wrong("duration = 2\n" + event).empty());
  EXPECT_TRUE(wrong("duration = 3\n" + event, {"duration=1"}).empty()) << "a shorter run";
  all_told(event + "again = true", "a time comes once");
  all_told("[[box]]\n[[explosion]]\nstrength = 1\ninterval = 0.1", "scheme = \"paper\"");
  all_told(
      "[[particle]]\nname = \"a\"\nposition = [1, 1]\ncopies = { count = 3, offset = [0.1, 0] }\n[[net]]\nof "
      "= "
      "\"a\"\ndiagonals = true",
      "one row");
}

TEST(Diagnostics, AKeyInTheWrongTableIsSentHome) {
  refused("gravity = [0, -1]", "a.toml:1:1: unknown key 'gravity'; it belongs in [room]");
  refused("[room]\nfps = 30", "a.toml:2:1: unknown key 'fps' in [room]; it belongs in [film]");
  refused("[film]\nduration = 30",
          "a.toml:2:1: unknown key 'duration' in [film]; it belongs at the top, before the first [table]");
}

TEST(Diagnostics, WhatComesLaterIsNamedAsSuch) {
  refused("[[particle]]\n[[spring]]\nbetween = [\"particle[0]\", [1, 1]]\nbreaks = 5",
          "a.toml:4:1: 'breaks' is not in this version of obscura yet");
  refused("version = 2",
          "a.toml:1:11: version 2 of the language is newer than this obscura, which reads version 1");
}

TEST(Diagnostics, WordsOfOtherProgramsAreTranslated) {
  refused("[[ball]]\nradius = 1\nrestitution = 0.5",
          "a.toml:3:1: unknown key 'restitution' in [[ball]]; it is 'elasticity' here");
  refused("[[ball]]\nradius = 1\nomega = 3",
          "a.toml:3:1: unknown key 'omega' in [[ball]]; it is 'spin' here, in degrees per second");
  refused("[[particle]]\n[[spring]]\nbetween = [\"particle[0]\", [1, 1]]\nk = 3",
          "a.toml:4:1: unknown key 'k' in [[spring]]; it is 'stiffness' here");
  refused("[[particle]]\nmass = \"1 - t\"",
          "a.toml:2:8: 'mass': expected a number of kilograms, got the string \"1 - t\"; a mass stays the "
          "same in a "
          "run: what it would change can be a [[force]]");
  refused("[[particle]]\nvelocity = [\"t\", 0]",
          "a.toml:2:13: 'velocity': expected numbers, got the string \"t\"; what moves by a formula has a "
          "'motion'");
}

TEST(Diagnostics, TypesAreNeverGuessed) {
  refused("[[particle]]\nmass = \"heavy\"",
          "a.toml:2:8: 'mass': expected a number of kilograms, got the string \"heavy\"");
  refused("[[particle]]\nmass = \"0.5\"",
          "a.toml:2:8: 'mass': expected a number of kilograms, got the string \"0.5\"; write it without the "
          "quotes");
  refused("title = 5", "a.toml:1:9: 'title': expected a string, got 5");
  refused("seed = 1.5", "a.toml:1:8: 'seed': expected a whole number, got 1.5");
  refused("seed = 2.0", "a.toml:1:8: 'seed': expected a whole number, got 2.0");
  refused("[look]\ncaption = 1", "a.toml:2:11: 'caption': expected true or false, got 1");
  refused("[room]\nsize = 4", "a.toml:2:8: 'size': expected two numbers [x, y] in metres, got 4");
  refused("[room]\nsize = [4]", "a.toml:2:8: 'size': expected two numbers [x, y] in metres, got 1 of them");
  refused("[room]\nsize = [4, true]", "a.toml:2:12: 'size': expected numbers, got true");
  refused("[[particle]]\nposition = 1979-05-27",
          "a.toml:2:12: 'position': expected two numbers [x, y] in metres, got a date or time");
  refused("room = 3", "a.toml:1:8: 'room': expected a table, got 3");
  refused("[[contact]]\nignore = []",
          "a.toml:1:1: 'contact': expected a table, got a list; write [contact], once");
  refused("[box]\nmass = 3", "a.toml:1:1: [box] stands for one of many; write [[box]]");
  refused("[ball]\nname = \"it\"\nposition = [1, 1]\n[[spring]]\nbetween = [\"it\", [1, 2]]",
          "a.toml:1:1: [ball] stands for one of many; write [[ball]]");
  refused("box = 3", "a.toml:1:7: 'box': expected a list of tables, got 3");
  refused("[film]\nsize = [1920, 1080.5]",
          "a.toml:2:15: 'size': expected two whole numbers [width, height], got 1080.5");
  refused(
      "[physics]\nrate = \"fast\"",
      "a.toml:2:8: 'rate': expected a number per second, or a fraction such as \"30000/1001\", got 'fast'");
}

TEST(Diagnostics, IntegersAreNumbers) {
  EXPECT_THAT(wrong("duration = 3\n[[particle]]\nmass = 2\nposition = [1, 2]"), ElementsAre());
}

TEST(Diagnostics, NumbersKeepTheirRanges) {
  refused("duration = 0", "a.toml:1:12: 'duration' must be positive, got 0");
  refused("[[particle]]\nmass = -1", "a.toml:2:8: 'mass' must be positive, got -1");
  refused("[[particle]]\nmass = 0", "a.toml:2:8: 'mass' must be positive, got 0");
  refused("[[particle]]\ndrag = -0.5", "a.toml:2:8: 'drag' must not be negative, got -0.5");
  refused("[[particle]]\nelasticity = 1.5", "a.toml:2:14: 'elasticity' must be between 0 and 1, got 1.5");
  refused("[[box]]\nsize = [1, 0]", "a.toml:2:12: 'size' must be positive, got 0");
  refused("[film]\nfps = 2000", "a.toml:2:7: 'fps' must be at most 1000 per second, got 2000");
  refused("[film]\nsize = [1920, 4]", "a.toml:2:15: 'size' must be at least 16 pixels, got 4");
  refused("[[particle]]\nmass = inf", "a.toml:2:8: 'mass' must be finite, got inf");
  refused("[[particle]]\nposition = [nan, 1]", "a.toml:2:13: 'position' must be finite, got nan");
  refused("duration = nan", "a.toml:1:12: 'duration' must be finite, got nan");
  refused("[[mouse]]\npath = [[0, 1, 1], [1, -inf, 2]]\n[[particle]]",
          "a.toml:2:24: 'path' must be finite, got -inf");
  refused("[[particle]]\nmass = 1e200", "a.toml:2:8: 'mass' is too large, got 1e+200");
}

TEST(Diagnostics, TimesAreExactOrRefused) {
  refused("duration = 0.12345678",
          "a.toml:1:12: 'duration' is kept exactly and 0.12345678 has too many digits: expected microseconds "
          "at the finest");
  refused("[film]\nfps = \"30000000/1001001\"",
          "a.toml:2:7: 'fps' is kept exactly and '30000000/1001001' has too many digits: expected a fraction "
          "of whole numbers up to a million");
}

TEST(Diagnostics, WhatIsTooSmallOrTooLargeToTurnSaysWhich) {
  refused("[[box]]\nsize = [1e-200, 1e-200]\nposition = [1, 1]",
          "a.toml:2:8: the box's moment of inertia is too small to compute with");
  refused("[[box]]\nsize = [1e-170, 1e-170]\nposition = [1, 1]\nmass = 1",
          "a.toml:2:8: the box's moment of inertia is too small to compute with");
}

TEST(Diagnostics, WordsComeFromTheirList) {
  refused("[look]\ntheme = \"papr\"",
          "a.toml:2:9: 'theme': expected one of paper, screen, got 'papr'; did you mean 'paper'?");
  refused("[physics]\nintegrator = \"verlet\"",
          "a.toml:2:14: 'integrator': expected one of rk4, midpoint, euler, semi-implicit, got 'verlet'");
  refused("[[particle]]\ncolor = \"bleu\"", "a.toml:2:9: 'color': 'bleu' is no colour; did you mean 'blue'?");
  refused(
      "[[particle]]\ncolor = \"#12\"",
      "a.toml:2:9: 'color': '#12' is no colour; expected \"#rrggbb\" or one of orange, sky, green, blue, "
      "vermilion, purple, yellow, grey, black, white, red, brown, pink, cyan, magenta, violet, navy, teal, "
      "turquoise, olive, lime, gold, silver, gray");
  refused(
      "[look]\narrows = [\"force\"]",
      "a.toml:2:11: 'arrows': 'force' is not in this version of obscura yet, which has velocity, contact");
}

const std::string kContact = "[physics]\ncollision = \"contact\"\n";

TEST(Diagnostics, PolygonsAreConvexAndSayWhereNot) {
  const auto polygon = [](const std::string& points) { return kContact + "[[polygon]]\npoints = " + points; };
  refused(polygon("[[0, 0], [1, 0], [0.2, 0.2], [0, 1]]"),
          "a.toml:4:27: points[2] turns the other way: a polygon must be convex; make a [[body]] of several");
  refused(polygon("[[0, 1], [0.2, 0.2], [1, 0], [0, 0]]"),
          "a.toml:4:19: points[1] turns the other way: a polygon must be convex; make a [[body]] of several");
  refused(polygon("[[0, 0], [0.5, 0], [1, 0], [0, 1]]"),
          "a.toml:4:19: points[1] lies on the line between its neighbours; leave it out");
  refused(polygon("[[0, 0], [1, 0], [1, 0], [0, 1]]"), "a.toml:4:27: points[1] and points[2] are one place");
  refused(polygon("[[0, 1], [-0.59, -0.81], [0.95, 0.31], [-0.95, 0.31], [0.59, -0.81]]"),
          "a.toml:4:11: the points go around more than once: a polygon must be convex");
  refused(polygon("[[0, 0], [1, 0]]"),
          "a.toml:4:10: 'points': expected three points or more [[x, y], ...] in metres, got 2");
  refused(kContact + "[[polygon]]",
          "a.toml:3:1: [[polygon]] needs 'points': three points or more [[x, y], ...] in metres");
}

TEST(Diagnostics, ShapesOfABodyAreOneOfThree) {
  refused(kContact + "[[body]]\nshapes = [{ radius = 0.1, size = [1, 1] }]",
          "a.toml:4:11: a shape is one of three: expected 'radius', 'size' or 'points'");
  refused(kContact + "[[body]]\nshapes = []", "a.toml:4:10: 'shapes' is empty: expected a part at least");
  refused(
      kContact + "[[body]]\nshapes = [{ radius = 0.1, densty = 2 }]",
      "a.toml:4:27: unknown key 'densty' in each of 'shapes'; it has radius, size, points, position, angle");
}

TEST(Diagnostics, JointsSayWhereTheyAre) {
  const std::string two =
      kContact +
      "[[ball]]\nname = \"a\"\nposition = [1, 1]\n[[ball]]\nname = \"b\"\nposition = [2, 1]\n"
      "[[particle]]\nname = \"p\"\nposition = [3, 1]\n[[joint]]\n";
  refused(two + "type = \"pin\"\nbetween = [\"a\", \"b\"]",
          "a.toml:12:1: a pin between two bodies needs 'at', the place in the room where it is, or a point "
          "of one "
          "in 'between'");
  refused(two + "type = \"pin\"\nbetween = [\"a\", \"room\"]\nlength = 2",
          "a.toml:15:10: 'length' is that of a rod or a rope; a pin has none");
  refused(two + "type = \"rod\"\nbetween = [\"a\", \"b\"]\nat = [1.5, 1]",
          "a.toml:15:6: 'at' is that of a pin, a weld or a slider; a rod has none");
  refused(two + "type = \"weld\"\nbetween = [\"a\", \"b\"]\naxis = [1, 0]",
          "a.toml:15:8: 'axis' is that of a slider; a weld has none");
  refused(two + "type = \"weld\"\nbetween = [\"a\", \"b\"]\nfriction = 1",
          "a.toml:15:12: 'friction' is that of a pin or a slider; a weld has none");
  refused(two + "type = \"rod\"\nbetween = [\"a\", \"b\"]\nlength = 2",
          "a.toml:15:10: 'length' is 2 m and its ends are 1 m apart at the start; move an end");
  refused(two + "type = \"rope\"\nbetween = [\"a\", \"b\"]\nlength = 0.9",
          "a.toml:15:10: 'length' is 0.9 m and its ends are 1 m apart at the start; move an end");
  refused(two + "type = \"rope\"\nbetween = [\"a\", \"room\"]",
          "a.toml:14:11: where in the room? A rope needs a place [x, y]");
  refused(two + "type = \"weld\"\nbetween = [\"p\", \"a\"]\nat = [2, 1]",
          "a.toml:14:11: 'p' is a particle, which does not turn: a weld needs a [[ball]]");
  refused(two + "type = \"pin\"\nbetween = [\"room\", [1, 1]]",
          "a.toml:14:11: 'between' names no body: it would hold nothing");
  refused(
      two + "type = \"pin\"\nbetween = [{ body = \"a\", at = \"right\" }, { body = \"b\", at = \"left\" }]",
      "a.toml:14:11: the two points of this pin are 0.6 m apart at the start");
  refused(two + "type = \"pin\"\nbetween = [\"a\", \"room\"]\nlimits = [10, 20]",
          "a.toml:15:10: 'limits' exclude where it starts: expected 0 between 10 and 20");
  refused(two + "type = \"hook\"\nbetween = [\"a\", \"room\"]",
          "a.toml:13:8: 'type': expected one of pin, hinge, ball, weld, slider, rod, rope, pulley, screw, "
          "gear, got 'hook'");
}

TEST(Diagnostics, GroupsAreThoseOfBodies) {
  refused("[[box]]\ngroup = \"stones\"\n[contact]\nignore = [[\"stones\", \"stone\"]]",
          "a.toml:4:22: no group or body is called 'stone'; did you mean 'stones'?");
  refused(
      "[[box]]\nname = \"a\"\ngroup = \"stones\"\n[[box]]\nname = \"b\"\ngroup = \"stones\"\n"
      "position = [1, 1]\n[contact]\nignore = [[\"a\", \"stones\"]]",
      "a.toml:9:12: 'a' is of a group with 'b', and a body has one group; give 'group' to what [contact] "
      "ignore "
      "names");
  refused("[[box]]\n[contact]\nignore = [\"stones\"]",
          "a.toml:3:11: 'ignore': expected pairs of names such as [\"stones\", \"frame\"], got the string "
          "\"stones\"");
}

TEST(Diagnostics, OverlapsNameThePairAndTheDepth) {
  const std::string pair =
      "[[box]]\nname = \"a\"\nsize = [1, 1]\nposition = [2, 2]\n[[box]]\nname = \"b\"\nsize = [1, 1]\n";
  refused(kContact + pair + "position = [2.9, 2.2]",
          "a.toml:10:12: 'a' and 'b' overlap by 0.1 m at the start; move them apart, or let them be pushed: "
          "[physics] "
          "overlap = \"separate\"");
  // not at an event, whose setting has nothing to do with it
  refused(kContact + pair +
              "position = [2.9, 2.2]\n[[when]]\ntime = 1\ndo = [{ set = 'room.gravity', to = [0, 1] }]",
          "a.toml:10:12: 'a' and 'b' overlap by 0.1 m at the start; move them apart, or let them be pushed: "
          "[physics] "
          "overlap = \"separate\"");
  refused(
      kContact + "[[ball]]\nname = \"ball\"\nposition = [1, 1]\ncopies = { count = 3, offset = [0.3, 0] }",
      "a.toml:5:12: 'ball[0]' and 'ball[1]' overlap by 0.1 m at the start, and another pair does; move them "
      "apart, or let them be pushed: [physics] overlap = \"separate\"");
  refused(
      kContact + "[[ball]]\nname = \"ball\"\nposition = [1, 1]\ncopies = { count = 4, offset = [0.3, 0] }",
      "a.toml:5:12: 'ball[0]' and 'ball[1]' overlap by 0.1 m at the start, and 2 more pairs do; move them "
      "apart, or "
      "let them be pushed: [physics] overlap = \"separate\"");
  // a millionth of a metre square's size is 1.4e-6 m: less is put right
  EXPECT_TRUE(wrong(kContact + pair + "position = [2.999999, 2.2]").empty());
  EXPECT_FALSE(wrong(kContact + pair + "position = [2.999998, 2.2]").empty());
  // what may overlap
  EXPECT_TRUE(wrong(kContact + "overlap = \"separate\"\n" + pair + "position = [2.9, 2.2]").empty());
  EXPECT_TRUE(wrong("[physics]\ncollision = \"handout\"\n" + pair + "position = [2.9, 2.2]").empty());
  EXPECT_TRUE(wrong(kContact + pair +
                    "position = [2.9, 2.2]\n[[joint]]\ntype = \"pin\"\nbetween = [\"a\", \"b\"]\n"
                    "at = [2.5, 2]")
                  .empty());
  EXPECT_FALSE(wrong(kContact + pair +
                     "position = [2.9, 2.2]\n[[joint]]\ntype = \"pin\"\nbetween = [\"a\", \"b\"]\n"
                     "at = [2.5, 2]\ntouching = true")
                   .empty());
  EXPECT_TRUE(wrong(kContact +
                    "[[ball]]\nposition = [1, 1]\ngroup = \"g\"\ncopies = { count = 4, offset = [0.3, 0] }\n"
                    "[contact]\nignore = [[\"g\", \"g\"]]")
                  .empty());
  EXPECT_TRUE(
      wrong(kContact + "[[ball]]\nposition = [1, 1]\nfixed = true\ncopies = { count = 4, offset = [0.3, 0] }")
          .empty());
}

TEST(Diagnostics, TheCameraFollowsOneBody) {
  refused("[[box]]\nname = \"a\"\n[camera]\nfollow = \"b\"",
          "a.toml:4:10: no body is called 'b'; did you mean 'a'?");
  refused("[[box]]\nname = \"a\"\n[camera]\nfollow = \"a\"\ncenter = [1, 1]",
          "a.toml:5:10: the camera follows a body, or looks at 'center'; leave one out");
}

TEST(Diagnostics, TheHandoutKnowsParticlesAndBoxes) {
  refused(
      "[physics]\ncollision = \"handout\"\n[[ball]]",
      "a.toml:3:1: [[ball]] is not in `collision = \"handout\"`, which knows particles and boxes; [physics] "
      "collision = \"contact\" has it");
}

TEST(Diagnostics, ANameIsNotWhatNamelessOnesAreCalled) {
  refused(kContact + "[[ball]]\nposition = [1, 1]\n[[particle]]\nname = \"ball\"",
          "a.toml:6:8: the name 'ball' is what [[ball]]s without one are called, as at a.toml:3:1");
  EXPECT_TRUE(wrong(kContact + "[[ball]]\nname = \"ball\"", {"ball.mass=2"}).empty());
}

TEST(Diagnostics, NamesAreOneEach) {
  refused("[[box]]\nname = \"a\"\n[[particle]]\nname = \"a\"",
          "a.toml:4:8: the name 'a' is taken by another body at a.toml:2:8");
  refused("[[box]]\nname = \"a\"\n[[spring]]\nname = \"a\"\nbetween = [\"a\", [1, 1]]",
          "a.toml:4:8: the name 'a' is taken at a.toml:2:8");
  refused("[[box]]\nname = \"room\"", "a.toml:2:8: 'name': 'room' is a word of the language; choose another");
  refused("[[box]]\nname = \"a b\"",
          "a.toml:2:8: 'name': expected letters, digits, _ and -, a letter first, got 'a b'");
  refused("[[box]]\nname = \"\"",
          "a.toml:2:8: 'name': expected letters, digits, _ and -, a letter first, got ''");
}

TEST(Diagnostics, ReferencesMustMeanSomething) {
  const std::string things =
      "[[particle]]\nname = \"ball\"\ncopies = { count = 3, offset = [0.5, 0] }\n[[box]]\nname = "
      "\"crate\"\n[[spring]]\n";
  refused(things + "between = [\"bal[1]\", \"crate\"]",
          "a.toml:7:12: no body is called 'bal'; did you mean 'ball'?");
  refused(things + "between = [\"ball[3]\", \"crate\"]",
          "a.toml:7:12: 'ball[3]': 'ball' has 3 copies, ball[0] .. ball[2]");
  refused(things + "between = [\"ball\", \"crate\"]",
          "a.toml:7:12: 'ball' is 3 copies; say which: ball[0] .. ball[2], or all, ball[*]");
  refused(things + "between = [\"crate[0]\", [1, 1]]",
          "a.toml:7:12: 'crate' has no copies; write it without brackets");
  refused(things + "between = [\"ball[0..1]\", \"ball[*]\"]",
          "a.toml:7:11: 'between' has 2 ends on one side and 3 on the other: expected as many, or one");
  refused(things + "between = [[1, 1], [2, 2]]",
          "a.toml:7:11: 'between' has two places: spring[0] would move nothing");
  refused(things + "between = [\"crate\", \"crate\"]",
          "a.toml:7:11: both ends of spring[0] are one point of 'crate'");
  refused(things + "between = [\"crate\", { body = \"ball[1]\", local = [0, 1] }]",
          "a.toml:7:49: 'ball[1]' is a particle, which has no point but its centre");
  refused(things + "between = [\"ball[0]\", { body = \"crate\", at = \"topleft\" }]",
          "a.toml:7:46: 'at': expected a corner or side such as \"top right\" or \"left\", got 'topleft'; "
          "did you mean 'top left'?");
  refused(things + "between = [\"ball[0]\", { body = \"crate\", at = \"top\", local = [0, 0] }]",
          "a.toml:7:23: 'local' and 'at' both say where on the body; leave one out");
  refused(things + "between = [\"ball[0]\", { local = [0, 0] }]",
          "a.toml:7:23: 'between': expected a body's name, { body = \"name\", local = [x, y] } or a place "
          "[x, y], got a table without 'body'");
  refused(things + "between = [\"crate\"]",
          "a.toml:7:11: 'between': expected two ends, each a body's name, { body = \"name\", local = [x, y] "
          "} or a place [x, y], got 1 of them");
  refused(things + "stiffness = 3",
          "a.toml:6:1: [[spring]] needs 'between': two ends, each a body's name, { body = \"name\", local = "
          "[x, y] } or a place [x, y]");
  refused("[[particle]]\n[look]\ntrails = { bal = 1 }", "a.toml:3:12: no body is called 'bal'");
  refused("[[particle]]\nname = \"a\"\n[[net]]\nof = \"a\"",
          "a.toml:4:6: 'a' has no copies to join: give it copies = { count = [5, 4], ... }");
  refused("[[net]]\nof = \"a\"", "a.toml:2:6: no body is called 'a'");
}

TEST(Diagnostics, BodiesLieInTheRoom) {
  refused("[room]\nsize = [4, 3]\n[[particle]]\nposition = [4.25, 1]",
          "a.toml:4:12: 'particle[0]' is outside the room: 0.25 m beyond the right wall (a.toml:2:8)");
  refused("[room]\nsize = [4, 3]\n[[particle]]\nposition = [1, 0.25]\nradius = 0.5",
          "a.toml:4:12: 'particle[0]' is outside the room: 0.25 m beyond the floor (a.toml:2:8)");
  refused("[[box]]\nsize = [1, 1]\nangle = 45\nposition = [0.5, 2]",
          "a.toml:4:12: 'box[0]' is outside the room: 0.207 m beyond the left wall (8 m by 4.5 m where "
          "room.size is left out)");
  refused(
      "[room]\nsize = [4, 3]\nwalls = [{ point = [2, 1], normal = [0, 2] }]\n[[particle]]\nposition = [1, "
      "0.5]",
      "a.toml:5:12: 'particle[0]' is outside the room: 0.5 m beyond room.walls[0] (a.toml:3:10)");
  refused("[[particle]]\nname = \"ball\"\nposition = [7, 4]\ncopies = { count = 4, offset = [0.5, 0.25] }",
          "a.toml:3:12: 'ball[3]' is outside the room: 0.5 m beyond the right wall (8 m by 4.5 m where "
          "room.size is left out)");
  refused("[[particle]]\nposition = [7, 1]\nname = \"b\"\ncopies = { count = 5, offset = [0.5, 0] }",
          "a.toml:2:12: 'b[3]' is outside the room: 0.5 m beyond the right wall (8 m by 4.5 m where "
          "room.size is left out), and so are 1 more of its copies");
}

TEST(Diagnostics, OnAWallIsInTheRoom) {
  EXPECT_THAT(wrong("[[particle]]\nposition = [8, 4.5]"), ElementsAre());
  EXPECT_THAT(wrong("[[particle]]\nradius = 0.1\nposition = [0.1, 0.1]"), ElementsAre());
  EXPECT_THAT(wrong("[[box]]\nsize = [0.6, 0.4]\nposition = [0.3, 0.2]"), ElementsAre());
  EXPECT_THAT(wrong("[[box]]\nsize = [0.6, 0.4]\nangle = 90\nposition = [0.2, 0.3]"), ElementsAre());
}

TEST(Diagnostics, WhatIsHeldCountsByItsCentre) {
  EXPECT_THAT(wrong("[[particle]]\nradius = 0.1\nfixed = true\nposition = [4, 4.5]"), ElementsAre());
  EXPECT_THAT(wrong("[[particle]]\nradius = 0.1\nfixed = true\nposition = [4, 4.6]"),
              ElementsAre(HasSubstr("0.1 m beyond the ceiling")));
}

TEST(Diagnostics, RoomsMustBeRooms) {
  refused("[room]\nwalls = [{ point = [0, 0], normal = [0, 0] }]",
          "a.toml:2:37: 'normal' is zero: expected the direction into the room, such as [0, 1]");
  refused("[room]\nwalls = [{ point = [0, 0] }]",
          "a.toml:2:10: each of 'walls' needs 'normal': two numbers [x, y]");
  refused("[room]\nsize = [4, 3]\nwalls = [{ point = [0, 9], normal = [0, 1] }]",
          "a.toml:3:10: room.walls[0] leaves no room: it lies on the outside of the walls before it");
  refused("[room]\nwalls = [{ point = [0, 0], normal = [0, 1] }]\n[[particle]]",
          "a.toml:3:1: [[particle]] needs 'position': an open room has no middle");
  refused("[room]\ncorner = [1, 1]\nwalls = [{ point = [0, 0], normal = [0, 1] }]",
          "a.toml:2:10: 'corner' is that of 'size', and there is none");
}

TEST(Diagnostics, PlaneAndSpaceDoNotMix) {
  refused("[room]\nsize = [4, 3]\n[[particle]]\nposition = [1, 1, 1]",
          "a.toml:4:12: 'position' has 3 numbers and 'size' at a.toml:2:8 has 2: a scene is planar or in "
          "space, not both");
  refused("[[particle]]\nposition = [1, 1]\n[[mouse]]\npath = [[0, 1, 1], [1, 2, 2, 2]]",
          "a.toml:4:20: 'place after the time in path' has 3 numbers and 'position' at a.toml:2:12 has 2: a "
          "scene is planar or in space, not both");
}

TEST(Diagnostics, MouseTimesIncrease) {
  const std::string ball = "[[particle]]\n[[mouse]]\n";
  refused(ball + "path = [[1, 4, 3], [1, 5, 3]]",
          "a.toml:3:21: times must increase along the path, got 1 after 1");
  refused(ball + "path = [[1, 4, 3]]",
          "a.toml:3:8: 'path': expected points in time [[t, x, y], ...], two at least, got 1");
  refused(ball + "path = [[-1, 4, 3], [1, 2, 2]]", "a.toml:3:10: 'time' must not be negative, got -1");
  refused(ball + "path = [[1, 4], [2, 2, 2]]", "a.toml:3:9: 'path': expected three numbers [t, x, y], got 2");
  refused("[[mouse]]\npath = [[0, 1, 1], [1, 2, 2]]",
          "a.toml:1:1: the mouse has nothing to take: no body of the scene can move");
}

TEST(Diagnostics, SpeedsOfAFilmArePositiveAndTheirKeysIncrease) {
  refused("[film]\nspeed = 0", "a.toml:2:9: 'speed' must be at least 0.001, got 0");
  refused("[film]\nspeed = \"fast\"",
          "a.toml:2:9: 'speed': expected a number or fraction, or a list of tables, got 'fast'");
  refused(
      "[film]\nspeed = [{ speed = 0.5 }]",
      "a.toml:2:10: each of 'speed' needs 'time': a number of seconds, a fraction such as \"30000/1001\", or "
      "the name of a mark");
  refused("[film]\nspeed = [{ time = 2 }, { time = 2, speed = 0.5 }]",
          "a.toml:2:33: times must increase from key to key, got 2 after 2");
  refused("[film]\nspeed = [{ time = 2, spead = 3 }]",
          "a.toml:2:22: unknown key 'spead' in each of 'speed'; did you mean 'speed'?");
}

TEST(Diagnostics, UnknownMathematicsIsAnErrorWithItsColumn) {
  refused("[[film.label]]\nat = [1, 1]\ntext = 'a = \\omgea^2 r'",
          "a.toml:3:8: 'text', column 5: unknown command '\\omgea'; did you mean '\\omega'?");
  refused(
      "[figure]\nformula = '$v = 3'",
      "a.toml:2:11: 'formula', column 1: '$' without another that ends the mathematics; '\\$' is a dollar");
}

// Wherever mathematics is written.
TEST(Diagnostics, MathematicsThatIsNotWholeIsAnErrorWithItsColumn) {
  const std::string half = "'\\frac' needs what stands above and below: '\\frac{1}{2}'";
  refused("[[film.label]]\nat = [1, 1]\ntext = 'a = \\frac{1}'", "a.toml:3:8: 'text', column 5: " + half);
  refused("title = 'energy $\\frac{1}$'", "a.toml:1:9: 'title', column 9: " + half);
  refused("[[film.caption]]\ntext = '$\\frac{1}$'", "a.toml:2:8: 'text', column 2: " + half);
  refused("[[film.card]]\ntitle = '$\\frac{1}$'", "a.toml:2:9: 'title', column 2: " + half);
  refused("[figure]\ntitles = 'a; $\\frac{1}$'", "a.toml:2:10: 'titles', column 5: " + half);
  refused("[film]\nvary = \"room.gravity=1,2\"\nvary_names = 'a; $\\frac{1}$'",
          "a.toml:3:14: 'vary_names', column 5: " + half);
  refused("[[ball]]\nlabel = '\\frac{1}'", "a.toml:2:9: 'label', column 1: " + half);
}

TEST(Diagnostics, AValueInALabelHasAQuantityAndOnePlace) {
  const std::string label = "[[film.label]]\nat = [1, 1]\ntext = ";
  refused(label + "'E={}'", "a.toml:3:8: 'text' has no value to show: {} stands for one");
  refused(label + "'E={} and {:.2}'\nquantity = 'energy'",
          "a.toml:3:8: 'text' shows one value, and has two places for it");
  EXPECT_NO_THROW(parse(label + "'${}^{14}C$'", "a.toml", {}));
}

TEST(Diagnostics, AMarkIsOfOneBody) {
  const std::string copies =
      "[[ball]]\nname = 'b'\nradius = 0.1\nposition = [1, 1]\ncopies = { count = 3, offset = [1, 0] }\n";
  refused(copies + "[[film.vector]]\nquantity = 'velocity'\nof = 'b[*]'",
          "a.toml:8:6: 'b[*]' is 3 bodies, and one is wanted: say which");
  refused(copies + "[[film.point]]\nat = 'b[*]'",
          "a.toml:7:6: 'b[*]' is 3 bodies, and one is wanted: say which");
  refused(copies + "[[film.point]]\nat = { body = 'b[*]', local = [0.05, 0] }",
          "a.toml:7:15: 'b[*]' is 3 bodies, and one is wanted: say which");
}

TEST(Diagnostics, AnAxisHasOneUnit) {
  refused("[[film.plot]]\nquantity = [\"x\", \"speed\"]\nof = \"a\"\n[[ball]]\nname = \"a\"",
          "a.toml:2:12: 'x' is in m and 'speed' in m/s: an axis has one unit, give each a plot of its own");
}

TEST(Diagnostics, PlotsOfAFilmAreOfSomethingAndLeaveRoom) {
  refused("[[film.plot]]\nquantity = [\"height\"]\n[[ball]]",
          "a.toml:1:1: a plot of 'height' needs 'of', the body that has it");
  refused("[[film.plot]]\nquantity = [\"energy\"]\nof = \"a\"\n[[ball]]\nname = \"a\"",
          "a.toml:3:6: 'energy' is of the whole room: leave 'of' out; of a body there are 'kinetic' and "
          "'gravity'");
  refused(
      "[[film.label]]\nat = [1, 1]\ntext = \"{}\"\nquantity = \"work\"\nof = \"a\"\n[[ball]]\nname = \"a\"",
      "a.toml:5:6: 'work' is of the whole room: leave 'of' out; of a body there are 'kinetic' and 'gravity'");
  refused("[[film.plot]]\nquantity = []\n[[ball]]",
          "a.toml:2:12: 'quantity': expected one at least, such as [\"energy\"]");
  refused(
      "[[film.plot]]\nquantity = [\"warmth\"]\n[[ball]]",
      "a.toml:2:13: 'quantity': expected one of energy, kinetic, potential, gravity, springs, fields, hand, "
      "work, "
      "x, height, speed, vx, vy, angle, spin, length, push, acceleration, momentum, weight, "
      "normal_force, friction, net_force, spring_force, joint_force, drag, field, contact, blast, torque, "
      "joint_torque, got 'warmth'");
  refused(
      "[[film.plot]]\nquantity = [\"energy\"]\nsize = 50\n[[film.plot]]\nquantity = [\"energy\"]\n[[ball]]",
      "a.toml:4:1: the plots take 80 percent of the picture: 75 is the most");
  refused(
      "[[film.plot]]\nquantity = [\"energy\"]\nsize = 15\n[[ball]]\nradius = 0.1\nposition = [1, 1]",
      "a.toml:3:8: there is no room for this plot: its axis would be 28 of the picture's 1080 pixels high; "
      "give it a larger 'size'");
  refused(
      "[[film.plot]]\nquantity = [\"energy\"]\n[[film.plot]]\nquantity = [\"kinetic\"]\n"
      "[[film.plot]]\nquantity = [\"energy\"]\nplace = \"right\"\n"
      "[[film.plot]]\nquantity = [\"kinetic\"]\nplace = \"right\"\n"
      "[[ball]]\nradius = 0.1\nposition = [1, 1]",
      "a.toml:5:1: there is no room for this plot: its axis would be 20 of the picture's 1080 pixels high; "
      "put fewer plots at the right, or give those below a smaller 'size'");
  refused("[figure]\nroom = false\n[[figure.plot]]\nquantity = [\"energy\"]\nheight = 12\n[[ball]]",
          "a.toml:5:10: there is no room for this plot: its title and its numbers take 10.6 mm, and its axis "
          "4 at "
          "least; give it a 'height' of 15");
  refused("[film]\nshutter = 400", "a.toml:2:11: 'shutter' must be at most 360 deg, got 400");
}

TEST(Diagnostics, CopiesAreCountedAndBounded) {
  refused("[[particle]]\ncopies = { count = [2000, 2000] }",
          "a.toml:2:20: 'count': 4000000 bodies in all are more than 1000000, the most a scene may have");
  refused("[[particle]]\ncopies = { count = 0 }", "a.toml:2:20: 'count' must be at least 1, got 0");
  refused("[[particle]]\ncopies = { offset = [1, 0] }",
          "a.toml:2:10: 'copies' needs 'count' or 'at': how many, or where");
  refused("[[particle]]\ncopies = { count = [3, 2], offset = [0.1, 0] }",
          "a.toml:2:37: 'offset': a grid needs one for each direction, such as [[0.3, 0], [0, 0.3]]");
  refused("[[particle]]\ncopies = { count = 3, offset = [[0.1, 0], [0, 1]] }",
          "a.toml:2:32: 'offset': expected 1 for a count in 1 direction, got 2");
  refused("[[particle]]\nmass = [1, 2]\ncopies = { count = 3 }",
          "a.toml:2:8: 'mass': expected one for each of the 3 copies, got 2");
  refused("[[particle]]\nmass = [1, 2]",
          "a.toml:2:8: 'mass' varies over copies, and there are none: expected a number of kilograms");
  refused("[[particle]]\nmass = { from = 1, too = 2 }\ncopies = { count = 3 }",
          "a.toml:2:20: unknown key 'too' in 'mass': expected { from, to } over copies, or a number of "
          "kilograms");
  refused("[[particle]]\nmass = { from = 1 }\ncopies = { count = 3 }",
          "a.toml:2:8: 'mass': expected { from, to }, got no 'to'");
  refused("[[particle]]\nmass = { from = 1, to = -2 }\ncopies = { count = 3 }",
          "a.toml:2:25: 'mass' must be positive, got -2");
  refused("[[particle]]\nfixed = \"0..3\"\ncopies = { count = 3 }",
          "a.toml:2:9: 'fixed': expected which of the 3 copies, such as \"0..2\" or \"0,2\", got '0..3'");
  refused("[[particle]]\nfixed = \"0\"",
          "a.toml:2:9: 'fixed': expected true or false, without quotes; a list of copies needs copies");
}

TEST(Diagnostics, OneThingIsSaidOnce) {
  refused("[[box]]\nmass = 1\ndensity = 2",
          "a.toml:3:11: 'mass' and 'density' both say how heavy it is; leave one out");
  refused("[camera]\nwidth = 3\nkeys = [{ time = 0 }]",
          "a.toml:2:9: the camera stands, or moves by 'keys'; leave one out");
  refused("[camera]\nkeys = [{ time = 1 }, { time = 1 }]",
          "a.toml:2:32: times must increase from key to key, got 1 after 1");
}

TEST(Diagnostics, OfGoldenStatesAndWhatIsKept) {
  const auto refused = [](const std::string& text, const std::string& line) {
    EXPECT_THAT(wrong("[golden]\n" + text), ElementsAre(line)) << text;
  };
  refused("states = 2", "a.toml:2:10: 'states': expected true, false, or the file of a run (CSV), got 2");
  refused("states = \"\"", "a.toml:2:10: 'states': expected the file of a run (CSV), got an empty name");
  refused("keep = \"hashes\"",
          "a.toml:2:8: 'keep': expected one of pictures, hash, got 'hashes'; did you mean 'hash'?");
}

TEST(Diagnostics, AllComeInOneGoInTheOrderOfTheFile) {
  EXPECT_THAT(
      wrong("[[spring]]\nbetween = [\"a\", \"b\"]\n[room]\nsize = [-1, 2]\n[[box]]\nmas = 2\ntitle = 2\n"),
      ElementsAre(
          "a.toml:2:12: no body is called 'a'", "a.toml:2:17: no body is called 'b'",
          "a.toml:4:9: 'size' must be positive, got -1",
          "a.toml:6:1: unknown key 'mas' in [[box]]; did you mean 'mass'?",
          "a.toml:7:1: unknown key 'title' in [[box]]; it belongs at the top, before the first [table]"));
}

TEST(Diagnostics, AHundredAreEnough) {
  std::string text;
  for (int i = 0; i < 250; ++i) text += "zzzzz" + std::to_string(i) + " = 1\n";
  const auto lines = wrong(text);
  ASSERT_EQ(lines.size(), 101u);
  EXPECT_EQ(lines.back(), "a.toml: and 150 more");
}

TEST(Diagnostics, ColumnsCountCodePoints) {
  EXPECT_THAT(wrong("[[box]]\nangle = [1, \"åå\", \"b\"]"),
              ElementsAre(StartsWith("a.toml:2:13: "), StartsWith("a.toml:2:19: ")));
}

// A body that is wrong is told once, and not again wherever it is named.
TEST(Diagnostics, AWrongBodyIsToldOnce) {
  EXPECT_THAT(wrong("[room]\nsize = [4, 4]\n[[ball]]\nname = \"b\"\nposition = [1, 1]\n"
                    "copies = { at = [[1, 1], [2, 2]] }\n[[ball]]\nname = \"c\"\nposition = [3, 3]\n"
                    "[[spring]]\nbetween = [\"b[0]\", \"c\"]\n[[joint]]\nname = \"j\"\ntype = \"rod\"\n"
                    "between = [\"b[1]\", \"c\"]\n[[when]]\nvalue = \"b[0].x > 2\"\n"
                    "do = [{ mark = \"m\" }]\n[[force]]\nof = \"b[*]\"\ncomponents = [\"1\", \"0\"]\n"),
              ElementsAre(StartsWith("a.toml:6:17: 'at' says where each copy is")));
}

}  // namespace
}  // namespace obscura::scene
