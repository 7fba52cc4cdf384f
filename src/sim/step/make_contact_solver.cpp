#include "sim/solve/contact_solver.h"

#include <array>
#include <iterator>

#include "sim/constraint/joints/joint.h"
#include "sim/constraint/material.h"
#include "sim/solve/exact/exact.h"
#include "sim/solve/iterate/plane.h"
#include "sim/solve/iterate/space.h"

namespace obscura::sim {

namespace {

template <int D>
using Make = std::unique_ptr<ContactSolver<D>>(const Model<D>& model, const std::vector<Path<D>>& paths);

template <class S, int D>
std::unique_ptr<ContactSolver<D>> make(const Model<D>& model, const std::vector<Path<D>>& paths) {
  return std::make_unique<S>(model, paths);
}

// how each solver is made, in the order of Solver
struct Maker {
  Make<2>* plane;
  Make<3>* space;

  template <int D>
  constexpr auto* maker() const {
    if constexpr (D == 2) {
      return plane;
    } else {
      return space;
    }
  }
};

struct Entry {
  SolverKind its;
  Maker made_by;
};

constexpr Entry kEntries[] = {
    {{Solver::direct, "direct", "is exact, for up to some hundred contacts", true},
     {make<ExactSolver<2>>, make<ExactSolver<3>>}},
    {{Solver::iterative, "iterative", "is for thousands of bodies", false},
     {make<PlaneIterative>, make<SpaceIterative>}},
};

constexpr auto kSolverKinds = [] {
  std::array<SolverKind, std::size(kEntries)> all{};
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = kEntries[i].its;
  return all;
}();

static_assert(
    [] {
      for (std::size_t i = 0; i < kSolverKinds.size(); ++i)
        if (kSolverKinds[i].kind != Solver(i + 1)) return false;
      return kSolverKinds.size() + 1 == std::size_t(Solver::count);
    }(),
    "each solver has a row, in the order of Solver");

constexpr std::size_t place(Solver solver) { return std::size_t(solver) - 1; }

}  // namespace

std::span<const SolverKind> solver_kinds() { return kSolverKinds; }

const SolverKind& solver_kind(Solver solver) { return kSolverKinds[place(solver)]; }

template <int D>
BodyCounts body_counts(const Model<D>& model) {
  BodyCounts all;
  for (const Body<D>& body : model.bodies) {
    if (body.fixed || body.bare) continue;
    ++(body.linked ? all.links : is_point(body.shape) ? all.points : all.bodies);
  }
  return all;
}

template <int D>
Solver solver(const Model<D>& model) {
  if (model.collision == Collision::event) return Solver::direct;
  if (!model.chains.empty()) return Solver::direct;                     // links are sides of its rows alone
  if (!model.rails.empty() || has_wires(model)) return Solver::direct;  // curves are its alone
  if (model.solver != Solver::automatic) return model.solver;
  if (has_rubbing_ropes(model)) return Solver::direct;
  if (has_static_friction(model)) return Solver::direct;  // alike
  return body_counts(model).template few<D>() ? Solver::direct : Solver::iterative;
}

template <int D>
std::unique_ptr<ContactSolver<D>> make_contact_solver(const Model<D>& model,
                                                      const std::vector<Path<D>>& paths) {
  return kEntries[place(solver(model))].made_by.template maker<D>()(model, paths);
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
