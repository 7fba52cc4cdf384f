#pragma once

#include <string>
#include <vector>

#include "sim/model/state.h"
#include "sim/model/trouble.h"

namespace obscura::sim {

/// How hard springs pull on a body, as an oscillator: x'' = -stiffness x - damping x'.
struct Tightness {
  int body = -1;
  double stiffness = 0;  // sum of k (1/m_a + 1/m_b), 1/s^2; 1/m = 1/mass + r^2/I at a point r from the centre
  double damping = 0;    // sum of c (1/m_a + 1/m_b), and the body's own drag, 1/s
  int ties = 0;          // how many springs and hands
  bool hand = false;     // the strongest is a mouse, not a spring
  int strongest = -1;    // its index
  bool of_joint = false;  // the only one is that of a joint, `strongest` its index
};

/// All springs on each body, and the hands that hold it under `grips`.
template <int D>
std::vector<Tightness> tightness(const Model<D>& model, const std::vector<Grip<D>>& grips);

/// Whether the integrator makes such an oscillator grow: at all, or, where it always does (Euler, midpoint),
/// by more than a factor e in a second.
bool grows(Integrator integrator, const Tightness& oscillator, double h);

/// The longest step at which it does not, no longer than h (s).
double longest_step(Integrator integrator, const Tightness& oscillator, double h);

/// How much of a constant force on such an oscillator at rest its springs and dampers answer within a step of
/// h (s), in the mean of it: what is missing of v = h f / m after it.
double share_answered(Integrator integrator, const Tightness& oscillator, double h);

/// A hint for the user: the step, the limit, the spring, and a rate that is high enough. Empty if the step is
/// short enough for every spring on every body.
template <int D>
std::string step_too_long_message(const Model<D>& model, const Tightness& oscillator);

/// The tightest of all bodies by its limit; body -1 where the step is short enough for all.
template <int D>
Tightness tightest(const Model<D>& model, const std::vector<Grip<D>>& grips);

/// The spring of a joint that holds a body for which the step is too long, the tightest of them, as it is if
/// no other joint holds its bodies; body -1 where there is none.
template <int D>
Tightness tightest_of_joints(const Model<D>& model, int body);

/// A body's name in messages: its own, or "body 3".
template <int D>
std::string named(const Model<D>& model, int body);

/// "rk4", "explicit Euler".
const char* spelled(Integrator integrator);

/// Instabilities that are known beforehand: the first spring group whose step is longer than the integrator's
/// limit, as the Trouble that it would end in; empty if there is none.
std::vector<Trouble> stability_warnings(const Model<2>& model);
std::vector<Trouble> stability_warnings(const Model<3>& model);

}  // namespace obscura::sim
