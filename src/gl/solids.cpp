// Solids hide each other by depth, kept as a float that is largest at the eye (or nearly nothing far away):
// its steps are then as fine as the distance asks for, from a centimetre to a kilometre.

#include "gl/solids.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "gl/error.h"

namespace obscura::gl {
namespace {

using draw::kMap;

constexpr int kSamples = 4;
constexpr float kBias = 0.0015f;  // of the map's depth

GLuint framebuffer(const Functions& gl, GLenum attachment, GLenum target, GLuint texture) {
  GLuint name = 0;
  gl.GenFramebuffers(1, &name);
  gl.BindFramebuffer(GL_FRAMEBUFFER, name);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, attachment, target, texture, 0);
  return name;
}

void check(const Functions& gl, const char* what) {
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Error(std::string("a framebuffer for ") + what + " cannot be made");
}

GLuint texture(const Functions& gl, GLenum inner, GLenum format, GLenum type, int width, int height,
               GLenum filter) {
  GLuint name = 0;
  gl.GenTextures(1, &name);
  gl.BindTexture(GL_TEXTURE_2D, name);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GLint(inner), width, height, 0, format, type, nullptr);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  for (GLenum which : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl.TexParameteri(GL_TEXTURE_2D, which, GLint(filter));
  for (GLenum which : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    gl.TexParameteri(GL_TEXTURE_2D, which, GL_CLAMP_TO_EDGE);
  return name;
}

}  // namespace

SolidPainter::SolidPainter(const Functions& gl, int width, int height)
    : gl_(gl),
      width_(width),
      height_(height),
      half_width_((width + 1) / 2),
      half_height_((height + 1) / 2),
      scale_(height / 1080.0),
      solid_program_(gl, "solid.vert", "solid.frag"),
      shadow_program_(gl, "solid.vert", "solid_shadow.frag"),
      grained_program_(gl, "solid.vert", "grained.frag"),
      grained_shadow_program_(gl, "solid.vert", "grained_shadow.frag"),
      marked_program_(gl, "solid.vert", "marked.frag"),
      marked_shadow_program_(gl, "solid.vert", "marked_shadow.frag"),
      water_program_(gl, "water.vert", "water.frag"),
      caster_program_(gl, "caster.vert", "caster.frag"),
      shade_program_(gl, "cover.vert", "shade.frag"),
      resolve_program_(gl, "cover.vert", "resolve.frag"),
      solid_array_(gl, sizeof(draw::Solids::Vertex), 0,
                   {{4, GL_FLOAT, offsetof(draw::Solids::Vertex, at)},
                    {4, GL_UNSIGNED_BYTE, offsetof(draw::Solids::Vertex, lit)},
                    {4, GL_UNSIGNED_BYTE, offsetof(draw::Solids::Vertex, shaded)},
                    {3, GL_FLOAT, offsetof(draw::Solids::Vertex, light)},
                    {2, GL_FLOAT, offsetof(draw::Solids::Vertex, slope)},
                    {4, GL_FLOAT, offsetof(draw::Solids::Vertex, grain)}}),
      caster_array_(gl, 3 * sizeof(float), 0, {{3, GL_FLOAT, 0}}),
      cover_array_(gl, 0, 0, {}),
      index_buffer_(gl, GL_ELEMENT_ARRAY_BUFFER),
      shade_(half_width_, half_height_),
      touched_(width, height) {
  // the samples, and how near they are
  for (GLuint* name : {&samples_texture_, &depth_texture_}) {
    gl.GenTextures(1, name);
    gl.BindTexture(GL_TEXTURE_2D_MULTISAMPLE, *name);
    gl.TexImage2DMultisample(GL_TEXTURE_2D_MULTISAMPLE, kSamples,
                             name == &samples_texture_ ? GL_RGBA8 : GL_DEPTH_COMPONENT32F, width, height,
                             GL_TRUE);
  }
  samples_ = framebuffer(gl, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D_MULTISAMPLE, samples_texture_);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D_MULTISAMPLE, depth_texture_, 0);
  check(gl, "four samples a pixel");

  map_texture_ = texture(gl, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, kMap, kMap, GL_NEAREST);
  map_ = framebuffer(gl, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, map_texture_);
  gl.DrawBuffer(GL_NONE);
  gl.ReadBuffer(GL_NONE);
  check(gl, "shadows");

  dark_texture_ = texture(gl, GL_R8, GL_RED, GL_UNSIGNED_BYTE, half_width_, half_height_, GL_LINEAR);

  for (const Program* program :
       {&solid_program_, &shadow_program_, &grained_program_, &grained_shadow_program_, &marked_program_,
        &marked_shadow_program_, &water_program_}) {
    program->use();
    gl.Uniform2f(program->uniform("per_half_size"), 2.0f / float(width), 2.0f / float(height));
  }
  for (const Program* program : {&shadow_program_, &grained_shadow_program_, &marked_shadow_program_}) {
    program->use();
    gl.Uniform2f(program->uniform("texel"), 1.0f / kMap, kBias);
  }
  shade_program_.use();
  // the half picture may be half a pixel larger
  gl.Uniform2f(shade_program_.uniform("per_size"), 0.5f / float(half_width_), 0.5f / float(half_height_));
}

