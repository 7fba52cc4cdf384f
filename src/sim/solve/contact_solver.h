#pragma once

#include <memory>
#include <vector>

#include "sim/model/path.h"
#include "sim/model/state.h"

namespace obscura::sim {

/// A solver of `contact` and `event`: moves a state on, with everything that touches, hangs and pulls.
template <int D>
class ContactSolver {
 public:
  virtual ~ContactSolver() = default;

  /// Moves `state` from t to t + h (s): bodies, contacts, joints, and which bodies sleep.
  virtual void step(State<D>& state, double t, double h) = 0;
};

/// Up to how many bodies the direct solver serves on its own accord: of those that move, with an extent, and
/// points. A few hundred rows when all lie in one heap, in space sooner: faces have more corners and friction
/// more ways. Points touch walls and bodies, not one another.
template <int D>
inline constexpr int kMostBodies = D == 2 ? 20 : 6;
inline constexpr int kMostPoints = 400;
/// The same of the links of chains, whose joints cost it no rows.
template <int D>
inline constexpr int kMostLinks = 5 * kMostBodies<D>;

/// How many bodies that move may touch others, with an extent; links of chains; and points.
struct BodyCounts {
  int bodies = 0, links = 0, points = 0;

  /// Whether the direct solver serves so many on its own accord.
  template <int D>
  bool few() const {
    return points <= kMostPoints && bodies <= kMostBodies<D> && links <= kMostLinks<D>;
  }
};
template <int D>
BodyCounts body_counts(const Model<D>& model);

/// Which solver serves a model, by how many may touch: decided when it is built, not step by step. `event`
/// and chains in reduced coordinates are the direct one's: for the other a scene leaves a chain its joints.
template <int D>
Solver solver(const Model<D>& model);

/// That solver. Both are kept by reference.
template <int D>
std::unique_ptr<ContactSolver<D>> make_contact_solver(const Model<D>& model,
                                                      const std::vector<Path<D>>& paths);

}  // namespace obscura::sim
