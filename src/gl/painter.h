#pragma once

#include <span>
#include <vector>

#include "draw/picture/list.h"
#include "gl/bands.h"
#include "gl/buffer.h"
#include "gl/damage.h"
#include "gl/glyphs.h"
#include "gl/head.h"
#include "gl/program.h"
#include "gl/strip.h"

namespace obscura::gl {

/// Puts lists down on the bound framebuffer: encodes every batch, uploads once, draws in painter's order.
class Painter {
 public:
  Painter(const Functions& gl, int width, int height);

  /// `ground`: the colour with which darkened and lightened strokes are mixed; the colours are premultiplied
  /// on the way, and so is the framebuffer. Marks the area that it draws on.
  void paint(const draw::List& list, draw::Color ground, bool transparent, Damage& damage) {
    paint(list, {}, end_of(list), ground, transparent, damage);
  }
  /// The same of the things of a list from `from` to `to`: one part after the other gives the pixels of the
  /// whole.
  void paint(const draw::List& list, Reach from, Reach to, draw::Color ground, bool transparent,
             Damage& damage);

 private:
  // instances, as the shaders read them
  struct Disc {
    float x, y, outer, inner;
    draw::Color fill, outline;
  };
  struct Box {  // or the frame of one: length and half width of its axes; only the dot, fill its colour
    float x, y, half_x, half_y;
    float axis_x, axis_y, line, dot;
    draw::Color fill, outline;
  };
  struct Polygon {
    float x0, y0, x1, y1;
    float first, count;
    draw::Color fill;
  };
  struct Quadrangle {
    float x0, y0, x1, y1;
    float corners[8];
    draw::Color fill;
  };
  struct Glyph {
    float x, y, width, height;
    float u, v;
    draw::Color ink;
  };
  enum class Shape {
    disc,
    dot,
    box,
    bar,
    slab,
    frame,
    stroke,
    darken,
    lighten,
    polygon,
    quadrangle,
    inside,
    glyph
  };
  /// The geometry of one draw call.
  struct Run {
    Shape shape;
    int first = 0, end = 0;  // instances; of strokes, indices
    Damage::Rect scissor;
    bool erases = false;  // takes away what lies below
  };

  /// A box or a frame, and how many lie below it at most.
  struct Layered {
    int layer;
    Shape shape;
    Box box;
    bool erases;
  };

  void encode(const draw::List& list, const draw::Batch& batch, Damage& damage);
  void add(const draw::Disc& disc, Damage& damage);
  void add(const draw::Box& box, Damage& damage);
  void lay_boxes();
  void add(const draw::List& list, const draw::Stroke& stroke, Damage& damage);
  void add(const draw::List& list, const draw::Polygon& polygon, Damage& damage);
  void add_large(const Quadrangle& whole);
  void add(const draw::Text& text, Damage& damage);
  bool touches(const Bounds& bounds, Damage& damage) const;
  static void mark(std::span<const Damage::Corner> polygon, const Bounds& seen, Damage& damage);
  bool erases(draw::Color color) const;
  void run(Shape shape, int first, int end, bool erases = false);
  void upload();
  void draw(const Run& run);

  const Functions& gl_;
  int width_, height_;
  double scale_;  // px a page unit
  Program disc_program_, dot_program_, box_program_, bar_program_, slab_program_, frame_program_,
      stroke_program_, polygon_program_, quadrangle_program_, inside_program_, glyph_program_;
  int ground_uniform_;
  VertexArray disc_array_, box_array_, strip_array_, polygon_array_, quadrangle_array_, glyph_array_;
  Buffer index_buffer_, edge_buffer_;
  GLuint edge_texture_ = 0;
  Glyphs glyph_pictures_;

  draw::Color ground_;
  bool transparent_ = false;
  Bounds clip_;  // of the batch at hand
  Damage::Rect scissor_;
  bool halo_ = false;
  std::vector<Run> runs_;
  std::vector<Disc> discs_;
  std::vector<Box> boxes_;
  std::vector<Layered> layered_;  // of the batch at hand
  std::vector<int> layers_;       // boxes that lie on each other, by tile
  Strip strip_;
  std::vector<draw::Node> row_;  // at hand, on whole pixels
  std::vector<Polygon> polygons_;
  std::vector<Damage::Corner> corners_;            // of the polygon at hand
  std::vector<Edge> edges_, outline_;              // of all polygons, band by band; of the one at hand
  std::vector<Quadrangle> quadrangles_, insides_;  // the pixels wholly within one at hand
  std::vector<Glyph> glyphs_;

 public:
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;
};

}  // namespace obscura::gl
