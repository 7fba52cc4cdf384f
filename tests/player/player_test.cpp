// The page that `obscura render SCENE -o page.html` writes, in a browser: what it shows against the pictures
// of the same instants, what keys and pointers do, and that it keeps to itself.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <regex>
#include <sstream>

#include "app/program.h"
#include "media/browser.h"
#include "media/png.h"
#include "needs.h"
#include "player/firefox.h"
#include "player/tab.h"

namespace obscura::app {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::string kScenes = OBSCURA_SOURCE_DIR "/scenes/";

std::vector<std::uint8_t> from_base64(const std::string& text) {
  std::vector<std::uint8_t> bytes;
  std::uint32_t held = 0;
  int bits = 0;
  for (const char c : text) {
    const std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t at = letters.find(c);
    if (at == letters.npos) continue;
    held = held << 6 | std::uint32_t(at);
    if ((bits += 6) >= 8) bytes.push_back(std::uint8_t(held >> (bits -= 8)));
  }
  return bytes;
}

/// A page in each browser. Firefox and its display are large, and tried by `script/test all`.
class Player : public Program, public ::testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    Program::SetUp();
    if (std::string(GetParam()) == "firefox") {
      OBSCURA_LONG("firefox-esr xvfb", installed("firefox-esr") && installed("Xvfb"));
    } else {
      browser_ = media::browser();
      OBSCURA_NEEDS(browser_, "chromium-headless-shell");
    }
  }

  void TearDown() override {
    tab_.reset();  // before its folder goes
    Program::TearDown();
  }

  void start() {
    tab_.reset();
    if (browser_)
      tab_ = std::make_unique<Tab>(*browser_, folder_.string(), 960, 640);
    else
      tab_ = std::make_unique<Firefox>(folder_.string(), 960, 640);
  }

  /// Makes a page of a scene, and opens it.
  void open(const std::string& scene, const std::string& flags = {}) {
    const Outcome made = obscura("render " + scene + " -o page.html --progress none " + flags);
    if (made.exit != 0) throw std::runtime_error(made.err);
    url_ = "file://" + path("page.html");
    start();
    tab_->open(url_);
    tab_->value("obscura.then(() => 1)");
  }

  Browser::Json player(const std::string& does) {
    return tab_->value("obscura.then((player) => { " + does + " })");
  }
  double frame() { return player("return player.frame;"); }

  /// Its picture of a frame, or its sketch of it.
  media::Image picture(double frame, int width, int height, bool sketched = false) {
    player("player.pause(); player.picture.size(" + std::to_string(width) + ", " + std::to_string(height) +
           "); player.frame = " + std::to_string(frame) + "; return 1;");
    return picture_now(sketched ? "player.draw(true); " : "player.draw(); ");
  }
  media::Image picture_now(const std::string& after = {}) {
    const std::string url = player(after + "return player.picture.canvas.toDataURL('image/png');");
    const std::vector<std::uint8_t> bytes = from_base64(url.substr(url.find(',') + 1));
    std::ofstream(path("seen.png"), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    return media::read_png(path("seen.png")).image;
  }

  /// The films' pictures of some frames.
  std::vector<media::Image> frames(const std::string& scene, const std::vector<int>& numbers, int width,
                                   int height) {
    std::string list;
    for (const int n : numbers) list += (list.empty() ? "" : ",") + std::to_string(n);
    const Outcome made = obscura("render " + scene + " -o frames/{frame}.png --progress none --size " +
                                 std::to_string(width) + "x" + std::to_string(height) + " --frames " + list);
    EXPECT_EQ(made.exit, 0) << made.err;
    std::vector<media::Image> all;
    for (const int n : numbers)
      all.push_back(media::read_png(path("frames/" + std::to_string(n) + ".png")).image);
    return all;
  }

  std::optional<std::string> browser_;
  std::string url_;
  std::unique_ptr<Browser> tab_;
};

// How many pixels, beside each other, differ from all that the film's picture is up to half a pixel around
// them by more than a quarter of a pixel's coverage. Two ways of covering a thin curve's pixels differ so in
// one pixel here and there; a line or a letter that is displaced does in many.
int displaced(const media::Image& film, const media::Image& page) {
  constexpr int kCoverage = 64;  // levels
  const int width = film.width, height = film.height;
  const auto level = [&](int x, int y, int c) {
    x = std::clamp(x, 0, width - 1), y = std::clamp(y, 0, height - 1);
    return int(film.row(y)[4 * x + c]);
  };
  std::vector<char> off(std::size_t(width) * height, 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) {
        const int seen = page.row(y)[4 * x + c];
        if (std::abs(seen - level(x, y, c)) <= kCoverage) continue;
        double low = 255, high = 0;
        for (int j = -1; j <= 1; ++j)
          for (int i = -1; i <= 1; ++i) {
            const double v =
                (level(x, y, c) + level(x + i, y, c) + level(x, y + j, c) + level(x + i, y + j, c)) / 4.0;
            low = std::min(low, v), high = std::max(high, v);
          }
        if (seen < low - kCoverage || seen > high + kCoverage) off[std::size_t(width) * y + x] = 1;
      }
  int count = 0;
  for (int y = 1; y + 1 < height; ++y)
    for (int x = 1; x + 1 < width; ++x) {
      if (!off[std::size_t(width) * y + x]) continue;
      int around = 0;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) around += off[std::size_t(width) * (y + j) + x + i];
      count += around > 1;
    }
  return count;
}

