#pragma once

#include "sim/model/contact.h"

namespace obscura::sim {

/// A contact point of a pair in space that may close within a substep, as the iterations see it.
template <int D>
struct ContactConstraint {
  ContactKey key;
  int a = 0, b = 0;  // bodies; walls and the room are the one after the last
  Vec<D> n, arm_a, arm_b, point;
  double gap = 0, mu = 0, bounce = 0;
  double per_width = 0;                     // 1/m: of the narrower body
  double rate = 0;                          // 1/s: how fast the bodies pass there, in widths of the narrower
  double least_strike = 0;                  // m/s: what closes slower has no impact of its own
  double least = 0;                         // m/s: of the normal speed after the substep
  double normal_impulse = 0;                // N s, along n
  Vec<D> tangent_impulse = Vec<D>::Zero();  // N s
  Vec<D> impact_impulse = Vec<D>::Zero();   // N s, of impacts within the substep
  Vec<D> before = Vec<D>::Zero();           // N: the force of the last substep
  Vec<D> belt = Vec<D>::Zero();             // m/s: what belts add to the slip of a against b
  Vec<D> drift = Vec<D>::Zero();        // m/s: what arms that turn within the substep add to it at its end
  Vec<D> half_change = Vec<D>::Zero();  // m/s: of what slides on, half of what changes in its slip
  int renewals = 0;                     // of its features, since the substep began
  double apart = 0;      // m/s: n . (v_a + w_a x arm_a - v_b - w_b x arm_b) - d(gap)/dt, as the
                         // last impact of its bodies left them
  bool after = false;    // of a body that had an impact
  bool rests = false;    // there it hardly closes or parts after it
  bool passes = false;   // however it looks, it does not close with an impact
  bool bounces = false;  // an impact that is left to the iterations
  bool closing = false;  // slowly
  bool slides = false;   // and goes on to
  bool blow = false;     // it closes fast
  double closes = 0;     // when it bounces, s from the start of the substep

  /// m/s: what is to be added to the speeds of its bodies at the end of the substep for the slip that
  /// friction is against: that at its end, or of what slides on in its middle.
  Vec<D> surface() const { return belt + drift - half_change; }
};

}  // namespace obscura::sim
