#pragma once

#include <utility>
#include <vector>

#include "draw/page/layout.h"

namespace obscura::draw {

/// Where the words of an arrow take its ends to be over a film. They go and turn with it; but where it begins
/// elsewhere or is longer or shorter in an instant, they begin to go over before and arrive after, and what
/// it does for less than the time between two samples they do not follow.
class EasedArrow {
 public:
  using Ends = std::pair<Point, Point>;  // tail, tip

  /// The arrow at a sample of the film, s, as seen from what it goes along with. In the order of time;
  /// `before`: the sample before, at which it may not have been there.
  void add(double film, double before, const Ends& ends);
  /// Once all are added: `speed` of a label, page units a second; `least`: page units, of a jump.
  void ease(double speed, double least);
  /// Where its ends are for its words when they are at `now`.
  Ends at(double film, const Ends& now) const;

 private:
  struct Knot {
    double film;
    Point real, eased;
    bool anew;           // no way leads here from the knot before
    bool jumps = false;  // from the knot before
    double slack = 0;    // how far from the line to the next knot it may be between both
  };
  using Knots = std::vector<Knot>;
  static void ease(Knots& knots, double speed, double least);
  static Point at(const Knots& knots, double film, const Point& now);

  Knots tails_, lengths_;  // the length: along x
};

}  // namespace obscura::draw
