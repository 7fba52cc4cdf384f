#include "gl/painter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace obscura::gl {
namespace {

constexpr float kMargin = 0.75f;  // px beyond an edge where a pixel may still be covered: sqrt(1/2)
constexpr double kDot = 3;        // px radius under which a disc's area is summed in chords

constexpr double kSlab = 0.75;  // px half extent under which a pixel may meet both edges of a slab
constexpr int kTile = 16;       // px, of the layers, and rows of a band of what is large
constexpr float kLarge = 64;    // px: of a polygon's lesser extent

constexpr GLsizei kCorners = 4;  // of a quad, as a triangle strip

// Brings the sides of a level line to whole pixels, `scale` px a page unit; false: it is between two.
bool bring_to_pixels(std::vector<draw::Node>& line, double scale) {
  const double middle = line[0].at.y(), half = line[0].width / 2;
  const double top = std::round((middle - half) * scale), bottom = std::round((middle + half) * scale);
  for (draw::Node& node : line)
    node.at.y() = (top + bottom) / (2 * scale), node.width = (bottom - top) / scale;
  return top < bottom;
}

// a straight stroke of one width and colour without round ends: as a box it takes half the time
std::optional<draw::Box> as_bar(const draw::List& list, const draw::Stroke& stroke) {
  if (stroke.whole || stroke.end - stroke.begin != 2 || stroke.cap != draw::Cap::butt ||
      stroke.blend != draw::Blend::over)
    return {};
  const draw::Node &a = list.nodes[std::size_t(stroke.begin)], &b = list.nodes[std::size_t(stroke.begin) + 1];
  const draw::Point way = b.at - a.at;
  const double length = way.norm();
  if (!(length > 0) || a.width != b.width || a.color != b.color) return {};
  draw::Box bar;
  bar.center = (a.at + b.at) / 2, bar.x_axis = way / length, bar.half = {length / 2, a.width / 2};
  bar.fill = bar.outline = a.color;
  return bar;
}

}  // namespace

Painter::Painter(const Functions& gl, int width, int height)
    : gl_(gl),
      width_(width),
      height_(height),
      scale_(height / 1080.0),
      disc_program_(gl, "disc.vert", "disc.frag"),
      dot_program_(gl, "disc.vert", "dot.frag"),
      box_program_(gl, "box.vert", "box.frag"),
      bar_program_(gl, "box.vert", "bar.frag"),
      slab_program_(gl, "box.vert", "slab.frag"),
      frame_program_(gl, "frame.vert", "frame.frag"),
      stroke_program_(gl, "stroke.vert", "stroke.frag"),
      polygon_program_(gl, "polygon.vert", "polygon.frag"),
      quadrangle_program_(gl, "quadrangle.vert", "quadrangle.frag"),
      inside_program_(gl, "quadrangle.vert", "inside.frag"),
      glyph_program_(gl, "glyph.vert", "glyph.frag"),
      ground_uniform_(stroke_program_.uniform("ground")),
      disc_array_(gl, sizeof(Disc), 1,
                  {{4, GL_FLOAT, offsetof(Disc, x)},
                   {4, GL_UNSIGNED_BYTE, offsetof(Disc, fill)},
                   {4, GL_UNSIGNED_BYTE, offsetof(Disc, outline)}}),
      box_array_(gl, sizeof(Box), 1,
                 {{4, GL_FLOAT, offsetof(Box, x)},
                  {4, GL_FLOAT, offsetof(Box, axis_x)},
                  {4, GL_UNSIGNED_BYTE, offsetof(Box, fill)},
                  {4, GL_UNSIGNED_BYTE, offsetof(Box, outline)}}),
      strip_array_(gl, sizeof(StripVertex), 0,
                   {{2, GL_FLOAT, offsetof(StripVertex, x)},
                    {3, GL_FLOAT, offsetof(StripVertex, lateral)},
                    {4, GL_UNSIGNED_BYTE, offsetof(StripVertex, color)},
                    {4, GL_FLOAT, offsetof(StripVertex, tangent_x)},
                    {4, GL_FLOAT, offsetof(StripVertex, cut_x)}}),
      polygon_array_(gl, sizeof(Polygon), 1,
                     {{4, GL_FLOAT, offsetof(Polygon, x0)},
                      {2, GL_FLOAT, offsetof(Polygon, first)},
                      {4, GL_UNSIGNED_BYTE, offsetof(Polygon, fill)}}),
      quadrangle_array_(gl, sizeof(Quadrangle), 1,
                        {{4, GL_FLOAT, offsetof(Quadrangle, x0)},
                         {4, GL_FLOAT, offsetof(Quadrangle, corners)},
                         {4, GL_FLOAT, offsetof(Quadrangle, corners) + 4 * sizeof(float)},
                         {4, GL_UNSIGNED_BYTE, offsetof(Quadrangle, fill)}}),
      glyph_array_(gl, sizeof(Glyph), 1,
                   {{4, GL_FLOAT, offsetof(Glyph, x)},
                    {2, GL_FLOAT, offsetof(Glyph, u)},
                    {4, GL_UNSIGNED_BYTE, offsetof(Glyph, ink)}}),
      index_buffer_(gl, GL_ELEMENT_ARRAY_BUFFER),
      edge_buffer_(gl, GL_TEXTURE_BUFFER),
      glyph_pictures_(gl) {
  for (const Program* program :
       {&disc_program_, &dot_program_, &box_program_, &bar_program_, &slab_program_, &frame_program_,
        &stroke_program_, &polygon_program_, &quadrangle_program_, &inside_program_, &glyph_program_}) {
    program->use();
    gl.Uniform2f(program->uniform("per_half_size"), 2.0f / float(width), 2.0f / float(height));
  }
  gl.GenTextures(1, &edge_texture_);
}

