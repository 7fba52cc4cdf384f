#include "sim/solve/contact_solver.h"

#include "sim/solve/exact/exact.h"
#include "sim/solve/iterate/plane.h"
#include "sim/solve/iterate/space.h"

namespace obscura::sim {

namespace {

// the solver for many bodies
std::unique_ptr<ContactSolver<2>> iterative(const Model<2>& model, const std::vector<Path<2>>& paths) {
  return std::make_unique<PlaneIterative<2>>(model, paths);
}
std::unique_ptr<ContactSolver<3>> iterative(const Model<3>& model, const std::vector<Path<3>>& paths) {
  return std::make_unique<SpaceIterative<3>>(model, paths);
}

}  // namespace

template <int D>
BodyCounts body_counts(const Model<D>& model) {
  BodyCounts all;
  for (const Body<D>& body : model.bodies) {
    if (body.fixed) continue;
    ++(body.linked ? all.links : is_point(body.shape) ? all.points : all.bodies);
  }
  return all;
}

template <int D>
Solver solver(const Model<D>& model) {
  if (model.collision == Collision::event) return Solver::direct;
  if (!model.chains.empty()) return Solver::direct;  // links are sides of its rows alone
  if (model.solver != Solver::automatic) return model.solver;
  return body_counts(model).template few<D>() ? Solver::direct : Solver::iterative;
}

template <int D>
std::unique_ptr<ContactSolver<D>> make_contact_solver(const Model<D>& model,
                                                      const std::vector<Path<D>>& paths) {
  if (solver(model) == Solver::direct) return std::make_unique<ExactSolver<D>>(model, paths);
  return iterative(model, paths);
}

template BodyCounts body_counts<2>(const Model<2>&);
template BodyCounts body_counts<3>(const Model<3>&);
template Solver solver<2>(const Model<2>&);
template Solver solver<3>(const Model<3>&);
template std::unique_ptr<ContactSolver<2>> make_contact_solver<2>(const Model<2>&,
                                                                  const std::vector<Path<2>>&);
template std::unique_ptr<ContactSolver<3>> make_contact_solver<3>(const Model<3>&,
                                                                  const std::vector<Path<3>>&);

}  // namespace obscura::sim