TEST_P(Player, ShowsThePicturesOfTheFilm) {
  std::vector<int> numbers;
  for (int i = 0; i < 20; ++i) numbers.push_back(i * 31 % 600);
  const auto film = frames(kScenes + "room.toml", numbers, 960, 540);
  open(kScenes + "room.toml");
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const media::Image page = picture(numbers[i], 960, 540);
    EXPECT_EQ(displaced(film[i], page), 0) << "frame " << numbers[i];
  }
}

TEST_P(Player, WhatIsDisplacedWouldBeSeen) {
  const auto film = frames(kScenes + "room.toml", {90}, 960, 540);
  open(kScenes + "room.toml");
  // 0.8 px to the right
  player("player.picture.view.move(1.6, 0); return 1;");
  EXPECT_GT(displaced(film[0], picture(90, 960, 540)), 50);
}

TEST_P(Player, ShowsPlotsMarksAndCaptionsOfTheFilm) {
  for (const char* scene : {"swing", "energy", "slope"}) {
    const std::vector<int> numbers{0, 77, 190};
    const auto film = frames(kScenes + scene + ".toml", numbers, 960, 540);
    open(kScenes + scene + ".toml");
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const media::Image page = picture(numbers[i], 960, 540);
      EXPECT_EQ(displaced(film[i], page), 0) << scene << " frame " << numbers[i];
    }
  }
}

TEST_P(Player, ShowsSeveralRunsBesideEachOther) {
  const std::vector<int> numbers{150};
  const auto film = frames(kScenes + "euler_and_rk4.toml", numbers, 960, 540);
  open(kScenes + "euler_and_rk4.toml");
  EXPECT_EQ(displaced(film[0], picture(150, 960, 540)), 0);
}

// levels between two pictures, on the average
double apart(const media::Image& a, const media::Image& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.pixels.size(); ++k) sum += std::abs(a.pixels[k] - b.pixels[k]);
  return sum / double(a.pixels.size());
}

// Space is lit and hidden pixel by pixel: it looks alike, and bodies stand where they do.
TEST_P(Player, ShowsSpaceAlike) {
  for (const char* look : {"crate.toml", "explosion.toml --theme screen --to 2"}) {
    const std::string scene = std::string(kScenes) + look;
    const auto film = frames(scene, {60}, 640, 360);
    open(scene);
    const media::Image page = picture(60, 640, 360);
    EXPECT_LT(apart(film[0], page), 0.8) << look << ": levels, on the average";
    EXPECT_LT(displaced(film[0], page), 0.003 * 640 * 360) << look;
  }
}

TEST_P(Player, ShowsMaterialsAlike) {
  std::ofstream(path("materials.toml")) << R"toml(title = "materials"
duration = 1
[room]
size  = [4, 3, 4]
walls = "ground"
[[ball]]
name = "a"
radius = 0.4
position = [-1, 0.4, 0]
material = "metal"
[[box]]
name = "b"
size = [0.8, 0.8, 0.8]
position = [0.2, 0.4, 0]
material = "checks"
[[capsule]]
name = "c"
length = 0.8
radius = 0.2
position = [1.2, 0.6, 0]
material = "wood"
[[box]]
name = "d"
size = [0.6, 0.3, 0.6]
position = [0.2, 0.95, 0]
material = "metal"
[camera]
width = 5
center = [0, 0.6, 0]
)toml";
  const auto film = frames(path("materials.toml"), {3}, 640, 360);
  open(path("materials.toml"));
  EXPECT_LT(apart(film[0], picture(3, 640, 360)), 0.8);
  // without them it would be another picture
  player(
      "const { lit } = player.picture.spaces[0]; lit.occlusion.texels.forEach((_, i, all) => { if (i % 24 "
      "=== "
      "10) all[i] = 0; }); "
      "lit.pieces.fill(lit.gl.TEXTURE2, lit.occlusion.texels); return 1;");
  EXPECT_GT(apart(film[0], picture(3, 640, 360)), 1.5);
}

constexpr const char* kThrown = R"toml(title = "thrown"
duration = 1
[room]
size  = [4, 3, 4]
walls = "ground"
[[ball]]
name     = "apple"
radius   = 0.3
position = [0, 1, 0]
velocity = [1, 3, 0.5]
label    = "an apple"
arrows   = ["velocity"]
[look]
velocity_scale = 0.4
[camera]
projection = "orthographic"
center     = [0, 1, 0]
width      = 5
)toml";

// What is said of space goes with it: the page turned by 40 degrees shows what a film by a camera there does.
TEST_P(Player, LabelsAndArrowsTurnWithTheView) {
  std::ofstream(path("here.toml")) << kThrown << "azimuth = 20\n";
  std::ofstream(path("there.toml")) << kThrown << "azimuth = 60\n";
  const auto film = frames(path("there.toml"), {12}, 640, 360);
  open(path("here.toml"));
  const media::Image before = picture(12, 640, 360);
  EXPECT_GT(displaced(film[0], before), 100);
  player("player.picture.view.turn = 40 * Math.PI / 180; return 1;");
  const media::Image turned = picture(12, 640, 360);
  EXPECT_LT(apart(film[0], turned), 0.8);
  EXPECT_LT(displaced(film[0], turned), 0.001 * 640 * 360);
}

