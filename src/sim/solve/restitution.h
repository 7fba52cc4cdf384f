#pragma once

#include "sim/math/false_position.h"

namespace obscura::sim {

/// The largest share of restitution, from 0 to `most`, with which an impact gains no energy: Newton's law
/// with friction can gain some, and with e = 0 never does. gain(share) solves the impact and answers what it
/// gains, of its size: not above 0 where it gains nothing but rounding; infinite where nothing is found. It
/// falls continuously with the share, so that the outcome is continuous in angles and speeds. The last call
/// of gain() is with the answer.
template <class Gain>
double restitution_share(double most, Gain&& gain) {
  constexpr double kEnough = 1e-10;  // of the size: what may be lost too much
  constexpr double kNear = 1e-12;    // of e
  constexpr int kTries = 60;
  const double at_high = gain(most);
  if (!(at_high > 0) || most == 0) return most;
  double gained = gain(0.0), last = 0;
  if (!(gained < 0)) return 0;
  FalsePosition root(0, gained, most, at_high);
  for (int n = 0; n < kTries && root.high() - root.low() > kNear && gained < -kEnough; ++n) {
    last = root.next();
    const double value = gain(last);
    root.put(last, value);
    if (!(value > 0)) gained = value;
  }
  if (last != root.low()) gain(root.low());
  return root.low();
}

}  // namespace obscura::sim
