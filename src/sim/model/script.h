#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/model/model.h"

namespace obscura::sim {

/// An instant on the physics clock: whole steps, and what lies beyond them as a fraction of a step, 0 <=
/// fraction < 1.
struct Beat {
  std::int64_t step = 0;
  double fraction = 0;

  bool operator==(const Beat&) const = default;
};
inline bool operator<(Beat a, Beat b) { return a.step != b.step ? a.step < b.step : a.fraction < b.fraction; }

/// The beat of time t (s, >= 0), floor(t rate) exactly.
Beat beat(Rational t, Rational rate);

/// Time of a beat, s: step / rate is rounded once while it has less than 53 bits.
double time(Beat at, Rational rate);

/// Length of a step, s.
inline double step_length(Rational rate) { return double(rate.den) / double(rate.num); }

/// An instant at which the script changes what happens: a step is cut there.
struct Edge {
  enum class Kind { press, knot, release, blast, calm };  // blast: it begins, or its next interval
  Beat at;
  int mouse = 0;  // or explosion
  Kind kind = Kind::knot;
};

/// All edges of the script in order. One that is within 1e-9 of a step of a step's boundary is that boundary;
/// one within 1e-9 of the edge before it is at the same instant.
template <int D>
std::vector<Edge> edges(const Model<D>& model);

}  // namespace obscura::sim
