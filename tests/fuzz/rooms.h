#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "sim/step/run.h"

namespace obscura::fuzz {

/// Ends the target: libFuzzer keeps the bytes.
[[noreturn]] inline void fail(const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  std::abort();
}

// Rooms of both dimensions, with contacts, joints, hands, a chain, bonds and explosions.

inline constexpr const char* kPlane = R"(
[room]
size = [4, 3]
[[box]]
name = "a"
size = [0.5, 0.5]
position = [1, 0.25]
[[ball]]
name = "b"
radius = 0.2
position = [1, 0.7]
[[particle]]
position = [2, 1]
[[spring]]
between = ["b", [1, 2]]
stiffness = 20
[[joint]]
type = "rope"
between = ["a", "b"]
[[box]]
name = "c"
size = [0.1, 0.4]
position = [3, 2]
[[box]]
name = "d"
size = [0.1, 0.4]
position = [3, 1.6]
[[joint]]
type = "pin"
between = ["c", [3, 2.2]]
[[joint]]
type = "pin"
between = ["c", "d"]
at = [3, 1.8]
[[chain]]
of = ["c", "d"]
[[mouse]]
path = [[0, 1, 1], [3, 2, 1]]
stiffness = 10
)";

inline constexpr const char* kSpace = R"(
[room]
size = [4, 3, 4]
[[box]]
name = "a"
size = [0.5, 0.5, 0.5]
position = [0, 0.25, 0]
[[box]]
name = "b"
size = [0.5, 0.5, 0.5]
position = [0, 0.75, 0]
[[ball]]
radius = 0.2
position = [1, 0.2, 0]
[[bond]]
of = ["a", "b"]
breaks = 100
[[explosion]]
center = [0, 0, 0]
strength = 1
)";

inline const scene::Scene& scene_of(bool space) {
  static const scene::Scene plane = scene::parse(kPlane, "plane.toml"),
                            solid = scene::parse(kSpace, "space.toml");
  return space ? solid : plane;
}

/// A state of it to begin with, so that what is mutated is nearly one.
inline const std::vector<std::uint64_t>& good(bool space) {
  const auto made = [](bool in_space) {
    const auto run = scene_of(in_space).run();
    run->at({1, 20});
    return run->saved();
  };
  static const std::vector<std::uint64_t> plane = made(false), solid = made(true);
  return space ? solid : plane;
}

/// Goes on for three steps, to some end. False: it stands too late for its times to be added to.
inline bool goes_on(sim::Run& run) {
  const sim::Rational now = run.now(), step = sim::rational(1) / run.rate();
  if (now.num > 1'000'000 * now.den) return false;
  run.at(now + step * sim::rational(5, 2));
  run.at(now + step * sim::rational(3));
  return true;
}

}  // namespace obscura::fuzz
