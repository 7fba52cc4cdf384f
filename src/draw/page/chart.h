#pragma once

#include <vector>

#include "draw/page/measure.h"
#include "draw/page/plot.h"
#include "draw/picture/list.h"
#include "draw/picture/theme.h"

namespace obscura::draw {

/// A plot over time beside a film's picture, in step with it.
struct Chart : Measured {
  enum class Place { below, right };  // of the picture
  Place place = Place::below;
  double share = 0.3;  // of the picture's height, or width
};

/// The charts of a run on the page of its film: axes of the whole run, and on them what has happened up to
/// now.
class Charts {
 public:
  Charts() = default;
  /// None, and so much of the page's foot is left free.
  explicit Charts(double foot) : foot_(foot) {}
  /// `plots`: one for each chart, from a run of `seconds`, which the axes span. `aspect`: of the page,
  /// at whose foot `foot` is left free.
  Charts(const std::vector<Chart>& charts, const std::vector<Plot>& plots, const Palette& colours,
         double aspect, double seconds, const sim::SceneInfo& cast, double foot, double type_scale);

  bool empty() const { return panels_.empty(); }
  /// How much of the page they take, page units.
  double right() const { return right_; }
  double below() const { return below_ + foot_; }

  /// Axes and ticks: the things that do not move.
  void draw_still(List& list) const;
  /// The lines up to `now`, where they are now, and their names there.
  void draw_lines(const sim::Snapshot& now, List& list) const;

 private:
  struct Panel {
    Chart chart;
    Plot plot;
    PlotArea area;
    // where the names of the lines are beside their heads: how far up or down at each of the plot's times
    std::vector<std::vector<double>> offsets;
    double offset(std::size_t line, double time) const;
  };
  void place_names(Panel& panel) const;
  std::vector<Panel> panels_;
  Palette colours_;
  sim::SceneInfo cast_;
  double right_ = 0, below_ = 0, foot_ = 0;
};

}  // namespace obscura::draw
