#pragma once

#include <cstdint>
#include <vector>

#include "draw/picture/solids.h"
#include "gl/buffer.h"
#include "gl/damage.h"
#include "gl/program.h"
#include "gl/shade.h"

namespace obscura::gl {

/// Puts down what is drawn by depth, with four samples a pixel: shadows on the ground, then solids, each of
/// them only where there is something.
class SolidPainter {
 public:
  SolidPainter(const Functions& gl, int width, int height);
  ~SolidPainter();
  SolidPainter(const SolidPainter&) = delete;
  SolidPainter& operator=(const SolidPainter&) = delete;

  /// Draws over what `frame` holds, and leaves it bound. Marks what it draws on.
  void paint(const draw::Solids& solids, unsigned frame, Damage& damage);

 private:
  void paint_ground(const draw::Solids& solids, const std::vector<draw::Solids::Shade>& shades,
                    draw::Color ink, unsigned frame, const Damage::Rect& window, Damage& damage);
  void paint_map(const draw::Solids& solids);

  const Functions& gl_;
  int width_, height_, half_width_, half_height_;
  double scale_;  // px a page unit
  Program solid_program_, shadow_program_, grained_program_, grained_shadow_program_, marked_program_,
      marked_shadow_program_, water_program_, caster_program_, shade_program_, resolve_program_;
  VertexArray solid_array_, caster_array_, cover_array_;
  Buffer index_buffer_;
  GLuint samples_texture_ = 0, depth_texture_ = 0, map_texture_ = 0, dark_texture_ = 0;
  GLuint samples_ = 0, map_ = 0;  // framebuffers
  Shade shade_;                   // of the half picture
  std::vector<draw::Solids::Vertex> vertices_;
  std::vector<std::uint32_t> indices_;
  std::vector<const draw::Solids::Shade*> seen_;
  std::vector<draw::Point> corners_;
  Damage touched_;
};

}  // namespace obscura::gl
