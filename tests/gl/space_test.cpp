#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "draw/compose/depict.h"
#include "draw/picture/solids.h"
#include "draw/space/camera.h"
#include "draw/space/light.h"
#include "gl/back_ends.h"
#include "gl/pictures.h"

namespace obscura::gl {
namespace {

using draw::Camera;
using draw::Color;
using draw::Point;
using sim::Vec3;

/// A run in space made by hand.
struct Made {
  sim::SceneInfo cast;
  sim::Snapshot now;
  draw::Look look;
  std::vector<Camera> cameras{draw::slant()};
  draw::Extent extent{{-2, 0, -2}, {2, 2, 2}};

  Made() {
    cast.dimension = 3, cast.scale = 2, look.caption = false;
    cast.walls.push_back({{0, 0, 0}, {0, 1, 0}});
  }
  int box(const Vec3& at, const Vec3& half, const char* color,
          const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity()) {
    return body(sim::ShapeKind::box, at, half, 0, color, turn);
  }
  int body(sim::ShapeKind kind, const Vec3& at, const Vec3& half, double radius, const char* color,
           const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity()) {
    sim::SceneInfo::Body who;
    who.kind = kind, who.half = half, who.radius = radius, who.turns = true, who.mass = 1;
    cast.bodies.push_back(who);
    sim::Snapshot::Body where;
    where.position = at, where.orientation = turn;
    now.bodies.push_back(where);
    draw::BodyLook own;
    own.color = draw::color(color);
    look.bodies.push_back(own);
    return int(cast.bodies.size()) - 1;
  }
  draw::Illustrator depictor(double aspect = 16.0 / 9) const { return {cast, look, cameras, extent, aspect}; }
  draw::Picture picture(double aspect = 16.0 / 9) const { return depictor(aspect).depict(now, {}); }
};

Made everything() {
  Made made;
  made.box({-0.8, 0.5, 0}, {0.3, 0.2, 0.4}, "orange",
           Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())));
  made.box({-0.5, 1.3, 0.2}, {0.2, 0.2, 0.2}, "blue");
  made.body(sim::ShapeKind::ball, {0.6, 0.3, 0.5}, Vec3::Zero(), 0.3, "green");
  made.body(sim::ShapeKind::capsule, {0.9, 0.9, -0.5}, {0, 0.3, 0}, 0.15, "purple",
            Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vec3::UnitZ())));
  made.cast.springs.push_back({-1, 1, 0.5, 1});
  made.now.springs.push_back({{-0.5, 2.2, 0.2}, {-0.5, 1.5, 0.2}});
  return made;
}

Color at(const media::Image& image, const Point& page) {
  const int x = int(page.x() * image.height / 1080), y = int(page.y() * image.height / 1080);
  const std::uint8_t* p = image.row(y) + 4 * x;
  return {p[0], p[1], p[2], p[3]};
}

double brightness(Color c) { return 0.3 * c.r + 0.6 * c.g + 0.1 * c.b; }

/// How much a colour has of the hue of another, whatever the shade: 1 for all, near 0 for grey.
double like(Color c, Color own) {
  const Vec3 a(c.r, c.g, c.b), b(own.r, own.g, own.b);
  const Vec3 hue = a.array() - a.mean(), wanted = b.array() - b.mean();
  return hue.dot(wanted) / (wanted.norm() * (hue.norm() + 10));
}

TEST(Space, ABallsCentreIsWhereAHandPutsIt) {
  for (auto projection : {Camera::Projection::orthographic, Camera::Projection::perspective}) {
    Made made;
    made.cast.walls.clear();
    made.look.light = Vec3(0, 0, 1);
    made.body(sim::ShapeKind::ball, {1.1, 0.7, 0.4}, Vec3::Zero(), 0.02, "black");
    Camera camera = draw::side();
    camera.elevation = 0, camera.projection = projection;
    draw::CameraKey key;
    key.center = Vec3(0, 1, 0), key.width = 4;
    camera.keys = {key};
    made.cameras = {camera};
    Renderer renderer(480, 270);
    const media::Image image = drawn(renderer, made.picture());
    double sum = 0, x = 0, y = 0;
    for (int r = 0; r < image.height; ++r)
      for (int c = 0; c < image.width; ++c) {
        const double dark = ink(image, c, r);
        sum += dark, x += dark * (c + 0.5), y += dark * (r + 0.5);
      }
    // 120 px a metre at the target; the eye is 2 m / tan 15 degrees before it
    const double depth =
        projection == Camera::Projection::perspective ? 1 - 0.4 * std::tan(M_PI / 12) / 2 : 1;
    EXPECT_NEAR(x / sum, 240 + 120 * 1.1 / depth, 0.1);
    EXPECT_NEAR(y / sum, 135 + 120 * 0.3 / depth, 0.1);
  }
}

