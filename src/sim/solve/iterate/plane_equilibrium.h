#pragma once

#include <span>
#include <utility>
#include <vector>

#include "sim/solve/iterate/joint_solver.h"
#include "sim/solve/iterate/plane_contact_rows.h"
#include "sim/solve/iterate/plane_pair_cache.h"
#include "sim/solve/sleep.h"

namespace obscura::sim::plane {

/// Forces under which candidates for sleep would stay at rest, by iterations.
class Equilibrium {
 public:
  Equilibrium(const Model<2>& model, const CoreShapes& cores);

  /// What the iterations of a step move.
  struct Step {
    const std::vector<Pair>& pairs;
    std::vector<ContactBatch>& batches;
    JointSolver<2>& joints;
    const std::vector<Pose>& poses;
  };

  /// Finds forces for candidates of `sleep` as in a step of h from rest, and writes them into the state and
  /// the batches. What they leave and the joints that bear it are told to `sleep`.
  void find(std::span<Sleep<2>::Island> islands, Sleep<2>& sleep, State<2>& state, const Step& step,
            double h);

 private:
  void fall(std::span<const Sleep<2>::Island> islands, JointSolver<2>& joints, double h);
  void gather(const Sleep<2>::Island& island, const State<2>& state, const Step& step);
  double iterate(const Sleep<2>::Island& island, State<2>& state, const Step& step, double h);
  void copy_to_joints(const Sleep<2>::Island& island, JointSolver<2>& joints) const;
  void copy_from_joints(const Sleep<2>::Island& island, JointSolver<2>& joints);

  const Model<2>& model_;
  const CoreShapes& cores_;
  std::vector<Motion> v_, zero_;
  std::vector<int> pair_of_;           // of each contact of the state
  std::vector<int> pairs_;             // of the island at hand, by lane
  std::vector<int> components_;        // of its joints
  std::vector<ContactBatch> batches_;  // its pairs, by themselves
  std::vector<char> marked_;           // its bodies
  LaneList slow_, fast_;
};

}  // namespace obscura::sim::plane
