// Any words as the state of a run, in scenes of both dimensions with contacts, joints, hands, bonds and
// chains: they are refused, or the run goes on for three steps to some end.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "scene/scene.h"
#include "sim/run.h"

namespace obscura {
namespace {

constexpr const char* kPlane = R"(
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
[[mouse]]
path = [[0, 1, 1], [3, 2, 1]]
stiffness = 10
)";

constexpr const char* kSpace = R"(
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
between = ["a", "b"]
strength = 100
[[explosion]]
center = [0, 0, 0]
strength = 1
)";

const scene::Scene& scene_of(bool space) {
  static const scene::Scene plane = scene::parse(kPlane, "plane.toml"),
                            solid = scene::parse(kSpace, "space.toml");
  return space ? solid : plane;
}

// a state to begin with, so that what is mutated is nearly one
const std::vector<std::uint64_t>& good(bool space) {
  const auto made = [](bool in_space) {
    const auto run = scene_of(in_space).run();
    run->at({1, 20});
    return run->saved();
  };
  static const std::vector<std::uint64_t> plane = made(false), solid = made(true);
  return space ? solid : plane;
}

}  // namespace
}  // namespace obscura

// The first byte: which scene, and whether the bytes are all of the state or are laid over a good one: a
// place of two bytes, then a word of eight.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace obscura;
  if (size < 1) return 0;
  const bool space = bytes[0] & 1, over = bytes[0] & 2;
  std::vector<std::uint64_t> words = over ? good(space) : std::vector<std::uint64_t>((size - 1) / 8);
  if (!over) {
    if (!words.empty()) std::memcpy(words.data(), bytes + 1, 8 * words.size());
  } else {
    for (std::size_t at = 1; at + 10 <= size; at += 10) {
      const std::size_t place = bytes[at] | std::size_t(bytes[at + 1]) << 8;
      std::memcpy(&words[place % words.size()], bytes + at + 2, 8);
    }
  }
  if (words.empty()) return 0;
  const scene::Scene& scene = scene_of(space);
  const auto run = scene.run(words);
  if (!run) return 0;
  const sim::Rational now = run->now();
  if (now.num > 1'000'000 * now.den) return 0;
  run->at(now + sim::Rational{3, 600});
  run->at(now + sim::Rational{7, 1200});
  return 0;
}