TEST(Space, OnALargerPageItIsWhereThePageHasIt) {
  Made made;
  made.cast.walls.clear();
  made.body(sim::ShapeKind::ball, {0.3, 1.2, 0}, Vec3::Zero(), 0.02, "black");
  // from behind, so that it is dark all over
  made.look.light = -made.depictor().lens(made.now).sight({0.3, 1.2, 0});
  const draw::Picture own = made.picture();
  Renderer renderer(640, 360);
  // a half as large, with its corner at a part of a pixel
  const Point corner(100.7, 61.1);
  draw::Picture page;
  page.ground = own.ground;
  page.solids.push_back(std::make_shared<const draw::Solids>(draw::placed(*own.solids[0], 0.5, corner)));
  const media::Image image = drawn(renderer, page);
  double sum = 0, x = 0, y = 0;
  for (int r = 0; r < image.height; ++r)
    for (int c = 0; c < image.width; ++c) {
      const double dark = ink(image, c, r);
      sum += dark, x += dark * (c + 0.5), y += dark * (r + 0.5);
    }
  const Point wanted = (corner + 0.5 * made.depictor().lens(made.now).page({0.3, 1.2, 0})) / 3;
  ASSERT_GT(sum, 0);
  EXPECT_NEAR(x / sum, wanted.x(), 0.1);  // four samples a pixel
  EXPECT_NEAR(y / sum, wanted.y(), 0.1);
}

// Of each triangle that may lie in a shadow the light's map is asked; of the others it is known beforehand
// that none reaches them. Asked of all, the picture is the same.
TEST(Space, WhatIsNotAskedOfTheMapLiesInNoShadow) {
  Made made;
  unsigned state = 1;
  const auto number = [&] {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) / 16777216.0;
  };
  for (int i = 0; i < 60; ++i) {
    Eigen::Vector4d turn;
    for (int k = 0; k < 4; ++k) turn[k] = number() - 0.5;
    const Vec3 half(0.1 + 0.2 * number(), 0.1 + 0.2 * number(), 0.1 + 0.2 * number());
    made.box({3 * number() - 1.5, 0.2 + 1.8 * number(), 3 * number() - 1.5}, half, "orange",
             Eigen::Quaterniond(turn).normalized());
  }
  made.cameras = {draw::slant()};
  Renderer renderer(640, 360);
  draw::Picture picture = made.picture();
  const media::Image few = drawn(renderer, picture);
  auto all = std::make_shared<draw::Solids>(*picture.solids[0]);
  ASSERT_FALSE(all->shadowed.empty());
  ASSERT_FALSE(all->triangles.empty());
  // but those turned away from the light, which are dark without it, and those beyond the map
  const auto asked = [&](std::size_t i) {
    bool within = true;
    for (std::size_t k = i; k < i + 3; ++k)
      for (float at : all->vertices[all->triangles[k]].light) within = within && at > 0 && at < 1;
    const draw::Solids::Vertex& v = all->vertices[all->triangles[i]];
    return within && !(v.lit == v.shaded);
  };
  std::vector<std::uint32_t> dark;
  for (std::size_t i = 0; i < all->triangles.size(); i += 3) {
    auto& list = asked(i) ? all->shadowed : dark;
    list.insert(list.end(), all->triangles.begin() + std::ptrdiff_t(i),
                all->triangles.begin() + std::ptrdiff_t(i) + 3);
  }
  ASSERT_LT(dark.size(), all->triangles.size()) << "none was left out";
  all->triangles = dark;
  picture.solids = {all};
  const media::Image every = drawn(renderer, picture);
  int other = 0;
  for (std::size_t i = 0; i < few.pixels.size(); ++i) other += std::abs(few.pixels[i] - every.pixels[i]) > 3;
  EXPECT_EQ(other, 0);
}

