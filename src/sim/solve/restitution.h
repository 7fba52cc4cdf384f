#pragma once

#include <cmath>

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
  double at_high = gain(most);
  if (!(at_high > 0) || most == 0) return most;
  double low = 0, high = most, at_low = gain(0.0), last = 0;
  if (!(at_low < 0)) return 0;
  // regula falsi, Illinois; by halves where nothing was found
  int side = 0;
  for (int n = 0; n < kTries && high - low > kNear && at_low < -kEnough; ++n) {
    double share = std::isfinite(at_high) ? (low * at_high - high * at_low) / (at_high - at_low) : high;
    if (!(share > low && share < high)) share = 0.5 * (low + high);
    const double value = gain(share);
    last = share;
    if (value > 0) {
      if (side > 0) at_low *= 0.5;
      high = share, at_high = value, side = 1;
    } else {
      if (side < 0) at_high *= 0.5;
      low = share, at_low = value, side = -1;
    }
  }
  if (last != low) gain(low);
  return low;
}

}  // namespace obscura::sim
