// SVG, written by hand: Cairo's would turn type into outlines. Each face that is used comes along as a font
// of its own, with the characters that the page has, so that a browser needs none installed.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <set>
#include <string_view>

#include "page/error.h"
#include "page/fonts.h"
#include "page/markup.h"
#include "page/pen.h"

namespace obscura::page {
namespace {

// a thousandth of a point is finer than any press
std::string number(double x) {
  std::string text = fmt::format("{:.3f}", std::abs(x) < 5e-4 ? 0.0 : x);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string place(const Point& p) { return number(p.x()) + " " + number(p.y()); }

// the code points of UTF-8
void characters(std::string_view text, std::set<std::uint32_t>& out) {
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i]);
    const std::size_t length = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    std::uint32_t c = length == 1 ? first : first & (0xFFu >> (length + 1));
    for (std::size_t k = 1; k < length && i + k < text.size(); ++k)
      c = c << 6 | (static_cast<unsigned char>(text[i + k]) & 0x3Fu);
    out.insert(c);
    i += length;
  }
}

// " fill=..." with its opacity
std::string ink(const char* what, Color color) {
  std::string text = fmt::format(" {}=\"#{:02x}{:02x}{:02x}\"", what, color.r, color.g, color.b);
  if (color.a < 255) text += fmt::format(" {}-opacity=\"{}\"", what, number(color.a / 255.0));
  return text;
}

class Svg final : public Pen {
 public:
  Svg(double width, double height, const Sheet& sheet) : width_(width), height_(height), sheet_(sheet) {}

  void fill_circle(const Point& center, double radius, Color color) override {
    if (radius <= 0 || color.a == 0) return;
    body_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}/>\n", number(center.x()), number(center.y()),
                         number(radius), ink("fill", color));
  }
  void ring(const Point& center, double radius, double width, Color color) override {
    body_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"none\" stroke-width=\"{}\"{}/>\n",
                         number(center.x()), number(center.y()), number(radius), number(width),
                         ink("stroke", color));
  }
  void fill(const std::vector<Point>& outline, Color color) override {
    if (outline.size() < 3 || color.a == 0) return;
    body_ += fmt::format("<path d=\"{}Z\"{}/>\n", line_of(outline), ink("fill", color));
  }
  void stroke(const std::vector<Point>& line, double width, Color color, draw::Cap cap,
              bool closed) override {
    if (line.size() < 2 || color.a == 0) return;
    body_ += fmt::format("<path d=\"{}{}\" fill=\"none\" stroke-width=\"{}\"{}{}/>\n", line_of(line),
                         closed ? "Z" : "", number(width), ink("stroke", color),
                         cap == draw::Cap::round && !closed ? " stroke-linecap=\"round\"" : "");
  }

  void type(const Point& start, const draw::Text& text, const draw::Line& line, double scale) override {
    body_ += fmt::format("<text xml:space=\"preserve\" y=\"{}\">", number(start.y()));
    for (std::size_t i = 0; i < text.spans.size(); ++i) {
      const draw::Span& span = text.spans[i];
      if (span.text.empty() || line.spans[i].glyphs.empty()) continue;
      const FaceName& face = face_name(span.face);
      const std::string shown = draw::characters_of(span);
      characters(shown, used_[std::size_t(span.face)]);
      const double x = start.x() + scale * line.spans[i].glyphs.front().at.x();
      // a later span says its baseline too: it would take over that of the one before
      body_ += fmt::format(
          "<tspan x=\"{}\"{} font-family=\"{}\" font-size=\"{}\"{}{}{}{}>{}</tspan>", number(x),
          i > 0 || span.rise != 0 ? fmt::format(" y=\"{}\"", number(start.y() - scale * span.rise)) : "",
          escaped(face.family), number(scale * span.size),
          face.weight != 400 ? fmt::format(" font-weight=\"{}\"", face.weight) : "",
          face.italic ? " font-style=\"italic\"" : "",
          span.tabular ? " style=\"font-feature-settings:'tnum'\"" : "", ink("fill", span.color),
          escaped(shown));
    }
    body_ += "</text>\n";
  }

  void image(const draw::Rect& where, const Raster& raster) override {
    if (raster.png.empty()) throw Error("an SVG takes pictures as PNG");
    body_ += fmt::format(
        "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" "
        "xlink:href=\"data:image/png;base64,{}\"/>\n",
        number(where.x), number(where.y), number(where.width), number(where.height), base64(raster.png));
  }

  void clip(const draw::Rect& r) override {
    ++clips_;
    body_ += fmt::format(
        "<clipPath id=\"c{}\"><path d=\"M{} {}h{}v{}h{}Z\"/></clipPath>\n"
        "<g clip-path=\"url(#c{})\">\n",
        clips_, number(r.x), number(r.y), number(r.width), number(r.height), number(-r.width), clips_);
  }
  void unclip() override { body_ += "</g>\n"; }
  void next_page() override { throw Error("an SVG has one page"); }

  std::vector<std::uint8_t> finish() override {
    std::string out = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" "
        "role=\"img\" width=\"{}mm\" height=\"{}mm\" viewBox=\"0 0 {} {}\">\n",
        number(width_ * 25.4 / 72), number(height_ * 25.4 / 72), number(width_), number(height_));
    if (!sheet_.title.empty()) out += fmt::format("<title>{}</title>\n", escaped(sheet_.title));
    if (!sheet_.text.empty()) out += fmt::format("<desc>{}</desc>\n", escaped(sheet_.text));
    std::string faces;
    // faces of one font are one
    const auto same = [](std::size_t i, std::size_t k) {
      const draw::FontFile &a = draw::font_file(draw::Face(i)), &b = draw::font_file(draw::Face(k));
      return a.path == b.path && a.index == b.index;
    };
    for (std::size_t i = 0; i < used_.size(); ++i)
      for (std::size_t k = 0; k < i && !used_[i].empty(); ++k)
        if (!used_[k].empty() && same(i, k)) used_[k].merge(used_[i]), used_[i].clear();
    for (std::size_t i = 0; i < used_.size(); ++i) {
      if (used_[i].empty()) continue;
      const std::vector<std::uint8_t> font = subset(draw::Face(i), used_[i]);
      if (font.empty()) continue;
      const FaceName& face = face_name(draw::Face(i));
      faces += fmt::format(
          "@font-face{{font-family:\"{}\";font-weight:{};font-style:{};"
          "src:url(data:font/otf;base64,{})}}\n",
          escaped(face.family), face.weight, face.italic ? "italic" : "normal", base64(font));
    }
    if (!faces.empty()) out += "<style>\n" + faces + "</style>\n";
    out += body_ + "</svg>\n";
    return {out.begin(), out.end()};
  }

 private:
  static std::string line_of(const std::vector<Point>& line) {
    std::string d = "M" + place(line[0]);
    for (std::size_t i = 1; i < line.size(); ++i) d += (i == 1 ? "L" : " ") + place(line[i]);
    return d;
  }

  double width_, height_;
  Sheet sheet_;
  std::string body_;
  std::array<std::set<std::uint32_t>, 6> used_;  // characters, of each face
  int clips_ = 0;
};

}  // namespace

std::unique_ptr<Pen> svg_pen(double width, double height, const Sheet& sheet) {
  return std::make_unique<Svg>(width, height, sheet);
}

}  // namespace obscura::page
