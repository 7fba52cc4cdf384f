#pragma once

#include <algorithm>
#include <cmath>

#include "sim/solve/iterate/substeps.h"

// When a gap of two bodies in flight closes with an impact,
//   g(t) = 0,  g'(t) < -v      v  the speed below which a closing is no impact, m/s
// by Newton's method along its course; where the bodies turn so far that this misleads, by halving.

namespace obscura::sim {

/// A gap at a time.
struct GapInTime {
  double width = 0, speed = 0;  // m, m/s
};

/// The time of a gap that does not close with an impact.
inline constexpr double kNeverCloses = 1e300;

/// When a gap that is open at `from` closes with an impact within a substep of h, s. `guess`: the first of
/// Newton's times; kNeverCloses: it opens at first. `slow`: -v. at(t): the gap at a time.
template <class At>
double closing_time(double from, double guess, double h, double slow, At&& at) {
  constexpr int kNewtonSteps = 8;
  constexpr double kLatest = 1.5;  // substeps: so late a gap may close that its tangent would close in one
  double when = guess, low = from, high = -1;
  for (int i = 0; i < kNewtonSteps && when <= from + kLatest * h; ++i) {
    const GapInTime gap = at(when);
    if (gap.width > 0 && !(gap.speed < 0)) {
      // it has come nearest before: was it closed then?
      for (double parted = when; parted - low > kInTime * h && high < 0;) {
        const double mid = 0.5 * (low + parted);
        const GapInTime then = at(mid);
        if (then.width <= 0)
          high = mid;
        else
          (then.speed < 0 ? low : parted) = mid;
      }
      if (high < 0) return kNeverCloses;
      break;
    }
    if (!(gap.speed < slow)) break;
    const double next = when - gap.width / gap.speed;
    if (std::fabs(next - when) <= kInTime * h) return when <= h ? when : kNeverCloses;
    when = std::clamp(next, from, from + kLatest * h);
  }
  if (high < 0) {
    if (from >= h || at(h).width > 0) return kNeverCloses;
    high = h;
  }
  while (high - low > kInTime * h) {
    when = 0.5 * (low + high);
    (at(when).width > 0 ? low : high) = when;
  }
  return at(low).speed < slow ? low : kNeverCloses;
}

/// The normal speed that the iterations must leave at a contact of bodies struck in this substep, m/s.
/// `target`: that which keeps it as it is after their last impact; `gap`: then; `together`: gaps up to this
/// touch; `slow`: -v; `left`: s until the substep ends.
inline double target_after_impacts(double target, const GapInTime& gap, double together, double slow,
                                   double left, double h) {
  // what closes with an impact just after the substep is the next one's
  const bool later = gap.speed < slow && gap.width > -left * gap.speed;
  if (gap.width <= together && !later) return target;
  // an approach this fast would have been an impact if the two could meet: they pass each other
  const bool passes = gap.speed < slow || left <= kInTime * h;
  return passes ? kNoAim : target - gap.width / left;
}

}  // namespace obscura::sim
