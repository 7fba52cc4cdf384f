#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace obscura::media {

/// At most `most` colours (0xRRGGBB, ascending) for the given ones with their counts. If they fit, they are
/// taken as they are; else half of the palette goes to the most frequent, which so stay exact, and the rest
/// to the means of boxes cut at the median.
std::vector<std::uint32_t> palette(std::vector<std::pair<std::uint32_t, std::uint32_t>> counted,
                                   std::size_t most);

/// The index of the colour nearest to `colour`.
std::size_t nearest(const std::vector<std::uint32_t>& palette, std::uint32_t colour);

}  // namespace obscura::media
