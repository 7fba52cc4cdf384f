// What a scene says of its film, its speed, its shutter, its plots, run as a user runs it and read back by
// other programs.

#include <algorithm>
#include <cmath>
#include <tuple>

#include <nlohmann/json.hpp>

#include "media/png.h"
#include "program.h"

namespace obscura::app {
namespace {

using Film = Program;

nlohmann::json origin_of(const std::string& png) {
  return nlohmann::json::parse(media::read_png(png).tags.at("obscura"));
}

TEST_F(Film, TenSecondsAtHalfSpeedAreTwenty) {
  scene(kRoom);
  const auto frames = [&](const std::string& flags) {
    const Outcome run = obscura("render scene.toml -o a.mp4 --size 96x54 --fps 30 --progress none " + flags);
    EXPECT_EQ(run.exit, 0) << run.err;
    return shell(
               "ffprobe -v error -count_frames -select_streams v -show_entries "
               "stream=nb_read_frames,duration -of csv=p=0 a.mp4")
        .out;
  };
  EXPECT_EQ(frames(""), "10.000000,300\n");
  EXPECT_EQ(frames("--set film.speed=0.5"), "20.000000,600\n");
  EXPECT_NE(obscura("check scene.toml --set film.speed=0.5").out.find("1200 frames at 60 fps"),
            std::string::npos);
}

TEST_F(Film, SlowFramesShowTheStatesOfTheirInstants) {
  scene(kRoom);
  const std::string small = "render scene.toml --size 96x54 --fps 30 --progress none ";
  ASSERT_EQ(obscura(small + "-o 'a/{frame}.png' --from 1 --to 2").exit, 0);
  ASSERT_EQ(obscura(small + "-o 'b/{frame}.png' --from 1 --to 2 --set film.speed=1/2").exit, 0);
  for (int n = 30; n < 60; ++n) {
    const auto a = origin_of(path("a/" + std::to_string(n) + ".png")),
               b = origin_of(path("b/" + std::to_string(2 * n) + ".png"));
    EXPECT_EQ(a["time"], b["time"]);
    EXPECT_EQ(a["state"], b["state"]);
  }
  EXPECT_EQ(origin_of(path("b/61.png"))["time"], "61/60");
  // the picture as well: its clock is the run's
  EXPECT_EQ(media::read_png(path("a/45.png")).image, media::read_png(path("b/90.png")).image);
}

TEST_F(Film, ARampKeepsItsPromiseAndItsOrigin) {
  scene(std::string(kRoom) +
        "[film]\nspeed = [{ time = 1 }, { time = 1.5, speed = 0.25 }, { time = 2, speed = 0.25 }, "
        "{ time = 2.5 }]\n");
  const std::string small = "render scene.toml --size 96x54 --fps 20 --progress none ";
  ASSERT_EQ(obscura(small + "-o m.mp4 --to 3 -j 1").exit, 0);
  ASSERT_EQ(obscura(small + "-o n.mp4 --to 3 -j 3").exit, 0);
  EXPECT_EQ(contents(path("m.mp4")), contents(path("n.mp4")));
  // 1 s, half a second at 5/8 on the way, half a second at 1/4, the way back, half a second: 5.1 s
  EXPECT_EQ(shell("ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 m.mp4").out,
            "102\n");
  EXPECT_EQ(obscura("verify m.mp4").exit, 0);
  EXPECT_NE(obscura("verify m.mp4").out.find("byte by byte"), std::string::npos);
}

// the light of a level, 0 to 1
double light(int level) {
  const double c = level / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

// 96 px a metre, white without an outline of its own on a dark page; 24 px while the shutter is open
const char* const kFlight = R"(
duration = 2
[room]
size    = [8, 4.5]
walls   = "none"
gravity = [0, 0]
[[box]]
size     = [1, 1]
position = [2, 2.25]
velocity = [5, 0]
color    = "white"
[camera]
center = [4, 2.25]
width  = 8
[look]
theme   = "screen"
caption = false
axes    = false
[film]
size    = [768, 432]
fps     = 10
shutter = 180
)";

TEST_F(Film, TheBlurOfAMovingBoxIsATrapezoidInLinearLight) {
  scene(kFlight);
  ASSERT_EQ(obscura("render scene.toml --at 0 -o a.png").exit, 0);
  const media::Image image = media::read_png(path("a.png")).image;
  const auto level = [&](int x, int y) { return int(image.row(y)[4 * x]); };
  // the middle of the box's height
  int top = 0, bottom = image.height - 1;
  while (level(200, top) != 255) ++top;
  while (level(200, bottom) != 255) --bottom;
  const int row = (top + bottom) / 2;
  const double dark = light(level(0, row));
  const double way = 5 * 0.05 * 96, from = 1.5 * 96, to = 2.5 * 96;
  const auto share = [&](double x) {
    return std::clamp((x - from) / way, 0.0, 1.0) - std::clamp((x - to) / way, 0.0, 1.0);
  };
  for (int x = 100; x < 320; ++x) {
    double expected = 0;
    for (int k = 0; k < 64; ++k) expected += share(x + (k + 0.5) / 64) / 64;
    const double seen = (light(level(x, row)) - dark) / (1 - dark);
    // one of the 24 moments has its edge on this pixel, antialiased by levels: at worst half of its light is
    // missing; and half a level
    EXPECT_NEAR(seen, expected, 0.5 / way + 0.005) << x;
  }
}

TEST_F(Film, WhatStandsStillIsTheSamePictureWithAShutter) {
  scene(R"(
title = "Nothing moves"
[[box]]
name  = "crate"
fixed = true
angle = 30
[[particle]]
position = [1, 2]
fixed    = true
[[spring]]
between = ["particle[0]", "crate"]
[look]
trails = 1
)");
  const std::string small = "render scene.toml --size 320x180 --fps 10 --to 0.5 --progress none ";
  ASSERT_EQ(obscura(small + "-o 'a/{frame}.png'").exit, 0);
  ASSERT_EQ(obscura(small + "-o 'b/{frame}.png' --set film.shutter=360").exit, 0);
  for (int n = 0; n < 5; ++n) {
    const std::string name = std::to_string(n) + ".png";
    EXPECT_EQ(media::read_png(path("a/" + name)).image, media::read_png(path("b/" + name)).image);
  }
}

TEST_F(Film, CamerasThatMoveBlurWhatStandsStill) {
  const std::string still = "[[box]]\nfixed = true\n";
  scene(still + "[camera]\nkeys = [{ time = 0 }, { time = 1, center = [6, 2], ease = \"linear\" }]\n");
  ASSERT_EQ(obscura("render scene.toml --at 0.5 --size 320x180 -o a.png").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --at 0.5 --size 320x180 -o b.png --set film.shutter=180").exit, 0);
  EXPECT_NE(media::read_png(path("a.png")).image, media::read_png(path("b.png")).image);
}

TEST_F(Film, TheClockIsThatOfTheInstantHoweverLongTheShutterIsOpen) {
  scene(kRoom);
  ASSERT_EQ(obscura("render scene.toml --at 1.99 --size 960x540 --fps 10 -o a.png").exit, 0);
  ASSERT_EQ(
      obscura("render scene.toml --at 1.99 --size 960x540 --fps 10 -o b.png --set film.shutter=360").exit, 0);
  const media::Image a = media::read_png(path("a.png")).image, b = media::read_png(path("b.png")).image;
  EXPECT_NE(a, b);
  const auto caption = std::ptrdiff_t(4) * a.width * 30;
  EXPECT_TRUE(std::equal(a.pixels.begin(), a.pixels.begin() + caption, b.pixels.begin()));
  EXPECT_EQ(origin_of(path("a.png"))["state"], origin_of(path("b.png"))["state"]);
}

TEST_F(Film, OneAndThreeWorkersMakeTheSameBytesOfAllOfItTogether) {
  scene(std::string(kRoom) + R"(
[film]
speed   = [{ time = 0.5 }, { time = 0.8, speed = 0.2 }]
shutter = 180
[[film.plot]]
quantity = ["energy", "kinetic", "potential"]
)");
  const std::string small = "render scene.toml --size 320x180 --fps 20 --to 1.1 --progress none ";
  ASSERT_EQ(obscura(small + "-o a.mp4 -j 1").exit, 0);
  ASSERT_EQ(obscura(small + "-o b.mp4 -j 3").exit, 0);
  EXPECT_GT(contents(path("a.mp4")).size(), 1000u);
  EXPECT_EQ(contents(path("a.mp4")), contents(path("b.mp4")));
  // a frame on its own is the frame of the film
  ASSERT_EQ(obscura(small + "-o 'c/{frame}.png'").exit, 0);
  ASSERT_EQ(obscura("render scene.toml --size 320x180 --fps 20 --at 0.5 -o d.png").exit, 0);
  EXPECT_EQ(media::read_png(path("c/10.png")).image, media::read_png(path("d.png")).image);
}

TEST_F(Film, APlotGrowsWithItsFilmOnAxesOfTheWholeRun) {
  // a free fall of 0.639 s
  scene(R"(
duration = 1
[room]
size  = [2, 2.5]
[[particle]]
name       = "ball"
position   = [1, 2]
elasticity = 0
color      = "blue"
[look]
caption = false
[[film.plot]]
quantity = ["height"]
of       = "ball"
size     = 50
)");
  const auto colored = [&](const char* at) {
    EXPECT_EQ(obscura(std::string("render scene.toml --size 640x480 -o a.png --at ") + at).exit, 0);
    const media::Image image = media::read_png(path("a.png")).image;
    // of the lower half: blue pixels, the columns that they reach, and the axes' ink
    int first = image.width, last = -1;
    std::int64_t ink = 0;
    for (int y = image.height / 2 + 12; y < image.height; ++y)
      for (int x = 0; x < image.width * 85 / 100; ++x) {
        const std::uint8_t* p = image.row(y) + 4 * x;
        if (p[2] > p[0] + 60) first = std::min(first, x), last = std::max(last, x);
        if (std::max({p[0], p[1], p[2]}) < 100 && p[2] < p[0] + 20) ++ink;
      }
    return std::tuple(first, last, ink);
  };
  const auto [first, quarter, axes] = colored("0.25");
  const auto [same, half, axes_too] = colored("0.5");
  EXPECT_NEAR(first, same, 1);
  // as much again, and not the dot's radius, 5 px
  EXPECT_NEAR(half - quarter, quarter - first, 8);
  EXPECT_GT(half - quarter, 80);
  EXPECT_EQ(axes, axes_too);
}

}  // namespace
}  // namespace obscura::app
