#include "page/letters.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include <fmt/format.h>

#include "draw/picture/faces.h"
#include "draw/picture/type.h"
#include "page/error.h"

namespace obscura::page {
namespace {

// a path that is being written
struct GlyphPath {
  std::string d;
  double scale = 1;  // thousandths a font unit

  std::string at(const FT_Vector* p) const {
    return fmt::format("{:.6g} {:.6g}", scale * double(p->x), -scale * double(p->y));
  }
};

}  // namespace

std::string glyph_outline(draw::Face which, std::uint32_t index) {
  static draw::OpenFaces open;  // of one thread: pages are written by one
  const FT_Face face = open.open(which);
  if (FT_Load_Glyph(face, index, FT_LOAD_NO_SCALE | FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP))
    throw Error(draw::font_file(which).path + ": FreeType cannot load glyph " + std::to_string(index));
  GlyphPath path;
  path.scale = 1000.0 / face->units_per_EM;
  FT_Outline_Funcs into{};
  into.move_to = [](const FT_Vector* p, void* to) {
    auto& its = *static_cast<GlyphPath*>(to);
    its.d += (its.d.empty() ? "M" : "ZM") + its.at(p);
    return 0;
  };
  into.line_to = [](const FT_Vector* p, void* to) {
    auto& its = *static_cast<GlyphPath*>(to);
    its.d += "L" + its.at(p);
    return 0;
  };
  into.conic_to = [](const FT_Vector* a, const FT_Vector* p, void* to) {
    auto& its = *static_cast<GlyphPath*>(to);
    its.d += "Q" + its.at(a) + " " + its.at(p);
    return 0;
  };
  into.cubic_to = [](const FT_Vector* a, const FT_Vector* b, const FT_Vector* p, void* to) {
    auto& its = *static_cast<GlyphPath*>(to);
    its.d += "C" + its.at(a) + " " + its.at(b) + " " + its.at(p);
    return 0;
  };
  FT_Outline_Decompose(&face->glyph->outline, &into, &path);
  return path.d.empty() ? path.d : path.d + "Z";
}

}  // namespace obscura::page
