#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <thread>
#include <vector>

#include "gl/back_ends.h"
#include "gl/error.h"
#include "gl/pictures.h"
#include "gl/renderer.h"

namespace obscura::gl {
namespace {

using draw::Color;

const Color kRed{213, 94, 0}, kBlue{0, 114, 178}, kGround{255, 255, 255};

// one of each, 108 px high
draw::Picture all_shapes() {
  draw::Picture picture;
  picture.aspect = 2;
  picture.ground = kGround;
  auto still = std::make_shared<draw::List>();
  still->add({{{100, 900}, 30, kBlue}, {{2000, 900}, 30, kBlue}});
  still->add(draw::Text{{300, 200}, draw::Align::left, {{"A room", draw::Face::bold, 150, {31, 35, 40}}}});
  picture.still = still;
  draw::Box box;
  box.center = {1200, 500}, box.x_axis = {0.8, 0.6}, box.half = {300, 150}, box.line = 30, box.axis = 80,
  box.axis_line = 12;
  box.fill = {158, 218, 201}, box.outline = {0, 110, 80}, box.axis_color = {0, 110, 80};
  picture.moving.add(box);
  picture.moving.add(draw::Disc{{800, 600}, 120, 25, {158, 200, 230}, kBlue});
  picture.moving.add(
      {{{300, 300}, 40, kRed}, {{700, 800}, 40, Color{213, 94, 0, 0}}, {{900, 300}, 10, kRed}});
  picture.moving.add({{1500, 200}, {1700, 300}, {1500, 400}, {1560, 300}}, kRed);
  return picture;
}

Color at(const media::Image& image, int x, int y) {
  const std::uint8_t* p = image.row(y) + 4 * x;
  return {p[0], p[1], p[2], p[3]};
}

TEST(Painting, WhatComesLaterLiesAboveAcrossKinds) {
  Renderer renderer(108, 108);
  draw::Picture picture;
  picture.aspect = 1;
  picture.ground = kGround;
  draw::Box box;
  box.center = {500, 500}, box.x_axis = {1, 0}, box.half = {300, 300}, box.fill = box.outline = kBlue;
  picture.moving.add(box);
  picture.moving.add(draw::Disc{{500, 500}, 200, 0, kRed, kRed});
  box.half = {100, 100};
  picture.moving.add(box);
  const media::Image image = drawn(renderer, picture);
  EXPECT_EQ(at(image, 50, 50), kBlue);
  EXPECT_EQ(at(image, 65, 50), kRed);
  EXPECT_EQ(at(image, 75, 50), kBlue);
  EXPECT_EQ(at(image, 95, 50), kGround);
}

TEST(Painting, ClipsHoldUntilTheyAreLifted) {
  Renderer renderer(108, 108);
  draw::Picture picture;
  picture.aspect = 1;
  picture.ground = kGround;
  picture.moving.clip({0, 0, 500, 1080});
  picture.moving.add(draw::Disc{{500, 300}, 200, 0, kRed, kRed});
  picture.moving.unclip();
  picture.moving.add(draw::Disc{{500, 800}, 200, 0, kBlue, kBlue});
  const media::Image image = drawn(renderer, picture);
  EXPECT_EQ(at(image, 45, 30), kRed);
  EXPECT_EQ(at(image, 55, 30), kGround);
  EXPECT_EQ(at(image, 55, 80), kBlue);
}

TEST(Painting, ATransparentPictureOverItsGroundIsTheOpaqueOne) {
  Renderer renderer(216, 108);
  draw::Picture picture = all_shapes();
  const media::Image opaque = drawn(renderer, picture);
  picture.transparent = true;
  const media::Image clear = drawn(renderer, picture);
  EXPECT_EQ(at(clear, 2, 2).a, 0);
  int differing = 0;
  for (std::size_t i = 0; i < clear.pixels.size(); i += 4) {
    const double alpha = clear.pixels[i + 3] / 255.0;
    for (std::size_t c = 0; c < 3; ++c) {
      // two roundings to 8 bits of alpha and colour
      differing += std::abs(alpha * clear.pixels[i + c] + (1 - alpha) * 255 - opaque.pixels[i + c]) > 2;
    }
  }
  EXPECT_EQ(differing, 0);
}

TEST(Painting, DoesNotDependOnWhatWasDrawnBefore) {
  Renderer renderer(216, 108), fresh(216, 108);
  draw::Picture picture = all_shapes();
  const media::Image first = drawn(renderer, picture);
  draw::Picture other;
  other.aspect = 2;
  other.ground = kRed;
  other.moving.add(draw::Disc{{1000, 500}, 400, 10, kBlue, kGround});
  drawn(renderer, other);
  EXPECT_EQ(drawn(renderer, picture), first);
  // things that went away leave nothing behind, whether the still list stayed or not
  draw::Picture emptied = picture;
  emptied.moving = {};
  EXPECT_EQ(drawn(renderer, emptied), drawn(fresh, emptied));
  emptied.still = nullptr;
  const media::Image blank = drawn(renderer, emptied);
  for (int x = 0; x < blank.width; ++x) EXPECT_EQ(at(blank, x, 90), kGround);
}

// Thin things at all angles, round and sharp turns, boxes, words: what one picture leaves of the one before
// is what a new renderer draws, and images differ only where the renderer says so.
TEST(Painting, OnlyWhatChangesIsDrawnAndReadAndThatIsAll) {
  std::mt19937 random(7);
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution<>(from, to)(random);
  };
  const auto place = [&] { return draw::Point(uniform(-200, 2100), uniform(-200, 1280)); };
  Renderer renderer(640, 360);
  auto still = std::make_shared<draw::List>();
  still->add(draw::Disc{{900, 500}, 300, 10, kBlue, kRed});
  media::Image before;
  double read = 0;
  constexpr int kPictures = 60;
  for (int k = 0; k < kPictures; ++k) {
    draw::Picture picture;
    picture.aspect = 640.0 / 360;
    picture.ground = kGround;
    picture.still = still;
    const int things = int(uniform(0, 4));
    for (int i = 0; i < things; ++i) {
      const double width = std::exp(uniform(0, 4.5));
      std::vector<draw::Node> nodes;
      const int count = 1 + int(uniform(0, 5));
      for (int n = 0; n < count; ++n) nodes.push_back({place(), width, kRed});
      picture.moving.add(nodes, uniform(0, 1) < 0.5 ? draw::Cap::butt : draw::Cap::round, draw::Blend::over,
                         uniform(0, 1) < 0.3);
      const double angle = uniform(0, 7);
      draw::Box box;
      box.center = place(), box.x_axis = {std::cos(angle), std::sin(angle)};
      box.half = {std::exp(uniform(0, 6.5)), std::exp(uniform(-1, 3))}, box.line = uniform(0, 6);
      box.fill = {158, 218, 201}, box.outline = kBlue;
      picture.moving.add(box);
    }
    picture.moving.add(
        draw::Text{place(), draw::Align::left, {{"word", draw::Face::bold, 60, {31, 35, 40}}}});
    const media::Image& now = renderer.draw(picture);
    Renderer fresh(640, 360);
    ASSERT_EQ(now, drawn(fresh, picture)) << k;
    if (const auto* changed = renderer.changed()) {
      for (const media::Rect& rect : *changed) {
        read += double(rect.width) * rect.height / (640 * 360) / kPictures;
        ASSERT_TRUE(rect.x % 2 == 0 && rect.y % 2 == 0 && rect.width % 2 == 0 && rect.height % 2 == 0);
        for (int y = rect.y; y < rect.y + rect.height; ++y)
          std::copy_n(now.row(y) + 4 * rect.x, 4 * rect.width, before.row(y) + 4 * rect.x);
      }
      ASSERT_EQ(before, now) << k;
    } else {
      EXPECT_EQ(k, 0);
    }
    before = now;
  }
  // bounds of all things would be most of the picture
  EXPECT_LT(read, 0.6);
}

// a thing of any kind, the same for the same seed
void add_any(draw::List& list, unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution<>(from, to)(random);
  };
  const auto place = [&] { return draw::Point(uniform(0, 1900), uniform(0, 1080)); };
  const Color ink(std::uint8_t(uniform(0, 256)), std::uint8_t(uniform(0, 256)), std::uint8_t(uniform(0, 256)),
                  std::uint8_t(uniform(60, 256)));
  const bool clipped = uniform(0, 1) < 0.2;
  if (clipped) list.clip({uniform(0, 900), uniform(0, 500), 800, 500});
  if (uniform(0, 1) < 0.2) {
    list.halo(true);
    list.add(draw::Disc{place(), uniform(10, 200), 0, kGround, kGround});
    list.halo(false);
  }
  switch (int(uniform(0, 5))) {
    case 0:
      list.add(draw::Disc{place(), uniform(2, 200), uniform(0, 9), ink, kBlue});
      break;
    case 1: {
      const double angle = uniform(0, 7);
      draw::Box box;
      box.center = place(), box.x_axis = {std::cos(angle), std::sin(angle)};
      box.half = {uniform(1, 400), uniform(1, 100)}, box.line = uniform(0, 6);
      box.fill = ink, box.outline = kBlue;
      list.add(box);
      break;
    }
    case 2:
      list.add({{place(), 8, ink}, {place(), 30, ink}, {place(), 8, ink}}, draw::Cap::round,
               uniform(0, 1) < 0.5 ? draw::Blend::darken : draw::Blend::over);
      break;
    case 3:
      list.add({place(), place(), place()}, ink);
      break;
    default:
      list.add(draw::Text{place(), draw::Align::left, {{"word", draw::Face::bold, 60, ink}}});
  }
  if (clipped) list.unclip();
}

