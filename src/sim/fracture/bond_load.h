#pragma once

#include <vector>

#include "sim/force/explosion.h"
#include "sim/force/forces.h"
#include "sim/model/path.h"
#include "sim/model/state.h"

namespace obscura::sim {

/// The loads on bonds. The rigid body prescribes the acceleration of each part. Mass times acceleration less
/// the outside forces on the part is what its bonds must transmit. If bonds form loops, the loads of least
/// norm are taken, as equally stiff bonds would bear them.
template <int D>
class BondLoads {
 public:
  /// Both are kept by reference.
  BondLoads(const Model<D>& model, const std::vector<Path<D>>& paths);

  /// Breaks the bonds of `state` that are loaded beyond their strength: clears their `intact`. `whole`: the
  /// model of the bonded bodies; `body`: for each part, its body there; `before`: the bodies as the step of h
  /// s began, which ends at t. Returns whether any broke.
  bool snap(State<D>& state, const Model<D>& whole, const std::vector<int>& body,
            const std::vector<AngularVec<D>>& before, double t, double h);

  /// The load of bond `bond` when last looked for, N: the root of |f|^2 + |tau|^2 / l^2, f the force through
  /// it and tau the torque about its point, midway between the two centres, l half their distance.
  double load(int bond) const { return loads_[bond]; }

 private:
  // a rigid body of bonded parts
  struct Composite {
    const Body<D>& body;
    BodyMotion<D> at;
    const std::vector<int>&parts, &bonds;
    AngularVec<D> before;  // its spin as the step of h s began
    double h;

    // equations of a part
    int rows() const { return body.turns() ? D + kAngular<D> : D; }
  };
  // its acceleration, and the change of its velocity by the impacts
  struct Rates {
    Vec<D> A = Vec<D>::Zero(), dv = Vec<D>::Zero();
    AngularVec<D> alpha = AngularVec<D>::Zero(), dw = AngularVec<D>::Zero();
  };
  // the parts that have equations
  struct Unknown {
    std::vector<int> place;  // one a body of the model: the number of its block of rows; -1: it has none
    int count = 0;
  };
  // the right side of G z = (f_i, n_i)
  struct Required {
    Eigen::MatrixXd loads;                    // columns: steady, and of the impacts
    double forces = 0, torques = 0, far = 0;  // sums of magnitudes; of the part farthest from the centre, m
  };
  struct Equations;  // the matrix G
  // the point of a bond, and l
  struct Lever {
    Vec<D> point;
    double l;
  };

  void push(const State<D>& state, double t);
  bool snap(State<D>& state, const Composite& it);
  Rates accelerate(const State<D>& state, const Composite& it) const;
  void add_couples(const State<D>& state, const Composite& it);
  Unknown number_parts(const Composite& it) const;
  Required required(const State<D>& state, const Composite& it, const Rates& rates,
                    const Unknown& parts) const;
  std::vector<Lever> levers(const State<D>& state, const Composite& it) const;
  bool may_break(const Composite& it, const Required& required, const std::vector<Lever>& levers) const;
  Equations equations(const State<D>& state, const Composite& it, const Unknown& parts,
                      const std::vector<Lever>& levers) const;
  bool break_overloaded(State<D>& state, const Composite& it, const Equations& system,
                        const Eigen::MatrixXd& loads);

  const Model<D>& model_;
  const std::vector<Path<D>>& paths_;
  Blasts<D> blasts_;
  Forces<D> forces_;
  std::vector<BodyMotion<D>> motions_;
  std::vector<Wrench<D>> steady_, blows_;  // on each part about its centre: forces, and impulses of the step
  std::vector<double> loads_;
};

}  // namespace obscura::sim
