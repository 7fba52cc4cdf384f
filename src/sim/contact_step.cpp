#include "sim/contact_step.h"

#include "sim/direct.h"
#include "sim/iterative.h"
#include "sim/sweeps.h"

namespace obscura::sim {

template <int D>
Crowd crowd(const Model<D>& model) {
  Crowd all;
  for (const Body<D>& body : model.bodies) {
    if (!body.fixed) ++(body.shape.kind == ShapeKind::point ? all.points : all.bodies);
  }
  return all;
}

template <int D>
Solver solver(const Model<D>& model) {
  if (model.collision == Collision::event) return Solver::direct;
  if (!model.chains.empty()) return Solver::direct;  // links are sides of its rows alone
  if (model.solver != Solver::automatic) return model.solver;
  const Crowd all = crowd(model);
  return all.points <= kMostPoints && all.bodies <= kMostBodies<D> ? Solver::direct : Solver::iterative;
}

template <int D>
std::unique_ptr<ContactStep<D>> contact_step(const Model<D>& model, const std::vector<Path<D>>& paths) {
  if (solver(model) == Solver::direct) return std::make_unique<Direct<D>>(model, paths);
  return std::make_unique<Iterative<D>>(model, paths);
}

template <>
std::unique_ptr<ContactStep<3>> contact_step<3>(const Model<3>& model, const std::vector<Path<3>>& paths) {
  if (solver(model) == Solver::direct) return std::make_unique<Direct<3>>(model, paths);
  return std::make_unique<Sweeps<3>>(model, paths);
}

template Crowd crowd<2>(const Model<2>&);
template Crowd crowd<3>(const Model<3>&);
template Solver solver<2>(const Model<2>&);
template Solver solver<3>(const Model<3>&);
template std::unique_ptr<ContactStep<2>> contact_step<2>(const Model<2>&, const std::vector<Path<2>>&);

}  // namespace obscura::sim
