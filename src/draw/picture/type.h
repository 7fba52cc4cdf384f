#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "draw/picture/list.h"

namespace obscura::draw {

/// A glyph of a face's font file, and where its origin goes from the line's start (page units, y down).
struct Glyph {
  std::uint32_t index = 0;
  Point at;
};

/// A span of type, shaped: kerned, with equal-width figures where asked.
struct Shaped {
  Face face = Face::regular;
  double size = 0;  // em, page units
  Color color;
  std::vector<Glyph> glyphs;
};

/// A line of type with its glyphs placed from (0, 0) on the baseline, and its width in page units.
struct Line {
  std::vector<Shaped> spans;
  double width = 0;
};

/// Shapes a line by its fonts' own metrics, unhinted, so that it scales. Throws draw::Error where a font is
/// missing.
Line shape(const Text& text);

/// Sets the decimal mark of all numbers in mathematics and of figures of equal width.
void set_decimal_mark(List& list, const std::string& mark);

/// The file of a face: Inter, or the family in $OBSCURA_FONT, for words, STIX for mathematics. Looked for in
/// $OBSCURA_FONTS and the system's font folders. Throws draw::Error naming the package.
const std::string& font_file(Face face);

}  // namespace obscura::draw
