// Tracks against closed forms, in both modes: wires, rails, loops, joints of pieces, what leaves and lands.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "scene/error.h"
#include "scene/text_run.h"

namespace obscura::scene {
namespace {

constexpr double kTrackG = 9.81, kHalfTurn = std::numbers::pi;

const std::vector<std::string> kTrackModes = {"contact", "event"};

std::string open_room(const std::string& mode, const std::string& room = "", int dimension = 2) {
  return fmt::format(
      "duration = 1000\n[room]\nsize = {}\ncorner = {}\nwalls = \"none\"\n{}\n[physics]\ncollision = "
      "\"{}\"\n",
      dimension == 2 ? "[20, 20]" : "[20, 20, 20]", dimension == 2 ? "[-10, -10]" : "[-10, -10, -10]", room,
      mode);
}

// what parse() says against a text; empty: nothing
std::string said_against(const std::string& text) {
  try {
    parse(text, "a.toml", {});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

const sim::Snapshot::Body& moving(const sim::Snapshot& now, const TextRun& scene, const std::string& name) {
  const auto& all = scene.run->scene_info().bodies;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].name == name) return now.bodies[i];
  ADD_FAILURE() << name;
  return now.bodies[0];
}

// integral of f from a to b by Simpson's rule, n even pieces
double integral(const std::function<double(double)>& f, double a, double b, int n = 20000) {
  double sum = f(a) + f(b);
  for (int i = 1; i < n; ++i) sum += (i % 2 ? 4 : 2) * f(a + (b - a) * i / n);
  return sum * (b - a) / n / 3;
}

// --- wires

// A bead on a fixed circle without friction is a pendulum; energy stays, and the scheme keeps its order.
TEST(Wire, ABeadOnACircleIsAPendulum) {
  for (const std::string& mode : kTrackModes) {
    const auto end = [&](int rate) {
      TextRun bead(open_room(mode) + fmt::format("rate = {}\n", rate) +
                   "[[track]]\nx = \"cos(s)\"\ny = \"sin(s)\"\nfrom = 0\nto = \"2*pi\"\nthread = "
                   "\"bead\"\nfriction = 0\n"
                   "[[particle]]\nname = \"bead\"\nposition = [0.8, 0.6]\nfriction = 0\n");
      return bead.place(2);
    };
    const auto pendulum = [&] {
      TextRun rod(open_room(mode) +
                  "rate = 4800\n[[particle]]\nname = \"bead\"\nposition = [0.8, 0.6]\n[[joint]]\ntype = "
                  "\"rod\"\nbetween = "
                  "[\"bead\", [0, 0]]\n");
      return rod.place(2);
    }();
    EXPECT_NEAR((end(1200) - pendulum).norm(), 0, 1e-9) << mode;
    const double coarse = (end(120) - pendulum).norm(), fine = (end(240) - pendulum).norm();
    EXPECT_NEAR(std::log2(coarse / fine), 4, 0.3) << mode << " " << coarse << " " << fine;
  }
}

// Races from rest: a line, a parabola and a cycloid, each to a ten-thousandth of its time.
TEST(Wire, ABrachistochroneTakesItsTime) {
  const double r = 1, w = kHalfTurn * r, h = 2 * r;  // a cycloid from its cusp to its lowest place
  const double s0 = 0.01;                            // where it begins: it takes as long from everywhere
  struct Race {
    std::string curve, bead;
    double time;
  };
  const double line = std::sqrt(2 * (w * w + h * h) / (kTrackG * h));
  // y = -h sqrt(x / w), as x = w (y / h)^2: upright where it begins
  const double parabola = 2 * integral(
                                  [&](double p) {  // y = p^2
                                    const double slope = 2 * w * p * p / (h * h);
                                    return std::sqrt((1 + slope * slope) / (2 * kTrackG));
                                  },
                                  0, std::sqrt(h));
  const double cycloid = kHalfTurn * std::sqrt(r / kTrackG);
  EXPECT_LT(cycloid, parabola);
  EXPECT_LT(parabola, line);
  const std::vector<Race> cases = {
      {fmt::format("points = [[0, 0], [{}, {}]]", w, -h), "[0, 0]", line},
      {fmt::format("x = \"{}*s^2\"\ny = \"-{}*s\"\nfrom = 0\nto = 1", w, h), "[0, 0]", parabola},
      {fmt::format("x = \"s - sin(s)\"\ny = \"cos(s) - 1\"\nfrom = {}\nto = \"pi\"", s0), "[0, 0]", cycloid}};
  for (const std::string& mode : kTrackModes) {
    for (const Race& each : cases) {
      TextRun race(open_room(mode) + "[[track]]\n" + each.curve + "\nfriction = 0\nthread = [\"bead\"]\n" +
                   "[[particle]]\nname = \"bead\"\nposition = " + each.bead + "\n");
      const double just = to_a_microsecond(each.time * (1 - 1e-4)), v = std::sqrt(2 * kTrackG * h);
      // as far from its end as it goes in a ten-thousandth of the time, and then it stands there
      const sim::Vec3 end(w, -h, 0);
      EXPECT_NEAR((race.place(just) - end).norm(), 1e-4 * each.time * v, 2e-6 * v * each.time)
          << each.curve << mode;
      EXPECT_GT((race.place(just) - end).norm(), 0);
      EXPECT_NEAR((race.place(to_a_microsecond(each.time * 1.1)) - end).norm(), 0, 1e-9)
          << each.curve << mode;
    }
  }
}

// Friction on a wire is mu times the load: v = v0 / (1 + mu v0 t / R) on a circle without gravity, in the
// plane and in space, and (sin a - mu cos a) g on a slope.
TEST(Wire, FrictionGoesByTheLoad) {
  for (const std::string& mode : kTrackModes) {
    for (const int dimension : {2, 3}) {
      const bool space = dimension == 3;
      TextRun ring(open_room(mode, space ? "gravity = [0, 0, 0]" : "gravity = [0, 0]", dimension) +
                   (space ? "[[track]]\nx = \"2*cos(s)\"\ny = \"1.6*sin(s)\"\nz = \"1.2*sin(s)\"\n"
                          : "[[track]]\nx = \"2*cos(s)\"\ny = \"2*sin(s)\"\n") +
                   "from = 0\nto = \"2*pi\"\nthread = \"bead\"\n" +
                   (space ? "[[particle]]\nname = \"bead\"\nposition = [2, 0, 0]\nvelocity = [0, 2.4, 1.8]\n"
                          : "[[particle]]\nname = \"bead\"\nposition = [2, 0]\nvelocity = [0, 3]\n") +
                   "friction = 0.25\n");
      const sim::Snapshot now = ring.at(2.5);
      EXPECT_NEAR(moving(now, ring, "bead").velocity.norm(), 3 / (1 + 0.25 * 3 * 2.5 / 2), 1e-9)
          << mode << dimension;
      EXPECT_NEAR(moving(now, ring, "bead").position.norm(), 2, 1e-11);
    }
    // 3-4-5: from rest it slides, at mu = 0.8 it stays
    TextRun slope(open_room(mode) +
                  "[[track]]\npoints = [[0, 0], [8, -6]]\nthread = [\"slides\", \"stays\"]\nends = \"free\"\n"
                  "[[particle]]\nname = \"slides\"\nposition = [0, 0]\nfriction = 0.5\n"
                  "[[particle]]\nname = \"stays\"\nposition = [4, -3]\nfriction = 0.8\n");
    const sim::Snapshot now = slope.at(1);
    EXPECT_NEAR(moving(now, slope, "slides").velocity.norm(), kTrackG * (0.6 - 0.5 * 0.8), 1e-9) << mode;
    EXPECT_NEAR((moving(now, slope, "stays").position - sim::Vec3(4, -3, 0)).norm(), 0, 1e-9) << mode;
  }
}

// A bead on a hoop that turns about its upright diameter: cos theta = g / (omega^2 R), and about that place
// it swings with omega sin theta.
TEST(Wire, ABeadOnAHoopThatTurnsHasItsPlace) {
  const double omega = 8, R = 0.5, cosine = kTrackG / (omega * omega * R),
               sine = std::sqrt(1 - cosine * cosine);
  for (const std::string& mode : kTrackModes) {
    const auto hoop = [&](double x, double y) {
      return open_room(mode, "", 3) +
             fmt::format(
                 "[[box]]\nname = \"hoop\"\nsize = [0.1, 0.1, 0.1]\nposition = [0, 0, 0]\n"
                 "motion = {{ angle = \"{:.17g}*t\", axis = [0, 1, 0] }}\n"
                 "[[track]]\non = \"hoop\"\nx = \"0.5*sin(s)\"\ny = \"-0.5*cos(s)\"\nz = 0\nfrom = 0\nto = "
                 "\"2*pi\"\n"
                 "thread = \"bead\"\nfriction = 0\n"
                 "[[particle]]\nname = \"bead\"\nposition = [{:.17g}, {:.17g}, 0]\n",
                 omega * 180 / kHalfTurn, x, y);
    };
    TextRun still(hoop(R * sine, -R * cosine));
    const sim::Snapshot now = still.at(3);
    EXPECT_NEAR(moving(now, still, "bead").position.y(), -R * cosine, 1e-8) << mode;
    const double angle = std::acos(cosine), off = 1e-4;
    TextRun swings(hoop(R * std::sin(angle + off), -R * std::cos(angle + off)));
    const double half = to_a_microsecond(kHalfTurn / (omega * sine));
    // after half a swing it is as far on the other side: y = -R cos(angle - off), second order in `off`
    EXPECT_NEAR(moving(swings.at(half), swings, "bead").position.y(), -R * std::cos(angle - off), 5e-8)
        << mode;
  }
}

// On a cart that rolls freely, momentum along the floor and energy stay.
TEST(Wire, OnACartMomentumAndEnergyStay) {
  for (const std::string& mode : kTrackModes) {
    TextRun scene(open_room(mode) +
                  "[[box]]\nname = \"cart\"\nsize = [2, 0.2]\nmass = 3\nposition = [0, 0]\n"
                  "[[joint]]\ntype = \"slider\"\nbetween = [\"cart\", \"room\"]\n"
                  "[[track]]\non = \"cart\"\npoints = [[-1, 1.5], { through = [0, 0.5], to = [1, 1.5] }]\n"
                  "thread = [\"bead\"]\nfriction = 0\n"
                  "[[particle]]\nname = \"bead\"\nmass = 1\nposition = [-0.8, 0.9]\n");
    const double begun = scene.at(0).energies.total();
    for (const double t : {0.3, 0.9, 2.0, 4.0}) {
      const sim::Snapshot now = scene.at(t);
      EXPECT_NEAR(now.momentum.x(), 0, 1e-10) << mode;
      EXPECT_NEAR(now.energies.total(), begun, 1e-7) << mode;
      const sim::Vec3 from = moving(now, scene, "bead").position - moving(now, scene, "cart").position;
      EXPECT_NEAR((from - sim::Vec3(0, 1.5, 0)).norm(), 1, 1e-10) << mode;
    }
  }
}

// A wire in a loop crosses itself: a bead goes once around and out; and a figure eight is run through
// straight on.
TEST(Wire, WhatCrossesItselfIsFollowed) {
  for (const std::string& mode : kTrackModes) {
    TextRun loop(
        open_room(mode) +
        "[[track]]\npoints = [[-3, 0], [0, 0], { through = [1, 1], to = [0, 2] }, { through = [-1, 1], to = "
        "[0, 0] }, [3, 0]]\nthread = \"bead\"\nfriction = 0\nends = \"free\"\n"
        "[[particle]]\nname = \"bead\"\nposition = [-2, 0]\nvelocity = [7, 0]\n");
    double highest = 0;
    for (int i = 1; i <= 100; ++i) highest = std::max(highest, loop.place(0.02 * i).y());
    EXPECT_NEAR(highest, 2, 0.01) << mode;
    // beyond the end it flies on, with the speed that it had at first
    EXPECT_NEAR(moving(loop.at(2.2), loop, "bead").velocity.x(), 7, 1e-8) << mode;
    EXPECT_LT(moving(loop.at(2.2), loop, "bead").position.y(), -1e-3) << mode;
    TextRun eight(open_room(mode, "gravity = [0, 0]") +
                  "[[track]]\nx = \"sin(s)\"\ny = \"sin(2*s)\"\nfrom = 0\nto = \"2*pi\"\nthread = \"bead\"\n"
                  "friction = 0\n[[particle]]\nname = \"bead\"\nposition = [1, 0]\nvelocity = [0, -1]\n");
    // without forces along it the speed stays; a round is its length, a half lies between both places [-1,
    // 0], [1, 0]
    const double length = integral(
        [](double u) { return std::sqrt(std::pow(std::cos(u), 2) + 4 * std::pow(std::cos(2 * u), 2)); }, 0,
        2 * kHalfTurn);
    EXPECT_NEAR((eight.place(to_a_microsecond(length / 2)) - sim::Vec3(-1, 0, 0)).norm(), 0, 2e-6) << mode;
    EXPECT_NEAR((eight.place(to_a_microsecond(5 * length)) - sim::Vec3(1, 0, 0)).norm(), 0, 2e-6) << mode;
  }
}

// A bead leaves an open end there and then, in every mode and at every rate, from a bend along its tangent,
// and from a rubbing slope of 1 in 2 with g (sin - mu cos) behind it.
TEST(Wire, ABeadLeavesAnOpenEndAtItsTime) {
  for (const std::string& mode : kTrackModes) {
    for (const int dimension : {2, 3}) {
      const std::string z = dimension == 2 ? "" : ", 0";
      for (const char* const rate : {"37", "100", "600"}) {
        SCOPED_TRACE(mode + " " + rate + " " + std::to_string(dimension));
        const std::vector<std::string> set = {std::string("physics.rate=") + rate};
        TextRun bend(
            open_room(mode, dimension == 2 ? "gravity = [0, 0]" : "gravity = [0, 0, 0]", dimension) +
                "[[track]]\nx = \"cos(s)\"\ny = \"sin(s)\"\n" + (dimension == 2 ? "" : "z = \"0\"\n") +
                "from = 0\nto = \"pi\"\nthread = \"bead\"\nends = \"free\"\nfriction = 0\n[[particle]]\n"
                "name = \"bead\"\nposition = [1, 0" +
                z + "]\nvelocity = [0, 3" + z + "]\n",
            set);
        const auto flies = moving(bend.at(1.8), bend, "bead");
        EXPECT_NEAR((flies.position - sim::Vec3(-1, -3 * (1.8 - kHalfTurn / 3), 0)).norm(), 0, 3e-8);
        EXPECT_NEAR((flies.velocity - sim::Vec3(0, -3, 0)).norm(), 0, 3e-8);

        TextRun slope(open_room(mode, "", dimension) + "[[track]]\npoints = [[-2, 1" + z + "], [0, 0" + z +
                          "]]\nthread = \"bead\"\nends = \"free\"\nfriction = 0.2\n[[particle]]\n"
                          "friction = 0.2\nname = \"bead\"\nposition = [-2, 1" +
                          z + "]\n",
                      set);
        const double root5 = std::sqrt(5), a = kTrackG * (1 - 0.2 * 2) / root5, v = std::sqrt(2 * a * root5),
                     past = 1.5 - v / a;
        const sim::Vec3 begun = v / root5 * sim::Vec3(2, -1, 0);
        EXPECT_NEAR((slope.place(1.5) - past * begun - sim::Vec3(0, -0.5 * kTrackG * past * past, 0)).norm(),
                    0, 1e-9);
      }
    }
  }
}

// A rod that turns flings its bead off: r = r0 cosh(omega t), and at the end with both velocities.
TEST(Wire, ABeadIsFlungOffARodThatTurns) {
  const double omega = 2, r0 = 0.2, end = std::acosh(1 / r0) / omega,
               out = r0 * omega * std::sinh(omega * end), angle = omega * end, t = 1.5;
  const sim::Vec3 along(std::cos(angle), std::sin(angle), 0), across(-along.y(), along.x(), 0);
  for (const std::string& mode : kTrackModes) {
    for (const char* const rate : {"60", "600"}) {
      TextRun rod(
          open_room(mode, "gravity = [0, 0]") +
              fmt::format("[[box]]\nname = \"rod\"\nsize = [0.05, 0.05]\nposition = [0, 0]\n"
                          "motion = {{ angle = \"{:.17g}*t\" }}\n[[track]]\non = \"rod\"\n"
                          "points = [[0.1, 0], [1, 0]]\nthread = \"bead\"\nfriction = 0\nends = \"free\"\n"
                          "[[particle]]\nname = \"bead\"\nposition = [0.2, 0]\nvelocity = [0, 0.4]\n",
                          omega * 180 / kHalfTurn),
          {std::string("physics.rate=") + rate});
      const auto bead = moving(rod.at(t), rod, "bead");
      const sim::Vec3 velocity = out * along + omega * across;
      EXPECT_NEAR((bead.velocity - velocity).norm(), 0, 5e-8) << mode << " " << rate;
      EXPECT_NEAR((bead.position - along - (t - end) * velocity).norm(), 0, 5e-8) << mode << " " << rate;
    }
  }
}

// A helix is a slope that is wound up: s = g sin(a) t^2 / 2 along it.
TEST(Wire, AHelixIsASlope) {
  for (const std::string& mode : kTrackModes) {
    TextRun helix(
        open_room(mode, "", 3) +
        "[[track]]\nx = \"cos(s)\"\ny = \"5 - 0.75*s\"\nz = \"sin(s)\"\nfrom = 0\nto = 12\nfriction = 0\n"
        "thread = \"bead\"\n[[particle]]\nname = \"bead\"\nposition = [1, 5, 0]\n");
    const double t = 1.5, along = 0.5 * kTrackG * 0.6 * t * t, s = along / 1.25;
    const sim::Vec3 expected(std::cos(s), 5 - 0.75 * s, std::sin(s));
    EXPECT_NEAR((helix.place(t) - expected).norm(), 0, 1e-9) << mode;
  }
}

// --- rails

// a slope of 3-4-5 from [-7, 8] to the floor, and a loop of radius 1 about [1, 1]
const std::string kLoop =
    "[[track]]\npoints = [[-7, 8], [-1, 0], [1, 0], { through = [2, 1], to = [1, 2] }, { through = [0, 1], "
    "to = "
    "[1, 0] }, [9, 0]]\nround = 0.5\nelasticity = 0\n";

// what starts at rest on the slope, its centre so high above the floor; a point slides, others roll with
// inertia share m r^2
std::string traveller(double share, double height) {
  const double r = share > 0 ? 0.1 : 0, y = height - 0.6 * r, x = -7 + 0.75 * (8 - y) + 0.8 * r;
  if (share == 0)
    return fmt::format("[[particle]]\nname = \"it\"\nposition = [{:.17g}, {:.17g}]\nfriction = 0\n", x, y);
  return fmt::format(
      "[[ball]]\nname = \"it\"\nradius = 0.1\nmass = 2\ninertia = {:.17g}\nposition = [{:.17g}, "
      "{:.17g}]\nfriction = "
      "9\n",
      share * 2 * r * r, x, height);
}

// whether it goes around the loop and never leaves it
bool loops(const std::string& mode, const std::string& text) {
  TextRun scene(open_room(mode) + text);
  bool inside = false, top = false;
  for (int i = 1; i < 600; ++i) {
    const sim::Snapshot now = scene.at(i / 100.0);
    const sim::Vec3 place = moving(now, scene, "it").position;
    bool touches = false;
    for (const auto& contact : now.contacts) touches = touches || contact.holds;
    inside = inside || place.x() > 1;
    top = top || (inside && place.y() > 1.7 && place.x() < 1);
    if (inside && !touches && place.x() < 2) return false;
    if (place.x() > 2) return top;
  }
  ADD_FAILURE() << "it comes to no end";
  return false;
}

// A loop behind a slope: a point goes around it from 5/2 R, a disc from 11/4 (R - r) above its lowest place,
// a ball, whose inertia is 2/5 m r^2, from 27/10 (R - r); within a thousandth.
TEST(Rail, LoopTheLoopTakesItsHeight) {
  for (const std::string& mode : kTrackModes) {
    for (const double share : {0.0, 0.5, 0.4}) {
      const double r = share > 0 ? 0.1 : 0, height = (2.5 + 0.5 * share) * (1 - r);
      EXPECT_TRUE(loops(mode, kLoop + traveller(share, r + 1.001 * height))) << mode << share;
      EXPECT_FALSE(loops(mode, kLoop + traveller(share, r + 0.999 * height))) << mode << share;
    }
  }
}

// Rolling or sliding over joints of pieces, from a line onto arcs of both bends, changes nothing: the speed
// is that of its height to a billionth.
TEST(Rail, JointsOfPiecesChangeNoVelocity) {
  const std::string track =
      "[[track]]\npoints = [[-4, 0], [-2, 0], { to = [-1, 0.06] }, { to = [0, 0.12] }, [1, 0.12], { to = [2, "
      "0.06] "
      "}, { to = [3, 0] }, [9, 0]]\nelasticity = 0\n";
  for (const std::string& mode : kTrackModes) {
    for (const std::string& body :
         {std::string("[[particle]]\nname = \"it\"\nposition = [-3, 0]\nvelocity = [5, 0]\nfriction = 0\n"),
          std::string(
              "[[ball]]\nname = \"it\"\nradius = 0.2\nposition = [-3, 0.2]\nvelocity = [5, 0]\nspin = "
              "-1432.394487827058\nfriction = 2\n")}) {
      TextRun scene(open_room(mode) + track + body);
      const bool ball = body[2] == 'b';
      const double share = ball ? 1.5 : 1;
      for (int i = 1; i <= 100; ++i) {
        const sim::Snapshot now = scene.at(0.016 * i);
        const auto& it = moving(now, scene, "it");
        const double rise = it.position.y() - (ball ? 0.2 : 0);
        const double v = std::sqrt(25 - 2 * kTrackG * rise / share);
        EXPECT_NEAR(it.velocity.norm(), v, 1e-8)
            << mode << " " << body << 0.016 * i << " " << it.position.x();
        EXPECT_FALSE(now.contacts.empty()) << mode << " " << it.position.x();
      }
      EXPECT_GT(moving(scene.at(1.6), scene, "it").position.x(), 3.5);
    }
  }
}

// A skier from the top of a hill leaves it where the hill no longer presses: at two thirds of its height.
TEST(Rail, ASkierLeavesTheRidgeWhereNothingPresses) {
  for (const std::string& mode : kTrackModes) {
    const double R = 2, begun = 0.1;
    TextRun scene(
        open_room(mode) +
        "[[track]]\nname = \"hill\"\npoints = [[-2, 0], { through = [0, 2], to = [2, 0] }]\nfriction = "
        "0\nelasticity = 0\n" +
        fmt::format("[[particle]]\nname = \"it\"\nposition = [{:.17g}, {:.17g}]\n", R * std::sin(begun),
                    R * std::cos(begun)) +
        "[[when]]\nleaves = [\"it\", \"hill\"]\ndo = [{ mark = \"off\" }]\n");
    // cos(leaves) = 2/3 cos(begun); the time from there by d phi / dt = sqrt(2 g (cos b - cos phi) / R)
    const double leaves = std::acos(2.0 / 3 * std::cos(begun));
    const double time = 2 * integral(
                                [&](double u) {
                                  const double phi = begun + u * u;
                                  // (cos b - cos phi) / u^2 at u = 0 is sin b
                                  const double drop = u < 1e-6 ? std::sin(begun)
                                                               : (std::cos(begun) - std::cos(phi)) / (u * u);
                                  return 1 / std::sqrt(2 * kTrackG * drop / R);
                                },
                                0, std::sqrt(leaves - begun));
    const auto touches = [&](double t) {
      const sim::Snapshot now = scene.at(to_a_microsecond(t));
      for (const auto& contact : now.contacts)
        if (contact.holds) return true;
      return false;
    };
    EXPECT_TRUE(touches(time - 0.004)) << mode;
    EXPECT_FALSE(touches(time + 0.004)) << mode;
    // from there on it falls freely
    const double v = std::sqrt(2 * kTrackG * R * (std::cos(begun) - std::cos(leaves))),
                 t = to_a_microsecond(time + 0.1);
    const double fell = t - time;
    const sim::Vec3 expected(R * std::sin(leaves) + v * std::cos(leaves) * fell,
                             R * std::cos(leaves) - v * std::sin(leaves) * fell - kTrackG * fell * fell / 2,
                             0);
    EXPECT_NEAR((moving(scene.at(t), scene, "it").position - expected).norm(), 0, 1e-8) << mode;
    ASSERT_EQ(scene.run->events().size(), 1u) << mode;
    EXPECT_NEAR(sim::value(scene.run->events()[0].time), time, mode == "event" ? 1e-8 : 1.0 / 600) << mode;
  }
}

// A ball that is thrown onto a track lands, and from behind it passes.
TEST(Rail, ABallLandsFromInFrontAndPassesFromBehind) {
  for (const std::string& mode : kTrackModes) {
    const std::string bowl =
        "[[track]]\npoints = [[-2, 2], { through = [0, 0], to = [2, 2] }]\nside = \"left\"\n";
    TextRun lands(
        open_room(mode) + bowl +
        "elasticity = 0.5\n[[ball]]\nname = \"it\"\nradius = 0.2\nposition = [0, 2.2]\nelasticity = 0.5\n");
    // it falls 2 m and rises a quarter of that
    const double down = std::sqrt(2 * 2 / kTrackG), v = std::sqrt(2 * kTrackG * 2);
    EXPECT_NEAR(moving(lands.at(to_a_microsecond(down + 0.5 * v / kTrackG)), lands, "it").position.y(),
                0.2 + 0.5, 1e-9)
        << mode;
    TextRun passes(open_room(mode) + bowl +
                   "[[ball]]\nname = \"it\"\nradius = 0.2\nposition = [0, -2]\nvelocity = [0, 9]\n");
    EXPECT_NEAR(moving(passes.at(0.5), passes, "it").position.y(), -2 + 9 * 0.5 - kTrackG * 0.125, 1e-9)
        << mode;
    // and from then on it is in front
    EXPECT_GT(moving(passes.at(4), passes, "it").position.y(), 0) << mode;
  }
}

// A ball in a bowl on a cart: with the cart pulled along with acceleration a it rests where tan(phi) = a/g;
// on a free cart momentum and energy stay.
TEST(Rail, OnAMovingBodyItHasThatMotion) {
  const std::string bowl =
      "[[track]]\non = \"cart\"\npoints = [[-1, 2], { through = [0, 1], to = [1, 2] }]\nfriction = "
      "0\nelasticity = "
      "0\n";
  for (const std::string& mode : kTrackModes) {
    const double a = 3, phi = std::atan(a / kTrackG), R = 1 - 0.2;
    TextRun pulled(
        open_room(mode) +
        "[[box]]\nname = \"cart\"\nsize = [2, 0.2]\nposition = [0, -1.5]\nmotion = { x = \"1.5*t^2\" }\n" +
        bowl +
        fmt::format("[[ball]]\nname = \"it\"\nradius = 0.2\nposition = [{:.17g}, {:.17g}]\n",
                    -R * std::sin(phi), 0.5 - R * std::cos(phi)));
    const sim::Snapshot now = pulled.at(1.5);
    EXPECT_NEAR(moving(now, pulled, "it").velocity.x(), a * 1.5, 1e-9) << mode;
    EXPECT_NEAR(moving(now, pulled, "it").position.y(), 0.5 - R * std::cos(phi), 1e-9) << mode;
    TextRun free(open_room(mode) +
                 "[[box]]\nname = \"cart\"\nsize = [2, 0.2]\nmass = 3\nposition = [0, -1.5]\n"
                 "[[joint]]\ntype = \"slider\"\nbetween = [\"cart\", \"room\"]\n" +
                 bowl + "[[ball]]\nname = \"it\"\nradius = 0.2\nposition = [-0.64, 0.02]\n");
    const double begun = free.at(0).energies.total();
    for (const double t : {0.3, 0.9, 2.1}) {
      EXPECT_NEAR(free.at(t).momentum.x(), 0, 1e-10) << mode;
      EXPECT_NEAR(free.at(t).energies.total(), begun, 1e-8) << mode;
    }
  }
}

// On curves of formulas and splines nothing is lost; and the mirror image of a track, which runs the other
// way and is touched from its right, is the mirror image of the motion.
TEST(Rail, FormulasAndSplinesLoseNothingAndHaveMirrorImages) {
  const std::vector<std::string> tracks = {
      "x = \"{0}*s\"\ny = \"0.3*s^2 + 0.1*sin(3*s)\"\nfrom = -3\nto = 3\n",
      "points = [[{1}3, 2.5], {{ spline = [[{1}1.5, 0.6], [0, 0.3], [{2}1.2, 0.7], [{2}3, 2.6]] }}]\n"};
  for (const std::string& mode : kTrackModes) {
    for (const std::string& track : tracks) {
      const auto text = [&](int side) {
        return open_room(mode) + "[[track]]\n" +
               fmt::format(fmt::runtime(track), side, side > 0 ? "-" : "", side > 0 ? "" : "-") +
               fmt::format(
                   "side = \"{}\"\nelasticity = 0\n[[ball]]\nname = \"it\"\nradius = 0.1\nelasticity = "
                   "0\nfriction = "
                   "5\nposition = [{}, 2.4]\n",
                   side > 0 ? "left" : "right", -1.8 * side);
      };
      TextRun scene(text(1)), mirror(text(-1));
      const double begun = scene.at(1).energies.total();
      for (const double t : {1.3, 2.0, 3.1}) {
        const sim::Snapshot now = scene.at(t), other = mirror.at(t);
        EXPECT_NEAR(now.energies.total(), begun, 1e-8) << mode << track << t;
        const sim::Vec3 p = moving(now, scene, "it").position, q = moving(other, mirror, "it").position;
        EXPECT_NEAR(p.x(), -q.x(), 1e-9) << mode << track << t;
        EXPECT_NEAR(p.y(), q.y(), 1e-9) << mode << track << t;
        EXPECT_FALSE(now.contacts.empty()) << mode << track << t;
      }
    }
  }
}

// At a kilometre a second nothing passes: a ball, a point and a box come back from a track.
TEST(Rail, NothingIsTooFast) {
  for (const std::string& mode : kTrackModes) {
    for (const std::string& body :
         {std::string("[[particle]]\nradius = 0.05\n"), std::string("[[particle]]\n"),
          std::string("[[box]]\nsize = [0.3, 0.2]\n")}) {
      TextRun scene(open_room(mode, "gravity = [0, 0]") +
                    "[[track]]\npoints = [[-2, -3], { through = [0, -5], to = [2, -3] }]\nelasticity = 1\n" +
                    body + "position = [0, 4]\nvelocity = [0, -1000]\nelasticity = 1\nfriction = 0\n");
      EXPECT_NEAR(scene.at(0.02).bodies[0].velocity.y(), 1000, 1e-6) << mode << body;
    }
  }
}

// What rolls off the end of a track turns over the edge or flies on, and what goes over a rail of both sides
// stays on its own.
TEST(Rail, EndsAndBothSides) {
  for (const std::string& mode : kTrackModes) {
    TextRun flies(
        open_room(mode) +
        "[[track]]\npoints = [[-2, 0], [0, 0]]\nfriction = 0\n[[ball]]\nname = \"it\"\nradius = 0.2\n"
        "position = [-1, 0.2]\nvelocity = [2, 0]\nfriction = 0\n");
    // v^2 > g r: it leaves at the edge
    EXPECT_NEAR(moving(flies.at(1), flies, "it").position.y(), 0.2 - kTrackG * 0.125, 1e-9) << mode;
    TextRun turns(open_room(mode) +
                  "[[track]]\npoints = [[-2, 0], [0, 0]]\nfriction = 0\nelasticity = 0\n[[ball]]\nname = "
                  "\"it\"\nradius = "
                  "0.2\nposition = [-0.5, 0.2]\nvelocity = [0.5, 0]\nfriction = 0\n");
    // over the edge at first with half of g r: it stays until cos = (2 + v^2/(g r)) / 3
    const double begun = turns.at(0).energies.total();
    EXPECT_NEAR(moving(turns.at(1.05), turns, "it").position.norm(), 0.2, 1e-9) << mode;
    EXPECT_NEAR(turns.at(1.1).energies.total(), begun, 1e-9) << mode;
    for (const double side : {1.0, -1.0}) {
      TextRun both(open_room(mode, fmt::format("gravity = [0, {}]", -kTrackG * side)) +
                   "[[track]]\npoints = [[-4, 0], [4, 0]]\nside = \"both\"\nelasticity = 0.5\n" +
                   fmt::format("[[particle]]\nname = \"it\"\nposition = [0, {}]\nelasticity = 0.5\n", side));
      const double down = std::sqrt(2 / kTrackG), v = kTrackG * down;
      EXPECT_NEAR(side * moving(both.at(to_a_microsecond(down + 0.5 * v / kTrackG)), both, "it").position.y(),
                  0.25, 1e-9)
          << mode;
      EXPECT_NEAR(moving(both.at(5), both, "it").position.y(), 0, 1e-9) << mode;
    }
  }
}

// --- in space

// A ball on two rails of space turns about a shorter lever: a = g sin a / (1 + 2/5 r^2 / (r^2 - d^2)).
TEST(RailInSpace, ABallRollsOnTwoRails) {
  for (const std::string& mode : kTrackModes) {
    const double r = 0.5, d = 0.3, lever2 = r * r - d * d, lever = std::sqrt(lever2);  // 0.4
    std::string rails;
    for (const double z : {-d, d})
      rails += fmt::format("[[track]]\npoints = [[-8, 6, {0}], [0, 0, {0}]]\n", z);
    TextRun scene(
        open_room(mode, "", 3) + rails +
        fmt::format("[[ball]]\nname = \"it\"\nradius = 0.5\nfriction = 2\nposition = [{:.17g}, {:.17g}, 0]\n",
                    -6 + 0.6 * lever, 4.5 + 0.8 * lever));
    const sim::Snapshot now = scene.at(1);
    const double a = kTrackG * 0.6 / (1 + 0.4 * r * r / lever2);
    EXPECT_NEAR(moving(now, scene, "it").velocity.norm(), a, 1e-8) << mode;
    EXPECT_NEAR(moving(now, scene, "it").spin.z(), -a / lever, 1e-8) << mode;
    EXPECT_NEAR(moving(now, scene, "it").position.z(), 0, 1e-9) << mode;
  }
}

// A ball that hangs in the plane of a rail moves as in the plane: without friction, in a bowl and over a
// joint of pieces; until what is unstable across it has grown.
TEST(RailInSpace, InAPlaneItIsThatOfThePlane) {
  for (const std::string& mode : kTrackModes) {
    const std::string tail = "friction = 0\nelasticity = 0\n";
    TextRun flat(open_room(mode) + "[[track]]\npoints = [[-4, 3], [0, 0], [3, 0]]\nround = 1\n" + tail +
                 "[[ball]]\nname = \"it\"\nradius = 0.2\nposition = [-2.88, 2.41]\n");
    TextRun space(open_room(mode, "", 3) +
                  "[[track]]\npoints = [[-4, 3, 0], [0, 0, 0], [3, 0, 0]]\nround = 1\n" + tail +
                  "[[ball]]\nname = \"it\"\nradius = 0.2\nposition = [-2.88, 2.41, 0]\n");
    for (const double t : {0.4, 0.8, 1.1})
      EXPECT_NEAR(
          (moving(flat.at(t), flat, "it").position - moving(space.at(t), space, "it").position).norm(), 0,
          1e-9)
          << mode << t;
  }
}

// --- bodies with corners

// A block on a slope of 3-4-5 slides with (sin a - mu cos a) g, or stays; and along a straight piece that
// bends up, its energy stays.
TEST(RailOfBoxes, ABlockSlidesOnASlopeAndUpABend) {
  for (const std::string& mode : kTrackModes) {
    const auto block = [&](double friction) {
      return open_room(mode) + "[[track]]\npoints = [[-8, 6], [0, 0]]\n" +
             fmt::format(
                 "[[box]]\nname = \"it\"\nsize = [0.4, 0.2]\nposition = [-5.94, 4.58]\nangle = "
                 "-36.86989764584402\nfriction = {}\n",
                 friction);
    };
    TextRun slides(block(0.5)), stays(block(0.8));
    const sim::Snapshot now = slides.at(1);
    EXPECT_NEAR(moving(now, slides, "it").velocity.norm(), kTrackG * (0.6 - 0.5 * 0.8), 1e-9) << mode;
    EXPECT_NEAR(moving(now, slides, "it").spin.z(), 0, 1e-9) << mode;
    EXPECT_NEAR((moving(stays.at(2), stays, "it").position - sim::Vec3(-5.94, 4.58, 0)).norm(), 0, 1e-9)
        << mode;
    TextRun bends(open_room(mode) +
                  "[[track]]\npoints = [[-4, 0], [0, 0], { to = [3, 3] }]\nfriction = 0\nelasticity = 0\n"
                  "[[box]]\nname = \"it\"\nsize = [0.6, 0.2]\nposition = [-1, 0.1]\nvelocity = [4, 0]\n");
    const double begun = bends.at(0).energies.total();
    for (const double t : {0.2, 0.4, 0.5, 0.8, 1.4}) {
      const sim::Snapshot then = bends.at(t);
      EXPECT_NEAR(then.energies.total(), begun, 1e-7) << mode << t;
      if (t != 0.5) continue;
      // both of its corners stay on the arc of radius 3 about [0, 3]
      const auto& it = moving(then, bends, "it");
      for (const double x : {-0.3, 0.3}) {
        const sim::Vec3 corner = it.position + it.orientation * sim::Vec3(x, -0.1, 0);
        EXPECT_NEAR((corner - sim::Vec3(0, 3, 0)).norm(), 3, 1e-8) << mode;
      }
    }
  }
}

// A plank rocks on a round top of radius R: half its thickness h below R it comes back, with
// omega^2 = g (R - h) / (L^2/12 + h^2/3), small.
TEST(RailOfBoxes, APlankRocksOnARoundTop) {
  for (const std::string& mode : kTrackModes) {
    const double R = 1, h = 0.1, L = 2, tilt = 1e-3;  // half its height is h
    const double omega = std::sqrt(kTrackG * (R - h) / (L * L / 12 + h * h / 3 + h * h));
    // tilted by rolling: the contact is R tilt along the plank
    const double s = std::sin(tilt), c = std::cos(tilt);
    TextRun rocks(
        open_room(mode) +
        "[[track]]\npoints = [[-1, 0], { through = [0, 1], to = [1, 0] }]\nelasticity = 0\n" +
        fmt::format("[[box]]\nname = \"it\"\nsize = [2, 0.2]\nposition = [{:.17g}, {:.17g}]\nangle = "
                    "{:.17g}\nfriction = 2\n",
                    -(R + h) * s + R * tilt * c, (R + h) * c + R * tilt * s, tilt * 180 / kHalfTurn));
    const double half = to_a_microsecond(kHalfTurn / omega);
    const double begun = rocks.at(0).energies.total();
    EXPECT_NEAR(moving(rocks.at(half), rocks, "it").angle, -tilt, 1e-8) << mode;
    EXPECT_NEAR(rocks.at(half).energies.total(), begun, 1e-10) << mode;
  }
}

// A block and a triangle that fall onto a track of two sides lie there, above it and below it.
TEST(RailOfBoxes, BothSidesBear) {
  for (const std::string& mode : kTrackModes) {
    for (const int side : {1, -1}) {
      TextRun falls(
          open_room(mode, fmt::format("gravity = [0, {}]", -kTrackG * side)) +
          "[[track]]\npoints = [[-4, 0], [4, 0]]\nside = \"both\"\nelasticity = 0\n" +
          fmt::format("[[box]]\nname = \"box\"\nsize = [0.6, 0.2]\nposition = [-1, {}]\nangle = 20\n", side) +
          fmt::format("[[polygon]]\nname = \"triangle\"\npoints = [[0, 0], [0.6, 0], [0.3, 0.5]]\nposition = "
                      "[1, {}]\nangle = {}\n",
                      side, side > 0 ? 0 : 180));
      const sim::Snapshot now = falls.at(4);
      EXPECT_NEAR(moving(now, falls, "box").position.y(), 0.1 * side, 1e-8) << mode;
      EXPECT_NEAR(moving(now, falls, "triangle").position.y(), 0.5 / 3 * side, 1e-8) << mode;
    }
  }
}

// A block that comes from behind passes, or falls back: it does not hang by its corners.
TEST(RailOfBoxes, FromBehindTheyPass) {
  for (const std::string& mode : kTrackModes) {
    for (const double v : {4.0, 4.8, 9.0}) {
      TextRun scene(
          open_room(mode) + "[[track]]\npoints = [[-4, 0], [4, 0]]\nelasticity = 0\n" +
          fmt::format("[[box]]\nname = \"it\"\nsize = [0.3, 0.5]\nposition = [0, -1]\nvelocity = [0, {}]\n"
                      "elasticity = 0\n",
                      v));
      // it rises by v^2 / 2 g: 0.82, 1.17 and 4.1 m
      const double t = to_a_microsecond(2 * v / kTrackG + 0.5);
      const double y = moving(scene.at(t), scene, "it").position.y();
      if (v < 9) {
        EXPECT_NEAR(y, -1 - v * 0.5 - kTrackG * 0.125, 1e-5) << mode << v;
      } else {
        EXPECT_NEAR(y, 0.25, 1e-9) << mode << v;
      }
    }
  }
}

// A block slides off the end of a track that lets nothing fall through before.
TEST(RailOfBoxes, ABlockTipsOverTheEnd) {
  for (const std::string& mode : kTrackModes) {
    TextRun tips(open_room(mode) +
                 "[[track]]\npoints = [[-2, 0], [0, 0]]\nfriction = 0\nelasticity = 0\n"
                 "[[box]]\nname = \"it\"\nsize = [1, 0.2]\nposition = [-1, 0.1]\nvelocity = [1, 0]\n");
    // its centre comes to the end after 1 s, until when it lies flat
    EXPECT_NEAR(moving(tips.at(0.999), tips, "it").position.y(), 0.1, 1e-9) << mode;
    const sim::Snapshot later = tips.at(1.2);
    const auto& it = moving(later, tips, "it");
    EXPECT_LT(it.angle, -0.01) << mode;
    EXPECT_NEAR(it.velocity.x(), 1, 0.1) << mode;
    EXPECT_LT(moving(tips.at(3), tips, "it").position.y(), -3) << mode;
  }
}

// --- what is refused

TEST(Tracks, ErrorsSayWhatToWrite) {
  using testing::HasSubstr;
  const std::string room = "[room]\nsize = [8, 4]\n[[particle]]\nname = \"p\"\nposition = [1, 1]\n";
  EXPECT_THAT(said_against(room + "[[track]]\npoints = [[0, 1], [1, 0], [3, 0]]\n"),
              HasSubstr("the track turns by 45 degrees at [1, 0]: it must be smooth. Write round = 0.2"));
  EXPECT_EQ(said_against(room + "[[track]]\nround = 0.3\npoints = [[0, 1], [1, 0], [3, 0]]\n"), "");
  EXPECT_THAT(said_against(room + "[[track]]\nround = 5\npoints = [[0, 1], [1, 0], [3, 0]]\n"),
              HasSubstr("arcs of 5 m are too wide"));
  EXPECT_THAT(said_against(room + "[[track]]\nx = \"cos(q)\"\ny = \"s\"\nfrom = 0\nto = 1\n"),
              HasSubstr("a.toml:7:10: 'x', column 5: "));
  EXPECT_THAT(said_against(room + "[[track]]\nx = \"s - sin(s)\"\ny = \"cos(s)\"\nfrom = 0\nto = 1\n"),
              HasSubstr("the track has no direction at s = 0"));
  EXPECT_THAT(said_against(room + "[[track]]\n"), HasSubstr("a track needs 'points', or 'x' and 'y'"));
  EXPECT_THAT(said_against("[room]\nsize = [8, 4, 8]\n[[track]]\npoints = [[0, 1, 0], [1, 1, "
                           "0]]\n[[box]]\nposition = [2, 2, 2]\n"),
              HasSubstr("'box[0]' might come upon the track 'track[0]'"));
  // a point passes by a track of space, but not one that runs on a wire of its own
  const std::string rail_and_bead =
      "[room]\nsize = [8, 4, 8]\n[[track]]\npoints = [[0, 1, 0], [1, 1, 0]]\n[[particle]]\nname = \"bead\"\n"
      "position = [2, 2, 2]\n";
  EXPECT_THAT(said_against(rail_and_bead), HasSubstr("thread = [\"bead\"]"));
  EXPECT_EQ(said_against(rail_and_bead + "[[track]]\npoints = [[1, 2, 2], [3, 2, 2]]\nthread = [\"bead\"]\n"),
            "");
  EXPECT_THAT(
      said_against(room +
                   "[[track]]\npoints = [[0, 1], [3, 1]]\n[[box]]\nsize = [1, 1]\nposition = [1.5, 1.4]\n"),
      HasSubstr("'box[0]' overlaps the track 'track[0]' by 0.1 m"));
  EXPECT_THAT(
      said_against(room + "[[track]]\npoints = [[0, 1], [1, 1]]\n[physics]\nsolver = \"iterative\"\n"),
      HasSubstr("tracks are for the direct solver"));
  EXPECT_THAT(
      said_against(room + "[[track]]\npoints = [[0, 1], [1, 1]]\n[physics]\ncollision = \"handout\"\n"),
      HasSubstr("[[track]] is not in `collision = \"handout\"`"));
  EXPECT_THAT(said_against(room + "[[track]]\npoints = [[0, 1], [1, 1]]\n[[ball]]\nposition = [0.5, 1.1]\n"),
              HasSubstr("'ball[0]' overlaps the track 'track[0]' by 0.1 m"));
  EXPECT_THAT(said_against(room + "[[track]]\npoints = [[0, 1], { through = [3, 1], to = [2, 1] }]\n"),
              HasSubstr("lie in a line"));
  EXPECT_EQ(
      said_against(room + "[[track]]\npoints = [[0, 2], { through = [1, 1], to = [2, 0] }, { spline = [[3, "
                          "1], [4, 0]] }]\n"),
      "");
  EXPECT_THAT(said_against(room + "[[track]]\npoints = [[0, 1], { thru = [1, 1], to = [2, 1] }]\n"),
              HasSubstr("unknown key 'thru' in a piece of a track: expected through, to or spline"));
}

}  // namespace
}  // namespace obscura::scene
