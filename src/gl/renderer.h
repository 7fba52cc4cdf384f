#pragma once

#include <memory>
#include <string>
#include <vector>

#include "draw/picture/list.h"
#include "gl/context.h"
#include "media/image.h"

namespace obscura::gl {

/// Puts pictures down as pixels, in a context of its own. Used from one thread at a time, not always the
/// same: it is current to a thread only while it draws. Several draw side by side.
class Renderer {
 public:
  /// Throws gl::Error where there is no context or the size is beyond its limit.
  Renderer(int width, int height, const ContextOptions& options = {});
  ~Renderer();
  Renderer(Renderer&&) noexcept;

  /// Draws into `out` (made the right size). The still list is drawn anew only when it is another one than
  /// last time.
  void draw(const draw::Picture& picture, media::Image& out);
  /// The same without a copy of what did not change. The image is good until the next call.
  const media::Image& draw(const draw::Picture& picture);
  /// Where the last image may differ from the one before, without overlap; nullptr: anywhere.
  const std::vector<media::Rect>* changed() const;

  /// GL_VERSION, GL_RENDERER, and the back end, for the origin.
  std::string version() const;
  std::string device() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace obscura::gl
