#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "draw/picture/faces.h"
#include "draw/picture/type.h"
#include "gl/functions.h"

namespace obscura::gl {

/// The place of a glyph's picture in the atlas, and its offset from the pen's whole pixel.
struct GlyphPicture {
  int left = 0, top = 0;  // px, from the pen to its first column and row, y down
  int width = 0, height = 0;
  int u = 0, v = 0;  // texels
};

/// Glyphs as coverage, drawn by FreeType at the size and the quarter of a pixel where they are wanted,
/// unhinted.
class Glyphs {
 public:
  explicit Glyphs(const Functions& gl);
  ~Glyphs();
  Glyphs(const Glyphs&) = delete;
  Glyphs& operator=(const Glyphs&) = delete;

  static constexpr int kQuarters = 4;

  /// `size` em in px, `quarter` of a pixel to the right. Throws draw::Error where the font cannot be read,
  /// gl::Error where the glyphs outgrow a texture.
  const GlyphPicture& picture(draw::Face face, std::uint32_t index, double size, int quarter);

  /// Uploads what is new and binds the atlas to texture unit 0.
  void bind();

 private:
  GlyphPicture draw(draw::Face face, std::uint32_t index, int size_26_6, int quarter);
  GlyphPicture place(int width, int height);

  const Functions& gl_;
  std::unique_ptr<draw::OpenFaces> faces_;
  std::unordered_map<std::uint64_t, GlyphPicture> pictures_;
  // rows of glyphs, each as tall as its tallest
  std::vector<std::uint8_t> texels_;
  int height_ = 0, largest_ = 0;
  int row_x_ = 0, row_y_ = 0, row_height_ = 0;
  GLuint texture_ = 0;
  int new_from_ = 0, new_to_ = 0, uploaded_height_ = 0;  // rows of texels
};

}  // namespace obscura::gl