// So do arcs of angles, dashes, and paths behind and before bodies.
TEST_P(Player, ArcsAndPathsTurnWithTheView) {
  const std::string scene = std::string(kThrown).substr(0, std::string(kThrown).find("[camera]")) +
                            R"toml([[film.angle]]
at   = [-1, 0.5, 0]
from = [1, 0.5, 0]
to   = "apple"
label = "a"
[[film.path]]
at    = "apple"
front = true
[[film.path]]
at      = { body = "apple", local = [0.4, 0, 0] }
lasting = 0.2
color   = "red"
)toml";
  const std::string camera = "[camera]\nprojection = \"orthographic\"\ncenter = [0, 1, 0]\nwidth = 5\n";
  std::ofstream(path("here.toml")) << scene << camera << "azimuth = 20\n";
  std::ofstream(path("there.toml")) << scene << camera << "azimuth = 50\n";
  const auto film = frames(path("there.toml"), {24}, 640, 360);
  open(path("here.toml"));
  EXPECT_GT(displaced(film[0], picture(24, 640, 360)), 100);
  player("player.picture.view.turn = 30 * Math.PI / 180; return 1;");
  const media::Image turned = picture(24, 640, 360);
  EXPECT_LT(apart(film[0], turned), 0.8);
  EXPECT_LT(displaced(film[0], turned), 0.001 * 640 * 360);
}

// Where a whole picture takes long, what moves is sketched: bodies are where they are, lit as they are.
TEST_P(Player, SketchesSpaceWhileItMoves) {
  const std::string scene = std::string(kScenes) + "tower.toml --to 1";
  const auto film = frames(scene, {50}, 640, 360);
  open(scene);
  picture(50, 640, 360);
  // as a slow machine finds it
  player("player.costs = [1e3, 1e3]; return 1;");
  EXPECT_TRUE(bool(player("return player.slow;")));
  const media::Image sketch = picture(50, 640, 360, true);
  EXPECT_LT(apart(film[0], sketch), 3.5);
  EXPECT_LT(displaced(film[0], sketch), 0.02 * 640 * 360);
  // told, not judged: how long seeks take here
  const std::string took = player(
      "const all = [true, false].map((sketched) => { const ms = []; for (let k = 0; k < 9; ++k) { const t = "
      "performance.now(); player.frame = (7 * k) % player.last; player.draw(sketched); "
      "player.picture.context.getImageData(0, 0, 1, 1); ms.push(performance.now() - t); } return ms.sort((a, "
      "b) => a - "
      "b)[4].toFixed(1); }); return all.join(' ms sketched, ') + ' ms whole';");
  std::cout << "a seek: " << took << "\n";
  player("player.costs = [1e3, 1e3]; player.frame = 50; return 1;");
  // and whole when it has stood for a while
  player(
      "player.draw(true); return new Promise((done) => { const wait = () => player.sketched ? "
      "setTimeout(wait, 20) : "
      "done(1); wait(); });");
  EXPECT_LT(apart(film[0], picture_now()), 0.8);
}

TEST_P(Player, ShowsSeveralRunsInSpaceBesideEachOther) {
  std::ofstream(path("two.toml")) << kThrown << "[film]\nvary = \"apple.elasticity=0,1\"\n";
  const auto film = frames(path("two.toml"), {50}, 960, 540);
  open(path("two.toml"));
  const media::Image page = picture(50, 960, 540);
  EXPECT_LT(apart(film[0], page), 0.8);
  EXPECT_LT(displaced(film[0], page), 0.001 * 960 * 540);
}

TEST_P(Player, KeysAndButtonsMoveTheFilm) {
  open(kScenes + "cradle.toml");
  EXPECT_EQ(frame(), 0);
  tab_->press("ArrowRight");
  tab_->press("ArrowRight");
  EXPECT_EQ(frame(), 2);
  tab_->press("ArrowLeft");
  EXPECT_EQ(frame(), 1);
  tab_->press("ArrowRight", true);
  EXPECT_EQ(frame(), 61) << "with Shift a second";
  tab_->press("End");
  EXPECT_EQ(frame(), double(player("return player.last;")));
  tab_->press("Home");
  EXPECT_EQ(frame(), 0);
  tab_->press("n");
  const double event = player("return player.film.events[0].film * player.film.fps;");
  EXPECT_NEAR(frame(), event, 1e-9) << "the first event";
  tab_->press(" ");
  EXPECT_TRUE(bool(player("return player.playing;")));
  tab_->press(" ");
  EXPECT_FALSE(bool(player("return player.playing;")));
  tab_->press("]");
  EXPECT_EQ(double(player("return player.rate;")), 2);
  tab_->press("l");
  EXPECT_EQ(tab_->value("document.getElementById('loop').getAttribute('aria-pressed')"), "true");
  tab_->value("document.getElementById('on').click()");
  tab_->value(
      "(() => { const s = document.getElementById('scrub'); s.value = 42; s.dispatchEvent(new "
      "Event('input')); })()");
  EXPECT_EQ(frame(), 42);
  EXPECT_THAT(tab_->complaints(url_), IsEmpty());
}

