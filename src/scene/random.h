#pragma once

#include <cstdint>

namespace obscura::scene {

// SplitMix64 (Steele, Lea and Flood 2014) used as a hash: a number for each (seed, stream, index), whatever
// else the scene has.
//   z = x + golden;  z = (z ^ z >> 30) a;  z = (z ^ z >> 27) b;  z ^ z >> 31

/// The next of SplitMix64 after x.
constexpr std::uint64_t splitmix(std::uint64_t x) {
  std::uint64_t z = x + 0x9E3779B97F4A7C15ull;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

/// Even over [-1, 1), the same bits everywhere.
constexpr double even(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  const std::uint64_t bits = splitmix(splitmix(splitmix(seed) ^ stream) ^ index);
  return double(bits >> 11) * 0x1p-52 - 1.0;
}

}  // namespace obscura::scene
