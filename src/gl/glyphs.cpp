#include "gl/glyphs.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include <algorithm>
#include <cmath>

#include "gl/error.h"

namespace obscura::gl {
namespace {

constexpr int kWidth = 1024;  // of the atlas
constexpr int kFirstHeight = 256;

}  // namespace

Glyphs::Glyphs(const Functions& gl)
    : gl_(gl), faces_(std::make_unique<draw::OpenFaces>()), largest_(gl.integer(GL_MAX_TEXTURE_SIZE)) {
  gl.GenTextures(1, &texture_);
  gl.BindTexture(GL_TEXTURE_2D, texture_);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
}

Glyphs::~Glyphs() { gl_.DeleteTextures(1, &texture_); }

const GlyphPicture& Glyphs::picture(draw::Face face, std::uint32_t index, double size, int quarter) {
  const int size_26_6 = int(std::lround(size * 64));
  const std::uint64_t key = std::uint64_t(index) | std::uint64_t(size_26_6 & 0xffffff) << 32 |
                            std::uint64_t(quarter) << 56 | std::uint64_t(face) << 58;
  const auto found = pictures_.find(key);
  if (found != pictures_.end()) return found->second;
  return pictures_.emplace(key, draw(face, index, size_26_6, quarter)).first->second;
}

GlyphPicture Glyphs::draw(draw::Face which, std::uint32_t index, int size_26_6, int quarter) {
  if (size_26_6 < 1) return {};
  const FT_Face face = faces_->open(which);
  if (FT_Set_Char_Size(face, size_26_6, size_26_6, 72, 72) ||
      FT_Load_Glyph(face, index, FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP)) {
    throw Error(draw::font_file(which).path + ": FreeType cannot load glyph " + std::to_string(index));
  }
  const FT_GlyphSlot slot = face->glyph;
  FT_Outline_Translate(&slot->outline, quarter * 64 / kQuarters, 0);
  if (FT_Render_Glyph(slot, FT_RENDER_MODE_NORMAL)) {
    throw Error(draw::font_file(which).path + ": FreeType cannot draw glyph " + std::to_string(index));
  }

  const FT_Bitmap& bitmap = slot->bitmap;
  GlyphPicture picture = place(int(bitmap.width), int(bitmap.rows));
  picture.left = slot->bitmap_left;
  picture.top = -slot->bitmap_top;
  for (int y = 0; y < picture.height; ++y) {
    const unsigned char* from = bitmap.buffer + std::ptrdiff_t(y) * bitmap.pitch;
    std::copy_n(from, picture.width, texels_.begin() + std::ptrdiff_t(kWidth) * (picture.v + y) + picture.u);
  }
  return picture;
}

GlyphPicture Glyphs::place(int width, int height) {
  if (width == 0 || height == 0) return {};
  if (width > kWidth) throw Error("a glyph is wider than " + std::to_string(kWidth) + " px");
  if (row_x_ + width > kWidth) {
    row_y_ += row_height_;
    row_x_ = row_height_ = 0;
  }
  row_height_ = std::max(row_height_, height);
  while (row_y_ + row_height_ > height_) height_ = std::max(kFirstHeight, 2 * height_);
  if (height_ > largest_) throw Error("the glyphs outgrow a texture of " + std::to_string(largest_) + " px");
  texels_.resize(std::size_t(kWidth) * height_);

  GlyphPicture picture;
  picture.width = width;
  picture.height = height;
  picture.u = row_x_;
  picture.v = row_y_;
  row_x_ += width;
  new_from_ = new_from_ == new_to_ ? row_y_ : std::min(new_from_, row_y_);
  new_to_ = std::max(new_to_, row_y_ + height);
  return picture;
}

void Glyphs::bind() {
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, texture_);
  if (new_from_ == new_to_) return;
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (uploaded_height_ != height_) {
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_R8, kWidth, height_, 0, GL_RED, GL_UNSIGNED_BYTE, texels_.data());
    uploaded_height_ = height_;
  } else {
    gl_.TexSubImage2D(GL_TEXTURE_2D, 0, 0, new_from_, kWidth, new_to_ - new_from_, GL_RED, GL_UNSIGNED_BYTE,
                      texels_.data() + std::ptrdiff_t(kWidth) * new_from_);
  }
  new_from_ = new_to_ = 0;
}

}  // namespace obscura::gl
