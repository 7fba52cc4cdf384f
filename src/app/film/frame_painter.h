#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "app/run/simulation.h"
#include "draw/compose/comparison.h"
#include "draw/compose/depict.h"
#include "scene/scene.h"

namespace obscura::app {

/// Makes the pictures of segments as things, not yet pixels. Used from one thread at a time.
class FramePainter {
 public:
  FramePainter(const scene::Scene& scene, const Ahead& ahead);

  /// The picture of a frame of a take; or of the instant `exposure` (from 1) while its shutter is open.
  draw::Picture frame(const FilmSegment& take, std::size_t frame, std::size_t exposure = 0) const;

  const std::vector<draw::Illustrator>& artists() const { return artists_; }
  const sim::SceneInfo& scene_info(std::size_t run = 0) const { return artists_[run].scene_info(); }
  /// The parts of the page that show the worlds of the runs: in space one for all.
  std::vector<draw::Rect> windows() const;
  /// The parts of the page that the runs have, one a run.
  std::vector<draw::Rect> panels() const;

 private:
  std::vector<draw::Illustrator> artists_;      // one a run
  std::vector<draw::ComparedRun> names_;        // of several
  std::vector<draw::Rect> panels_;              // of several beside each other
  std::optional<draw::Comparison> comparison_;  // of those
  double aspect_;
  sim::Rational fps_;
  draw::Pace speed_;
};

}  // namespace obscura::app
