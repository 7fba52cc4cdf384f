#pragma once

#include <cstdint>
#include <string>
#include <utility>
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
  std::string drawn{};  // the span's text with boxes for letters that the font lacks, where it lacks any
};

/// A line of type with its glyphs placed from (0, 0) on the baseline, and its width in page units.
struct Line {
  std::vector<Shaped> spans;
  double width = 0;
};

/// Shapes a line by its fonts' own metrics, unhinted, so that it scales. Throws draw::Error where a font is
/// missing.
Line shape(const Text& text);

/// How far the ink of a line reaches above its baseline and below it, page units; both may be negative.
std::pair<double, double> ink_of(const Text& text);

/// The same line with signs that the font of a span lacks in spans of another face that has them: words and
/// mathematics help each other out. Throws draw::Error where a font is missing.
Text with_all_signs(const Text& text);

/// The letters that words had so far, of any thread, and no face has, each once and in the order in which
/// they were met: boxes are drawn in their places.
std::vector<std::string> letters_without_glyph();

/// Words with another decimal mark (UTF-8) between the digits of their numbers.
std::string with_decimal_mark(std::string words, const std::string& mark);
/// Sets the decimal mark of all numbers in mathematics and of figures of equal width.
void set_decimal_mark(List& list, const std::string& mark);

/// A font in a file, which may hold several.
struct FontFile {
  std::string path;
  int index = 0;
  bool alphabets =
      false;  // letters of mathematics are characters of their own, as in fonts with a MATH table
};

/// The font of a face: Inter, or the family in $OBSCURA_FONT, for words; for mathematics STIX, or that family
/// where it has a MATH table. Looked for in $OBSCURA_FONTS and the system's font folders, a family by
/// fontconfig too. Throws draw::Error naming the package.
const FontFile& font_file(Face face);

/// A span's text in the characters of its face's font.
std::string characters_of(const Span& span);

}  // namespace obscura::draw
