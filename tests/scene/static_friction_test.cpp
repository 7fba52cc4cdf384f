// What does not slip bears mu_s f_n, what slips mu f_n <= mu_s f_n: closed forms in both dimensions, under
// `event` nearly at rounding, in `contact` at the first order of the step in which a slip begins.

#include "scene/text_run.h"

namespace obscura::scene {
namespace {

constexpr double kToRounding = 1e-12;  // m, of some metres and 600 steps
// m: a slip begins some 1e-9 s late, where friction is exceeded by what the cone's law tells from none, and
// then at once by 2 m/s^2 for some seconds
constexpr double kLate = 1e-8;

std::string slab(bool space, const std::string& more) {
  return fmt::format(
      "[[box]]\nname = \"b\"\nsize = [0.4, 0.2{}]\nposition = [8, 0.1{}]\nmass = 1\nelasticity = 0\n"
      "friction = 0.3\nstatic_friction = 0.5\n{}\n",
      space ? ", 0.3" : "", space ? ", 0" : "", more);
}

std::string floor_room(bool space, const std::string& collision, int rate, const std::string& gravity) {
  return fmt::format("[physics]\ncollision = \"{}\"\nrate = {}\n[room]\nsize = {}\ngravity = {}\n", collision,
                     rate, space ? "[40, 8, 40]" : "[40, 8]", gravity);
}

// A force that is 5 N at t0 and grows by 2 N a second, on 1 kg with mu_s = 0.5 and mu = 0.3, g = 10 m/s^2:
//   x = (t - t0)^2 + (t - t0)^3 / 3
TEST(StaticFriction, IsWhatAForceMustOvercome) {
  for (const bool space : {false, true}) {
    for (const double t0 : {0.1037, 0.5}) {
      for (const double sign : {1.0, -1.0}) {
        const std::string push =
            fmt::format("[[force]]\nof = \"b\"\ncomponents = [\"{}*(5 + 2*(t - {}))\", \"0\"{}]\n", sign, t0,
                        space ? ", \"0\"" : "");
        const auto off = [&](const std::string& collision, int rate) {
          const TextRun run(floor_room(space, collision, rate, space ? "[0, -10, 0]" : "[0, -10]") +
                            slab(space, "") + push);
          return std::fabs(run.place(t0 + 1.5).x() - 8 - sign * 3.375);
        };
        for (const int rate : {50, 600}) EXPECT_LE(off("event", rate), kLate) << space << t0 << sign;
        // a slip that begins at most a step late: 2 m/s^2 for 1.5 s
        EXPECT_LE(off("contact", 600), 3.01 / 600) << space << t0 << sign;
      }
    }
  }
}

// A force of 2 N/s on a block of 1 kg slips it at t0 = mu_s g / 2 s, whatever share of the load its front and
// its rear edge bear (the block's height makes them differ); and then
//   x = (t^3 - t0^3) / 3 - t0^2 (t - t0) - mu g (t - t0)^2 / 2
// up to a slip that begins some 1e-9 s late, and so is slower by (mu_s - mu) g times that
TEST(StaticFriction, IsThatOfAllContactsTogether) {
  struct Block {
    double height, rests, slips;
  };
  for (const bool space : {false, true}) {
    for (const auto& [height, rests, slips] :
         {Block{0.08, 0.6, 0.4}, Block{0.1, 0.6, 0.4}, Block{0.12, 0.6, 0.4}, Block{0.2, 0.3, 0.2},
          Block{0.3, 0.3, 0.2}, Block{0.1, 1, 0.5}, Block{0.02, 0.5, 0}}) {
      const std::string scene = fmt::format(
          "[[box]]\nname = \"b\"\nsize = [0.4, {0}{1}]\nposition = [8, {2}{3}]\nmass = 1\nelasticity = 0\n"
          "friction = {4}\nstatic_friction = {5}\n[[force]]\ncomponents = [\"2*t\", \"0\"{6}]\n",
          height, space ? ", 0.3" : "", height / 2, space ? ", 0" : "", slips, rests, space ? ", \"0\"" : "");
      const double t0 = 5 * rests, t = t0 + 1;
      const double way = (t * t * t - t0 * t0 * t0) / 3 - t0 * t0 - 5 * slips;
      for (const int rate : {60, 600}) {
        const TextRun run(floor_room(space, "event", rate, space ? "[0, -10, 0]" : "[0, -10]") + scene);
        EXPECT_NEAR(run.place(t0 - 0.001).x(), 8, kToRounding) << space << height << rests << rate;
        EXPECT_NEAR(run.place(t).x(), 8 + way, 4e-9 * 10 * (rests - slips))
            << space << height << rests << rate;
      }
    }
  }
}

// On a slope of slope 0.4, between the two, what lies stays, for ever, and what is pushed goes on:
//   s = v t + g (sin - 0.3 cos) t^2 / 2
TEST(StaticFriction, OnASlopeBetweenTheTwoWhatLiesStaysAndWhatSlidesGoesOn) {
  const double a = std::atan(0.4), g = 10;
  for (const bool space : {false, true}) {
    for (const std::string collision : {"contact", "event"}) {
      const std::string gravity =
          fmt::format("[{:.17g}, {:.17g}{}]", g * std::sin(a), -g * std::cos(a), space ? ", 0" : "");
      const std::string room = floor_room(space, collision, 60, gravity);
      const TextRun lies(room + slab(space, ""));
      EXPECT_NEAR(lies.place(3).x(), 8, kToRounding) << space << collision;
      EXPECT_TRUE(lies.at(3).bodies[0].at_rest) << space << collision;
      const TextRun slides(room + slab(space, fmt::format("velocity = [0.5, 0{}]", space ? ", 0" : "")));
      const double way = 0.5 * 3 + g * (std::sin(a) - 0.3 * std::cos(a)) * 9 / 2;
      EXPECT_NEAR(slides.place(3).x(), 8 + way, kToRounding) << space << collision;
    }
  }
}

// A block on a belt, held by a spring, moves by jerks. It sticks until the spring bears mu_s m g, x_s from
// where it is slack, and then swings about x_k = mu m g / k:
//   x = x_k + (x_s - x_k) cos w t + V/w sin w t
// until it has the belt's speed V again, 2 (pi - atan(w (x_s - x_k) / V)) / w later, at 2 x_k - x_s.
TEST(StaticFriction, MakesABlockOnABeltStickAndSlip) {
  const double k = 20, V = 0.2, g = 10, w = std::sqrt(k), x_s = 0.5 * g / k, x_k = 0.3 * g / k;
  const double slip = 2 * (std::acos(-1.0) - std::atan(w * (x_s - x_k) / V)) / w, stick = 2 * (x_s - x_k) / V;
  const auto way = [&](double t) {
    t -= x_s / V;
    if (t < 0) return x_s + V * t;
    t = std::fmod(t, slip + stick);
    return t < slip ? x_k + (x_s - x_k) * std::cos(w * t) + V / w * std::sin(w * t)
                    : 2 * x_k - x_s + V * (t - slip);
  };
  const std::string bodies =
      "[[box]]\nname = \"belt\"\nsize = [20, 1]\nposition = [10, 0.5]\nfixed = true\nsurface_speed = 0.2\n"
      "friction = 0.3\nstatic_friction = 0.5\nelasticity = 0\n"
      "[[box]]\nname = \"b\"\nsize = [0.4, 0.2]\nposition = [5, 1.1]\nvelocity = [0.2, 0]\nmass = 1\n"
      "friction = 0.3\nstatic_friction = 0.5\nelasticity = 0\n"
      "[[spring]]\nbetween = [\"b\", [3, 1.1]]\nstiffness = 20\nrest_length = 2\n";
  for (const int rate : {60, 600}) {
    const TextRun run(floor_room(false, "event", rate, "[0, -10]") + bodies);
    for (double t = 0.5; t < 9; t += 0.5)
      EXPECT_NEAR(run.place(t, number_of(run, "b")).x(), 5 + way(t), rate == 60 ? 1e-6 : kLate) << rate << t;
  }
}

TEST(StaticFriction, IsRefusedWhereItCannotBe) {
  const auto says = [](const std::string& text, const std::string& what) {
    EXPECT_NE(refusal(text).find(what), std::string::npos) << refusal(text);
  };
  says(slab(false, "") + "[physics]\nsolver = \"iterative\"\n", "a.toml:11:10: 'static_friction' is for the");
  says(slab(false, "") + "[physics]\ncollision = \"handout\"\n", "has no friction");
  says("[[ball]]\nradius = 1\nfriction = 0.5\nstatic_friction = 0.4\n",
       "a.toml:4:19: 'static_friction' is that of what does not slip: at least 'friction', 0.5 here");
  says("[room]\nsize = [4, 4]\nstatic_friction = 0.4\n", "needs 'friction'");
  says("[[ball]]\nradius = 1\nmu_s = 0.4\n",
       "a.toml:3:1: unknown key 'mu_s' in [[ball]]; it is 'static_friction' here");
}

}  // namespace
}  // namespace obscura::scene
