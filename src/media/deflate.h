#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace obscura::media {

/// A zlib stream (RFC 1950) of the rows of a drawn picture: the same bytes give the same stream. A row has
/// `row` bytes, the first of which is its filter's, then pixels of `pixel` bytes; any bytes may be said to be
/// so, and are only deflated worse. Requires at most 2 GiB.
std::vector<std::uint8_t> deflated(std::span<const std::uint8_t> bytes, std::size_t row, std::size_t pixel);

}  // namespace obscura::media
