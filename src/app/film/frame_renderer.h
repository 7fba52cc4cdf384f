#pragma once

#include <cstddef>
#include <vector>

#include "app/film/frame_painter.h"
#include "app/run/simulation.h"
#include "gl/renderer.h"
#include "media/exposure.h"
#include "media/image.h"
#include "scene/scene.h"

namespace obscura::app {

/// Makes the pictures of segments, one for each frame: of its instant, or, while things move and the shutter
/// is open, the mean of several. Used from one thread at a time; several work in parallel.
class FrameRenderer {
 public:
  FrameRenderer(const scene::Scene& scene, const Ahead& ahead, const gl::ContextOptions& context);

  /// The picture of a frame of a take, good until the next one. `transparent`: with the ground left out.
  const media::Image& print(const FilmSegment& take, std::size_t frame, bool transparent);

  /// Where the last picture may differ from the one before; nullptr: anywhere.
  const std::vector<media::Rect>* changed() const {
    return of_one_instant_ > 1 ? renderer_.changed() : nullptr;
  }

  /// The same as things, not yet pixels; of the instant alone.
  draw::Picture frame(const FilmSegment& take, std::size_t frame) const {
    return painter_.frame(take, frame);
  }
  /// The pixels of a picture, good until the next ones.
  const media::Image& pixels(const draw::Picture& picture) {
    of_one_instant_ = 0;
    return renderer_.draw(picture);
  }

  const gl::Renderer& renderer() const { return renderer_; }
  const sim::SceneInfo& scene_info(std::size_t run = 0) const { return painter_.scene_info(run); }

 private:
  gl::Renderer renderer_;
  FramePainter painter_;
  media::Exposure exposure_;
  int of_one_instant_ = 0;  // how many pictures were, one after the other
};

}  // namespace obscura::app