Painter::~Painter() { gl_.DeleteTextures(1, &edge_texture_); }

void Painter::paint(const draw::List& list, Reach from, Reach to, draw::Color ground, bool transparent,
                    Damage& damage) {
  ground_ = ground, transparent_ = transparent;
  runs_.clear();
  discs_.clear();
  boxes_.clear();
  strip_.clear();
  polygons_.clear();
  quadrangles_.clear();
  edges_.clear();
  glyphs_.clear();
  for (int n = from.batches; n < int(list.batches.size()) && Reach{n, 0} < to; ++n) {
    draw::Batch part = list.batches[std::size_t(n)];
    if (n == to.batches) part.end = part.begin + to.things;
    if (n == from.batches) part.begin += from.things;
    encode(list, part, damage);
  }

  upload();

  gl_.Enable(GL_SCISSOR_TEST);
  gl_.Enable(GL_BLEND);
  for (const Run& run : runs_) draw(run);
  gl_.Disable(GL_SCISSOR_TEST);
  gl_.Disable(GL_BLEND);
}

void Painter::encode(const draw::List& list, const draw::Batch& batch, Damage& damage) {
  // a clip is widened to whole pixels
  clip_ = {0, 0, float(width_), float(height_)};
  if (batch.clip >= 0) {
    const draw::Rect& r = list.clips[std::size_t(batch.clip)];
    clip_ = clip_ & Bounds{float(std::floor(r.x * scale_ + 1e-6)), float(std::floor(r.y * scale_ + 1e-6)),
                           float(std::ceil((r.x + r.width) * scale_ - 1e-6)),
                           float(std::ceil((r.y + r.height) * scale_ - 1e-6))};
  }
  if (!any(clip_)) return;
  halo_ = batch.halo;
  scissor_ = {int(clip_.x0), int(clip_.y0), int(clip_.x1 - clip_.x0), int(clip_.y1 - clip_.y0)};

  for (int i = batch.begin; i < batch.end; ++i) {
    const auto at = std::size_t(i);
    switch (batch.kind) {
      case draw::Kind::disc:
        add(list.discs[at], damage);
        break;
      case draw::Kind::box:
        add(list.boxes[at], damage);
        break;
      case draw::Kind::stroke:
        if (const auto bar = as_bar(list, list.strokes[at])) {
          add(*bar, damage);
        } else {
          lay_boxes();
          add(list, list.strokes[at], damage);
        }
        break;
      case draw::Kind::polygon:
        add(list, list.polygons[at], damage);
        break;
      case draw::Kind::text:
        add(list.texts[at], damage);
        break;
    }
  }
  lay_boxes();
}

