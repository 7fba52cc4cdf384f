#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "draw/picture/list.h"
#include "draw/picture/type.h"
#include "page/page.h"

namespace obscura::page {

using draw::Color;
using draw::Point;

/// Writes one form of page. Lengths in points, y down from the top left corner.
class Pen {
 public:
  virtual ~Pen() = default;

  virtual void fill_circle(const Point& center, double radius, Color color) = 0;
  virtual void ring(const Point& center, double radius, double width, Color color) = 0;
  /// Closed outlines; overlaps are filled once.
  virtual void fill(const std::vector<Point>& outline, Color color) = 0;
  /// Mitred up to four times the width.
  virtual void stroke(const std::vector<Point>& line, double width, Color color, draw::Cap cap,
                      bool closed) = 0;
  /// A line of type that begins at `start` on its baseline; `line` is `text` shaped, `scale` points a page
  /// unit.
  virtual void type(const Point& start, const draw::Text& text, const draw::Line& line, double scale) = 0;
  virtual void image(const draw::Rect& where, const Raster& raster) = 0;
  virtual void clip(const draw::Rect& rect) = 0;
  virtual void unclip() = 0;
  /// From here on the page is one figure, which has the sheet's text instead of the picture, if there is one.
  virtual void begin_figure() {}
  /// Ends a page and begins the next.
  virtual void next_page() = 0;
  /// The file.
  virtual std::vector<std::uint8_t> finish() = 0;
};

std::unique_ptr<Pen> svg_pen(double width, double height, const Sheet& sheet);
/// Null where this build has no Cairo.
std::unique_ptr<Pen> pdf_pen(double width, double height, const Sheet& sheet);

/// Puts a list on a page, `scale` points a page unit. `ground`: the colour with which strokes that darken or
/// lighten are mixed.
void put(const draw::List& list, double scale, Color ground, Pen& pen);

}  // namespace obscura::page
