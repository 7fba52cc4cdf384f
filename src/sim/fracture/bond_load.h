#pragma once

#include <vector>

#include "sim/force/explosion.h"
#include "sim/model/path.h"
#include "sim/model/state.h"

namespace obscura::sim {

/// The loads on bonds. A rigid body prescribes how each of its parts accelerates; the force that this needs
/// beyond the outside forces comes through the part's bonds. If bonds form loops, the loads of least norm are
/// taken, as equally stiff bonds would bear them.
template <int D>
class BondLoads {
 public:
  /// Both are kept by reference.
  BondLoads(const Model<D>& model, const std::vector<Path<D>>& paths);

  /// Breaks the bonds of `state` that are loaded beyond their strength: clears their `holds`. `whole`: the
  /// model of the bonded bodies; `body`: for each part, its body there. Returns whether any broke.
  bool snap(State<D>& state, const Model<D>& whole, const std::vector<int>& body, double t);

  /// The load of bond `bond` when last looked for, N: the root of |f|^2 + |tau|^2 / l^2, f the force through
  /// it and tau the torque about its point, midway between the two centres, l half their distance.
  double load(int bond) const { return loads_[bond]; }

 private:
  void push(const State<D>& state, double t);
  bool snap(State<D>& state, const Body<D>& whole, const BodyMotion<D>& at, const std::vector<int>& parts,
            const std::vector<int>& bonds);

  const Model<D>& model_;
  const std::vector<Path<D>>& paths_;
  Blasts<D> blasts_;
  std::vector<Wrench<D>> steady_, blows_;  // on each part about its centre: forces, and impulses of the step
  std::vector<double> loads_;
};

}  // namespace obscura::sim
