#include "sim/contact_step.h"

#include "sim/direct.h"
#include "sim/iterative.h"

namespace obscura::sim {

namespace {

constexpr int kMostBodies = 40;   // with an extent, that move: a few hundred rows when all lie in one heap
constexpr int kMostPoints = 400;  // they touch walls and bodies, not one another

}  // namespace

template <int D>
Solver solver(const Model<D>& model) {
  if (model.collision == Collision::event || !model.joints.empty()) return Solver::direct;
  if (model.solver != Solver::automatic) return model.solver;
  int points = 0, bodies = 0;
  for (const Body<D>& body : model.bodies) {
    if (!body.fixed) ++(body.shape.kind == ShapeKind::point ? points : bodies);
  }
  return points <= kMostPoints && bodies <= kMostBodies ? Solver::direct : Solver::iterative;
}

template <int D>
std::unique_ptr<ContactStep<D>> contact_step(const Model<D>& model, const std::vector<Path<D>>& paths) {
  if (solver(model) == Solver::direct) return std::make_unique<Direct<D>>(model, paths);
  return std::make_unique<Iterative<D>>(model, paths);
}

template Solver solver<2>(const Model<2>&);
template std::unique_ptr<ContactStep<2>> contact_step<2>(const Model<2>&, const std::vector<Path<2>>&);

}  // namespace obscura::sim
