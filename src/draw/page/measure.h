#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "draw/page/marks.h"
#include "draw/page/plot.h"
#include "sim/model/snapshot.h"

namespace obscura::draw {

/// A quantity of an instant: one table serves plots, arrows, values in labels and --measure.
struct Measure {
  std::string_view name;                    // as a scene calls it
  const char *label, *unit;                 // what its line is called, as mathematics; of its values
  std::string_view color;                   // of the palette; empty: ink
  enum class Of { room, body, either } of;  // either: of a body where one is named, else of all the room
  double (*read)(const sim::SceneInfo& cast, const sim::Snapshot& now, int body);  // null: arrows alone
  std::optional<Quantity> arrow{};  // none: a number, which no arrow shows

  /// Its value; `body` is the one that has it, -1: the room.
  double at(const sim::SceneInfo& cast, const sim::Snapshot& now, int body) const {
    return read(cast, now, body);
  }
};

/// The measure of a name; none where there is no such.
const Measure* measure(std::string_view name);

/// The names of those that plots show, of those that arrows show, in the order of the table.
std::vector<std::string> plotted();
std::vector<std::string> arrows();

/// Which quantities a plot shows.
struct Measured {
  std::vector<std::string> quantities;
  std::vector<int> bodies;                           // those measured; none: the whole room
  std::string against;                               // a quantity, instead of time
  std::optional<std::pair<double, double>> range{};  // of the values' axis; none: all there are

  /// A line of the plot.
  struct Line {
    const Measure* measure = nullptr;
    int body = -1;
    double at(const sim::SceneInfo& cast, const sim::Snapshot& now) const {
      return measure->at(cast, now, body);
    }
  };
  std::vector<const Measure*> measures() const;
  std::vector<Line> lines() const;
  /// What a line goes along, if not time.
  std::optional<Line> along(const Line& line) const;
};

/// A plot of them before anything is measured: lines with names, colours and dashes, and titles of its axes.
/// Of one body a quantity has its arrows' colour, or one that means nothing else; several bodies have theirs,
/// which `line_color` tells, or shades of it where they share one, and the names that `called` tells, as
/// mathematics; those of the scene without it. `quiet`: whether others are to be looked at.
Plot empty_plot(const Measured& measured, const Palette& colours, const sim::SceneInfo& cast,
                const std::function<Color(int body)>& line_color,
                const std::function<std::string(int body)>& called = {},
                const std::function<bool(int body)>& quiet = {});

/// A name of a scene as mathematics: "left_bob" is a left bob, "crate[2]" a crate with an index.
std::string spoken(std::string name);

/// "normal force": a name of the scene or of the table in words.
std::string in_words(std::string_view name);

}  // namespace obscura::draw
