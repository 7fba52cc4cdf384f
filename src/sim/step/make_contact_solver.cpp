#include "sim/solve/contact_solver.h"

#include <utility>

#include "sim/energy/energy_guard.h"
#include "sim/solve/exact/exact.h"
#include "sim/solve/exact/lone_bodies.h"
#include "sim/solve/iterate/plane.h"
#include "sim/solve/iterate/space.h"

namespace obscura::sim {

namespace {

constexpr double kAll = 1e300;
constexpr double kSinks = 1e-6;   // of what it could fall for
constexpr double kSwings = 1e-2;  // of its motion on joints: the error of a step of second order

// a solver's steps, none of which leaves more energy than there was
template <int D>
class Passive final : public ContactSolver<D> {
 public:
  Passive(const Model<D>& model, const std::vector<Path<D>>& paths, std::unique_ptr<ContactSolver<D>> solver)
      : model_(model),
        solver_(std::move(solver)),
        account_(model),
        direct_(sim::solver(model) == Solver::direct) {
    if (!direct_) lone_ = std::make_unique<LoneBodies<D>>(model, paths);
  }

  void step(State<D>& state, double t, double h) override {
    // what lets go within the step is no longer told after it
    touched_.clear();
    for (const Contact<D>& contact : state.contacts) {
      if (!direct_) break;
      touched_.emplace_back(contact.key.a, contact.key.b);
    }
    account_.open(state);
    if (lone_) lone_->find(state, h);
    solver_->step(state, t, h);
    if (lone_) lone_->step(state, t, h);
    // what overlaps at the start is to be lifted apart
    if (model_.overlap == Overlap::separate || !account_.risen(state)) return;
    for (const auto& [a, b] : touched_) account_.touch(a, b);
    for (const Contact<D>& contact : state.contacts) account_.touch(contact.key.a, contact.key.b);
    // so is what overlaps by next to nothing; joints of second order give and take; and a heap that is put
    // right sixty times a second has sunk by as much between
    const double share = state.step == 0 ? kAll : D == 2 && !direct_ ? kSinks : 0;
    for (int i = 0; share > 0 && i < int(model_.bodies.size()); ++i) account_.excuse(i, share);
    for (const Joint<D>& joint : model_.joints) {
      if (direct_) break;
      for (const int body : {joint.a.body, joint.b.body}) {
        if (body >= 0 && state.step > 0) account_.excuse(body, kSinks, kSwings);
      }
    }
    account_.take_back(state);
  }

 private:
  const Model<D>& model_;
  std::unique_ptr<ContactSolver<D>> solver_;
  EnergyGuard<D> account_;
  bool direct_;
  std::unique_ptr<LoneBodies<D>> lone_;  // beside a solver for many
  std::vector<std::pair<int, int>> touched_;
};

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
  std::unique_ptr<ContactSolver<D>> all;
  if (solver(model) == Solver::direct)
    all = std::make_unique<ExactSolver<D>>(model, paths);
  else
    all = iterative(model, paths);
  return std::make_unique<Passive<D>>(model, paths, std::move(all));
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
