#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace obscura::page {

/// A PDF of Cairo whose one structure element /Figure says `text` instead of the picture, in English, with
/// the title in the window's bar where it has one. Throws page::Error where the file is laid out otherwise
/// than by Cairo at version 1.4 of the format.
std::vector<std::uint8_t> described(std::vector<std::uint8_t> pdf, const std::string& text, bool titled);

}  // namespace obscura::page