TEST_P(Player, PlaysAndBeginsAgain) {
  open(kScenes + "cradle.toml", "--to 0.2");
  player("player.loop(); player.speed(4); player.play(); return 1;");
  // it has begun again when it is at an earlier frame than before
  const bool again = player(
      "return new Promise((done) => { let before = -1; const look = () => { if (player.frame < before) "
      "return done(true); "
      "before = player.frame; requestAnimationFrame(look); }; look(); });");
  EXPECT_TRUE(again);
  EXPECT_THAT(tab_->complaints(url_), IsEmpty());
}

TEST_P(Player, PointingAtABodyTellsItsNameAndValues) {
  open(kScenes + "bounce.toml");
  const Browser::Json at = player(
      "player.show(30); player.draw(); const body = player.film.bodies[0]; const disc = "
      "player.reel.things.find((t) => t.what "
      "=== 3 && t.kind === 0 && t.index === body.index); disc.lives_at(30); const n = disc.numbers(30, []); "
      "const box = "
      "player.picture.canvas.getBoundingClientRect(); return [box.left + n[0] * box.height / 1080, box.top + "
      "n[1] * "
      "box.height / 1080, body.name];");
  tab_->point(at[0], at[1]);
  const std::string tip = tab_->value(
      "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => "
      "done(document.getElementById('tip').textContent))))");
  EXPECT_THAT(tip, HasSubstr("ball["));
  EXPECT_THAT(tip, HasSubstr("m/s"));
  // half a second of free fall
  EXPECT_THAT(tip, HasSubstr("4.9"));
  EXPECT_THAT(tab_->complaints(url_), IsEmpty());
}

// The values of a run as `obscura states` writes them, at each frame of the film, by their columns' names.
std::vector<std::map<std::string, double>> table_of(const std::string& csv) {
  std::vector<std::map<std::string, double>> rows;
  const auto table = cells(csv);
  for (std::size_t row = 1; row < table.size(); ++row) {
    rows.emplace_back();
    for (std::size_t i = 0; i < std::min(table[0].size(), table[row].size()); ++i)
      rows.back()[table[0][i]] = std::atof(table[row][i].c_str());
  }
  return rows;
}

// In a large room, beside a fast body, too: what the table tells is the run's own in each of its digits.
TEST_P(Player, TheTableTellsTheRunsOwnValues) {
  std::ofstream(path("large.toml")) << R"toml(title = "A shot"
duration = 2
[room]
size  = [120, 60]
walls = "ground"
[[ball]]
name     = "shot"
radius   = 1
position = [5, 2]
velocity = [20, 25]
[[ball]]
name       = "slow"
radius     = 1
position   = [60, 1]
velocity   = [0.05, 0]
elasticity = 0
[[spring]]
between     = [[90, 30], "hung"]
stiffness   = 10
rest_length = 1
[[ball]]
name     = "hung"
radius   = 1
mass     = 1
position = [90, 20]
)toml";
  for (const std::string& scene : {path("large.toml"), kScenes + "room.toml --set duration=2"}) {
    const auto run = table_of(obscura("states " + scene + " --every 1/60 --format csv").out);
    ASSERT_GT(run.size(), 100u);
    open(scene);
    for (int frame = 0; frame < 110; frame += 11) {
      const Browser::Json rows = player("return player.values.table(" + std::to_string(frame) +
                                        ", -1).rows.map((row) => [row.body.name, ...row.words]);");
      for (const Browser::Json& row : rows) {
        const std::string name = row[0];
        int column = 0;
        for (const char* what : {"position.x", "position.y", "velocity.x", "velocity.y"}) {
          std::string told = row[++column];
          if (const std::size_t at = told.find("−"); at != told.npos) told.replace(at, 3, "-");
          const std::size_t point = told.find('.');
          const double digit = point == told.npos ? 1 : std::pow(10, -double(told.size() - point - 1));
          const double is = run[std::size_t(frame)].at(name + "." + what);
          // rounded, of what is known to a twentieth of a digit
          EXPECT_LE(std::abs(std::stod(told) - is), 0.56 * digit)
              << name << "." << what << " in frame " << frame << ": " << told << ", is " << is;
          EXPECT_LE(digit, 0.011) << name << "." << what << ": " << told;
        }
      }
    }
  }
  // what goes on as it does is told as it does
  open(path("large.toml"));
  EXPECT_TRUE(
      bool(player("return [...Array(100).keys()].every((frame) => player.values.table(frame, "
                  "-1).rows[0].words[2] === '20.00');")));
}

// Bodies of several runs have one name: the table says whose each row is, and sorts by runs, too.
TEST_P(Player, TheTableSaysOfWhichRunARowIs) {
  open(kScenes + "euler_and_rk4.toml");
  const std::string columns =
      "document.getElementById('values').open = true; player.list(); return [...document.querySelectorAll("
      "'#values tr')].map((row) => row.children[1].textContent);";
  const Browser::Json all = player(columns);
  ASSERT_GE(all.size(), 3u);
  EXPECT_EQ(all[0], "run");
  const Browser::Json names = player(
      "return [...new Set(player.film.bodies.filter((body) => !body.fixed).map((body) => body.run))];");
  EXPECT_EQ(names.size(), 2u);
  for (std::size_t i = 1; i < all.size(); ++i)
    EXPECT_THAT(std::vector<std::string>(names), ::testing::Contains(std::string(all[i])));
  // sorted by speed, by a column that is a number, and by the run
  player("document.querySelector('#values th:last-child button').click(); return 1;");
  EXPECT_TRUE(tab_->value(
      "(() => { const speeds = [...document.querySelectorAll('#values td:last-child')].map((each) => "
      "Number(each.textContent)); return speeds.every((v, i) => i === 0 || v <= speeds[i - 1]); })()"));
  player("document.querySelector('#values th:nth-child(2) button').click(); return 1;");
  EXPECT_EQ(player(columns), all);
  // pointed at, a body says whose it is
  player(
      "player.pointed = { part: 1, index: player.film.bodies.find((b) => b.part === 1).index, x: 0, y: 0 "
      "}; player.tell(); return 1;");
  EXPECT_THAT(std::string(tab_->value("document.getElementById('tip').textContent")),
              HasSubstr(std::string(names[1])));
  EXPECT_THAT(tab_->complaints(url_), IsEmpty());
}

