#pragma once

#include <utility>

#include "sim/model/state.h"
#include "sim/step/stepper.h"

namespace obscura::sim {

/// A state at the end of a step, and when that is, s; -1: there is none.
template <int D>
struct Met {
  double time = -1;
  State<D> state;
};

/// The first step of a world, within its first second, in which two touch with an impact; and how many
/// impacts there are in it and until `after` s later.
template <int D>
std::pair<Met<D>, int> first_impact(const World<D>& world, double after) {
  State<D> state = world.state;
  Stepper<D> stepper(world.model);
  stepper.begin(state);
  const double rate = value(world.model.rate);
  Met<D> met;
  int impacts = 0;
  while (double(state.step) < rate && (met.time < 0 || double(state.step) / rate < met.time + after)) {
    if (stepper.step(state)) break;
    for (const Contact<D>& contact : state.contacts) impacts += contact.impulse.norm() > 0;
    if (impacts == 0 || met.time >= 0) continue;
    met = {double(state.step) / rate, state};
  }
  return {met, impacts};
}

}  // namespace obscura::sim