// What has stayed for some pictures is drawn once, until it changes: other things come before it, it goes, or
// there is another still list.
TEST(Painting, WhatStaysBelowWhatMovesIsDrawnOnceToTheSamePixels) {
  for (const bool transparent : {false, true}) {
    std::mt19937 random(3);
    const auto below = [&](int n) { return int(random() % unsigned(n)); };
    Renderer renderer(640, 360);
    std::vector<unsigned> things{1, 2, 3, 4, 5, 6, 7, 8};
    auto still = std::make_shared<draw::List>();
    media::Image before;
    int staying = 0;
    for (int k = 0; k < 100; ++k) {
      const int at = below(int(things.size()));
      const unsigned other = random();
      if (below(12) == 0) things.insert(things.begin() + at, other);
      if (things.size() > 4 && below(14) == 0) things.erase(things.begin() + at);
      if (below(60) == 0) still = std::make_shared<draw::List>(), add_any(*still, random());
      draw::Picture picture;
      picture.aspect = 640.0 / 360;
      picture.ground = kGround;
      picture.transparent = transparent;
      picture.still = still;
      for (const unsigned thing : things) add_any(picture.moving, thing);
      for (int i = 0; i < 3; ++i) add_any(picture.moving, random());
      const media::Image& now = renderer.draw(picture);
      Renderer fresh(640, 360);
      ASSERT_EQ(now, drawn(fresh, picture)) << k;
      if (const auto* changed = renderer.changed())
        for (const media::Rect& rect : *changed)
          for (int y = rect.y; y < rect.y + rect.height; ++y)
            std::copy_n(now.row(y) + 4 * rect.x, 4 * rect.width, before.row(y) + 4 * rect.x);
      else
        before = now;
      ASSERT_EQ(before, now) << k;
    }
    // a pile that is struck: one thing after another begins to move, the uppermost first
    const auto piled = std::make_shared<draw::List>();
    for (int k = 0; k < 60; ++k) {
      draw::Picture picture;
      picture.aspect = 640.0 / 360;
      picture.ground = kGround;
      picture.transparent = transparent;
      picture.still = piled;
      for (int i = 0; i < 40; ++i) {
        const double fallen = 3 * std::max(0, k - 10 - (40 - i));
        picture.moving.add(draw::Disc{{40.0 * i + fallen, 500}, 30, 4, kBlue, kRed});
      }
      const media::Image& now = renderer.draw(picture);
      Renderer fresh(640, 360);
      ASSERT_EQ(now, drawn(fresh, picture)) << k;
    }
    // a large thing that stays, and a small one that moves over it: in the end the small one alone is read
    for (int k = 0; k < 100 && staying < 3; ++k) {
      draw::Picture picture;
      picture.aspect = 640.0 / 360;
      picture.ground = kGround;
      picture.transparent = transparent;
      picture.moving.add({{0, 0}, {1800, 0}, {900, 1000}}, kRed);
      picture.moving.add(draw::Disc{{400.0 + k, 300}, 20, 0, kBlue, kBlue});
      const media::Image& now = renderer.draw(picture);
      Renderer fresh(640, 360);
      ASSERT_EQ(now, drawn(fresh, picture)) << k;
      double read = 0;
      if (const auto* changed = renderer.changed())
        for (const media::Rect& rect : *changed) read += double(rect.width) * rect.height / (640 * 360);
      staying = renderer.changed() && read < 0.02 ? staying + 1 : 0;
    }
    EXPECT_EQ(staying, 3);
  }
}