SolidPainter::~SolidPainter() {
  for (GLuint name : {samples_, map_}) gl_.DeleteFramebuffers(1, &name);
  for (GLuint name : {samples_texture_, depth_texture_, map_texture_, dark_texture_})
    gl_.DeleteTextures(1, &name);
}

void SolidPainter::paint(const draw::Solids& solids, unsigned frame, Damage& damage) {
  const auto px = [&](double units) { return units * scale_; };
  const draw::Rect& w = solids.window;
  Damage::Rect window{std::clamp(int(std::floor(px(w.x) + 1e-6)), 0, width_),
                      std::clamp(int(std::floor(px(w.y) + 1e-6)), 0, height_), 0, 0};
  window.width = std::clamp(int(std::ceil(px(w.x + w.width) - 1e-6)), 0, width_) - window.x;
  window.height = std::clamp(int(std::ceil(px(w.y + w.height) - 1e-6)), 0, height_) - window.y;
  if (window.width <= 0 || window.height <= 0) return;
  gl_.Enable(GL_SCISSOR_TEST);
  // where bodies are near it, and where the light does not reach it
  if (solids.touch.a > 0) paint_ground(solids, solids.touches, solids.touch, frame, window, damage);
  if (solids.shade.a > 0) paint_ground(solids, solids.shades, solids.shade, frame, window, damage);
  if (solids.triangles.empty() && solids.shadowed.empty() && solids.water.empty()) {
    gl_.Disable(GL_SCISSOR_TEST);
    gl_.BindFramebuffer(GL_FRAMEBUFFER, frame);
    return;
  }

  // corners in px, and where they are
  const Bounds seen{float(window.x), float(window.y), float(window.x + window.width),
                    float(window.y + window.height)};
  vertices_ = solids.vertices;
  for (draw::Solids::Vertex& v : vertices_) {
    v.at[0] = float(v.at[0] * scale_);
    v.at[1] = float(v.at[1] * scale_);
  }
  touched_.clear();
  const auto touch = [&](const std::vector<std::uint32_t>& triangles) {
    for (std::size_t i = 0; i < triangles.size(); i += 3) {
      Bounds b{1e9f, 1e9f, -1e9f, -1e9f};
      for (std::size_t k = i; k < i + 3; ++k) {
        const auto& at = vertices_[triangles[k]].at;
        if (at[3] <= 0) {
          b = seen;
          break;
        }
        const float x = at[0] / at[3], y = at[1] / at[3];
        b = {std::min(b.x0, x - 1), std::min(b.y0, y - 1), std::max(b.x1, x + 1), std::max(b.y1, y + 1)};
      }
      b = b & seen;
      if (any(b)) touched_.mark(b);
    }
  };
  touch(solids.triangles);
  touch(solids.shadowed);
  touch(solids.water);
  damage.add(touched_);

  const bool map = !solids.casters.empty() && !solids.shadowed.empty();
  if (map) paint_map(solids);

  // by depth
  gl_.BindFramebuffer(GL_FRAMEBUFFER, samples_);
  gl_.ClearColor(0, 0, 0, 0);
  gl_.ClearDepth(0);
  for (const Damage::Rect& r : touched_.rects()) {
    gl_.Scissor(r.x, r.y, r.width, r.height);
    gl_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  }
  gl_.Scissor(window.x, window.y, window.width, window.height);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthFunc(GL_GREATER);
  if (gl_.ClipControl) gl_.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  solid_array_.upload(vertices_);
  solid_array_.bind();
  indices_ = solids.triangles;
  indices_.insert(indices_.end(), solids.shadowed.begin(), solids.shadowed.end());
  indices_.insert(indices_.end(), solids.water.begin(), solids.water.end());
  index_buffer_.upload(indices_);
  const auto draw = [&](const Program& program, std::size_t first, std::size_t count) {
    if (count == 0) return;
    program.use();
    gl_.DrawElements(GL_TRIANGLES, GLsizei(count), GL_UNSIGNED_INT,
                     reinterpret_cast<const void*>(sizeof(std::uint32_t) * first));
  };
  const Program& plain = solids.grained ? grained_program_ : solids.marked ? marked_program_ : solid_program_;
  const Program& shadowed = solids.grained  ? grained_shadow_program_
                            : solids.marked ? marked_shadow_program_
                                            : shadow_program_;
  draw(plain, 0, solids.triangles.size());
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, map_texture_);
  if (map) {
    shadowed.use();
    gl_.Uniform2f(shadowed.uniform("soft"), solids.soft[0], solids.soft[1]);
  }
  draw(map ? shadowed : plain, solids.triangles.size(), solids.shadowed.size());
  if (!solids.water.empty()) {
    gl_.Enable(GL_BLEND);
    gl_.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    draw(water_program_, solids.triangles.size() + solids.shadowed.size(), solids.water.size());
    gl_.Disable(GL_BLEND);
  }
  if (gl_.ClipControl) gl_.ClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  gl_.Disable(GL_DEPTH_TEST);

  // the samples' means, over the picture
  gl_.BindFramebuffer(GL_FRAMEBUFFER, frame);
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_.BindTexture(GL_TEXTURE_2D_MULTISAMPLE, samples_texture_);
  resolve_program_.use();
  cover_array_.bind();
  for (const Damage::Rect& r : touched_.rects()) {
    gl_.Scissor(r.x, r.y, r.width, r.height);
    gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  }
  gl_.Disable(GL_BLEND);
  gl_.Disable(GL_SCISSOR_TEST);
}

