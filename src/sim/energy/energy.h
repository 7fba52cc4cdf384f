#pragma once

#include <vector>

#include "sim/model/body_motion.h"
#include "sim/model/path.h"
#include "sim/model/snapshot.h"
#include "sim/model/state.h"

namespace obscura::sim {

// The energy of a state. Fixed bodies are part of the room and count nothing.

/// Kinetic energy of one body, J.
template <int D>
double kinetic(const Model<D>& model, const State<D>& state, int body);

/// Kinetic energy of all bodies that are not fixed, J.
template <int D>
double kinetic(const Model<D>& model, const State<D>& state);

/// Gravity's potential of one body relative to the origin, -m g . x, J.
template <int D>
double gravity_energy(const Model<D>& model, const State<D>& state, int body);

/// Energy in spring `spring`, J.
template <int D>
double spring_energy(const Model<D>& model, const State<D>& state, int spring);

/// Energy in the spring of joint `joint`, J; none where it has none or is broken.
template <int D>
double joint_spring_energy(const Model<D>& model, const State<D>& state, int joint);

/// Energy in the spring of mouse `mouse` at time t, J; none where it holds nothing.
template <int D>
double spring_energy(const Model<D>& model, const State<D>& state, const std::vector<Path<D>>& paths,
                     int mouse, double t);

/// Potentials of the forces at time t, J; added to `each`, one a body, if it is given.
template <int D>
double field_energy(const Model<D>& model, const State<D>& state, double t,
                    std::vector<double>* each = nullptr);

/// All of it, with the ledger, at time t (s).
template <int D>
Energies energies(const Model<D>& model, const State<D>& state, const std::vector<Path<D>>& paths, double t);

/// Sum of m v, kg m/s.
template <int D>
Vec<D> momentum(const Model<D>& model, const State<D>& state);

/// About the origin, kg m^2/s.
template <int D>
AngularVec<D> angular_momentum(const Model<D>& model, const State<D>& state);

}  // namespace obscura::sim
