#pragma once

#include <utility>
#include <vector>

#include "draw/page/measure.h"
#include "draw/page/names_beside.h"
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

/// Whether a run is all right at an instant; `ended`: this is its last finite state.
enum class Fate { well, diverges, ended };

/// An instant of one of several runs.
struct RunInstant {
  const sim::Snapshot* now = nullptr;
  Fate fate = Fate::well;
};

/// The charts of a run on the page of its film: axes of the whole run, and on them what has happened up to
/// now.
class Charts {
 public:
  Charts() = default;
  /// None, and so much of the page's foot is left free.
  explicit Charts(double foot) : foot_(foot) {}
  /// `plots`: one for each chart, from a run of `seconds`, which the axes span. `aspect`: of the page,
  /// at whose foot `foot` is left free. Of several runs, one of each of `casts`, a plot has first the lines
  /// of the first, then those of the second.
  Charts(const std::vector<Chart>& charts, const std::vector<Plot>& plots, const Palette& colours,
         double aspect, double seconds, const std::vector<sim::SceneInfo>& casts, double foot,
         double type_scale);
  /// What charts take of the right and of the foot of a page, page units.
  static std::pair<double, double> room(const std::vector<Chart>& charts, double aspect);

  /// How high the axes of charts are, page units: of a key above them it is not known yet.
  static std::vector<double> axis_heights(const std::vector<Chart>& charts, double aspect, double foot,
                                          double type_scale);

  /// How wide charts are, axes and all that is beside them, page units.
  static std::vector<double> widths(const std::vector<Chart>& charts, double aspect, double foot);

  bool empty() const { return panels_.empty(); }
  /// How much of the page they take, page units.
  double right() const { return right_; }
  double below() const { return below_ + foot_; }

  /// A chart and where its values lie on the page.
  struct Shown {
    const Chart& chart;
    const Plot& plot;
    const PlotArea& area;
  };
  std::vector<Shown> shown() const;

  /// Axes and ticks: the things that do not move.
  void draw_still(List& list) const;
  /// The lines up to `now`, where they are now, and their names there.
  void draw_lines(const sim::Snapshot& now, List& list) const {
    draw_lines(std::vector{RunInstant{&now}}, list);
  }
  /// The same of several runs.
  void draw_lines(const std::vector<RunInstant>& nows, List& list) const;

 private:
  struct Panel {
    Chart chart;
    Plot plot;
    PlotArea area;
    NamePlaces names;                        // at each of the plot's times
    std::vector<std::vector<Point>> around;  // against a quantity: from a line's head to its name
    bool leads = false;                      // whether any name has a leader at any time
    double offset(std::size_t line, double time) const;
    /// From the head of a line to the middle of its name's left end.
    Point beside(std::size_t line, double time) const;
    /// s: when the name of a line changes places for the nth time.
    double change(std::size_t line, std::size_t number) const;
    /// How well the leader to its name is seen, 0 to 1: not where the name is beside its head.
    double led(std::size_t line, double time) const;
    /// How well its name is seen, 0 to 1.
    double seen(std::size_t line, double time) const;
    /// For which part of the run names are not seen, of all names together.
    double unseen() const;
  };
  /// Axes and the places of names, in type of this size.
  void lay_out_panels(const std::vector<Chart>& charts, const std::vector<Plot>& plots,
                      const std::vector<Rect>& rects, double point, double seconds);
  void place_names(Panel& panel, const Rect& rect, double seconds) const;
  void end_zero_line(const Panel& panel, std::size_t line, const Point& name, double seen, List& list) const;
  static std::vector<std::vector<Point>> heads(const Panel& panel);
  std::vector<Panel> panels_;
  Palette colours_;
  std::vector<sim::SceneInfo> casts_;
  double right_ = 0, below_ = 0, foot_ = 0;
};

}  // namespace obscura::draw