// Halos and plates cover what lies below with the ground's colour: where there is no ground they are holes,
// so that over any slide they are of the slide's colour. Other things of that colour are not.
TEST(Painting, HalosAreHolesWhereThereIsNoGround) {
  draw::Picture picture;
  picture.aspect = 2;
  picture.ground = kGround;
  draw::List& list = picture.moving;
  list.add(draw::Disc{{500, 500}, 400, 0, kRed, kRed});
  list.halo(true);
  draw::Color half = kGround;
  half.a = 150;
  list.add(draw::Box{.center = {300, 500}, .x_axis = {1, 0}, .half = {80, 80}, .fill = half});
  list.add({{{500, 200}, 60, kGround}, {{560, 800}, 60, kGround}}, draw::Cap::butt);
  list.add({{700, 400}, {800, 500}, {700, 600}, {680, 500}}, kGround);
  list.add(draw::Disc{{300, 700}, 60, 20, kBlue, kGround});
  list.halo(false);
  list.add(draw::Disc{{400, 700}, 60, 0, kGround, kGround});
  Renderer renderer(216, 108);
  const media::Image opaque = drawn(renderer, picture);
  picture.transparent = true;
  const media::Image clear = drawn(renderer, picture);
  EXPECT_EQ(clear.row(50)[4 * 53 + 3], 0);                  // in the stroke
  EXPECT_EQ(clear.row(50)[4 * 73 + 3], 0);                  // in the polygon
  EXPECT_NEAR(clear.row(50)[4 * 30 + 3], 255 - half.a, 1);  // under the plate
  EXPECT_NEAR(at(clear, 30, 50).r, kRed.r, 2);              // which leaves the colour that is there
  EXPECT_EQ(clear.row(70)[4 * 40 + 3], 255);                // of the disc
  EXPECT_EQ(at(clear, 30, 70), kBlue);                      // within its rim
  EXPECT_LT(clear.row(70)[4 * 25 + 3], 100);                // which is none
  // over the ground it is the other picture
  for (int y = 0; y < clear.height; ++y)
    for (int x = 0; x < clear.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const std::uint8_t* p = clear.row(y) + 4 * x;
        const int ground = c == 0 ? kGround.r : c == 1 ? kGround.g : kGround.b;
        EXPECT_NEAR((p[c] * p[3] + ground * (255 - p[3])) / 255.0, opaque.row(y)[4 * x + c], 2)
            << x << " " << y;
      }
}

