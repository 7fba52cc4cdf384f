// Scenes whose limit of standing is known.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <variant>

#include "scene/scene.h"

namespace obscura::scene {
namespace {

// half a ring of stones of mean radius 1 and this thickness, joints along its radii, on the ground; in space
// as wide as it is thick
Scene arch(int stones, double thickness, bool space = false) {
  std::string text = "duration = 2\n[room]\n";
  text += space ? "size = [8, 4, 4]\n" : "size = [8, 4]\n";
  for (int i = 0; i < stones; ++i) {
    std::string points;
    for (const auto& [side, joint] : {std::pair{-1, 0}, {1, 0}, {1, 1}, {-1, 1}}) {
      const double angle = std::numbers::pi * (i + joint) / stones, r = 1 + side * thickness / 2;
      const std::string place = fmt::format("[{}, {}", r * std::cos(angle), r * std::sin(angle));
      points +=
          space ? fmt::format("{0}, {1}], {0}, {2}], ", place, -thickness / 2, thickness / 2) : place + "], ";
    }
    text += fmt::format("[[{}]]\npoints = [{}]\nposition = {}\nfriction = 2\nelasticity = 0\n",
                        space ? "hull" : "polygon", points, space ? "[0, 0, 0]" : "[4, 0]");
  }
  return parse(text, "arch.toml", {});
}

// how far the farthest stone has come in two seconds, m
double moved(const Scene& scene) {
  const auto run = scene.run();
  const auto begin = std::get<sim::Snapshot>(run->at({0, 1})), end = std::get<sim::Snapshot>(run->at({2, 1}));
  double most = 0;
  for (std::size_t i = 0; i < begin.bodies.size(); ++i)
    most = std::max(most, (end.bodies[i].position - begin.bodies[i].position).norm());
  return most;
}

// Milankovitch 1907: 0.1075 of the mean radius. Hinges are at joints alone, so that few stones stand a little
// below it: 16 to 0.1071.
TEST(Statics, ASemicircularArchStandsFromMilankovitchsThicknessOn) {
  for (const int stones : {16, 24, 40}) {
    EXPECT_EQ(moved(arch(stones, 0.1076)), 0) << stones;
    EXPECT_GT(moved(arch(stones, 0.1065)), 0.1) << stones;
  }
}

TEST(Statics, SoItDoesInSpace) {
  EXPECT_EQ(moved(arch(16, 0.1076, true)), 0);
  EXPECT_GT(moved(arch(16, 0.1065, true)), 0.1);
}

// The k-th block from the top reaches 1/(2k) of its length beyond what is below it, at most.
TEST(Statics, BlocksHangOverATableByTheHarmonicSeries) {
  for (const int blocks : {4, 10, 30}) {
    for (const double share : {0.999, 1.001}) {
      std::string text =
          "duration = 2\n[room]\nsize = [10, 9]\n[[box]]\nsize = [2, 1]\nposition = [3, 0.5]\nfixed = true\n";
      double end = 4;
      for (int i = 0; i < blocks; ++i) {
        end += share / (2 * (blocks - i));
        text += fmt::format("[[box]]\nsize = [1, 0.2]\nposition = [{}, {}]\nelasticity = 0\n", end - 0.5,
                            1.1 + 0.2 * i);
      }
      const double far = moved(parse(text, "hang.toml", {}));
      if (share < 1) {
        EXPECT_EQ(far, 0) << blocks;
      } else {
        EXPECT_GT(far, 0.1) << blocks;
      }
    }
  }
}

}  // namespace
}  // namespace obscura::scene