TEST(Space, FacesAreLitFromTheSideTheLightIsOn) {
  const auto face = [](const Vec3& light, const Vec3& on) {
    Made made;
    made.look.light = light;
    made.box({0, 0.5, 0}, {0.5, 0.5, 0.5}, "grey");
    Renderer renderer(320, 180);
    const media::Image image = drawn(renderer, made.picture());
    return brightness(at(image, made.depictor().lens(made.now).page(Vec3(0, 0.5, 0) + on)));
  };
  // slant sees the front, the right and the upper side
  const Vec3 front(0.1, 0.1, 0.5), right(0.5, 0.1, 0.1), top(0, 0.5, 0);
  EXPECT_GT(face({-0.2, 0.5, 1}, front), face({-0.2, 0.5, 1}, right) + 20);
  EXPECT_GT(face({1, 0.5, 0.2}, right), face({1, 0.5, 0.2}, front) + 20);
  EXPECT_GT(face({-0.6, 1, 0.42}, top), face({-0.6, 1, 0.42}, front) + 20);
  EXPECT_GT(face({-0.6, 1, 0.42}, right), 40) << "never black";
}

TEST(Space, NothingIsInFrontOfWhatHidesIt) {
  // a far box of every other size behind a near one, which is turned a little more each time
  Renderer renderer(320, 180);
  for (int k = 0; k < 12; ++k) {
    Made made;
    made.cast.walls.clear();
    made.box({0, 1, 0.6}, {0.6, 0.6, 0.2}, "orange",
             Eigen::Quaterniond(Eigen::AngleAxisd(0.3 * k, Vec3(1, 1, 0).normalized())));
    made.box({0.2, 1, -0.8}, {1.5, 0.4, 0.2}, "blue");
    made.cameras = {draw::side()};
    const media::Image image = drawn(renderer, made.picture());
    const draw::CameraProjection lens = made.depictor().lens(made.now);
    // places on the near box's middle cross: its own colour, whatever the shade
    for (double t : {-0.5, -0.25, 0.0, 0.25, 0.5}) {
      const Color seen =
          at(image, lens.page(made.now.bodies[0].position + made.now.bodies[0].orientation * Vec3(t, 0, 0)));
      EXPECT_GT(like(seen, *draw::color("orange")), 0.7) << k << " " << t;
    }
  }
}

TEST(Space, ACentimetreIsWholeInAKilometre) {
  // a box of 1 cm on a plate at the near end of a hall of 1 km: its upper face hides the plate, and a thing
  // half a millimetre under the plate stays under it
  Made made;
  made.cast.walls.clear();
  made.cast.scale = 1000;
  made.extent = {{-500, 0, -500}, {500, 1000, 500}};
  made.box({0, -0.5, 0}, {500, 0.5, 500}, "grey");
  made.box({400, 0.005, 300}, {0.005, 0.005, 0.005}, "orange");
  made.box({400.02, -0.0015, 300}, {0.005, 0.001, 0.005}, "blue");
  made.box({-300, 50, -400}, {50, 50, 50}, "green");
  Camera camera = draw::slant();
  draw::CameraKey key;
  key.center = Vec3(400.01, 0, 300), key.width = 0.1;
  camera.keys = {key};
  Renderer renderer(480, 270);
  for (auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic}) {
    camera.projection = projection;
    made.cameras = {camera};
    const media::Image image = drawn(renderer, made.picture());
    const draw::CameraProjection lens = made.depictor().lens(made.now);
    const Color top = at(image, lens.page({400, 0.01, 300}));
    EXPECT_GT(like(top, *draw::color("orange")), 0.7);
    const Color over = at(image, lens.page({400.02, 0, 300}));
    EXPECT_LT(like(over, *draw::color("blue")), 0.5) << "what is under the plate";
  }
}

TEST(Space, ShadowsLieOnTheGroundAwayFromTheLightSoftAndNeverBlack) {
  Made made;
  made.look.ground = false;  // no grid
  made.box({0, 1, 0}, {0.4, 0.1, 0.4}, "orange");
  Renderer renderer(640, 360);
  const media::Image image = drawn(renderer, made.picture());
  const draw::CameraProjection lens = made.depictor().lens(made.now);
  // the shadow's middle by hand: 1 m down along the light
  const Vec3 foot(0.6, 0, -0.42);
  const double dark = brightness(at(image, lens.page(foot)));
  EXPECT_LT(dark, 235);
  EXPECT_GT(dark, 120);
  EXPECT_EQ(brightness(at(image, lens.page({-1.2, 0, 0.84}))), 255) << "on the light's side";
  // across its edge it grows dark in many steps
  int steps = 0;
  double last = 255;
  for (double t = 0; t <= 1; t += 0.01) {
    const double here = brightness(at(image, lens.page(foot + Vec3(0, 0, 0.95 * (1 - t)))));
    EXPECT_LE(here, last + 1.5);
    steps += here < last;
    last = here;
  }
  EXPECT_GT(steps, 8);
}

