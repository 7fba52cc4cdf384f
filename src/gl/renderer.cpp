#include "gl/renderer.h"

#include <algorithm>
#include <array>
#include <optional>
#include <tuple>
#include <utility>

#include "gl/damage.h"
#include "gl/error.h"
#include "gl/functions.h"
#include "gl/painter.h"
#include "gl/solids.h"

namespace obscura::gl {
namespace {

/// A framebuffer over one texture, RGBA8.
class Canvas {
 public:
  Canvas(const Functions& gl, int width, int height) : gl_(gl) {
    gl.GenTextures(1, &texture_);
    gl.BindTexture(GL_TEXTURE_2D, texture_);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    gl.GenFramebuffers(1, &framebuffer_);
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_, 0);
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      throw Error("a framebuffer of " + std::to_string(width) + " x " + std::to_string(height) +
                  " cannot be made");
    }
  }
  ~Canvas() {
    gl_.DeleteFramebuffers(1, &framebuffer_);
    gl_.DeleteTextures(1, &texture_);
  }
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  void bind() const { gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_); }
  GLuint texture() const { return texture_; }
  GLuint framebuffer() const { return framebuffer_; }

 private:
  const Functions& gl_;
  GLuint texture_ = 0, framebuffer_ = 0;
};

void check_size(const Functions& gl, int width, int height) {
  std::array<GLint, 2> viewport{};
  gl.GetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport.data());
  const int limit = std::min(
      {gl.integer(GL_MAX_TEXTURE_SIZE), gl.integer(GL_MAX_RENDERBUFFER_SIZE), viewport[0], viewport[1]});
  if (width >= 1 && height >= 1 && width <= limit && height <= limit) return;
  throw Error("a picture of " + std::to_string(width) + " x " + std::to_string(height) +
              " cannot be drawn: this OpenGL's limit is " + std::to_string(limit) + " px a side");
}

// premultiplied to plain, to the nearest level
void unpremultiply(std::uint8_t* p, int count) {
  for (const std::uint8_t* end = p + std::ptrdiff_t(4) * count; p < end; p += 4) {
    const int a = p[3];
    if (a == 255) continue;
    for (int c = 0; c < 3; ++c) p[c] = std::uint8_t(a == 0 ? 0 : std::min((p[c] * 255 + a / 2) / a, 255));
  }
}

// what of a list becomes pixels
template <class List>
auto drawn_of(List& list) {
  return std::tie(list.batches, list.discs, list.boxes, list.strokes, list.polygons, list.texts, list.nodes,
                  list.points, list.clips);
}

constexpr int kSteady = 4;      // pictures in which the head of a list is the same before it is laid
constexpr int kLongest = 1024;  // the same of what moved again and again

/// Holds a context current while it draws, and leaves the thread free of it after.
class Current {
 public:
  explicit Current(Context& context) : context_(context) { context.make_current(); }
  ~Current() { context_.release(); }
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;

 private:
  Context& context_;
};

}  // namespace

struct Renderer::Impl {
  int width, height;
  std::unique_ptr<Context> context;
  // the members below live in the context and are destroyed before it
  Functions gl;
  std::string version, device;
  std::string trouble;     // the last GL error of a debug build
  Canvas backdrop, frame;  // ground, still list and what is laid on it; the picture
  Painter painter;
  std::optional<SolidPainter> solid_painter;  // from the first picture in space on
  Damage damage;                              // what the last picture drew over the backdrop
  bool drawn = false;
  draw::Color ground;
  bool transparent = false;
  std::shared_ptr<const draw::List> still;
  /// The head of what moves that has not moved for some time: it is drawn once, on the backdrop.
  struct Laid {
    Reach reach;          // of the last list
    Damage damage;        // where
    Reach steady;         // the head that was the same
    int pictures = 0;     // in so many
    int wait = kSteady;   // before it is laid
    int since = kSteady;  // pictures since some of it moved again
  } laid;
  draw::List last;                   // what moved in the last picture
  bool last_flat = false;            // whether that is known, and was all of it
  media::Image image;                // what was read last
  std::vector<media::Rect> changed;  // where
  bool all_changed = true;

