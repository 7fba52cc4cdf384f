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
    : renderer_(opened(scene.film, context)),
      artist_(depictor(scene, ahead)),
      fps_(scene.film.fps),
      speed_(scene.film.speed) {}

const media::Image& FrameRenderer::print(const FilmSegment& take, std::size_t frame, bool transparent) {
  const sim::Snapshot& instant = take.moments[frame];
  const double film = film_time(take.shots[frame], fps_, speed_);
  const auto draw = [&](const sim::Snapshot& moment) -> const media::Image& {
    draw::Picture picture = artist_.depict(moment, take.ways, {instant, film, speed_.speed(film)});
    picture.transparent = transparent;
    return renderer_.draw(picture);
  };
  const std::vector<sim::Snapshot>& open = take.open[frame];
  if (open.empty()) return draw(instant);
  for (const sim::Snapshot& moment : open) exposure_.add(draw(moment));
  return exposure_.develop();
}

}  // namespace obscura::app
