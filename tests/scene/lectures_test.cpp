// Demonstrations of a first course of mechanics against their closed forms or equations of their own, as a
// lecturer writes them.

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "text_run.h"

namespace obscura::scene {
namespace {

// A heavy symmetric top that is let go tilted, by Lagrange's equations of nutation th, precession ph:
//   I1 th'' = I1 ph'^2 sin cos - p ph' sin + m g l sin,   I1 ph' sin^2 = p (cos th0 - cos th),   p = I3 w3
TEST(Lectures, AHeavyTopNutatesAsLagrangesEquationsSay) {
  const double g = 9.81, m = 0.5, l = 0.4, I3 = 0.02, I1c = 0.013, w3 = 60, th0 = std::numbers::pi / 3;
  const TextRun run(fmt::format(
      "duration = 2\n[room]\nsize = [2, 2, 2]\n[[ball]]\nname = 'top'\nradius = 0.05\nmass = {}\n"
      "inertia = [{}, {}, {}]\nposition = [{}, {}, 0]\norientation = [0, 0, -60]\nspin = [{}, {}, 0]\n"
      "[[joint]]\ntype = 'ball'\nbetween = ['top', 'room']\nat = [0, 1, 0]\n",
      m, I1c, I3, I1c, l * std::sin(th0), 1 + l * std::cos(th0), w3 * 180 / std::numbers::pi * std::sin(th0),
      w3 * 180 / std::numbers::pi * std::cos(th0)));
  const double I1 = I1c + m * l * l, p = I3 * w3;
  using S = std::array<double, 3>;  // th, th', ph
  const auto rate = [&](const S& s) -> S {
    const double sine = std::sin(s[0]), cosine = std::cos(s[0]),
                 turns = p * (std::cos(th0) - cosine) / (I1 * sine * sine);
    return {s[1], (I1 * turns * turns * cosine - p * turns + m * g * l) * sine / I1, turns};
  };
  S s{th0, 0, 0};
  const double dt = 1e-4;
  for (int i = 0; i < 10000; ++i) {
    const auto at = [&](const S& k, double part) {
      return S{s[0] + part * dt * k[0], s[1] + part * dt * k[1], s[2] + part * dt * k[2]};
    };
    const S a = rate(s), b = rate(at(a, 0.5)), c = rate(at(b, 0.5)), d = rate(at(c, 1));
    for (int k = 0; k < 3; ++k) s[k] += dt / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
  }
  const sim::Vec3 place = run.place(1);
  EXPECT_NEAR(place.x(), l * std::sin(s[0]) * std::cos(s[2]), 1e-6);
  EXPECT_NEAR(place.y(), 1 + l * std::cos(s[0]), 1e-6);
  EXPECT_NEAR(place.z(), -l * std::sin(s[0]) * std::sin(s[2]), 1e-6);
  EXPECT_GT(s[2], 1);
}

// Foucault's pendulum in a frame that turns with W: e^(-iWt) (cos wt + i W/w sin wt)
TEST(Lectures, FoucaultsPendulumTurnsAgainstItsFrame) {
  const TextRun run(
      "duration = 60\n[constants]\nW = 0.05\nl = 4\n[room]\nsize = [3, 3]\ngravity = [0, 0]\n[[particle]]\n"
      "name = 'bob'\nposition = [2.5, 1.5]\n[[force]]\ncenter = [1.5, 1.5]\n"
      "components = ['-9.81/l*m*dx + 2*m*W*vy + m*W^2*dx', '-9.81/l*m*dy - 2*m*W*vx + m*W^2*dy']\n");
  const double w = std::sqrt(9.81 / 4), W = 0.05, t = 60;
  const double a = std::cos(w * t), b = W / w * std::sin(w * t);
  EXPECT_NEAR(run.place(t).x(), 1.5 + a * std::cos(W * t) + b * std::sin(W * t), 1e-8);
  EXPECT_NEAR(run.place(t).y(), 1.5 - a * std::sin(W * t) + b * std::cos(W * t), 1e-8);
}

// A tunnel through the earth, in metres, kilograms and seconds: once through and back in 2 pi sqrt(R/g)
TEST(Lectures, ATunnelThroughTheEarthTakesItsTime) {
  const TextRun run(
      "duration = 6000\n[room]\nsize = [1.4e7, 1.4e7]\ncorner = [-7e6, -7e6]\nwalls = 'none'\ngravity = [0, "
      "0]\n"
      "[physics]\nrate = 1\n[[particle]]\nposition = [6.371e6, 0]\n[[force]]\ncenter = [0, 0]\n"
      "components = ['-9.81*m*dx/6.371e6', '-9.81*m*dy/6.371e6']\n");
  const double w = std::sqrt(9.81 / 6.371e6);
  EXPECT_NEAR(run.place(5000).x(), 6.371e6 * std::cos(w * 5000), 1e-3);
}

// What flies moves by the scheme that is named, in every manner: with a = -g and n steps of h the place is
//   v n h - g h^2 n (n - 1)/2 by Euler's, v n h - g h^2 n (n + 1)/2 by the semi-implicit one, else v t - g
//   t^2/2
TEST(Lectures, WhatFliesMovesByTheSchemeThatIsNamed) {
  for (const bool space : {false, true}) {
    for (const Manner& manner : kManners) {
      for (const std::string scheme : {"euler", "semi-implicit", "midpoint", "rk4"}) {
        const int n = 540;
        const double h = 1.0 / 600, more = scheme == "euler" ? -n : scheme == "semi-implicit" ? n : 0;
        const TextRun run(
            (space ? space_without_walls(manner, "gravity = [0, -10, 0]")
                   : plane_without_walls(manner, "gravity = [0, -10]")) +
                fmt::format("[[ball]]\nradius = 0.2\nposition = [1, 2{0}]\nvelocity = [3, 1{0}]\n",
                            space ? ", 0" : ""),
            {"physics.integrator=" + scheme, "physics.rate=600"});
        const sim::Snapshot::Body now = run.at(n * h).bodies[0];
        EXPECT_NEAR(now.position.x(), 1 + 3 * n * h, 1e-12) << manner.name << scheme << space;
        EXPECT_NEAR(now.position.y(), 2 + n * h - 5 * h * h * (n * n + more), 1e-12) << manner.name << scheme;
        EXPECT_NEAR(now.velocity.y(), 1 - 10 * n * h, 1e-12) << manner.name << scheme << space;
      }
    }
  }
}

// Those too that are about to touch, at a rate of which each step has several substeps: two balls that fall
// side by side, and close in slowly.
TEST(Lectures, SubstepsShareOutTheSchemesOwnStep) {
  for (const bool space : {false, true}) {
    for (const std::string scheme : {"euler", "semi-implicit", "midpoint", "rk4"}) {
      const int n = 20;
      const double h = 0.02, more = scheme == "euler" ? -n : scheme == "semi-implicit" ? n : 0;
      const std::string z = space ? ", 0" : "";
      const TextRun run(
          (space ? space_without_walls(kManners[2], "gravity = [0, -10, 0]")
                 : plane_without_walls(kManners[2], "gravity = [0, -10]")) +
              "[[ball]]\nradius = 0.2\nposition = [0, 5" + z + "]\nspin = " + (space ? "[0, 0, 90]" : "90") +
              "\n[[ball]]\nradius = 0.2\nposition = [0.41, 5" + z + "]\nvelocity = [-0.02, 0" + z + "]\n",
          {"physics.integrator=" + scheme, "physics.rate=50"});
      const sim::Snapshot now = run.at(n * h);
      for (const sim::Snapshot::Body& body : now.bodies) {
        EXPECT_NEAR(body.position.y(), 5 - 5 * h * h * (n * n + more), 1e-12) << scheme << space;
        EXPECT_NEAR(body.velocity.y(), -10 * n * h, 1e-12) << scheme << space;
      }
      EXPECT_NEAR(now.bodies[0].spin.z(), std::numbers::pi / 2, 1e-12) << scheme << space;
      EXPECT_NEAR(now.bodies[0].angle, std::numbers::pi / 2 * n * h, space ? 10 : 1e-12) << scheme;
    }
  }
}

// Semi-implicit Euler holds the energy of a pendulum on a rod, too, for forces of joints are those that end
// the step on the constraint: it only swings about its value, by an amount of the order of the step.
TEST(Lectures, SemiImplicitEulerKeepsAPendulumsEnergy) {
  for (const bool space : {false, true}) {
    for (const Manner& manner : kManners) {
      for (const int links : {1, 2}) {
        const std::string z = space ? ", 0" : "";
        const TextRun run(
            (space ? space_without_walls(manner, "gravity = [0, -9.81, 0]") : plane_without_walls(manner)) +
                fmt::format("[[particle]]\nname = 'b'\nposition = [1, 0{0}]\n[[joint]]\ntype = 'rod'\n"
                            "between = [[0, 0{0}], 'b']\n",
                            z) +
                (links == 1 ? ""
                            : fmt::format("[[particle]]\nname = 'c'\nmass = 0.5\nposition = [1, 0.5{0}]\n"
                                          "[[joint]]\ntype = 'rod'\nbetween = ['b', 'c']\n",
                                          z)),
            {"physics.integrator=semi-implicit", "physics.rate=120"});
        const double begun = run.at(0).energies.total();
        double most = 0, late = 0;
        for (int i = 1; i <= 400; ++i) {
          const double off = run.at(0.05 * i).energies.total() - begun;
          most = std::max(most, std::abs(off));
          if (i > 200) late += off / 200;
        }
        EXPECT_LT(most, links == 1 ? 0.1 : 0.6) << manner.name << space << links;  // of some 10 J that swing
        EXPECT_LT(std::abs(late), links == 1 ? 0.03 : 0.3) << manner.name << space << links;
      }
    }
  }
}

// What joints do not allow is corrected before the run begins, and told so at t = 0: a rod that is to swing
// about its end has a quarter of the spin that it is given about its middle.
TEST(Lectures, VelocitiesAtTheStartAreThoseThatJointsAllow) {
  for (const Manner& manner : kManners) {
    const TextRun run(
        plane_without_walls(manner) +
        "[[box]]\nname = 'rod'\nsize = [0.06, 1.2]\nmass = 1\nposition = [0, -0.57]\nspin = 90\n"
        "inertia = 0.1083\n[[joint]]\ntype = 'pin'\nbetween = ['rod', 'room']\nat = [0, 0]\n");
    const double I = 0.1083, spin = std::numbers::pi / 2 * I / (I + 0.57 * 0.57);
    const sim::Snapshot begun = run.at(0);
    EXPECT_NEAR(begun.bodies[0].spin.z(), spin, 1e-12) << manner.name;
    EXPECT_NEAR(begun.bodies[0].velocity.x(), 0.57 * spin, 1e-12) << manner.name;
    const double total = begun.energies.total();
    EXPECT_NEAR(run.at(1).energies.total(), total, 1e-6) << manner.name;
  }
}

}  // namespace
}  // namespace obscura::scene
