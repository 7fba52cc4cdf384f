#pragma once

#include "sim/math/spatial.h"
#include "sim/model/body_motion.h"
#include "sim/shape/shape.h"

namespace obscura::sim {

/// Force (N) of an explosion on a point: F = S r / (|r|^2 + eps^2)^(3/2), r from its centre. Nothing at the
/// centre itself, where it has no direction.
template <int D>
Vec<D> blast(const Explosion<D>& explosion, const Vec<D>& place);

/// Forces of explosions on whole bodies: the sum of the forces on the body's points (its tips), and their
/// torque about the centre of mass. A body of n points feels about n times the force on a particle there, as
/// in the explosion paper.
template <int D>
class Blasts {
 public:
  /// The model is kept by reference.
  explicit Blasts(const Model<D>& model);

  /// On body `body` that stands so, in the room's frame.
  Wrench<D> push(const Explosion<D>& explosion, int body, const BodyMotion<D>& at) const;

  /// Begins explosion `explosion`, or its next interval: computes the forces that are held through the
  /// interval. When the explosion begins, sleeping bodies wake.
  void begin(State<D>& state, int explosion) const;

  /// Ends it.
  void end(State<D>& state, int explosion) const;

 private:
  const Model<D>& model_;
  SupportVertices<D> tips_;
};

/// Whether any explosion acts.
template <int D>
bool blasting(const State<D>& state) {
  for (const Blast<D>& it : state.blasts) {
    if (it.on) return true;
  }
  return false;
}

}  // namespace obscura::sim
