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

/// How a body lands, by landing_of(drop) with Newton's law; where that would gain energy, with the largest e
/// by which it does not.
template <class Drop, class Landing>
Landing without_gain(const Drop& drop, Landing (*landing_of)(const Drop&)) {
  const Landing landing = landing_of(drop);
  if (!landing.gains) return landing;
  double low = 0, high = drop.e;
  Drop with = drop;
  for (int i = 0; i < 60; ++i) {
    with.e = 0.5 * (low + high);
    (landing_of(with).gains ? high : low) = with.e;
  }
  with.e = low;
  return landing_of(with);
}

}  // namespace obscura::sim
