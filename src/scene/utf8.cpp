#include "scene/utf8.h"

#include <algorithm>

namespace obscura::scene {

namespace {

constexpr std::size_t kLongestName = 100;  // bytes: file systems take 255, endings and .partial included

// the number of a code point of 1 to 4 bytes
unsigned number(std::string_view point) {
  unsigned n = static_cast<unsigned char>(point[0]);
  if (point.size() > 1) n &= 0x7Fu >> point.size();
  for (std::size_t i = 1; i < point.size(); ++i) n = n << 6 | (static_cast<unsigned char>(point[i]) & 0x3Fu);
  return n;
}

}  // namespace

std::size_t code_point(std::string_view text) {
  if (text.empty()) return 0;
  const auto at = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const auto tail = [&](std::size_t i) { return (at(i) & 0xC0u) == 0x80u; };
  const unsigned c = at(0);
  if (c < 0x80) return 1;
  if (c >= 0xC2 && c <= 0xDF) return tail(1) ? 2 : 0;
  if (c >= 0xE0 && c <= 0xEF) {
    if (!tail(1) || !tail(2)) return 0;
    const unsigned point = number(text.substr(0, 3));
    return point >= 0x800 && (point < 0xD800 || point > 0xDFFF) ? 3 : 0;
  }
  if (c >= 0xF0 && c <= 0xF4) {
    if (!tail(1) || !tail(2) || !tail(3)) return 0;
    const unsigned point = number(text.substr(0, 4));
    return point >= 0x10000 && point <= 0x10FFFF ? 4 : 0;
  }
  return 0;
}

bool is_control(std::string_view point) {
  const unsigned n = number(point);
  return n < 0x20 || (n >= 0x7F && n < 0xA0) || (n >= 0x200E && n <= 0x200F) ||
         (n >= 0x2028 && n <= 0x202E) || (n >= 0x2066 && n <= 0x2069);
}

bool is_path_name(std::string_view name) {
  if (name.empty() || name.size() > kLongestName) return false;
  if (std::string_view(".- ").find(name.front()) != name.npos) return false;
  if (std::string_view(". ").find(name.back()) != name.npos) return false;
  if (name.find_first_of("/\\:*?\"<>|%{}") != name.npos) return false;
  for (std::size_t i = 0; i < name.size();) {
    const std::size_t bytes = code_point(name.substr(i));
    if (bytes == 0 || is_control(name.substr(i, bytes))) return false;
    i += bytes;
  }
  return true;
}

}  // namespace obscura::scene