// A wall that rises from the ground takes the shadows of what is over it, and hides the ground's.
TEST(Space, AShadowLiesOnTheSlopeUnderABodyNotOnTheGroundBehindIt) {
  Made made;
  made.look.ground = false;
  const Vec3 place(0, 1.6, 0), on(0, 1.2, 0), normal = Vec3(0.5, std::sqrt(0.75), 0);
  made.cast.walls.push_back({on, normal});
  made.box(place, {0.15, 0.05, 0.15}, "orange");
  Renderer renderer(640, 360);
  const media::Image image = drawn(renderer, made.picture());
  const draw::CameraProjection lens = made.depictor().lens(made.now);
  const Vec3 light = Vec3(-0.6, 1, 0.42).normalized();
  const Vec3 foot = place - light * ((place - on).dot(normal) / light.dot(normal));
  const Vec3 under = place - light * (place.y() / light.y());
  EXPECT_LT(brightness(at(image, lens.page(foot))), 235);
  EXPECT_GT(brightness(at(image, lens.page(under))), 250) << "behind the slope";
}

TEST(Space, ABoxThrowsItsShadowOnAnother) {
  Renderer renderer(320, 180);
  const auto top = [&](double height) {
    Made made;
    made.box({0, 0.25, 0}, {0.8, 0.25, 0.8}, "sky");
    // over the light's way to the middle of the upper face
    made.box(Vec3(0, 0.5, 0) + height * Vec3(-0.6, 1, 0.42), {0.2, 0.05, 0.2}, "orange");
    const media::Image image = drawn(renderer, made.picture());
    return brightness(at(image, made.depictor().lens(made.now).page({0, 0.5, 0})));
  };
  EXPECT_LT(top(0.6), top(-3) - 25);
}

/// A plate over a large one: the edge of its shadow there takes more pixels the higher it is.
TEST(Space, AShadowOnABodyIsSofterTheHigherItsCasterIs) {
  Renderer renderer(1920, 1080);
  const auto edge = [&](double height) {
    Made made;
    made.look.ground = false;
    made.box({0, 0.25, 0}, {1.5, 0.25, 1.5}, "sky");
    made.box(Vec3(0, 0.5, 0) + height * Vec3(-0.6, 1, 0.42), {0.4, 0.001, 0.4}, "orange");
    const media::Image image = drawn(renderer, made.picture());
    const draw::CameraProjection lens = made.depictor().lens(made.now);
    const auto across = [&](double x) { return brightness(at(image, lens.page({x, 0.5, 0}))); };
    const double lit = across(0.6), dark = across(0.36);
    EXPECT_LT(dark, lit - 25);
    int between = 0;
    for (double x = 0.36; x < 0.6; x += 0.001) between += across(x) > dark + 5 && across(x) < lit - 5;
    return between * 0.001;  // m
  };
  EXPECT_GT(edge(0.8), 2 * edge(0.1));
}

/// A ball that turns has lines on it, which go with it; a particle, what is small and what is asked to be
/// plain have none.
TEST(Space, ARollingBallShowsHowItTurns) {
  Renderer renderer(960, 540);
  const auto ball = [&](double angle, double radius, bool turns, bool axes) {
    Made made;
    made.look.ground = false, made.look.axes = axes;
    const int it = made.body(sim::ShapeKind::ball, {0, 1, 0}, Vec3::Zero(), radius, "blue",
                             Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vec3::UnitZ())));
    made.cast.bodies[std::size_t(it)].turns = turns;
    return drawn(renderer, made.picture());
  };
  EXPECT_NE(ball(0.3, 0.4, true, true), ball(0.6, 0.4, true, true));
  EXPECT_NE(ball(0.3, 0.4, true, true), ball(0.3, 0.4, true, false));
  EXPECT_EQ(ball(0.3, 0.4, true, false), ball(0.6, 0.4, true, false));
  EXPECT_EQ(ball(0.3, 0.4, false, true), ball(0.3, 0.4, true, false));
  EXPECT_EQ(ball(0.3, 0.03, true, true), ball(0.3, 0.03, true, false)) << "about five pixels";
}

