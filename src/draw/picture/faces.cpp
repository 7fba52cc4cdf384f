#include "draw/picture/faces.h"

#include <ft2build.h>
#include FT_FREETYPE_H

#include "draw/picture/error.h"
#include "draw/picture/type.h"

namespace obscura::draw {

OpenFaces::OpenFaces() {
  if (FT_Init_FreeType(&library_)) throw Error("FreeType cannot be started");
}
OpenFaces::~OpenFaces() { FT_Done_FreeType(library_); }  // and its faces

FT_FaceRec_* OpenFaces::open(Face face) {
  FT_Face& found = faces_[std::size_t(face)];
  const FontFile& file = font_file(face);
  if (!found && FT_New_Face(library_, file.path.c_str(), file.index, &found))
    throw Error(file.path + ": FreeType cannot read it");
  return found;
}

}  // namespace obscura::draw