/// Those of four corners are filled by rows of pixels that lie wholly in them, and where the first corner
/// comes again at the end they are not. As one moves, nothing is left behind.
TEST(Painting, LargePolygonsAreTheSameFromTheirEdgesAndFromWithin) {
  const auto picture = [](double turn, bool again, std::uint8_t alpha) {
    draw::Picture made;
    made.aspect = 2;
    made.ground = kGround;
    std::vector<draw::Point> corners;
    for (const draw::Point& p :
         {draw::Point(-700, -260), draw::Point(520, -300), draw::Point(900, 240), draw::Point(-300, 400)})
      corners.push_back(draw::Point(1080, 540) + Eigen::Rotation2Dd(turn) * p);
    if (again) corners.push_back(corners[0]);
    made.moving.add(draw::Disc{{1000, 500}, 300, 0, kBlue, kBlue});
    made.moving.add(corners, draw::Color{0xD0, 0x80, 0x20, alpha});
    return made;
  };
  Renderer moves(1296, 648), fresh(1296, 648), other(1296, 648);
  for (const double turn : {0.0, 0.3, 1.1, 1.5707963267948966, 2.5, 4.0}) {
    for (const std::uint8_t alpha : {std::uint8_t(255), std::uint8_t(120)}) {
      const media::Image image = drawn(moves, picture(turn, false, alpha));
      EXPECT_EQ(image, drawn(fresh, picture(turn, true, alpha))) << turn;
      drawn(other, blank(image, kGround));
      EXPECT_EQ(image, drawn(other, picture(turn, false, alpha))) << turn;
    }
  }
}

