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
      artists_(depictors(scene, ahead)),
      fps_(scene.film.fps),
      speed_(scene.film.speed) {
  if (!ahead.runs) return;
  std::vector<draw::Rect> panels;
  for (const Ahead::Run& run : *ahead.runs) {
    names_.push_back(run.look);
    panels.push_back(run.panel);
  }
  if (scene.film.over) return;
  const double aspect = double(scene.film.width) / scene.film.height;
  comparison_.emplace(names_, artists_, panels, scene.look, aspect, ahead.charts,
                      draw::laid_out(scene.film.titles, aspect, scene.look.type_scale));
}

// the picture of a frame, or of one of the instants while its shutter is open, from 1
draw::Picture FrameRenderer::picture(const FilmSegment& take, std::size_t frame, double film,
                                     std::size_t exposure) const {
  const double speed = speed_.speed(film), time = sim::value(take.shots[frame].time);
  const auto drawn = [&](const RunSegment& run) -> const sim::Snapshot& {
    return exposure == 0 ? run.moments[frame] : run.open[frame][exposure - 1];
  };
  if (comparison_) {
    std::vector<draw::Comparison::Instant> instants;
    for (std::size_t i = 0; i < artists_.size(); ++i)
      instants.push_back(
          {drawn(take.run(i)), take.run(i).moments[frame], take.run(i).ways, take.run(i).fates[frame]});
    return comparison_->depict(instants, time, film, speed);
  }
  draw::FrameInstant at{take.moments[frame], film, speed, take.fates[frame]};
  draw::RunsOver over{&names_, {}, time};
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const RunSegment& run = take.run(i);
    over.runs.push_back({&artists_[i], &drawn(run), &run.moments[frame], run.ways, run.fates[frame]});
  }
  if (!names_.empty()) at.over = &over;
  return artists_.front().depict(drawn(take), take.ways, at);
}

draw::Picture FrameRenderer::frame(const FilmSegment& take, std::size_t frame) const {
  return picture(take, frame, film_time(take.shots[frame], fps_, speed_), 0);
}

const media::Image& FrameRenderer::print(const FilmSegment& take, std::size_t frame, bool transparent) {
  const double film = film_time(take.shots[frame], fps_, speed_);
  const auto draw = [&](std::size_t exposure) -> const media::Image& {
    draw::Picture picture = this->picture(take, frame, film, exposure);
    picture.transparent = transparent;
    return renderer_.draw(picture);
  };
  std::size_t exposures = take.open[frame].size();
  for (const RunSegment& run : take.others) exposures = std::min(exposures, run.open[frame].size());
  if (exposures == 0) return draw(0);
  for (std::size_t k = 1; k <= exposures; ++k) exposure_.add(draw(k));
  return exposure_.develop();
}

}  // namespace obscura::app
