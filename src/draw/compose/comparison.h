#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "draw/compose/depict.h"

namespace obscura::draw {

/// One of several runs that a film shows together.
struct ComparedRun {
  std::string name;
  Color color{};  // of its name, of its lines in plots
};

/// The colour of one of them: those of bodies in turn, then darker and lighter ones.
Color compared_color(int run);
/// And what its lines and names have.
Paint compared_paint(int run, Theme theme);

/// Places for the pictures of `n` runs on a page of this caption, these titles and charts: equal panels, as
/// large as they can be for a world that is `across` times as wide as it is high. Page units, but whole
/// pixels of a picture `height` high.
std::vector<Rect> compared_panels(int n, double across, const Look& look, const std::vector<Chart>& charts,
                                  const Titles& titles, double aspect, int height);

/// Runs in panels beside each other: one caption, one clock, the charts of all of them. Each picture is drawn
/// by an illustrator of its own, for the aspect of its panel.
class Comparison {
 public:
  /// A run at an instant: its own snapshot and the ways of its trails.
  struct Instant {
    const sim::Snapshot& now;    // what is drawn
    const sim::Snapshot& frame;  // of the frame that `now` is a moment of
    std::span<const std::shared_ptr<const sim::Track>> ways;
    Fate fate = Fate::well;
  };

  Comparison(std::vector<ComparedRun> runs, std::vector<Illustrator> artists, std::vector<Rect> panels,
             const Look& look, double aspect, const Charts& charts, const Titles& titles);

  /// The picture of one frame: `time` is that of the clock, s of the run.
  Picture depict(const std::vector<Instant>& runs, double time, double film, double speed) const;

 private:
  std::vector<ComparedRun> runs_;
  std::vector<Illustrator> artists_;
  std::vector<Rect> panels_;
  Look look_;
  Charts charts_;
  Titles titles_;
  Palette colours_;
  Layout layout_;
  double aspect_ = 1;
  // the last still list, and those of the panels that it is made of
  struct Still;
  std::shared_ptr<Still> still_;
};

/// Names of runs that are drawn over each other, in the corner of the window.
void draw_run_names(const std::vector<ComparedRun>& runs, const std::vector<RunInstant>& nows,
                    const Rect& window, double weight, const Palette& colours, List& list);

/// Says on a picture that its run diverges, or has done so: in the corner of the window.
void draw_fate(const RunInstant& now, const Rect& window, double weight, const Palette& colours, List& list);

}  // namespace obscura::draw
