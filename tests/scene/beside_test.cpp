// No body is braked by what happens elsewhere: what slides, rolls and bounces beside a heap, or on one, moves
// as it does alone.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "text_run.h"

namespace obscura::scene {
namespace {

// what is named "it", after a second
sim::Snapshot::Body run(const std::string& text, int rate) {
  const TextRun run(text, {fmt::format("physics.rate={}", rate)});
  return run.at(1).bodies.at(number_of(run, "it"));
}

std::string vector(bool space, double x, double y) {
  return space ? fmt::format("[{}, {}, 0]", x, y) : fmt::format("[{}, {}]", x, y);
}

// what moves at x, on a floor at height y
std::string mover(bool space, const std::string& kind, double x, double y) {
  const std::string size = space ? "[0.4, 0.4, 0.4]" : "[0.4, 0.4]";
  if (kind == "slides")
    return fmt::format(
        "[[box]]\nname = \"it\"\nsize = {}\nmass = 2\nfriction = 0.3\nelasticity = 0\n"
        "position = {}\nvelocity = {}\n",
        size, vector(space, x, y + 0.2), vector(space, 2, 0));
  return fmt::format(
      "[[ball]]\nname = \"it\"\nradius = 0.2\nmass = 2\nfriction = 0.5\nelasticity = {}\n"
      "position = {}\nvelocity = {}\nspin = {}\n",
      kind == "rolls" ? 0 : 1, vector(space, x, y + (kind == "rolls" ? 0.2 : 1.2)), vector(space, 2, 0),
      space ? "[0, 0, -572.957795130823]" : "-572.957795130823");
}

class Beside : public testing::TestWithParam<std::tuple<bool, std::string, int>> {};

// a heap that falls and settles ten metres away
TEST_P(Beside, AHeapAllMovesAsAlone) {
  const auto [space, kind, rate] = GetParam();
  const std::string room =
      fmt::format("seed = 5\n[room]\nsize = {}\n[physics]\nsolver = \"iterative\"\n{}",
                  space ? "[40, 8, 10]" : "[40, 8]", mover(space, kind, space ? -15 : 2, 0));
  const std::string heap = fmt::format(
      "[[box]]\nname = \"heap\"\nsize = {}\nfriction = 0.5\nelasticity = 0.1\nposition = {}\n"
      "copies = {{ {}, jitter = 0.01 }}\n",
      space ? "[0.2, 0.2, 0.2]" : "[0.2, 0.2]", space ? "[8, 0.3, -1]" : "[25, 0.3]",
      space ? "count = [4, 4, 4], offset = [[0.25, 0, 0], [0.02, 0.25, 0], [0, 0, 0.25]]"
            : "count = [10, 8], offset = [[0.25, 0], [0.02, 0.25]]");
  const sim::Snapshot::Body alone = run(room, rate), beside = run(room + heap, rate);
  EXPECT_NEAR(beside.position[0], alone.position[0], 1e-9);
  EXPECT_NEAR(beside.position[1], alone.position[1], 1e-9);
  EXPECT_NEAR(beside.velocity[0], alone.velocity[0], 1e-9);
}

INSTANTIATE_TEST_SUITE_P(, Beside,
                         testing::Combine(testing::Bool(), testing::Values("slides", "rolls", "bounces"),
                                          testing::Values(60, 600)));

class On : public testing::TestWithParam<std::tuple<bool, std::string, int>> {};

// a plank on blocks that rest on each other
TEST_P(On, AHeapAllMovesAsOnTheFloor) {
  const auto [space, kind, rate] = GetParam();
  const std::string room =
      fmt::format("[room]\nsize = {}\n[physics]\nsolver = \"iterative\"\n", space ? "[14, 8, 6]" : "[14, 8]");
  const double left = space ? -7 : 0;
  const std::string size = space ? "0.4, 0.4, 0.4" : "0.4, 0.4";
  const std::string heap = fmt::format(
      "[[box]]\nsize = [{}]\nmass = 60\nfriction = 0.9\nelasticity = 0\nposition = {}\n"
      "copies = {{ count = [8, 2], offset = [{}, {}] }}\n"
      "[[box]]\nsize = [{}]\nmass = 200\nfriction = 0.3\nelasticity = 0\nposition = {}\n",
      size, vector(space, left + 2, 0.2), vector(space, 1.3, 0), vector(space, 0, 0.4),
      space ? "11, 0.2, 0.4" : "11, 0.2", vector(space, left + 6.8, 0.9));
  const sim::Snapshot::Body floor = run(room + mover(space, kind, left + 2.5, 0), rate);
  const sim::Snapshot::Body heaped = run(room + heap + mover(space, kind, left + 2.5, 1), rate);
  EXPECT_NEAR(heaped.velocity[0], floor.velocity[0], 1e-5);
  EXPECT_NEAR(heaped.position[0], floor.position[0], 1e-5);
  EXPECT_NEAR(heaped.position[1], floor.position[1] + 1, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(, On,
                         testing::Combine(testing::Bool(), testing::Values("slides", "rolls"),
                                          testing::Values(60, 600)));

}  // namespace
}  // namespace obscura::scene