/// A fluid's surface tints what lies under it, and not what rises out of it before it.
TEST(Space, AFluidIsSeenThrough) {
  Renderer renderer(640, 360);
  Made made;
  made.look.ground = false;
  made.box({-0.8, 0.2, 0}, {0.2, 0.1, 0.2}, "orange");
  made.box({0.8, 0.9, 0}, {0.2, 0.3, 0.2}, "orange");
  const media::Image dry = drawn(renderer, made.picture());
  made.cast.surface = 0.8;
  const media::Image wet = drawn(renderer, made.picture());
  const draw::CameraProjection lens = made.depictor().lens(made.now);
  const Color sky = *draw::color("sky"), orange = *draw::color("orange");
  const auto both = [&](const Vec3& place) {
    return std::pair(at(dry, lens.page(place)), at(wet, lens.page(place)));
  };
  const auto [ground, under_water] = both({0, 0, 0});
  EXPECT_GT(like(under_water, sky), 0.7);
  const auto [box, drowned] = both({-0.8, 0.3, 0});
  EXPECT_GT(like(drowned, orange), 0.5);
  EXPECT_LT(like(drowned, orange), like(box, orange) - 0.001);
  const auto [top, still_top] = both({0.8, 1.2, 0});
  EXPECT_EQ(top, still_top);
}

TEST(Space, OnADarkGroundAShadowIsSeenFromTheLastRow) {
  Made made;
  made.look.theme = draw::Theme::screen, made.look.ground = true;
  made.box({0, 1, 0}, {0.4, 0.1, 0.4}, "orange");
  Renderer renderer(640, 360);
  const media::Image image = drawn(renderer, made.picture());
  const draw::CameraProjection lens = made.depictor().lens(made.now);
  const Color dark = at(image, lens.page({0.6, 0, -0.42})), lit = at(image, lens.page({-0.6, 0, 0.46}));
  EXPECT_GT(draw::contrast(lit, dark), 1.6);
  EXPECT_GT(brightness(dark), 8) << "not black";
}

/// Pixels that differ from all around them, which are alike: a level of rounding and the steps of a shade
/// less.
int specks(const media::Image& image) {
  int found = 0;
  const auto level = [&](int x, int y) { return int(image.row(y)[4 * x + 1]); };
  for (int y = 1; y + 1 < image.height; ++y)
    for (int x = 1; x + 1 < image.width; ++x) {
      int low = 255, high = 0;
      for (int k = 0; k < 9; ++k) {
        if (k == 4) continue;
        low = std::min(low, level(x + k % 3 - 1, y + k / 3 - 1));
        high = std::max(high, level(x + k % 3 - 1, y + k / 3 - 1));
      }
      found += high - low <= 4 && (level(x, y) < low - 4 || level(x, y) > high + 4);
    }
  return found;
}

// Near the rod its triangles are cut into pieces for the darkness there. Cut unlike, they would leave specks
// of the white ground between them.
TEST(Space, AFlatFaceHasNoSpecks) {
  Made made;
  made.cast.walls.clear(), made.look.ground = false;
  const int disc = made.body(sim::ShapeKind::hull, {0, 0.5, 0}, Vec3::Zero(), 0, "orange");
  sim::SceneInfo::Body& form = made.cast.bodies[std::size_t(disc)];
  form.faces.assign(2, {});
  constexpr int kSides = 24;
  for (int i = 0; i < kSides; ++i) {
    const double turn = 2 * M_PI * i / kSides;
    form.vertices.emplace_back(1.2 * std::cos(turn), 0, -1.2 * std::sin(turn));
    form.faces[0].push_back(i), form.faces[1].push_back(2 * kSides - 1 - i);
    form.faces.push_back({i, kSides + i, kSides + (i + 1) % kSides, (i + 1) % kSides});
  }
  for (int i = 0; i < kSides; ++i) form.vertices.push_back(form.vertices[std::size_t(i)] - Vec3(0, 0.2, 0));
  made.body(sim::ShapeKind::capsule, {0, 0.8, 0}, {0, 0.3, 0}, 0.2, "orange");
  Renderer renderer(640, 360);
  int found = 0;
  for (int i = 0; i < 48; ++i) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.137 * i, Vec3(1, 8, 0.5).normalized()));
    made.now.bodies[0].orientation = made.now.bodies[1].orientation = turn;
    made.now.bodies[1].position = made.now.bodies[0].position + turn * Vec3(0, 0.5, 0);
    found += specks(drawn(renderer, made.picture()));
  }
  EXPECT_EQ(found, 0);
}

