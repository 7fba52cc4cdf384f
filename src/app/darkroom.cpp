#include "app/darkroom.h"

namespace obscura::app {

Darkroom::Darkroom(const scene::Scene& scene, const draw::Charts& charts, const gl::ContextOptions& context)
    : renderer_(scene.film.width, scene.film.height, context), artist_(depictor(scene, charts)) {}

const media::Image& Darkroom::print(const Take& take, std::size_t frame, bool transparent) {
  const sim::Snapshot& instant = take.moments[frame];
  const auto draw = [&](const sim::Snapshot& moment) -> const media::Image& {
    draw::Picture picture = artist_.depict(moment, take.ways, instant);
    picture.transparent = transparent;
    return renderer_.draw(picture);
  };
  const std::vector<sim::Snapshot>& open = take.open[frame];
  if (open.empty()) return draw(instant);
  for (const sim::Snapshot& moment : open) exposure_.add(draw(moment));
  return exposure_.develop();
}

}  // namespace obscura::app
