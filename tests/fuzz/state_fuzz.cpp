// Any words as the state of a run, in scenes of both dimensions with contacts, joints, hands, bonds and
// chains: they are refused, or the run goes on for three steps to some end.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "../fuzz/rooms.h"

// The first byte: which scene, and whether the bytes are all of the state or are laid over a good one: a
// place of two bytes, then a word of eight.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace obscura;
  if (size < 1) return 0;
  const bool space = bytes[0] & 1, over = bytes[0] & 2;
  std::vector<std::uint64_t> words = over ? fuzz::good(space) : std::vector<std::uint64_t>((size - 1) / 8);
  if (!over) {
    if (!words.empty()) std::memcpy(words.data(), bytes + 1, 8 * words.size());
  } else {
    for (std::size_t at = 1; at + 10 <= size; at += 10) {
      const std::size_t place = bytes[at] | std::size_t(bytes[at + 1]) << 8;
      std::memcpy(&words[place % words.size()], bytes + at + 2, 8);
    }
  }
  if (words.empty()) return 0;
  if (const auto run = fuzz::scene_of(space).run(words)) fuzz::goes_on(*run);
  return 0;
}