// Where two of its pieces lie side by side their edges are brought to other parts of a pixel, and the dark
// face between them would be seen there.
TEST(Space, ABodyOfBoxesSideBySideHasNoSpecks) {
  Made made;
  made.cast.walls.clear(), made.look.ground = false;
  made.body(sim::ShapeKind::compound, {0, 0.8, 0}, Vec3::Zero(), 0, "grey");
  for (int i = 0; i < 6; ++i) {
    sim::SceneInfo::Part part;
    part.kind = sim::ShapeKind::box, part.half = {0.15, 0.75 - 0.1 * i, 0.6};
    part.center = {0.3 * i - 0.75, part.half.y() - 0.75, 0};
    made.cast.bodies[0].parts.push_back(part);
  }
  Renderer renderer(1280, 720);
  int found = 0;
  for (int i = 0; i < 12; ++i) {
    made.now.bodies[0].orientation = Eigen::AngleAxisd(0.05 * i - 0.3, Vec3(0.3, 1, 0.2).normalized());
    found += specks(drawn(renderer, made.picture()));
  }
  EXPECT_EQ(found, 0);
}

/// The dark ground from a slant, its grid's lines 100 m apart if there shall be none.
Made bare_ground(bool lines) {
  Made made;
  made.look.theme = draw::Theme::screen;
  if (!lines) made.look.tile = 100;
  draw::CameraKey key;
  key.center = Vec3(50.3, 0, 50.2), key.width = 4;
  made.cameras[0].keys = {key};
  return made;
}

// Its rows meet at parts of pixels in most of these sizes, and would leave a darker line there.
TEST(Space, ThePoolOfLightHasNoSeams) {
  const Made made = bare_ground(false);
  for (const auto& [width, height] :
       {std::pair(1280, 720), {2560, 1440}, {1366, 768}, {1920, 1080}, {427, 240}}) {
    Renderer renderer(width, height);
    const media::Image image = drawn(renderer, made.picture(double(width) / height));
    for (const double part : {0.2, 0.36, 0.5, 0.71}) {
      const int x = int(part * width);
      const auto level = [&](int y) { return int(image.row(y)[4 * x + 1]); };
      int peak = 0;
      for (int y = 0; y < height; ++y)
        if (level(y) > level(peak)) peak = y;
      EXPECT_GT(level(peak), level(0) + 8);
      for (int y = 1; y < height; ++y) {
        const int rise = (level(y) - level(y - 1)) * (y <= peak ? 1 : -1);
        EXPECT_GE(rise, -1) << width << " x " << height << " at " << x << ", " << y;
      }
      for (int y = 1; y + 1 < height; ++y)
        EXPECT_GE(level(y) + 1, std::min(level(y - 1), level(y + 1))) << width << " x " << height;
    }
  }
}

TEST(Space, TheGridIsAsClearInThePoolOfLightAsOutside) {
  const Made made = bare_ground(true), bare = bare_ground(false);
  for (const int height : {720, 1080}) {
    Renderer renderer(height * 16 / 9, height);
    const media::Image with = drawn(renderer, made.picture()), without = drawn(renderer, bare.picture());
    const draw::CameraProjection lens = made.depictor().lens(made.now);
    // how much brighter a line along x is than the ground, summed across it: in steps between two other lines
    const auto clear = [&](double x) {
      const Point p = lens.page({x, 0, 50}) * height / 1080;
      double sum = 0;
      for (int y = int(p.y()) - 4; y <= int(p.y()) + 4; ++y)
        sum += with.row(y)[4 * int(p.x()) + 1] - without.row(y)[4 * int(p.x()) + 1];
      return sum;
    };
    // outside it is 49 levels over the ground, 1.5 page units wide; a tenth for the levels' own steps
    for (double x = 49.25; x < 51.3; x += 0.05) {
      if (std::abs(x / 0.5 - std::round(x / 0.5)) < 0.2) continue;  // near a line across
      EXPECT_GT(clear(x), 0.9 * 49 * 1.5 * height / 1080) << height << ": " << x;
    }
  }
}

