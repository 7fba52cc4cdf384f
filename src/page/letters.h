#pragma once

#include <cstdint>
#include <string>

#include "draw/picture/list.h"

namespace obscura::page {

/// The outline of a glyph as the d of an SVG path, in thousandths of an em, y down from the baseline. Throws
/// page::Error.
std::string glyph_outline(draw::Face face, std::uint32_t index);

}  // namespace obscura::page