void SolidPainter::paint_ground(const draw::Solids& solids, const std::vector<draw::Solids::Shade>& shades,
                                draw::Color ink, unsigned frame, const Damage::Rect& window, Damage& damage) {
  // each ray's shadows are shifted within a pixel of the half picture: their mean has smooth edges
  const Bounds seen{float(window.x), float(window.y), float(window.x + window.width),
                    float(window.y + window.height)};
  const auto shift = [](const draw::Solids::Shade& shade) {
    const int ray = std::countr_zero(shade.rays);
    return shade.rays == ~0u ? draw::Point(0, 0)
                             : draw::Point(double(ray * 5 % 32) / 16 - 1, double(ray * 13 % 32) / 16 - 1);
  };
  touched_.clear();
  seen_.clear();
  for (const draw::Solids::Shade& shade : shades) {
    Bounds b{1e9f, 1e9f, -1e9f, -1e9f};
    for (int i = shade.begin; i < shade.end; ++i) {
      const draw::Point p = solids.points[std::size_t(i)] * scale_;
      const auto x = float(p.x()), y = float(p.y());
      b = {std::min(b.x0, x - 4), std::min(b.y0, y - 4), std::max(b.x1, x + 4), std::max(b.y1, y + 4)};
    }
    b = b & seen;
    if (!any(b)) continue;
    touched_.mark(b);
    seen_.push_back(&shade);
  }
  if (seen_.empty()) return;
  damage.add(touched_);

  // how dark it is, two pixels by two
  const auto halved = [&](const Damage::Rect& r) {
    const int x = std::max(r.x / 2 - 1, 0), y = std::max(r.y / 2 - 1, 0);
    return Damage::Rect{x, y, std::min((r.x + r.width + 1) / 2 + 1, half_width_) - x,
                        std::min((r.y + r.height + 1) / 2 + 1, half_height_) - y};
  };
  for (const Damage::Rect& r : touched_.bands()) shade_.clear(halved(r));
  for (const draw::Solids::Shade* shade : seen_) {
    const draw::Point by = shift(*shade);
    corners_.clear();
    for (int i = shade->begin; i < shade->end; ++i)
      corners_.push_back((solids.points[std::size_t(i)] * scale_ + by) / 2);
    shade_.add(corners_, shade->rays);
  }
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, dark_texture_);
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl_.PixelStorei(GL_UNPACK_ROW_LENGTH, half_width_);
  for (const Damage::Rect& r : touched_.bands()) {
    const Damage::Rect h = halved(r);
    shade_.count(h);
    gl_.TexSubImage2D(GL_TEXTURE_2D, 0, h.x, h.y, h.width, h.height, GL_RED, GL_UNSIGNED_BYTE,
                      shade_.dark().data() + std::ptrdiff_t(half_width_) * h.y + h.x);
  }
  gl_.PixelStorei(GL_UNPACK_ROW_LENGTH, 0);

  // over the picture
  gl_.BindFramebuffer(GL_FRAMEBUFFER, frame);
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  cover_array_.bind();
  shade_program_.use();
  const float alpha = float(ink.a) / 255.0f;
  gl_.Uniform4f(shade_program_.uniform("shade"), float(ink.r) / 255.0f * alpha, float(ink.g) / 255.0f * alpha,
                float(ink.b) / 255.0f * alpha, alpha);
  for (const Damage::Rect& r : touched_.rects()) {
    // the window's edge cuts it
    const int x0 = std::max(r.x, window.x), y0 = std::max(r.y, window.y);
    const int x1 = std::min(r.x + r.width, window.x + window.width),
              y1 = std::min(r.y + r.height, window.y + window.height);
    if (x1 <= x0 || y1 <= y0) continue;
    gl_.Scissor(x0, y0, x1 - x0, y1 - y0);
    gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  }
  gl_.Disable(GL_BLEND);
}

void SolidPainter::paint_map(const draw::Solids& solids) {
  gl_.Viewport(0, 0, kMap, kMap);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, map_);
  gl_.Scissor(0, 0, kMap, kMap);
  gl_.ClearDepth(1);
  gl_.Clear(GL_DEPTH_BUFFER_BIT);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthFunc(GL_LESS);
  caster_program_.use();
  caster_array_.upload(solids.casters);
  caster_array_.bind();
  gl_.DrawArrays(GL_TRIANGLES, 0, GLsizei(solids.casters.size()));
  gl_.Disable(GL_DEPTH_TEST);
  gl_.Viewport(0, 0, width_, height_);
}

}  // namespace obscura::gl
