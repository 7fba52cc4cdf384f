#pragma once

#include <vector>

#include "sim/force/explosion.h"
#include "sim/force/forces.h"
#include "sim/model/path.h"
#include "sim/model/state.h"

namespace obscura::sim {

/// What bonds bear. A rigid body says how each of its parts accelerates; what the forces from outside do not
/// give a part comes through its bonds. Where bonds form loops, those loads that are least together (what
/// equally stiff bonds would bear).
template <int D>
class BondLoads {
 public:
  /// Both are kept by reference.
  BondLoads(const Model<D>& model, const std::vector<Path<D>>& paths);

  /// Breaks the bonds of `state` that are loaded beyond their strength: clears their `holds`. `whole`: what
  /// they make of the parts; `body`: of each part, its body there. Returns whether any broke.
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
  Forces<D> forces_;
  std::vector<BodyMotion<D>> motions_;
  std::vector<Wrench<D>> steady_, blows_;  // on each part about its centre: forces, and impulses of the step
  std::vector<double> loads_;
};

}  // namespace obscura::sim
