#pragma once

#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "draw/compose/annotate.h"
#include "draw/page/marks.h"
#include "draw/picture/world_line.h"

namespace obscura::draw {

class Illustrator;

/// What is known of a run before its film: what marks need to be the same in every frame, whichever machine
/// draws it.
struct RunAhead {
  std::vector<sim::Snapshot> moments;       // in the order of time
  std::vector<double> films;                // s of the film: when it shows each first
  std::vector<sim::Snapshot> between;       // more instants, for the lengths of arrows
  std::vector<sim::Snapshot> ghosts;        // one a ghost of the marks
  std::shared_ptr<const sim::Track> track;  // of the bodies with paths
  std::vector<double> between_films{};      // s of the film: when it shows the instants between
  // of the runs that are drawn over it, in the order of time: their bodies are there, too
  std::vector<std::vector<sim::Snapshot>> others{};
};

/// The scales of a film's arrows: those of `given` that are not 0, and for the others the ones at which all
/// arrows of their kind are seen whole in the whole run.
Scales run_scales(const Marks& marks, const Illustrator& artist, const RunAhead& ahead, const Scales& given);

/// The marks of a film. Arrows have one scale, values one number of digits and each label a place that it
/// leaves only slowly, all found from the run ahead: so a frame is the same in a still, a shard and the whole
/// film. docs/design.md, "Marks".
class Annotations {
 public:
  /// `given`: scales that the scene sets; those that are 0 are chosen by the run. `fps`: of the film.
  /// `rows`: of its pixels; words keep to whole ones. 0: how many is not known, and Text::whole says so.
  Annotations(const Marks& marks, const Illustrator& artist, RunAhead ahead, const Scales& given, double fps,
              int rows);

  /// What lies in the world: the paths of points up to an instant.
  std::vector<WorldLine> lines(const sim::Snapshot& now, double film) const;
  /// The earlier instants that are shown now, with their marks.
  std::vector<std::pair<const sim::Snapshot*, const Marks::Ghost*>> ghosts(const sim::Snapshot& now,
                                                                           double film) const;
  /// Arrows and words over a panel's picture.
  void draw(int panel, const Projection& projection, const sim::Snapshot& now, double film, List& list) const;

  /// The arrows that are there and whose words are never strong enough to be read, as the arrows are too
  /// short, at the instants that the plan looks at: numbers of the marks' vectors, and the largest value of
  /// each, of its quantity's unit.
  const std::vector<std::pair<int, double>>& never_seen() const { return never_seen_; }

  const Scales& scales() const { return scales_; }
  const LabelPlan& plan(int panel) const { return plans_[std::size_t(panel)]; }

 private:
  void plan_passing(const RunAhead& ahead, const Illustrator& artist, int panel, LabelPlan& plan) const;

  Marks marks_;
  sim::SceneInfo cast_;
  Look look_;
  Palette colours_;
  Lettering lettering_;
  Scales scales_;
  std::vector<LabelPlan> plans_;  // one a panel
  std::vector<std::pair<int, double>> never_seen_;
  std::vector<sim::Snapshot> ghosts_;
  std::vector<std::vector<sim::Track::Point>> paths_;  // one a path of the marks, of its point
};

/// The points of the paths of marks since the run's start, up to `now` where it is given, as many as their
/// curves need: they are no farther than `tolerance` (m) from the line through them.
std::vector<std::vector<sim::Track::Point>> paths_of(
    const Marks& marks, std::span<const std::shared_ptr<const sim::Track>> tracks, double tolerance,
    const sim::Snapshot* now = nullptr);

/// Those paths up to an instant.
std::vector<WorldLine> path_lines(const Marks& marks,
                                  const std::vector<std::vector<sim::Track::Point>>& paths,
                                  const sim::Snapshot& now, double film);

}  // namespace obscura::draw
