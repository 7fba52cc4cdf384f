#include "page/fonts.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_TRUETYPE_TABLES_H

#include <hb-subset.h>
#include <hb.h>

#include <array>
#include <memory>

#include "draw/picture/type.h"
#include "page/error.h"

namespace obscura::page {
namespace {

FaceName read_name(draw::Face which) {
  const draw::FontFile& file = draw::font_file(which);
  FT_Library library = nullptr;
  if (FT_Init_FreeType(&library)) throw Error("FreeType cannot be started");
  const std::unique_ptr<FT_LibraryRec_, decltype(&FT_Done_FreeType)> closed(library, FT_Done_FreeType);
  FT_Face face = nullptr;
  if (FT_New_Face(library, file.path.c_str(), file.index, &face))
    throw Error(file.path + ": FreeType cannot read it");
  FaceName name{face->family_name ? face->family_name : "", 400,
                (face->style_flags & FT_STYLE_FLAG_ITALIC) != 0};
  if (const auto* os2 = static_cast<TT_OS2*>(FT_Get_Sfnt_Table(face, FT_SFNT_OS2)))
    name.weight = int(os2->usWeightClass);
  return name;
}

template <class T>
using Held = std::unique_ptr<T, void (*)(T*)>;

}  // namespace

const FaceName& face_name(draw::Face face) {
  static std::array<std::unique_ptr<FaceName>, 6> known;  // of one thread: pages are written by one
  auto& name = known[std::size_t(face)];
  if (!name) name = std::make_unique<FaceName>(read_name(face));
  return *name;
}

std::vector<std::uint8_t> subset(draw::Face face, const std::set<std::uint32_t>& characters) {
  const draw::FontFile& font = draw::font_file(face);
  const Held<hb_blob_t> file(hb_blob_create_from_file(font.path.c_str()), hb_blob_destroy);
  const Held<hb_face_t> whole(hb_face_create(file.get(), unsigned(font.index)), hb_face_destroy);
  const Held<hb_subset_input_t> wanted(hb_subset_input_create_or_fail(), hb_subset_input_destroy);
  if (!wanted) throw Error("HarfBuzz cannot make a font smaller: out of memory");
  for (const std::uint32_t c : characters) hb_set_add(hb_subset_input_unicode_set(wanted.get()), c);
  const Held<hb_face_t> smaller(hb_subset_or_fail(whole.get(), wanted.get()), hb_face_destroy);
  if (!smaller) return {};
  const Held<hb_blob_t> bytes(hb_face_reference_blob(smaller.get()), hb_blob_destroy);
  unsigned size = 0;
  const char* data = hb_blob_get_data(bytes.get(), &size);
  return {data, data + size};
}

}  // namespace obscura::page
