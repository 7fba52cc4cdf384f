#include "app/film/frame_renderer.h"

#include "app/console/memory.h"

namespace obscura::app {

namespace {

gl::Renderer opened(const scene::Film& film, const gl::ContextOptions& context) {
  require_memory_to_draw(double(film.width) * film.height);
  return gl::Renderer(film.width, film.height, context);
}

}  // namespace

FrameRenderer::FrameRenderer(const scene::Scene& scene, const Ahead& ahead, const gl::ContextOptions& context)
    : renderer_(opened(scene.film, context)), painter_(scene, ahead) {}

const media::Image& FrameRenderer::print(const FilmSegment& take, std::size_t frame, bool transparent) {
  const auto draw = [&](std::size_t exposure) -> const media::Image& {
    draw::Picture picture = painter_.frame(take, frame, exposure);
    picture.transparent = transparent;
    return renderer_.draw(picture);
  };
  std::size_t exposures = take.open[frame].size();
  for (const RunSegment& run : take.others) exposures = std::min(exposures, run.open[frame].size());
  if (exposures == 0) {
    ++of_one_instant_;
    return draw(0);
  }
  of_one_instant_ = 0;
  for (std::size_t k = 1; k <= exposures; ++k) exposure_.add(draw(k));
  return exposure_.develop();
}

}  // namespace obscura::app