// A page of a part of the film tells of that part: events are those it shows, where it shows them.
TEST_P(Player, TellsOfThePartThatItShows) {
  const std::string events =
      "return player.film.events.map((each) => [each.time, player.frame_of(each), each.text]);";
  open(kScenes + "room.toml");
  const Browser::Json whole = player(events);
  EXPECT_GT(double(whole.back()[0]), 9);
  open(kScenes + "room.toml", "--from 1 --to 3");
  const Browser::Json shown = player(events);
  ASSERT_GT(shown.size(), 5u);
  std::size_t count = 0;
  for (const Browser::Json& each : whole)
    if (const double time = each[0]; time >= 1 && time < 3) {
      ASSERT_LT(count, shown.size());
      EXPECT_EQ(shown[count][2], each[2]);
      EXPECT_NEAR(double(shown[count][1]), std::min(double(each[1]) - 60, 119.0), 1e-9) << each;
      ++count;
    }
  EXPECT_EQ(shown.size(), count);
  // no instant that is told is later than its end
  const std::string story = tab_->value("document.getElementById('story').textContent");
  EXPECT_THAT(story, HasSubstr("At the end, at 3 s"));
  EXPECT_THAT(story, HasSubstr("from 1 s to 3 s; it lasts 10 s"));
  const std::regex instant("at ([0-9.]+) s\\b");
  for (std::sregex_iterator at(story.begin(), story.end(), instant), end; at != end; ++at)
    EXPECT_LE(std::stod((*at)[1]), 3) << at->str();
}

// An impact has one time, in the sentences and in the list.
TEST_P(Player, ListsAnImpactWhenItIsDescribed) {
  const std::string described = obscura("describe " + kScenes + "room.toml").out;
  std::smatch first;
  ASSERT_TRUE(std::regex_search(described, first, std::regex("the first at ([0-9.]+) s"))) << described;
  open(kScenes + "room.toml");
  EXPECT_THAT(std::string(player("return document.querySelector('#events li').textContent;")),
              ::testing::StartsWith(first[1].str() + " s"));
}

// Given the page alone: when was the crate struck, how fast was it, how does that look from above?
TEST_P(Player, TellsAStrangerWhenTheCrateWasStruckAndHowFastItWas) {
  open(kScenes + "crate.toml");
  tab_->press("n");
  const std::string struck = tab_->value(
      "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => "
      "done(document.querySelector('#events .now').textContent))))");
  EXPECT_THAT(struck, HasSubstr("0.580 s"));
  // after a fall of that time: 9.81 * 0.58
  EXPECT_THAT(struck, HasSubstr("hits the stone, closing at 5.69 m/s"));
  // it flew at 3 m/s and fell for that time: what is told is of the instant before the impact, on the clock
  // too
  tab_->press("v");
  const std::string table = tab_->value(
      "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => "
      "done([...document.querySelectorAll('#values tr')].find((row) => "
      "row.textContent.startsWith('board[2]')).lastChild.textContent))))");
  EXPECT_NEAR(std::stod(table), std::hypot(3, 9.81 * 0.58), 0.005);
  EXPECT_EQ(tab_->value("document.getElementById('when').textContent"), "at 0.580 s, just before");
  EXPECT_EQ(tab_->value("document.getElementById('clock').textContent"), "0.58 / 3.00 s");
  // a click on the tick goes there, not to the frame beside it
  tab_->press("v");
  tab_->press("Home");
  tab_->value("scrollTo(0, 0)");
  const Browser::Json tick = tab_->value(
      "(async () => { const player = await obscura, box = "
      "document.getElementById('scrub').getBoundingClientRect(); "
      "return [box.left + player.track_place(player.frame_of(player.film.events[0]), box.width) + 1, box.top "
      "+ "
      "box.height / 2]; })()");
  tab_->drag(tick[0], tick[1], tick[0], tick[1]);
  EXPECT_NEAR(double(player("return player.frame / 60;")), 0.58, 0.001);
  tab_->press("v");
  // sorted by speed the fastest comes first, and has a ring where one points at its row
  tab_->value("document.querySelector('#values th:last-child button').click()");
  EXPECT_TRUE(tab_->value(
      "(() => { const speeds = [...document.querySelectorAll('#values td:last-child')].map((each) => "
      "Number(each.textContent)); return speeds.every((v, i) => i === 0 || v <= speeds[i - 1]); })()"));
  tab_->value("document.querySelector('#values tbody tr').dispatchEvent(new PointerEvent('pointerenter'))");
  EXPECT_TRUE(
      player("const named = player.picture.named, [x, y] = player.picture.place_of(...named); "
             "return x > 0 && x < player.picture.width && y > 0 && y < 1080;"));
  tab_->press("t");
  EXPECT_NEAR(double(player("return player.picture.spaces[0].lenses(player.frame)[0].back[1];")), 1, 1e-6);
  EXPECT_THAT(tab_->complaints(url_), IsEmpty());
}

