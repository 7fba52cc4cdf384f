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

/// The bodies that bonds make of the parts of a model, each rigid: one of a kind with the bodies of any
/// model, so that whatever moves those moves these.
template <int D>
struct Whole {
  Model<D> model;
  std::vector<int> body;          // of each part, its body in `model`
  std::vector<char> alone;        // each part: it is all of its body
  std::vector<int> joints, kept;  // of each joint of `model`, that of the parts; and the other way, or -1
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

  /// Readies a state: at the start bonds hold the parts as they stand. Velocities that are not those of one
  /// rigid body become those of the same momentum and angular momentum.
  void begin(State<D>& state);

  /// Whether what moves in a state is what its bonds make of the parts.
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
  Whole<D> whole_;
  std::vector<char> known_;              // which bonds `whole_` is made of
  std::vector<std::vector<int>> parts_;  // of each body of `whole_`
  std::unique_ptr<Stepper<D>> stepper_;  // of `whole_`
};

}  // namespace obscura::sim
