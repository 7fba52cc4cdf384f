#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace obscura::page {

/// SHA-256 of some bytes, as a page's content security policy names the styles and scripts that may run.
/// Source: FIPS 180-4, §6.2.
std::array<std::uint8_t, 32> sha256(std::string_view bytes);

}  // namespace obscura::page
