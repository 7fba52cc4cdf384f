// Files that mean harm, or none at all: each ends in a scene or in complaints, quickly.

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "scene/document.h"
#include "scene/error.h"
#include "scene/scene.h"

namespace obscura::scene {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

std::string complaint(const std::string& text) {
  try {
    parse(text, "a.toml");
    return "";
  } catch (const Error& error) {
    return error.complaints.front().text();
  }
}

std::string repeated(const std::string& part, int n) {
  std::string all;
  for (int i = 0; i < n; ++i) all += part;
  return all;
}

TEST(Hostile, DeepKeysAreRefusedBeforeTheParserSeesThem) {
  EXPECT_EQ(complaint("a" + repeated(".a", 100'000) + " = 1"),
            "a.toml:1:128: a dotted key of more than 64 parts");
  EXPECT_EQ(complaint("[a" + repeated(".a", 100'000) + "]"),
            "a.toml:1:129: a dotted key of more than 64 parts");
  EXPECT_EQ(complaint("b = {a" + repeated(" . a", 100'000) + " = 1}"),
            "a.toml:1:260: a dotted key of more than 64 parts");
  EXPECT_EQ(complaint("a = " + std::string(100'000, '[')),
            "a.toml:1:69: lists and tables are nested more than 64 deep here");
  EXPECT_EQ(complaint("a = " + repeated("{a=", 100'000)),
            "a.toml:1:197: lists and tables are nested more than 64 deep here");
}

TEST(Hostile, WhatIsDeepInAStringOrACommentIsNot) {
  EXPECT_EQ(
      complaint("# " + std::string(1000, '[') + "\ntitle = \"" + std::string(1000, '[') + "." + "\" # {{{"),
      "");
  EXPECT_EQ(complaint("title = '''" + std::string(1000, '{') + "'' ''''\nseed = 1"), "");
  EXPECT_EQ(complaint("title = \"\\\"" + std::string(1000, '[') + "\""), "");
  // a string that ends in two quotes of its own hides nothing
  EXPECT_THAT(complaint("title = [\"\"\"a\"\"\"\"\", " + std::string(100'000, '[')), HasSubstr("nested"));
}

TEST(Hostile, BytesThatAreNoTextAreNamed) {
  EXPECT_EQ(complaint("title = \"a\x01\""),
            "a.toml:1:11: a control byte (0x01) has no place in a scene; is this a text file?");
  EXPECT_EQ(complaint(std::string("title\0 = 1", 10)),
            "a.toml:1:6: a control byte (0x00) has no place in a scene; is this a text file?");
  EXPECT_EQ(complaint("\ntitle = \"\xff\""),
            "a.toml:2:10: the byte 0xFF is not UTF-8; save the file as UTF-8");
  EXPECT_EQ(complaint("title = \"\xed\xa0\x80\""),
            "a.toml:1:10: the byte 0xED is not UTF-8; save the file as UTF-8");  // a lone surrogate
  EXPECT_EQ(complaint("title = \"\xc0\xaf\""),
            "a.toml:1:10: the byte 0xC0 is not UTF-8; save the file as UTF-8");  // overlong
  EXPECT_EQ(complaint("title = \"\xe2\x82"),
            "a.toml:1:10: the byte 0xE2 is not UTF-8; save the file as UTF-8");  // cut
  EXPECT_EQ(complaint("title = \"Ångström\"\r\nseed = 1\r\n"), "");
}

TEST(Hostile, ATableWithoutWhatItNeedsIsTold) {
  for (const char* path : {"room.walls",   "polygon",       "body",        "spring",       "net",
                           "joint",        "chain",         "bond",        "explosion",    "mouse",
                           "camera.keys",  "film.speed",    "film.plot",   "figure.point", "figure.vector",
                           "figure.angle", "figure.length", "figure.cone", "figure.label", "figure.plot"})
    EXPECT_THAT(complaint("[[" + std::string(path) + "]]"), HasSubstr("need")) << path;
  // found by fuzzing: a label without its text was read all the same
  EXPECT_THAT(complaint("[[figure.label]]\nat = [0, 0]"), HasSubstr("needs 'text'"));
  EXPECT_THAT(complaint("[[figure.label]]\ntext = 'a'"), HasSubstr("needs 'at'"));
}

TEST(Hostile, WhatIsFarTooFastIsStepped) {
  // 1e4 widths a step: looked for in each of them at each of its cuts it took minutes
  const Scene scene = parse(
      "[room]\nsize = [4, 3, 4]\n[[box]]\nsize = [0.5, 0.5, 0.5]\nposition = [0, 0.25, 0]\n"
      "[[box]]\nsize = [0.5, 0.5, 0.5]\nposition = [0, 0.75, 0]\nvelocity = [2.9e6, 1e5, 0]\n",
      "a.toml");
  EXPECT_TRUE(std::holds_alternative<sim::Snapshot>(scene.run()->at({1, 600})));
  // one that has flown past three is in sight of all of them for good: 600,000 looks a step, minutes a second
  const Scene past = parse(
      "[room]\nsize = [4, 3, 4]\nwalls = \"none\"\ngravity = [0, 0, 0]\n[physics]\ncollision = \"event\"\n"
      "[[box]]\nsize = [0.5, 0.5, 0.5]\nposition = [-1, 0.25, 0]\ncopies = { count = 3, offset = [0, 1, 0] "
      "}\n"
      "[[ball]]\nradius = 0.1\nposition = [1, 1, 1]\nvelocity = [2.9e6, 1e5, 0]\n",
      "past.toml");
  EXPECT_TRUE(std::holds_alternative<sim::Snapshot>(past.run()->at({1, 1})));
}

TEST(Hostile, WhatIsNotTomlIsOneLine) {
  EXPECT_THAT(complaint("title == 1"), StartsWith("a.toml:1:8: not TOML: "));
  EXPECT_THAT(complaint("[room"), StartsWith("a.toml:1:6: not TOML: "));
  for (const std::string text :
       {"a = [1, 2", "a = \"b", "seed = 99999999999999999999", "= 1", "a = 1 b = 2"}) {
    const std::string line = complaint(text);
    EXPECT_THAT(line, HasSubstr("not TOML")) << text;
    EXPECT_EQ(line.find('\n'), std::string::npos);
  }
}

TEST(Hostile, WhatIsGivenTwiceIsNoSyntaxErrorAndSaysWhereItWasFirst) {
  EXPECT_EQ(complaint("[room]\n[room]"),
            "a.toml:2:1: [room] is given a second time; the first is in line 1: put its keys together");
  EXPECT_EQ(
      complaint(
          "title = \"[look]\"\n[look]\ntheme = \"paper\"\n[room]\n\n [ \"look\" ] # more\ncaption = true"),
      "a.toml:6:2: [ \"look\" ] is given a second time; the first is in line 2: put its keys together");
  EXPECT_EQ(complaint("[look]\n[[look]]"),
            "a.toml:2:1: [[look]] is given a second time; the first is in line 1");
  EXPECT_EQ(complaint("[[box]]\n[[box]]\n[box]"),
            "a.toml:3:1: [box] is given a second time; the first is in line 2");
  EXPECT_EQ(complaint("look.theme = \"paper\"\n[look]\ncaption = true"),
            "a.toml:2:1: [look] is given a second time; the first is in line 1: put its keys together");
  EXPECT_EQ(complaint("title = 1\nseed = 1\ntitle = 2"),
            "a.toml:3:9: 'title' is given a second time; the first is in line 1");
  // of the same table, not of the one before
  EXPECT_EQ(complaint("[[box]]\nmass = 1\n[[box]]\nsize = [1, 1]\nmass = 1\nmass = 2"),
            "a.toml:6:8: 'mass' is given a second time; the first is in line 5");
  EXPECT_EQ(complaint("camera = { width = 1, width = 2 }"), "a.toml:1:31: 'width' is given a second time");
}

TEST(Hostile, WhatIsForgottenIsNamed) {
  EXPECT_EQ(complaint("[look]\ntheme = \"paper\ntrails = 1"),
            "a.toml:2:15: not TOML: a quote is opened here and not closed");
  EXPECT_THAT(complaint("[room]\nsize = [4, 3\n[[box]]\nmass = 1"),
              testing::EndsWith("not TOML: a bracket opened in line 2 is not closed"));
  EXPECT_THAT(complaint("[[box]\nmass = 1"),
              testing::EndsWith("not TOML: a table's name closes as it opens: [room], [[box]]"));
  EXPECT_THAT(complaint("[look]\ntheme = paper"),
              testing::EndsWith("not TOML: words go in quotes: \"paper\""));
  EXPECT_THAT(complaint("[box]\nmass ="), testing::EndsWith("not TOML: a value is missing after the ="));
  EXPECT_THAT(complaint("[box]\nmass = .1"),
              testing::EndsWith("not TOML: a number has a digit before its point: 0.1"));
  EXPECT_THAT(complaint("[box]\nsize = [1, -.1]"),
              testing::EndsWith("not TOML: a number has a digit before its point: 0.1"));
  EXPECT_THAT(complaint("[box]\nmass = 0,5"),
              testing::EndsWith("not TOML: a number has a point, not a comma: 0.1"));
  EXPECT_THAT(complaint("[box]\nmass"), testing::EndsWith("not TOML: a key is given as key = value"));
}

TEST(Hostile, NothingIsNoScene) {
  EXPECT_EQ(complaint(""), "a.toml: has no keys at all; `obscura new NAME` writes a scene to start from");
  EXPECT_EQ(complaint("# only a comment\n"),
            "a.toml: has no keys at all; `obscura new NAME` writes a scene to start from");
}

TEST(Hostile, FilesThatAreNone) {
  const fs::path folder =
      fs::temp_directory_path() / ("obscura_scene_hostile_test_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  EXPECT_THROW(
      {
        try {
          read((folder / "none.toml").string());
        } catch (const Error& error) {
          EXPECT_EQ(error.what(), (folder / "none.toml").string() + ": no such file");
          throw;
        }
      },
      Error);
  EXPECT_THROW(
      {
        try {
          read(folder.string());
        } catch (const Error& error) {
          EXPECT_EQ(error.what(), folder.string() + ": is a folder, not a scene");
          throw;
        }
      },
      Error);
  std::ofstream(folder / "long.toml") << "title = \"a\"\n" << std::string(17 << 20, '#');
  EXPECT_THROW(
      {
        try {
          read((folder / "long.toml").string());
        } catch (const Error& error) {
          EXPECT_EQ(error.what(), (folder / "long.toml").string() +
                                      ": is longer than 16 MiB; copies say many bodies in one line");
          throw;
        }
      },
      Error);
  fs::remove_all(folder);
}

// a scene with one of everything: what mutations start from
constexpr const char* kWhole = R"(version = 1
title = "a"
duration = 2.5
seed = 3
[room]
size = [8, 4.5]
corner = [0, 0]
walls = [{ point = [0, 0], normal = [0.2, 1], elasticity = 0.5 }]
[physics]
rate = "600/1"
[[particle]]
name = "ball"
position = [4, 3]
elasticity = { from = 0, to = 1 }
fixed = "0,2..3"
copies = { count = [3, 2], offset = [[0.3, 0], [0, 0.3]], jitter = 0.02, turn = 3, around = [4, 2] }
[[box]]
name = "crate"
size = [1.0, 0.5]
position = [5, 3]
angle = 30
[[spring]]
between = ["ball[3]", { body = "crate", local = [0.5, 0.25] }]
[[spring]]
between = ["ball[*]", [1, 1]]
stiffness = [1, 2, 3, 4, 5, 6]
[[net]]
of = "ball"
[[mouse]]
path = [[1.0, 4, 3], [1.6, 5.5, 3.8]]
[camera]
keys = [{ time = 0, center = [4, 2], width = 9 }, { time = 4, ease = "in" }]
[look]
trails = { ball = 1 }
)";

TEST(Hostile, MutationsEndInASceneOrInComplaints) {
  ASSERT_EQ(complaint(kWhole), "");
  std::mt19937 random(7);
  const auto below = [&](std::size_t n) { return std::size_t(random()) % n; };
  const std::vector<std::string> pieces = {"[",          "]",    "{",       "}",     "\"",
                                           "'",          ".",    ",",       "=",     "\n",
                                           "#",          "-",    "0",       "1e308", "nan",
                                           "inf",        "-1",   "\"\"\"",  "[*]",   "[[",
                                           "]]",         "0..4", "true",    "name",  "copies",
                                           "\xff",       "\x01", "é",       "ball",  "9223372036854775807",
                                           "1979-05-27", "from", "[room]\n"};
  const std::string whole = kWhole;
  int good = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string text = whole;
    for (std::size_t edits = 1 + below(4); edits > 0; --edits) {
      const std::size_t at = below(text.size());
      switch (below(6)) {
        case 0:
          text.erase(at, 1 + below(8));
          break;
        case 1:
          text.insert(at, pieces[below(pieces.size())]);
          break;
        case 2:
          text[at] = char(below(256));
          break;
        case 3: {  // a line somewhere else
          const std::size_t end = std::min(text.find('\n', at), text.size() - 1);
          const std::string part = text.substr(at, end - at + 1);
          text.insert(below(text.size()), part);
          break;
        }
        case 4:
          text.insert(at, " ");
          break;
        default: {  // a number for another
          const std::size_t digit = text.find_first_of("0123456789", at);
          if (digit != std::string::npos)
            text.replace(digit, 1, below(2) ? std::to_string(below(10)) : pieces[below(pieces.size())]);
        }
      }
      if (text.empty()) text = " ";
    }
    try {
      parse(text, "a.toml");
      ++good;
    } catch (const Error& error) {
      for (const Complaint& each : error.complaints)
        ASSERT_EQ(each.text().find('\n'), std::string::npos) << each.text();
    }
  }
  EXPECT_GT(good, 30);    // some are harmless
  EXPECT_LT(good, 2000);  // most are not
}

TEST(Hostile, NoiseEndsInComplaints) {
  std::mt19937 random(11);
  for (int round = 0; round < 2000; ++round) {
    std::string text;
    for (int n = int(random() % 200); n > 0; --n)
      text += round % 2 ? char(random() % 256) : char(32 + random() % 96);
    try {
      parse(text, "a.toml");
    } catch (const Error&) {
    }
  }
}

TEST(Hostile, OverridesOfNoise) {
  std::mt19937 random(13);
  const std::vector<std::string> words = {
      "ball",  "crate",  "[0]",   "[3]",      ".",     "position", "x",
      "=",     "copies", "count", "path",     "-1",    "[",        "]",
      "mouse", "room",   "walls", "1",        "{a=1}", "title",    "keys",
      "look",  "trails", "fixed", "\"0..1\"", "[1,2]", "between",  "[99999999999999999999]",
      "name"};
  for (int round = 0; round < 3000; ++round) {
    std::vector<std::string> sets(1 + random() % 3);
    for (std::string& set : sets)
      for (int n = 1 + int(random() % 7); n > 0; --n) set += words[random() % words.size()];
    try {
      parse(kWhole, "a.toml", sets);
    } catch (const Error&) {
    }
  }
}

TEST(Hostile, AGridOfMoreBodiesThanANumberHoldsIsRefused) {
  EXPECT_THAT(complaint("[[ball]]\nposition = [1, 1]\n"
                        "copies = { count = [1000000, 1000000] }"),
              HasSubstr("the most a scene may have"));
}

TEST(Hostile, ALeverOutOfAllProportionIsRefused) {
  // found by fuzzing: ten steps made 80 J of 40
  EXPECT_EQ(complaint("[[box]]\nname = \"arm\"\nsize = [1, 0.2]\nposition = [2, 2]\n"
                      "[[joint]]\ntype = \"pin\"\nbetween = [\"arm\", \"room\"]\nat = [-1000000, 2]"),
            "a.toml:8:6: this is 1e+06 m from the middle of 'arm': expected at most 900");
}

TEST(Hostile, AHundredThousandBallsAtOnePlaceAreToldAndNotCounted) {
  const std::string text = "[[ball]]\nposition = [1, 1]\nradius = 0.1\ncopies = { count = 100000 }\n";
  EXPECT_EQ(
      complaint(text),
      "a.toml:2:12: 'ball[0][0]' and 'ball[0][1]' overlap by 0.2 m at the start, and at least 99999 more "
      "pairs do; move them apart, or let them be pushed: [physics] overlap = \"separate\"");
  // nor can so many be pushed apart
  EXPECT_EQ(complaint(text + "[physics]\noverlap = \"separate\""),
            "a.toml: more than 20000000 pairs of bodies are near each other at the start, too many to be "
            "simulated; move them apart");
}

TEST(Hostile, AHundredThousandParticlesAtOnePlaceAreStepped) {
  // points do not touch each other
  for (const std::string z : {"", ", 1"}) {
    const Scene it =
        parse("[[particle]]\nposition = [1, 1" + z + "]\ncopies = { count = 100000 }\n[[ball]]\n" +
                  "position = [3, 1" + z + "]\ncopies = { count = 30, offset = [0.05, 0" +
                  (z.empty() ? "" : ", 0") + "] }\nradius = 0.02",
              "a.toml");
    EXPECT_TRUE(std::holds_alternative<sim::Snapshot>(it.run()->at({1, 600})));
  }
}

TEST(Hostile, MoreCouplesThanTheDirectSolverTakesAreRefused) {
  const std::string room = "[room]\nsize = [110, 80]\n",
                    grid = "count = [400, 250], offset = [[0.26, 0], [0, 0.26]]";
  const auto balls = [&](const std::string& count) {
    return "[[ball]]\nradius = 0.1\nposition = [0.2, 0.2]\ncopies = { " + count + " }\n";
  };
  EXPECT_EQ(
      complaint(room + "[physics]\nsolver = \"direct\"\n" + balls(grid)),
      "a.toml:4:10: the direct solver looks at all pairs of bodies and walls, 5000350000 here, and takes "
      "20000000 at most; leave 'solver' out: the iterative one is for thousands of bodies");
  EXPECT_THAT(
      complaint(room + "[physics]\ncollision = \"event\"\n" + balls(grid)),
      testing::AllOf(testing::StartsWith("a.toml:4:13: "), HasSubstr("collision = \"contact\" is for")));
  // what is not looked at is not counted: points among themselves, and fixed bodies
  EXPECT_EQ(
      complaint(room + "[physics]\nsolver = \"direct\"\n[[particle]]\nposition = [0.2, 0.2]\ncopies = { " +
                grid + " }\n" + "[[ball]]\nradius = 0.1\nposition = [109, 79]"),
      "");
  EXPECT_EQ(complaint(room + "[physics]\nsolver = \"direct\"\n" + balls(grid) +
                      "fixed = true\n[[ball]]\nradius = 0.1\nposition = [109, 79]"),
            "");
}

TEST(Hostile, TwentyThousandWallsAreRefused) {
  const std::string wall = "[[room.walls]]\npoint = [0, 0]\nnormal = [0, 1]\n",
                    ball = "[[ball]]\nposition = [0, 2]";
  EXPECT_EQ(complaint("[room]\n" + repeated(wall, 20'000) + ball),
            "a.toml:2:1: 'walls': 20000 walls are more than 1000, the most a room may have");
  EXPECT_EQ(complaint("[room]\n" + repeated(wall, 1000) + ball),
            "a.toml:26:1: room.walls[8] lies in one plane with 8 others: expected fewer; leave it out");
  EXPECT_EQ(complaint("[room]\n" + repeated(wall, 8) + ball), "");
}

TEST(Hostile, AHundredThousandBodiesAreRead) {
  const Scene it = parse(
      "[[particle]]\nposition = [1, 1]\ncopies = { count = [400, 250], offset = [[0.01, 0], [0, 0.01]] }",
      "a.toml");
  EXPECT_EQ(it.plane().model.bodies.size(), 100'000u);
}

// Ten looks a second at a film that may only lose energy, but for a billionth of what it begins with.
void expect_losses(const Scene& it, int seconds, double deepest) {
  const auto run = it.run();
  double before = std::get<sim::Snapshot>(run->at({0, 1})).energies.total();
  const double begun = before;
  for (int k = 1; k <= 10 * seconds; ++k) {
    const auto moment = run->at({k, 10});
    ASSERT_TRUE(std::holds_alternative<sim::Snapshot>(moment)) << k;
    const auto& now = std::get<sim::Snapshot>(moment);
    EXPECT_LE(now.energies.total(), before + 1e-9 * begun) << k;
    for (const auto& contact : now.contacts) EXPECT_GE(contact.gap, -deepest) << k;
    before = now.energies.total();
  }
}

// Friction stops and turns these two ten thousand times within a thousandth of a step, and four level corners
// that turn about one of them have their directions only by a long search: a minute for a second, once.
TEST(Hostile, TwoThatCrawlInCornersByEventsComeToTheEnd) {
  const Scene it = parse(
      "[room]\nsize = [1, 1, 1]\n[physics]\ncollision = \"event\"\n"
      "[[capsule]]\nposition = [0.25, 0.25, 0.25]\nvelocity = [2.998, 0.831, 1.822]\nradius = 0.065\n"
      "length = 0.291\nspin = [360.2, 9.1, -127.9]\nelasticity = 0\nfriction = 0.2\n"
      "[[box]]\nposition = [-0.25, 0.25, -0.25]\nvelocity = [2.226, -0.816, 2.591]\n"
      "size = [0.162, 0.097, 0.055]\nspin = [407.8, -76.4, 384.1]\nelasticity = 0\nfriction = 0.2",
      "crawl.toml");
  expect_losses(it, 1, 1e-9);
}

// Two boxes on a rod wedge themselves in after three seconds: near the angle at which friction locks, the
// forces that would keep their slides grow without bound, and threw them out of all places.
TEST(Hostile, WhatJamsIsStopped) {
  const Scene it = parse(
      "[room]\nsize = [3, 3]\n[physics]\nrate = 240\nsolver = \"direct\"\nimpacts = \"sequential\"\n"
      "[[box]]\nname = \"b0\"\nposition = [0.75, 0.75]\nvelocity = [-2.173, -3.496]\nsize = [0.221, 0.11]\n"
      "angle = 190.5\nspin = -295.9\nmass = 1\nelasticity = 0\nfriction = 0.5\n"
      "[[box]]\nname = \"b1\"\nposition = [1.25, 2.75]\nvelocity = [-1.432, 1.226]\nsize = [0.193, 0.145]\n"
      "angle = 134.2\nspin = -424.8\nmass = 10\nelasticity = 0\nfriction = 0.5\n"
      "[[box]]\nposition = [2.25, 1.25]\nvelocity = [1.842, 2.804]\nsize = [0.057, 0.062]\n"
      "angle = 223.8\nspin = -386.3\nmass = 1\nelasticity = 0\nfriction = 0.5\n"
      "[[ball]]\nposition = [2.25, 0.75]\nvelocity = [3.806, 2.649]\nradius = 0.040\nspin = 440.7\n"
      "mass = 1\nelasticity = 0\nfriction = 0.5\n"
      "[[polygon]]\nposition = [2.75, 1.75]\nvelocity = [2.931, 3.082]\nangle = 13\nmass = 1\n"
      "points = [[-0.15, -0.1], [0.15, -0.1], [0.1, 0.15], [-0.05, 0.18]]\nelasticity = 0\nfriction = 0.5\n"
      "[[joint]]\ntype = \"rod\"\nbetween = [\"b1\", \"b0\"]",
      "jam.toml");
  expect_losses(it, 4, 1e-6);
}

}  // namespace
}  // namespace obscura::scene