TEST_P(Player, WheelAndFingersComeNearer) {
  open(kScenes + "cradle.toml");
  tab_->wheel(300, 200, -200);
  EXPECT_GT(double(player("return player.picture.view.zoom;")), 1.1);
  tab_->press("0");
  EXPECT_EQ(double(player("return player.picture.view.zoom;")), 1);
  tab_->pinch(400, 200, {40, 60, 80});
  EXPECT_GT(double(player("return player.picture.view.zoom;")), 1.2);
}

TEST_P(Player, SpaceIsSeenFromAbove) {
  open(kScenes + "crate.toml");
  tab_->press("t");
  const double up = player("return player.picture.spaces[0].lenses(0)[0].back[1];");
  EXPECT_NEAR(up, 1, 1e-6);
  // what is pointed at is found where it is seen from there
  const Browser::Json found = player(
      "player.frame = 0; player.draw(); const s = player.picture.spaces[0], lens = s.lenses(0)[0]; const [x, "
      "y] "
      "= "
      "lens.page(s.body(0).at); return s.body_at(x, y, 0);");
  EXPECT_TRUE(found.is_array());
  // turned a little from there
  tab_->drag(480, 300, 480, 290);
  const double turned = player("return player.picture.spaces[0].lenses(0)[0].back[1];");
  EXPECT_LT(turned, 0.9999);
  EXPECT_GT(turned, 0.95);
  tab_->press("0");
  EXPECT_FALSE(bool(player("return player.picture.view.moved;")));
  tab_->press("t");
  tab_->press("t");
  EXPECT_FALSE(bool(player("return player.picture.view.moved;")));
  // the wheel comes nearer to what it points at
  const std::string place =
      "const [x, y] = player.picture.spaces[0].lenses(0)[0].page(player.picture.spaces[0].body(0).at), box = "
      "player.picture.canvas.getBoundingClientRect(); return [box.left + x * box.height / 1080, box.top + y "
      "* "
      "box.height / 1080];";
  const Browser::Json before = player("player.pause(); player.frame = 0; player.draw(); " + place);
  tab_->wheel(before[0], before[1], -300);
  const Browser::Json after = player("player.draw(); " + place);
  EXPECT_GT(double(player("return player.picture.view.zoom;")), 1.3);
  EXPECT_NEAR(double(before[0]), double(after[0]), 3);
  EXPECT_NEAR(double(before[1]), double(after[1]), 3);
  EXPECT_THAT(tab_->complaints(url_), IsEmpty());
}

// A row of the table that is pointed at names its body as long as it is, and stays the row it is.
TEST_P(Player, PointingAtARowNamesItsBody) {
  open(kScenes + "swing.toml");
  const std::string soon = "new Promise((done) => setTimeout(() => done(player.picture.named), 100))";
  const Browser::Json at = player(
      "player.pause(); document.getElementById('values').open = true; player.list(); window.row = "
      "document.querySelector('#values tbody tr'); row.scrollIntoView({ block: 'center' }); const box = "
      "row.getBoundingClientRect(); return [box.left + 20, box.top + box.height / 2];");
  tab_->point(at[0], at[1]);
  EXPECT_TRUE(player("return " + soon + ";").is_array());
  EXPECT_TRUE(bool(player("player.draw(); return window.row.isConnected;")));
  tab_->point(at[0], 5);
  EXPECT_TRUE(player("return " + soon + ";").is_null());
}

TEST_P(Player, WordsOfASceneAreWords) {
  std::ofstream(path("evil.toml")) << R"toml(
title = "</title></script><script>document.title='owned'</script><img src=x onerror=alert(1)> & \"quoted\""
duration = 0.1
[room]
size = [4, 3]
[[ball]]
radius = 0.2
position = [2, 1.5]
[[film.caption]]
text = "<!-- --> </script><script>document.title='owned'</script>"
)toml";
  open(path("evil.toml"));
  EXPECT_EQ(
      tab_->value("document.title"),
      "</title></script><script>document.title='owned'</script><img src=x onerror=alert(1)> & \"quoted\"");
  EXPECT_EQ(tab_->value("document.images.length"), 0);
  EXPECT_EQ(tab_->value("document.scripts.length"), 1);
  EXPECT_THAT(std::string(player(
                  "player.frame = 3; player.draw(); return document.getElementById('caption').textContent;")),
              HasSubstr("</script>"));
  EXPECT_THAT(tab_->complaints(url_), IsEmpty());
  // what the page may do is said in it, and nothing of elsewhere is in it
  const std::string page = contents(path("page.html"));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_THAT(page, Not(HasSubstr("unsafe")));
  EXPECT_FALSE(std::regex_search(page, std::regex("(src|href)=\"?(https?:)?//")));
}