// A film that stands still: the same things again change nothing, whoever made them, and what comes after is
// drawn over what was there.
TEST(Painting, TheSamePictureAgainChangesNothing) {
  Renderer renderer(216, 108), fresh(216, 108);
  draw::Picture picture = all_shapes();
  const media::Image first = drawn(renderer, picture);
  const draw::Picture again = picture;
  EXPECT_EQ(drawn(renderer, again), first);
  ASSERT_NE(renderer.changed(), nullptr);
  EXPECT_TRUE(renderer.changed()->empty());
  // a digit of its words
  picture.moving.add(draw::Text{{300, 300}, draw::Align::left, {{"1.0", draw::Face::bold, 90, kBlue}}});
  drawn(renderer, picture);
  picture.moving.texts.back().spans[0].text = "1.1";
  EXPECT_EQ(drawn(renderer, picture), drawn(fresh, picture));
  EXPECT_FALSE(renderer.changed()->empty());
  EXPECT_EQ(drawn(renderer, again), first);
}

TEST(Painting, SeveralThreadsDrawTheSameBytes) {
  Renderer renderer(216, 108);
  const media::Image expected = drawn(renderer, all_shapes());
  for (const Backend backend : {Backend::osmesa, Backend::egl}) {
    if (!opens(backend)) continue;
    // more than most machines have processors: some share Mesa's screen
    std::vector<media::Image> images(20);
    {
      std::vector<std::jthread> threads;
      for (media::Image& image : images) {
        threads.emplace_back([&image, backend] {
          Renderer own(216, 108, {.backend = backend});
          for (int i = 0; i < 5; ++i) own.draw(all_shapes(), image);
        });
      }
    }
    for (const media::Image& image : images) EXPECT_EQ(image, expected);
  }
}

TEST(Painting, BothBackEndsDrawTheSameBytes) {
  OBSCURA_NEEDS_BOTH_BACK_ENDS();
  Renderer osmesa(216, 108, {.backend = Backend::osmesa});
  Renderer egl(216, 108, {.backend = Backend::egl});
  EXPECT_EQ(drawn(egl, all_shapes()), drawn(osmesa, all_shapes()));
  EXPECT_NE(egl.device(), osmesa.device());
}

TEST(Painting, AHundredThousandDiscsAreDrawn) {
  Renderer renderer(216, 108);
  draw::Picture picture;
  picture.aspect = 2;
  picture.ground = kGround;
  for (int i = 0; i < 100'000; ++i)
    picture.moving.add(draw::Disc{{double(i % 500) * 4, double(i / 500) * 5}, 2, 0, kBlue, kBlue});
  picture.moving.add(draw::Disc{{1000, 500}, 50, 0, kRed, kRed});
  EXPECT_EQ(at(drawn(renderer, picture), 100, 50), kRed);
}

}  // namespace
}  // namespace obscura::gl
