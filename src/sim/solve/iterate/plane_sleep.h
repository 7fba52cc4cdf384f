#pragma once

#include <span>
#include <vector>

#include "sim/constraint/mobility.h"
#include "sim/math/islands.h"
#include "sim/model/state.h"
#include "sim/solve/cone/statics.h"
#include "sim/solve/iterate/contact_rows.h"
#include "sim/solve/iterate/joint_solver.h"
#include "sim/solve/iterate/pair_cache.h"

namespace obscura::sim::plane {

/// Puts islands to sleep, by the rule of sim/constraint/mobility.h. Bodies that touch are an island.
class Rest {
 public:
  Rest(const Model<2>& model, const CoreShapes& cores);

  /// Freezes islands; forces of those that have waited but are not yet held are improved. `movers`: bodies
  /// that springs and hands hold are never frozen. `span`: s since it was last asked. True where someone
  /// froze.
  bool freeze(State<2>& state, const Pairs& pairs, std::vector<ContactBatch>& seats, JointSolver<2>& joints,
              const std::vector<Pose>& poses, const std::vector<Motion>& v, const std::vector<char>& movers,
              double h, double span);

  /// Freezes what begins without speed and in equilibrium, small islands without joints. True where someone
  /// froze.
  bool begin(State<2>& state, const Pairs& pairs, const std::vector<Pose>& poses,
             const std::vector<Motion>& v, const std::vector<char>& movers);

  /// Wakes islands that something awake will touch within `span` s, and those of `movers`. True where someone
  /// woke.
  bool wake(State<2>& state, const std::vector<Pair>& pairs, const std::vector<Motion>& v,
            const std::vector<char>& movers, double span);

 private:
  // the touches of these pairs, written where they are now, and whether exact forces hold them
  bool held(State<2>& state, const Pairs& pairs, std::span<const int> of, const std::vector<Pose>& poses);
  void freeze(State<2>& state, int body) const;
  bool joins(const Contact<2>& touch, const Pair& pair) const;
  Mobile mobile(const State<2>& state, const Pairs& pairs, const JointSolver<2>& joints,
                std::span<const int> of, std::span<const std::pair<int, int>> members,
                const std::vector<Motion>& v, double h);
  template <class Alike>
  void unite_joined(const State<2>& state, Alike&& alike);

  const Model<2>& model_;
  const CoreShapes& cores_;
  Statics<2> statics_;
  Mobility<2> mobility_;
  std::vector<Rotation<2>> turns_;  // one moment of inertia is the same in all
  std::vector<BearingContact<2>> touches_;
  std::vector<int> bearing_;  // their contacts
  std::vector<char> free_;
  Islands islands_;
  std::vector<char> restless_;
  std::vector<int> order_;                    // pairs by island, then by lane
  std::vector<std::pair<int, int>> members_;  // island, body
  std::vector<int> parts_;                    // of the joints of an island
  std::vector<char> marked_;                  // bodies of an island
  std::vector<ContactBatch> some_;
  std::vector<Motion> v_, zero_;
  Found slow_, fast_;
};

}  // namespace obscura::sim::plane