bool Painter::touches(const Bounds& bounds, Damage& damage) const {
  const Bounds seen = bounds & clip_;
  if (!any(seen)) return false;
  damage.mark(seen);
  return true;
}

// the tiles that a convex polygon meets, where it is seen
void Painter::mark(std::span<const Damage::Corner> polygon, const Bounds& seen, Damage& damage) {
  Bounds bounds{polygon[0].x, polygon[0].y, polygon[0].x, polygon[0].y};
  for (const Damage::Corner& p : polygon)
    bounds = {std::min(bounds.x0, p.x), std::min(bounds.y0, p.y), std::max(bounds.x1, p.x),
              std::max(bounds.y1, p.y)};
  const Bounds within = bounds & seen;
  if (within.x0 <= within.x1 && within.y0 <= within.y1) damage.mark(polygon, within);
}

// A halo of the ground's colour is a hole where the ground is left out.
bool Painter::erases(draw::Color color) const {
  return halo_ && transparent_ && color.r == ground_.r && color.g == ground_.g && color.b == ground_.b;
}

void Painter::run(Shape shape, int first, int end, bool erases) {
  const auto same = [](const Damage::Rect& a, const Damage::Rect& b) {
    return a.x == b.x && a.y == b.y && a.width == b.width && a.height == b.height;
  };
  if (!runs_.empty() && runs_.back().shape == shape && runs_.back().erases == erases &&
      same(runs_.back().scissor, scissor_)) {
    runs_.back().end = end;
  } else {
    runs_.push_back({shape, first, end, scissor_, erases});
  }
}

void Painter::add(const draw::Disc& disc, Damage& damage) {
  if (disc.line > 0 && erases(disc.outline) && !erases(disc.fill)) {
    // its rim alone is a halo
    add(draw::Disc{disc.center, disc.radius, 0, disc.outline, disc.outline}, damage);
    return add(draw::Disc{disc.center, disc.radius - disc.line, 0, disc.fill, disc.fill}, damage);
  }
  const auto x = float(disc.center.x() * scale_), y = float(disc.center.y() * scale_);
  const auto outer = float(disc.radius * scale_);
  const auto inner = float(std::max(disc.radius - disc.line, 0.0) * scale_);
  const float reach = outer + kMargin;
  if (!(outer > 0) || !touches({x - reach, y - reach, x + reach, y + reach}, damage)) return;
  discs_.push_back({x, y, outer, inner, disc.fill, disc.outline});
  const int end = int(discs_.size());
  run(inner < kDot ? Shape::dot : Shape::disc, end - 1, end, erases(disc.fill));
}