  Impl(int w, int h, const ContextOptions& options)
      : width(w),
        height(h),
        context(create(options)),
        gl((checked(*context, w, h))),
        backdrop(gl, w, h),
        frame(gl, w, h),
        painter(gl, w, h),
        damage(w, h),
        laid{.reach = {}, .damage = Damage(w, h), .steady = {}} {
    version = gl.string(GL_VERSION);
    device = gl.string(GL_RENDERER) + ", " + context->backend();
#ifndef NDEBUG
    if (gl.DebugMessageCallback) {
      gl.Enable(GL_DEBUG_OUTPUT);
      gl.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
      gl.DebugMessageCallback(
          [](GLenum, GLenum type, GLuint, GLenum, GLsizei, const GLchar* text, const void* impl) {
            // no exception may cross the callback
            if (type == GL_DEBUG_TYPE_ERROR) static_cast<Impl*>(const_cast<void*>(impl))->trouble = text;
          },
          this);
    }
#endif
  }

  static Functions checked(const Context& context, int w, int h) {
    Functions functions(context);
    check_size(functions, w, h);
    return functions;
  }

  void draw_backdrop(const draw::Picture& picture);
  void lay(const draw::Picture& picture, Reach same);
  void restore();
  void read(const Damage::Rect& rect);
};

void Renderer::Impl::draw_backdrop(const draw::Picture& picture) {
  ground = picture.ground;
  transparent = picture.transparent;
  still = picture.still;
  backdrop.bind();
  const auto level = [&](std::uint8_t c) { return transparent ? 0.0f : float(c) / 255.0f; };
  gl.ClearColor(level(ground.r), level(ground.g), level(ground.b), level(255));
  gl.Clear(GL_COLOR_BUFFER_BIT);
  Damage none(width, height);
  if (still) painter.paint(*still, ground, transparent, none);
}

/// Keeps the head of what moves on the backdrop, of which `same` is as in the last picture.
void Renderer::Impl::lay(const draw::Picture& picture, Reach same) {
  const auto put = [&](Reach reach) {
    backdrop.bind();
    painter.paint(picture.moving, laid.reach, reach, ground, transparent, laid.damage);
    laid.reach = reach;
  };
  if (same < laid.reach) {
    // Some of it moves again: what lies below that stays, what lies above is waited for longer. Where more
    // begins to move soon after, as in a pile that is struck, all is waited for.
    const bool soon = laid.since < laid.wait;
    draw_backdrop(picture);
    damage.add(laid.damage);
    const int wait = std::min(2 * laid.wait, kLongest);
    laid = {.reach = {}, .damage = Damage(width, height), .steady = {}, .wait = wait, .since = 0};
    if (!soon) put(same);
  }
  laid.since = std::min(laid.since + 1, kLongest);
  laid.steady = laid.pictures == 0 ? same : std::min(laid.steady, same);
  if (++laid.pictures < laid.wait) return;
  laid.pictures = 0;
  if (laid.steady <= laid.reach) return;
  put(laid.steady);
}

void Renderer::Impl::restore() {
  const auto copy = [&](const Damage::Rect& r) {
    if (gl.CopyImageSubData) {
      gl.CopyImageSubData(backdrop.texture(), GL_TEXTURE_2D, 0, r.x, r.y, 0, frame.texture(), GL_TEXTURE_2D,
                          0, r.x, r.y, 0, r.width, r.height, 1);
    } else {
      gl.BindFramebuffer(GL_READ_FRAMEBUFFER, backdrop.framebuffer());
      gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, frame.framebuffer());
      gl.BlitFramebuffer(r.x, r.y, r.x + r.width, r.y + r.height, r.x, r.y, r.x + r.width, r.y + r.height,
                         GL_COLOR_BUFFER_BIT, GL_NEAREST);
    }
  };
  if (drawn) {
    for (const Damage::Rect& rect : damage.rects()) copy(rect);
  } else {
    copy({0, 0, width, height});
  }
  damage.clear();
  drawn = true;
}