TEST_P(Player, HasRolesForThoseWhoDoNotSeeIt) {
  open(kScenes + "swing.toml");
  EXPECT_EQ(tab_->value("document.getElementById('picture').getAttribute('role')"), "img");
  EXPECT_GT(int(tab_->value("document.querySelectorAll('#story li').length")), 2);
  EXPECT_EQ(
      tab_->value("[...document.querySelectorAll('button, select, input')].filter((e) => !(e.title || "
                  "e.textContent.trim() || e.getAttribute('aria-label') || e.closest('label'))).length"),
      0)
      << "all controls have names";
  const std::string time = player(
      "player.show(60); player.draw(); return "
      "document.getElementById('scrub').getAttribute('aria-valuetext');");
  EXPECT_THAT(time, HasSubstr(" s of the run"));
  EXPECT_EQ(tab_->value("document.getElementById('caption').getAttribute('aria-live')"), "polite");
}

INSTANTIATE_TEST_SUITE_P(Of, Player, ::testing::Values("chromium", "firefox"),
                         [](const auto& browser) { return std::string(browser.param); });

class Memory : public Program {};

// Ten minutes of looping leave no more behind than one.
TEST_F(Memory, IsSteadyOverTenMinutes) {
  const auto browser = media::browser();
  OBSCURA_LONG("chromium-headless-shell", browser);
  for (const char* scene : {"room", "crate"}) {
    ASSERT_EQ(obscura("render " + kScenes + scene + ".toml -o page.html --to 2 --progress none").exit, 0);
    Tab tab(*browser, folder_.string(), 960, 640);
    tab.open("file://" + path("page.html"));
    tab.call("HeapProfiler.enable");
    tab.value("obscura.then((player) => { player.loop(); player.play(); })");
    // after so many seconds, what is left when all garbage is gone, and how often the film began again
    const auto left = [&](int seconds) {
      tab.value("new Promise((done) => setTimeout(done, " + std::to_string(1000 * seconds) + "))");
      tab.call("HeapProfiler.collectGarbage");
      return double(tab.call("Runtime.getHeapUsage")["usedSize"]);
    };
    const double first = left(30), last = left(570);
    EXPECT_TRUE(bool(tab.value("obscura.then((player) => player.playing)")));
    EXPECT_LT(last, first + 256 * 1024) << scene << ": bytes, from " << first;
    std::cout << scene << ": " << first << " bytes after half a minute, " << last << " after ten\n";
  }
}

class ScrollBars : public Program {};

// Where bars take room, the picture is as wide as they leave: nothing of it is beside the page.
TEST_F(ScrollBars, LeaveThePictureWhole) {
  const auto browser = media::browser();
  OBSCURA_NEEDS(browser, "chromium-headless-shell");
  ASSERT_EQ(obscura("render " + kScenes + "swing.toml -o page.html --to 1 --progress none").exit, 0);
  // of each height the page fits in, and does not, with all that can be opened
  for (const int height : {800, 1000, 640}) {
    Tab tab(*browser, folder_.string(), 1280, height, Tab::kScrollBars);
    tab.open("file://" + path("page.html"));
    tab.value("obscura.then(() => 1)");
    for (const char* opened : {"false", "true"}) {
      tab.value("document.querySelectorAll('details').forEach((each) => (each.open = " + std::string(opened) +
                "))");
      const Browser::Json seen = tab.value(
          "(() => { const page = document.documentElement, box = "
          "document.getElementById('picture').getBoundingClientRect(); return [page.scrollWidth, "
          "page.clientWidth, box.left, box.right]; })()");
      EXPECT_LT(double(seen[1]), 1280) << "there is a bar";
      EXPECT_EQ(seen[0], seen[1]) << height << ", opened " << opened;
      EXPECT_GE(double(seen[2]), 0);
      EXPECT_LE(double(seen[3]), double(seen[1]));
    }
  }
  // an embedded one has none
  Tab tab(*browser, folder_.string(), 960, 580, Tab::kScrollBars);
  tab.open("file://" + path("page.html#embed"));
  EXPECT_EQ(tab.value("obscura.then(() => document.documentElement.clientWidth)"), 960);
}

class Printed : public Program {};

// On paper there are the whole picture, what happens and all events, and nothing to press.
TEST_F(Printed, PageHasThePictureWholeAndItsEvents) {
  const auto browser = media::browser();
  OBSCURA_NEEDS(browser, "chromium-headless-shell");
  ASSERT_EQ(
      obscura("render " + kScenes + "room.toml -o page.html --to 3 --theme screen --progress none").exit, 0);
  Tab tab(*browser, folder_.string(), 1280, 800);
  tab.open("file://" + path("page.html"));
  tab.value("obscura.then(() => 1)");
  // the width of a page of A4 less its margins: the player does not lay itself out for it
  tab.call("Emulation.setEmulatedMedia", {{"media", "print"}});
  tab.value(
      "(() => { window.dispatchEvent(new Event('beforeprint')); document.body.style.width = '700px'; })()");
  const Browser::Json box = tab.value(
      "(() => { const box = document.getElementById('picture').getBoundingClientRect(); return [box.left, "
      "box.right, box.width / box.height]; })()");
  EXPECT_GE(double(box[0]), 0);
  EXPECT_LE(double(box[1]), 700);
  EXPECT_NEAR(double(box[2]), 16.0 / 9, 0.01);
  const auto height = [&](const std::string& of) {
    return double(tab.value("document.querySelector('" + of + "').getBoundingClientRect().height"));
  };
  EXPECT_EQ(height("#controls"), 0);
  EXPECT_GT(height("#story ul"), 50);
  // every one of them, not those in a box that is scrolled
  const int events = tab.value("document.querySelectorAll('#events li').length");
  EXPECT_GT(height("#events ol"), 15 * events);
  EXPECT_EQ(tab.value("getComputedStyle(document.body).color"), "rgb(31, 35, 40)") << "dark on paper";
  // and on the screen they are as they were
  tab.value("window.dispatchEvent(new Event('afterprint'))");
  tab.call("Emulation.setEmulatedMedia", {{"media", "screen"}});
  EXPECT_EQ(tab.value("document.querySelectorAll('details[open]').length"), 0);
  EXPECT_GT(height("#controls"), 20);
}