void Painter::add(const draw::Box& box, Damage& damage) {
  const draw::Point center = box.center * scale_, half = box.half * scale_;
  const draw::Point u = box.x_axis, v(-u.y(), u.x());
  const double line = box.line * scale_;
  const double rx = std::abs(u.x()) * half.x() + std::abs(v.x()) * half.y() + kMargin;
  const double ry = std::abs(u.y()) * half.x() + std::abs(v.y()) * half.y() + kMargin;
  const Bounds bounds{float(center.x() - rx), float(center.y() - ry), float(center.x() + rx),
                      float(center.y() + ry)};
  const Bounds seen = bounds & clip_;
  if (!any(seen)) return;
  const draw::Point a = (half.x() + kMargin) * u, b = (half.y() + kMargin) * v;
  const auto corner = [&](const draw::Point& way) {
    return Damage::Corner{float(center.x() + way.x()), float(center.y() + way.y())};
  };
  mark(std::array{corner(a + b), corner(a - b), corner(-a - b), corner(b - a)}, seen, damage);

  // above all that came before it in the tiles that it touches
  const int columns = width_ / kTile + 1, rows = height_ / kTile + 1;
  layers_.resize(std::size_t(columns) * rows);
  int layer = 0;
  const auto each_tile = [&](auto&& visit) {
    for (int r = int(seen.y0) / kTile; r <= int(seen.y1) / kTile; ++r)
      for (int c = int(seen.x0) / kTile; c <= int(seen.x1) / kTile; ++c)
        visit(layers_[std::size_t(columns) * r + c]);
  };
  each_tile([&](int below) { layer = std::max(layer, below); });
  each_tile([&](int& below) { below = layer + 1; });

  const auto push = [&](Shape shape, double x, double y, double outlined, double dot, draw::Color fill,
                        draw::Color outline) {
    layered_.push_back({layer, shape,
                        Box{float(center.x()), float(center.y()), float(x), float(y), float(u.x()),
                            float(u.y()), float(outlined), float(dot), fill, outline},
                        erases(fill)});
  };
  const Shape shape = half.minCoeff() - line < kSlab ? Shape::slab : line > 0 ? Shape::box : Shape::bar;
  push(shape, half.x(), half.y(), line, 0, box.fill, box.outline);
  if (box.axis > 0 && box.axis_line > 0) {
    push(Shape::frame, box.axis * scale_, box.axis_line * scale_ / 2, 0, 1.5 * box.axis_line * scale_,
         box.axis_color, box.axis_color);
  }
}

// Boxes that do not touch may be drawn in any order, so that each layer is drawn shape by shape.
void Painter::lay_boxes() {
  if (layered_.empty()) return;
  std::stable_sort(layered_.begin(), layered_.end(), [](const Layered& a, const Layered& b) {
    return a.layer != b.layer ? a.layer < b.layer : a.shape < b.shape;
  });
  for (const Layered& next : layered_) {
    boxes_.push_back(next.box);
    const int end = int(boxes_.size());
    run(next.shape, end - 1, end, next.erases);
  }
  layered_.clear();
  std::fill(layers_.begin(), layers_.end(), 0);
}

void Painter::add(const draw::List& list, const draw::Stroke& stroke, Damage& damage) {
  std::span nodes(list.nodes.data() + stroke.begin, std::size_t(stroke.end - stroke.begin));
  if (stroke.whole) {
    row_.assign(nodes.begin(), nodes.end());
    if (!bring_to_pixels(row_, scale_)) return;
    nodes = row_;
  }
  const std::size_t vertices = strip_.vertices.size(), first = strip_.indices.size();
  const Bounds seen = add_stroke(nodes, stroke, scale_, strip_) & clip_;
  if (!any(seen)) {
    strip_.vertices.resize(vertices);
    strip_.indices.resize(first);
    return;
  }
  for (std::size_t i = first; i + 2 < strip_.indices.size(); i += 3) {
    Damage::Corner triangle[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const StripVertex& v = strip_.vertices[strip_.indices[i + k]];
      triangle[k] = {v.x, v.y};
    }
    mark(triangle, seen, damage);
  }
  run(stroke.blend == draw::Blend::darken    ? Shape::darken
      : stroke.blend == draw::Blend::lighten ? Shape::lighten
                                             : Shape::stroke,
      int(first), int(strip_.indices.size()), erases(nodes.front().color));
}

