#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/model/model.h"

namespace obscura::sim {

/// An instant on the physics clock: whole steps, and what lies beyond them as a fraction of a step, 0 <=
/// fraction < 1.
struct TimeStamp {
  std::int64_t step = 0;
  double fraction = 0;

  bool operator==(const TimeStamp&) const = default;
};
inline bool operator<(TimeStamp a, TimeStamp b) {
  return a.step != b.step ? a.step < b.step : a.fraction < b.fraction;
}

/// The time stamp of t (s, >= 0): step = floor(t rate) exactly.
TimeStamp time_stamp(Rational t, Rational rate);

/// The same of an instant at which a step may be cut: within 1e-9 of a step of a step's boundary it is that.
TimeStamp snapped_stamp(Rational t, Rational rate);

/// The time (s) of a time stamp. step / rate is rounded once while it has less than 53 bits.
double time(TimeStamp at, Rational rate);

/// How long a piece of a step is in which a formula of the time jumps, of a step (sim/step/jumps.h); no piece
/// of less than twice that is anything else.
inline constexpr double kJumpPiece = 1e-9;

/// Length of a step, s.
inline double step_length(Rational rate) { return double(rate.den) / double(rate.num); }

/// An instant at which the script changes what happens: a step is cut there.
struct ScriptEvent {
  /// blast: it begins, or its next interval; bend: a knot of a body's path; let_go: of a body
  enum class Kind { press, knot, release, blast, calm, bend, let_go };
  TimeStamp at;
  int mouse = 0;  // or explosion, or drive
  Kind kind = Kind::knot;
};

/// All events of the script in order. An event within 1e-9 of a step from a step's boundary is moved onto the
/// boundary; events within 1e-9 of a step of each other get the same instant.
template <int D>
std::vector<ScriptEvent> edges(const Model<D>& model);

}  // namespace obscura::sim
