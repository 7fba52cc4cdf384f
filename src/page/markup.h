#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace obscura::page {

/// Text for an element or an attribute in double quotes, of XML and of HTML. Control characters, which XML
/// does not have, become spaces; ends of lines and tabs stay.
std::string escaped(std::string_view text);

/// Bytes as a data: URL has them. RFC 4648 §4, padded.
std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace obscura::page