void Painter::add(const draw::List& list, const draw::Polygon& polygon, Damage& damage) {
  constexpr float far = std::numeric_limits<float>::infinity();
  Bounds bounds{far, far, -far, -far};
  const int count = polygon.end - polygon.begin;
  outline_.clear();
  for (int i = 0; i < count; ++i) {
    const draw::Point p = list.points[std::size_t(polygon.begin + i)] * scale_;
    const draw::Point q = list.points[std::size_t(polygon.begin + (i + 1) % count)] * scale_;
    const Edge edge{float(p.x()), float(p.y()), float(q.x()), float(q.y())};
    outline_.push_back(edge);
    bounds = {std::min(bounds.x0, edge.px), std::min(bounds.y0, edge.py), std::max(bounds.x1, edge.px),
              std::max(bounds.y1, edge.py)};
  }
  bounds = {bounds.x0 - 0.5f, bounds.y0 - 0.5f, bounds.x1 + 0.5f, bounds.y1 + 0.5f};
  const bool large =
      count <= 4 && std::min(bounds.x1 - bounds.x0, bounds.y1 - bounds.y0) > kLarge && convex(outline_);
  if (large) {
    if (!any(bounds & clip_)) return;
    corners_.clear();
    for (const Edge& edge : outline_) corners_.push_back({edge.px, edge.py});
    mark(corners_, clip_, damage);
  } else if (!touches(bounds, damage)) {
    return;
  }
  const Bounds page = bounds & Bounds{-1, -1, float(width_ + 1), float(height_ + 1)};
  if (count == 3 || count == 4) {
    Quadrangle made{page.x0, page.y0, page.x1, page.y1, {}, polygon.fill};
    // of three the last is there twice
    for (std::size_t i = 0; i < 4; ++i) {
      const Edge& edge = outline_[std::min(i, outline_.size() - 1)];
      made.corners[2 * i] = edge.px, made.corners[2 * i + 1] = edge.py;
    }
    if (large) return add_large(made);
    quadrangles_.push_back(made);
    const int end = int(quadrangles_.size());
    return run(Shape::quadrangle, end - 1, end, erases(polygon.fill));
  }
  const int first = int(polygons_.size());
  for (const Band& band : banded(outline_, page.y0, page.y1, edges_))
    polygons_.push_back(
        {page.x0, band.y0, page.x1, band.y1, float(band.first), float(band.count), polygon.fill});
  run(Shape::polygon, first, int(polygons_.size()), erases(polygon.fill));
}

// The outline at hand, which is convex, in bands of rows: the pixels that meet its edges, and those that lie
// wholly in it, which are filled without the edges.
void Painter::add_large(const Quadrangle& whole) {
  const int first = int(quadrangles_.size());
  insides_.clear();
  const auto part = [&](std::vector<Quadrangle>& to, float x0, float y0, float x1, float y1) {
    const Bounds seen = Bounds{x0, y0, x1, y1} & Bounds{whole.x0, whole.y0, whole.x1, whole.y1};
    if (!any(seen)) return;
    Quadrangle piece = whole;
    piece.x0 = seen.x0, piece.y0 = seen.y0, piece.x1 = seen.x1, piece.y1 = seen.y1;
    to.push_back(piece);
  };
  for (int y = int(std::floor(whole.y0)); float(y) < whole.y1; y += kTile) {
    const Columns at = columns(outline_, y, y + kTile);
    const auto top = float(y), bottom = float(y + kTile);
    if (at.full1 - at.full0 < kTile) {
      part(quadrangles_, float(at.part0), top, float(at.part1), bottom);
    } else {
      part(quadrangles_, float(at.part0), top, float(at.full0), bottom);
      part(insides_, float(at.full0), top, float(at.full1), bottom);
      part(quadrangles_, float(at.full1), top, float(at.part1), bottom);
    }
  }
  const int edges = int(quadrangles_.size());
  quadrangles_.insert(quadrangles_.end(), insides_.begin(), insides_.end());
  const int end = int(quadrangles_.size());
  if (edges > first) run(Shape::quadrangle, first, edges, erases(whole.fill));
  if (end > edges) run(Shape::inside, edges, end, erases(whole.fill));
}

