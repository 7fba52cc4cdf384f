#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sim/fracture/bond_load.h"
#include "sim/model/state.h"
#include "sim/model/trouble.h"

namespace obscura::sim {

template <int D>
class Stepper;

/// The rigid bodies that bonds make of the parts of a model. They form an ordinary Model, which any stepper
/// steps.
template <int D>
struct BondedModel {
  Model<D> model;
  std::vector<int> body;    // one a part: its body in `model`
  std::vector<char> alone;  // one a part: it is the only one of its body
  std::vector<int> joints;  // one a joint of `model`: the joint of the parts
  std::vector<int> kept;    // one a joint of the parts: the joint of `model`, or -1
};

/// Steps a model with bonds: moves the bodies that bonds make of the parts, copies their motion to the parts,
/// and breaks bonds that are loaded beyond their strength at the end of a step. Pieces go on as they moved:
/// momentum, angular momentum and energy are those before the break.
template <int D>
class BondedBodies {
 public:
  /// Both are kept by reference.
  BondedBodies(const Model<D>& model, const std::vector<Path<D>>& paths);
  ~BondedBodies();

  /// Prepares a state. Bonds hold the parts in their poses at the start. If the velocities of bonded parts
  /// are not those of one rigid body, they become those with the same momentum and angular momentum.
  void begin(State<D>& state);

  /// Whether State::bonded agrees with the intact bonds of a state.
  bool fits(const State<D>& state);

  std::optional<Trouble> step(State<D>& state);
  std::optional<Trouble> partial_step(State<D>& state, double fraction);

 private:
  void gather(const State<D>& state);
  void tell(State<D>& state) const;
  int part_at(int body, const Vec<D>& point, const State<D>& state) const;
  void split(State<D>& state);

  const Model<D>& model_;
  BondLoads<D> loads_;
  BondedModel<D> whole_;
  std::vector<char> known_;              // which bonds `whole_` is made of
  std::vector<std::vector<int>> parts_;  // of each body of `whole_`
  std::unique_ptr<Stepper<D>> stepper_;  // of `whole_`
};

}  // namespace obscura::sim