// A camera that comes nearer would otherwise have finer tiles from one frame to the next.
TEST(Space, TheGridKeepsItsTilesWhileTheCameraMoves) {
  Made made = bare_ground(true);
  draw::CameraKey near = made.cameras[0].keys[0];
  near.time = 1, near.width = 2.5;
  made.cameras[0].keys.push_back(near), made.now.time = 1;
  Renderer renderer(640, 360);
  const media::Image as_it_is = drawn(renderer, made.picture());
  made.look.tile = 0.5;  // as at the start
  EXPECT_EQ(drawn(renderer, made.picture()), as_it_is);
  made.look.tile = 0.2;
  EXPECT_NE(drawn(renderer, made.picture()), as_it_is);
}

// The edge between two faces that are seen: lighter than both on the dark, where a body's outline is lost,
// and darker on paper.
TEST(Space, TheEdgesOfABoxCatchTheLightOnTheDark) {
  for (const draw::Theme theme : {draw::Theme::screen, draw::Theme::paper}) {
    Made made;
    made.box({0, 0.5, 0}, {0.5, 0.5, 0.5}, "blue");
    made.look.theme = theme;
    made.cameras[0].azimuth = std::numbers::pi / 4;
    draw::CameraKey key;
    key.center = Vec3(0, 0.5, 0), key.width = 4;
    made.cameras[0].keys = {key};
    const draw::CameraProjection lens = made.depictor().lens(made.now);
    Renderer renderer(1280, 720);
    const media::Image image = drawn(renderer, made.picture());
    const Point middle = lens.page({0.5, 0.6, 0.5});
    const auto bright = [&](double x) { return brightness(at(image, {middle.x() + x, middle.y()})); };
    double most = 0, least = 255;
    for (double x = -4; x <= 4; x += 0.5)
      most = std::max(most, bright(x)), least = std::min(least, bright(x));
    const double faces[] = {bright(-20), bright(20)};
    if (theme == draw::Theme::screen) {
      EXPECT_GT(most, 1.3 * std::max(faces[0], faces[1]));
    } else {
      EXPECT_LT(least, 0.9 * std::min(faces[0], faces[1]));
    }
  }
}

TEST(Space, TheSameBytesTwiceAndFromBothBackEnds) {
  OBSCURA_NEEDS_BOTH_BACK_ENDS();
  Renderer osmesa(320, 180, {.backend = Backend::osmesa});
  Renderer egl(320, 180, {.backend = Backend::egl});
  const Made made = everything();
  const media::Image first = drawn(osmesa, made.picture());
  Made other = everything();
  other.now.bodies[0].position.y() += 0.5;
  other.look.theme = draw::Theme::screen;
  drawn(osmesa, other.picture());
  EXPECT_EQ(drawn(osmesa, made.picture()), first) << "whatever was drawn before";
  EXPECT_EQ(drawn(egl, made.picture()), first);
}

TEST(Space, CamerasBesideEachOtherKeepToTheirWindows) {
  Made made = everything();
  made.cameras = {draw::side(), draw::slant()};
  Renderer renderer(960, 540);
  const media::Image both = drawn(renderer, made.picture());
  const draw::CameraProjection left = made.depictor().lens(made.now, 0),
                               right = made.depictor().lens(made.now, 1);
  EXPECT_LT(left.window.x + left.window.width, right.window.x);
  for (const draw::CameraProjection& lens : {left, right}) {
    const Color green = at(both, lens.page({0.6, 0.3, 0.5}));
    EXPECT_GT(like(green, *draw::color("green")), 0.7);
  }
  // between them there is the page, with a line in the middle
  const double end = left.window.x + left.window.width, begin = right.window.x;
  for (int y = 0; y < both.height; ++y) {
    const double down = (y + 0.5) * 1080 / both.height;
    EXPECT_EQ(at(both, {end + 5, down}), (Color{255, 255, 255}));
    EXPECT_EQ(at(both, {begin - 5, down}), (Color{255, 255, 255}));
    if (down < left.window.y + 3) continue;
    EXPECT_LT(at(both, {(end + begin) / 2, down}).r, 220);
  }
}

}  // namespace
}  // namespace obscura::gl