void Renderer::Impl::read(const Damage::Rect& rect) {
  gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
  gl.PixelStorei(GL_PACK_ROW_LENGTH, width);
  std::uint8_t* corner = image.row(rect.y) + 4 * rect.x;
  gl.ReadPixels(rect.x, rect.y, rect.width, rect.height, GL_RGBA, GL_UNSIGNED_BYTE, corner);
  for (int y = rect.y; transparent && y < rect.y + rect.height; ++y)
    unpremultiply(image.row(y) + 4 * rect.x, rect.width);
}

Renderer::Renderer(int width, int height, const ContextOptions& options)
    : impl_(std::make_unique<Impl>(width, height, options)) {
  impl_->context->release();
}

Renderer::~Renderer() {
  // delete the context's objects inside it
  if (impl_) impl_->context->make_current();
}

Renderer::Renderer(Renderer&&) noexcept = default;

void Renderer::draw(const draw::Picture& picture, media::Image& out) { out = draw(picture); }

const media::Image& Renderer::draw(const draw::Picture& picture) {
  Impl& my = *impl_;

  // a film that stands still shows the same picture again
  const bool flat = picture.solids.empty();
  const bool same_backdrop = my.drawn && my.still == picture.still && my.ground == picture.ground &&
                             my.transparent == picture.transparent;
  if (same_backdrop && flat && my.last_flat && drawn_of(my.last) == drawn_of(picture.moving)) {
    my.all_changed = false;
    my.changed.clear();
    return my.image;
  }
  const Reach same = same_backdrop && flat && my.last_flat ? common_head(my.last, picture.moving) : Reach();
  my.last_flat = false;

  const Current current(*my.context);
  my.gl.Viewport(0, 0, my.width, my.height);

  // ground and still list, when they are others than last time
  if (!same_backdrop) {
    my.drawn = false;
    my.draw_backdrop(picture);
    my.laid = {.reach = {}, .damage = Damage(my.width, my.height), .steady = {}};
  }
  my.lay(picture, same);

  // moving things, over the rest of the backdrop from the last picture
  const bool anew = !my.drawn;
  Damage changed = my.damage;
  my.restore();
  my.drawn = false;  // until it is whole
  my.frame.bind();
  for (const auto& solids : picture.solids) {
    if (!my.solid_painter) my.solid_painter.emplace(my.gl, my.width, my.height);
    my.solid_painter->paint(*solids, my.frame.framebuffer(), my.damage);
  }
  my.frame.bind();
  my.painter.paint(picture.moving, my.laid.reach, end_of(picture.moving), picture.ground, picture.transparent,
                   my.damage);

  // read the pixels that either picture drew on
  my.image.width = my.width;
  my.image.height = my.height;
  my.image.pixels.resize(std::size_t(4) * my.width * my.height);
  changed.add(my.damage);
  my.changed.assign(1, {0, 0, my.width, my.height});
  my.all_changed = anew;
  if (!anew) my.changed = changed.bands();
  for (const Damage::Rect& rect : my.changed) my.read(rect);

  const GLenum error = my.gl.GetError();
  if (error != GL_NO_ERROR || !my.trouble.empty()) {
    throw Error("OpenGL error " + std::to_string(error) + " while drawing" +
                (my.trouble.empty() ? "" : ": " + std::exchange(my.trouble, "")));
  }
  my.drawn = true;
  my.last_flat = flat;
  if (flat) drawn_of(my.last) = drawn_of(picture.moving);
  return my.image;
}

const std::vector<media::Rect>* Renderer::changed() const {
  return impl_->all_changed ? nullptr : &impl_->changed;
}

std::string Renderer::version() const { return impl_->version; }
std::string Renderer::device() const { return impl_->device; }

}  // namespace obscura::gl
