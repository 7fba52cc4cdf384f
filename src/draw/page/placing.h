#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "draw/page/layout.h"
#include "draw/picture/formula.h"

namespace obscura::draw {

/// From which part of the way from a to b to which it lies within a rectangle; none: it passes by.
std::optional<std::pair<double, double>> part_within(const Point& a, const Point& b, const Rect& rect);

/// Finds room for words: beside what they name, over no line and no other word where that can be; with a
/// leader line where they must stand farther off.
class Placing {
 public:
  /// `margin`: how much room words want around them, of their height.
  explicit Placing(const Rect& page, double margin = 0.12) : page_(page), margin_(margin) {}

  /// Lines that labels should not cover; a heavier line is avoided more. Of an arrow: leaders should not
  /// cross it either.
  void avoid(const Point& a, const Point& b, double weight, bool arrow = false);
  /// A convex area that labels should not cover, and what it costs to lie wholly in it. `led`: the same of a
  /// leader, where that is not as much.
  void avoid(const std::vector<Point>& area, double cost, std::optional<double> led = {});

  /// A place for a label, and how good: candidates are tried from the first on.
  struct Candidate {
    Point center;
    double cost = 0;  // of its own: how far from what is usual
    bool leader = false;
    bool clear = false;  // of a survey: nothing lies under it
    Point moved{0, 0};   // of a survey: by the page's edge
    Point end{0, 0};     // of words that stand still: of its leader
  };
  /// Words that stand still, and where they could stand.
  struct Words {
    Point size;
    std::vector<Candidate> places;
  };
  /// The place of each, for the least cost of all together: none lies on lines, on another, on another's
  /// leader or beyond the page's edge, and no two leaders cross, where that can be.
  std::vector<Candidate> place(std::vector<Words> all) const;
  /// The cost of a candidate by the lines and areas that are to be avoided, and its own; neither other labels
  /// nor the page's edge count.
  double cost(const Point& size, const Candidate& candidate) const;
  /// The cost, page units, of a leader from words of `size` to what they name at `anchor`: `crossing` for
  /// each arrow that it crosses and each area that it runs through, and of these their share of it too. Not
  /// for what it begins in, nor for areas that cost a leader less than a crossing.
  double leading(const Point& anchor, const Point& size, const Point& center, double crossing) const;

  /// The centre of words of `size` that just clear a point in direction n; aslant they have a corner there.
  static Point beyond(const Point& at, const Point& n, double gap, const Point& size);
  /// How far words of `size` about `center` are from the line from a to b; 0: it runs through them.
  static double off_line(const Point& center, const Point& size, const Point& a, const Point& b);

  /// Places around a point, and farther off with a leader; beside an arrow.
  static std::vector<Candidate> around(const Point& at, double gap, const Point& size, double unit);
  /// `fixed`: first those to the right of its way, however it turns; else first those at its upper side.
  /// `past`: how far from its tail those past its tip are at least.
  static std::vector<Candidate> along(const Point& tail, const Point& tip, double gap, const Point& size,
                                      double unit, bool fixed = false, std::optional<double> past = {});
  /// Places with a leader around an arrow's tail, which do not turn with it: `reach` from the tail at least,
  /// and as far as the arrow is at its longest. Those against it cost more.
  static std::vector<Candidate> beside_swing(const Point& tail, const Point& tip, double reach,
                                             double longest, double gap, const Point& size, double unit);

 private:
  Rect rect_of(const Point& size, const Candidate& candidate) const;
  double lines(const Rect& rect) const;
  bool on_page(const Rect& rect) const;
  double together(const Words& a, const Candidate& at, const Words& b, const Candidate& other) const;

  struct Area {
    std::vector<Point> outline;
    Rect around;
    double cost, led;
  };
  struct Line {
    Point a, b;
    double weight;
    bool arrow;
  };
  Rect page_;
  double margin_;
  std::vector<Line> lines_;
  std::vector<Area> areas_;
};

}  // namespace obscura::draw
