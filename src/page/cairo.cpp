// PDF by Cairo: type as glyphs of the fonts that come along in the file, with the text they stand for. A page
// that is described is one figure, with alternative text (page/described.h).
#ifdef OBSCURA_CAIRO

#include <cairo-ft.h>
#include <cairo-pdf.h>
#include <cairo.h>

#include <array>
#include <cmath>
#include <new>
#include <numbers>

#include "page/described.h"
#include "page/error.h"
#include "page/pen.h"

namespace obscura::page {
namespace {

/// A face with the library that it lives in: Cairo may keep it longer than the page.
struct Type {
  FT_Library library = nullptr;
  FT_Face face = nullptr;
  ~Type() {
    if (face) FT_Done_Face(face);
    if (library) FT_Done_FreeType(library);
  }
};

cairo_font_face_t* open(draw::Face which) {
  static const cairo_user_data_key_t key{};
  const draw::FontFile& file = draw::font_file(which);
  auto type = std::make_unique<Type>();
  if (FT_Init_FreeType(&type->library) ||
      FT_New_Face(type->library, file.path.c_str(), file.index, &type->face))
    throw Error(file.path + ": FreeType cannot read it");
  cairo_font_face_t* face =
      cairo_ft_font_face_create_for_ft_face(type->face, FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP);
  const auto drop = [](void* held) { delete static_cast<Type*>(held); };
  if (cairo_font_face_set_user_data(face, &key, type.get(), drop) == CAIRO_STATUS_SUCCESS)
    (void)type.release();
  return face;
}

// no exception may cross Cairo
cairo_status_t take(void* bytes, const unsigned char* data, unsigned length) noexcept {
  try {
    auto& out = *static_cast<std::vector<std::uint8_t>*>(bytes);
    out.insert(out.end(), data, data + length);
    return CAIRO_STATUS_SUCCESS;
  } catch (const std::bad_alloc&) {
    return CAIRO_STATUS_NO_MEMORY;
  }
}

int characters(const std::string& text) {
  int count = 0;
  for (const char c : text) count += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  return count;
}

int length_of(char first) {
  const auto c = static_cast<unsigned char>(first);
  return c < 0x80 ? 1 : c < 0xE0 ? 2 : c < 0xF0 ? 3 : 4;
}

class Pdf final : public Pen {
 public:
  Pdf(double width, double height, const Sheet& sheet)
      : surface_(cairo_pdf_surface_create_for_stream(take, &bytes_, width, height)),
        cairo_(cairo_create(surface_)),
        text_(sheet.text),
        titled_(!sheet.title.empty()) {
    // newer versions may have objects that are compressed
    cairo_pdf_surface_restrict_to_version(surface_, CAIRO_PDF_VERSION_1_4);
    cairo_pdf_surface_set_metadata(surface_, CAIRO_PDF_METADATA_TITLE, sheet.title.c_str());
    cairo_pdf_surface_set_metadata(surface_, CAIRO_PDF_METADATA_SUBJECT, sheet.text.c_str());
    cairo_pdf_surface_set_metadata(surface_, CAIRO_PDF_METADATA_CREATOR, "obscura");
    // the same bytes whenever it is made
    cairo_pdf_surface_set_metadata(surface_, CAIRO_PDF_METADATA_CREATE_DATE, "");
    cairo_set_miter_limit(cairo_, 4);
  }
  ~Pdf() override {
    cairo_destroy(cairo_);
    cairo_surface_destroy(surface_);
    for (cairo_font_face_t* face : faces_)
      if (face) cairo_font_face_destroy(face);
  }
  Pdf(const Pdf&) = delete;
  Pdf& operator=(const Pdf&) = delete;