class WithoutWebGl : public Program {};

TEST_F(WithoutWebGl, SpaceIsSketched) {
  const auto browser = media::browser();
  OBSCURA_NEEDS(browser, "chromium-headless-shell");
  ASSERT_EQ(obscura("render " + kScenes + "crate.toml -o page.html --to 1 --progress none").exit, 0);
  Tab tab(*browser, folder_.string(), 960, 640, "--disable-3d-apis");
  const std::string url = "file://" + path("page.html");
  tab.open(url);
  // some of the planks' colour is on the page
  const double brown = tab.value(
      "obscura.then((player) => { player.frame = 30; player.draw(); const { width, height } = "
      "player.picture.canvas; "
      "const { data } = player.picture.context.getImageData(0, 0, width, height); let n = 0; "
      "for (let i = 0; i < data.length; i += 4) n += data[i] > data[i + 2] + 40; return n; })");
  EXPECT_GT(brown, 2000);
}

class Still : public Program {};

TEST_F(Still, AndWordsAreShownWithoutScripts) {
  const auto browser = media::browser();
  OBSCURA_NEEDS(browser, "chromium-headless-shell");
  for (const char* scene : {"cradle", "crate"}) {
    ASSERT_EQ(obscura("render " + kScenes + scene + ".toml -o page.html --to 0.2 --progress none").exit, 0);
    Tab tab(*browser, folder_.string(), 960, 640);
    tab.call("Emulation.setScriptExecutionDisabled", {{"value", true}});
    tab.open("file://" + path("page.html"));
    tab.call("Emulation.setScriptExecutionDisabled", {{"value", false}});
    EXPECT_GT(double(tab.value("document.querySelector('img.still').naturalWidth")), 100) << scene;
    EXPECT_GT(int(tab.value("document.querySelectorAll('#story li').length")), 2) << scene;
  }
}

}  // namespace

using PageFile = Program;

TEST_F(PageFile, TenSecondsOfTheRoomAreSmall) {
  const Outcome made = obscura("render " OBSCURA_SOURCE_DIR "/scenes/room.toml -o room.html --progress none");
  ASSERT_EQ(made.exit, 0) << made.err;
  EXPECT_LT(std::filesystem::file_size(path("room.html")), 500'000u);
}

TEST_F(PageFile, IsMadeAgainByVerify) {
  ASSERT_EQ(obscura("render " OBSCURA_SOURCE_DIR "/scenes/cradle.toml -o cradle.html --to 1 --fps 30").exit,
            0);
  const Outcome still = obscura("verify cradle.html");
  EXPECT_EQ(still.exit, 0) << still.out;
  EXPECT_THAT(still.out, ::testing::HasSubstr("byte by byte"));
  EXPECT_EQ(obscura("verify --states cradle.html").exit, 0);
  std::string page = contents(path("cradle.html"));
  page.replace(page.find("id=\"reel\">") + 40, 1, "!");
  std::ofstream(path("cradle.html"), std::ios::binary) << page;
  EXPECT_EQ(obscura("verify cradle.html").exit, 1);
}

TEST_F(PageFile, ShowsASweep) {
  const std::string scene = OBSCURA_SOURCE_DIR "/scenes/tumble.toml --set duration=0.2 --set film.fps=30 ";
  const Outcome made =
      obscura("sweep " + scene + "--vary physics.rate=300,600 --vary seed=1,2 -o sweep.html");
  ASSERT_EQ(made.exit, 0) << made.err;
  const std::string page = contents(path("sweep.html"));
  EXPECT_EQ(obscura("verify sweep.html").exit, 0);
  const Outcome many = obscura("sweep " + scene + "--vary seed=1:40 -o sweep.html");
  EXPECT_EQ(many.exit, 2);
  EXPECT_THAT(many.err, ::testing::HasSubstr("40 runs are more than 16"));
  EXPECT_EQ(obscura("sweep " + scene + "--vary seed=1:4 --at 1 -o sweep.html").exit, 2);
  EXPECT_EQ(contents(path("sweep.html")), page) << "and the page that was there is there yet";
}

TEST_F(PageFile, IsOfAFilm) {
  const Outcome still = obscura("render " OBSCURA_SOURCE_DIR "/scenes/cradle.toml -o cradle.html --at 1");
  EXPECT_EQ(still.exit, 2);
  EXPECT_THAT(still.err, ::testing::HasSubstr("--at"));
}

}  // namespace obscura::app
