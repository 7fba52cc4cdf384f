#include "app/film/frame_painter.h"

namespace obscura::app {

FramePainter::FramePainter(const scene::Scene& scene, const Ahead& ahead)
    : artists_(depictors(scene, ahead)),
      aspect_(double(scene.film.width) / scene.film.height),
      fps_(scene.film.fps),
      speed_(scene.film.speed) {
  if (!ahead.runs) return;
  for (const Ahead::Run& run : *ahead.runs) names_.push_back(run.look);
  if (scene.film.over) return;
  for (const Ahead::Run& run : *ahead.runs) panels_.push_back(run.panel);
  comparison_.emplace(names_, artists_, panels_, scene.look, aspect_, ahead.charts,
                      draw::laid_out(scene.film.titles, aspect_, scene.look.type_scale));
}

draw::Picture FramePainter::frame(const FilmSegment& take, std::size_t frame, std::size_t exposure) const {
  const double film = film_time(take.shots[frame], fps_, speed_), speed = speed_.speed(film),
               time = sim::value(take.shots[frame].time);
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

std::vector<draw::Rect> FramePainter::panels() const {
  if (comparison_) return panels_;
  return std::vector<draw::Rect>(artists_.size(), {0, 0, 1080 * aspect_, 1080});
}

std::vector<draw::Rect> FramePainter::windows() const {
  std::vector<draw::Rect> all;
  for (std::size_t i = 0; i < artists_.size(); ++i) {
    draw::Rect window = artists_[i].window();
    if (comparison_) {
      const draw::Rect& panel = panels_[i];
      const double k = panel.height / 1080;
      window = {panel.x + k * window.x, panel.y + k * window.y, k * window.width, k * window.height};
    }
    all.push_back(window);
  }
  return all;
}

}  // namespace obscura::app