  void fill_circle(const Point& center, double radius, Color color) override {
    if (radius <= 0 || color.a == 0) return;
    circle(center, radius);
    ink(color);
    cairo_fill(cairo_);
  }
  void ring(const Point& center, double radius, double width, Color color) override {
    circle(center, radius);
    ink(color);
    cairo_set_line_width(cairo_, width);
    cairo_stroke(cairo_);
  }
  void fill(const std::vector<Point>& outline, Color color) override {
    if (outline.size() < 3 || color.a == 0) return;
    trace(outline, true);
    ink(color);
    cairo_fill(cairo_);
  }
  void stroke(const std::vector<Point>& line, double width, Color color, draw::Cap cap,
              bool closed) override {
    if (line.size() < 2 || color.a == 0) return;
    trace(line, closed);
    ink(color);
    cairo_set_line_width(cairo_, width);
    cairo_set_line_cap(cairo_, cap == draw::Cap::round ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
    cairo_stroke(cairo_);
  }

  void type(const Point& start, const draw::Text& text, const draw::Line& line, double scale) override {
    for (std::size_t i = 0; i < text.spans.size(); ++i) {
      const draw::Span& span = text.spans[i];
      if (span.text.empty() || line.spans[i].glyphs.empty()) continue;
      const std::string& words = line.spans[i].drawn.empty() ? span.text : line.spans[i].drawn;
      std::vector<cairo_glyph_t> glyphs;
      for (const draw::Glyph& glyph : line.spans[i].glyphs)
        glyphs.push_back({glyph.index, start.x() + scale * glyph.at.x(), start.y() + scale * glyph.at.y()});

      // a glyph a character, or all of them together
      std::vector<cairo_text_cluster_t> clusters;
      if (characters(words) == int(glyphs.size())) {
        for (std::size_t at = 0; at < words.size(); at += std::size_t(clusters.back().num_bytes))
          clusters.push_back({length_of(words[at]), 1});
      } else {
        clusters.push_back({int(words.size()), int(glyphs.size())});
      }
      cairo_font_face_t*& face = faces_[std::size_t(span.face)];
      if (!face) face = open(span.face);
      cairo_set_font_face(cairo_, face);
      cairo_set_font_size(cairo_, scale * span.size);
      ink(span.color);
      cairo_show_text_glyphs(cairo_, words.data(), int(words.size()), glyphs.data(), int(glyphs.size()),
                             clusters.data(), int(clusters.size()), cairo_text_cluster_flags_t(0));
    }
  }

  void image(const draw::Rect& where, const Raster& raster) override {
    const int stride = cairo_format_stride_for_width(CAIRO_FORMAT_RGB24, raster.width);
    std::vector<std::uint8_t> rows(std::size_t(stride) * raster.height);
    for (int y = 0; y < raster.height; ++y) {
      for (int x = 0; x < raster.width; ++x) {
        const std::uint8_t* from = raster.pixels + 4 * (std::size_t(raster.width) * y + x);
        auto* to = reinterpret_cast<std::uint32_t*>(rows.data() + std::size_t(stride) * y) + x;
        *to = std::uint32_t(from[0]) << 16 | std::uint32_t(from[1]) << 8 | from[2];
      }
    }
    cairo_surface_t* pixels = cairo_image_surface_create_for_data(rows.data(), CAIRO_FORMAT_RGB24,
                                                                  raster.width, raster.height, stride);
    cairo_save(cairo_);
    cairo_translate(cairo_, where.x, where.y);
    cairo_scale(cairo_, where.width / raster.width, where.height / raster.height);
    cairo_set_source_surface(cairo_, pixels, 0, 0);
    cairo_paint(cairo_);
    cairo_restore(cairo_);
    // written out before the rows go
    cairo_surface_flush(surface_);
    kept_.push_back(std::move(rows));
    cairo_surface_destroy(pixels);
  }

  // after the ground or the pixels: Cairo forgets what came before what covers the page, tags and all
  void begin_figure() override {
    for (const char* tag : {kDocument, kFigure})
      if (!text_.empty()) cairo_tag_begin(cairo_, tag, nullptr);
  }

  void clip(const draw::Rect& r) override {
    cairo_save(cairo_);
    cairo_rectangle(cairo_, r.x, r.y, r.width, r.height);
    cairo_clip(cairo_);
  }
  void unclip() override { cairo_restore(cairo_); }
  void next_page() override {
    cairo_show_page(cairo_);
    kept_.clear();
  }

  std::vector<std::uint8_t> finish() override {
    for (const char* tag : {kFigure, kDocument})
      if (!text_.empty()) cairo_tag_end(cairo_, tag);
    cairo_show_page(cairo_);
    const cairo_status_t drawn = cairo_status(cairo_);
    cairo_surface_finish(surface_);
    const cairo_status_t status = drawn ? drawn : cairo_surface_status(surface_);
    if (status != CAIRO_STATUS_SUCCESS) throw Error(std::string("Cairo: ") + cairo_status_to_string(status));
    return text_.empty() ? std::move(bytes_) : described(std::move(bytes_), text_, titled_);
  }

 private:
  static constexpr const char *kDocument = "Document", *kFigure = "Figure";

  void ink(Color c) { cairo_set_source_rgba(cairo_, c.r / 255.0, c.g / 255.0, c.b / 255.0, c.a / 255.0); }
  void circle(const Point& center, double radius) {
    cairo_new_path(cairo_);
    cairo_arc(cairo_, center.x(), center.y(), radius, 0, 2 * std::numbers::pi);
    cairo_close_path(cairo_);
  }
  void trace(const std::vector<Point>& line, bool closed) {
    cairo_new_path(cairo_);
    for (const Point& p : line) cairo_line_to(cairo_, p.x(), p.y());
    if (closed) cairo_close_path(cairo_);
  }

  std::vector<std::uint8_t> bytes_;
  std::vector<std::vector<std::uint8_t>> kept_;  // pixels that Cairo reads until the page is finished
  cairo_surface_t* surface_;
  cairo_t* cairo_;
  std::string text_;
  bool titled_;
  std::array<cairo_font_face_t*, 6> faces_{};
};

}  // namespace

std::unique_ptr<Pen> pdf_pen(double width, double height, const Sheet& sheet) {
  return std::make_unique<Pdf>(width, height, sheet);
}

}  // namespace obscura::page

#endif