void Painter::add(const draw::Text& text, Damage& damage) {
  const draw::Line line = draw::shape(text);
  double start = text.at.x();
  if (text.align == draw::Align::center) start -= line.width / 2;
  if (text.align == draw::Align::right) start -= line.width;

  const int first = int(glyphs_.size());
  for (const draw::Shaped& span : line.spans) {
    for (const draw::Glyph& glyph : span.glyphs) {
      // a quarter of a pixel across, whole pixels down
      const double x = std::floor((start + glyph.at.x()) * scale_ * Glyphs::kQuarters + 0.5);
      const double pen = std::floor(x / Glyphs::kQuarters);
      const double baseline = std::floor((text.at.y() + glyph.at.y()) * scale_ + 0.5);
      if (!(std::abs(pen) < 1e6 && std::abs(baseline) < 1e6)) continue;
      const GlyphPicture& picture = glyph_pictures_.picture(span.face, glyph.index, span.size * scale_,
                                                            int(x - pen * Glyphs::kQuarters));
      const auto left = float(pen + picture.left), top = float(baseline + picture.top);
      const auto width = float(picture.width), height = float(picture.height);
      if (picture.width == 0 || !touches({left, top, left + width, top + height}, damage)) continue;
      glyphs_.push_back({left, top, width, height, float(picture.u), float(picture.v), span.color});
    }
  }
  const int end = int(glyphs_.size());
  if (end > first) run(Shape::glyph, first, end);
}

void Painter::upload() {
  if (!discs_.empty()) disc_array_.upload(discs_);
  if (!boxes_.empty()) box_array_.upload(boxes_);
  if (!polygons_.empty()) {
    polygon_array_.upload(polygons_);
    edge_buffer_.upload(edges_);
    gl_.ActiveTexture(GL_TEXTURE0);
    gl_.BindTexture(GL_TEXTURE_BUFFER, edge_texture_);
    gl_.TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, edge_buffer_.name());
  }
  if (!quadrangles_.empty()) quadrangle_array_.upload(quadrangles_);
  if (!glyphs_.empty()) {
    glyph_array_.upload(glyphs_);
    glyph_pictures_.bind();
  }
  if (!strip_.indices.empty()) {
    strip_array_.upload(strip_.vertices);
    strip_array_.bind();
    index_buffer_.upload(strip_.indices);
  }
}

void Painter::draw(const Run& run) {
  gl_.BlendFunc(run.erases ? GL_ZERO : GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_.Scissor(run.scissor.x, run.scissor.y, run.scissor.width, run.scissor.height);
  const int count = run.end - run.first;
  const auto quads = [&](const Program& program, VertexArray& array) {
    program.use();
    array.bind(run.first);
    gl_.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, kCorners, count);
  };
  switch (run.shape) {
    case Shape::disc:
      quads(disc_program_, disc_array_);
      break;
    case Shape::dot:
      quads(dot_program_, disc_array_);
      break;
    case Shape::box:
      quads(box_program_, box_array_);
      break;
    case Shape::bar:
      quads(bar_program_, box_array_);
      break;
    case Shape::slab:
      quads(slab_program_, box_array_);
      break;
    case Shape::frame:
      quads(frame_program_, box_array_);
      break;
    case Shape::polygon:
      quads(polygon_program_, polygon_array_);
      break;
    case Shape::quadrangle:
      quads(quadrangle_program_, quadrangle_array_);
      break;
    case Shape::inside:
      quads(inside_program_, quadrangle_array_);
      break;
    case Shape::glyph:
      quads(glyph_program_, glyph_array_);
      break;
    case Shape::stroke:
    case Shape::darken:
    case Shape::lighten: {
      stroke_program_.use();
      strip_array_.bind();
      // without a ground to mix with, more of a colour is more of its ink on either theme
      const bool mixed = run.shape != Shape::stroke && !transparent_;
      const auto level = [&](std::uint8_t c) { return mixed ? float(c) / 255.0f : 0.0f; };
      gl_.Uniform4f(ground_uniform_, level(ground_.r), level(ground_.g), level(ground_.b), level(255));
      if (run.shape != Shape::stroke)
        gl_.BlendEquation(mixed && run.shape == Shape::darken ? GL_MIN : GL_MAX);
      gl_.DrawElements(GL_TRIANGLES, count, GL_UNSIGNED_INT,
                       reinterpret_cast<const void*>(sizeof(std::uint32_t) * std::size_t(run.first)));
      if (run.shape != Shape::stroke) gl_.BlendEquation(GL_FUNC_ADD);
      break;
    }
  }
}

}  // namespace obscura::gl
