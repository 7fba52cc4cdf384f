#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "sim/model/course.h"
#include "sim/model/path.h"
#include "sim/model/state.h"

namespace obscura::sim {

/// A part of a step, from t to t + h (s): all of it, or one of its substeps.
template <int D>
struct StepPart {
  State<D>& state;
  double t = 0, h = 0;
  int substep = 0;
};

/// A solver of `contact` and `event`: the stages of its step. It overrides those that it has work for.
template <int D>
class ContactSolver {
 public:
  virtual ~ContactSolver() = default;

  /// Moves `state` from t to t + h (s): bodies, contacts, joints, and which bodies sleep. The same list for
  /// every solver and both dimensions; energy is ContactStep's (sim/step/contact_step.h).
  void step(State<D>& state, double t, double h) {
    const StepPart<D> whole{state, t, h};
    if (!collide(whole)) return;
    wake(whole);
    const int all = substeps();
    for (int i = 0; i < all; ++i) {
      const StepPart<D> part{state, t + i * (h / all), h / all, i};
      move_free(part);
      warm_start(part);
      resolve_impacts(part);
      iterate(part);
      advance(part);
      project(part);
    }
    report(whole);
    sleep(whole);
  }

  /// The next step begins with a state that another solver left.
  virtual void begin_anew() {}

  /// From now on, notes how bodies go through a step, as far as it knows more than where they are at its end.
  virtual void watch(Course<D>*) {}

  /// Finds what may touch within the step. False: all bodies sleep, and the step is done.
  virtual bool collide(StepPart<D> step) = 0;
  /// Wakes bodies that are touched or pulled; in the first step puts to sleep those that start at rest.
  virtual void wake(StepPart<D>) {}

  /// How far the last step has pushed each body out of overlaps, m; null: none. The energy guard does not
  /// count the work of these pushes.
  virtual const Vec<D>* corrections() const { return nullptr; }

  /// Bodies that a limit, a rope, a motor or friction of a joint has pushed in the last step, one a body;
  /// null: none. Like contacts these may only take energy.
  virtual const std::vector<char>* pushed_by_joints() const { return nullptr; }

  /// Into how many substeps the following stages divide the step.
  virtual int substeps() const { return 1; }
  // of each substep, whose h is part.h
  /// Moves all bodies without contacts and joints.
  virtual void move_free(StepPart<D>) {}
  /// Applies the contact forces of the last step as first impulses. In space the impacts decide which
  /// contacts these push, so there it is done at the start of iterate().
  virtual void warm_start(StepPart<D>) {}
  /// Impacts within the substep, each at its time.
  virtual void resolve_impacts(StepPart<D>) {}
  /// Impulses of contacts and joints, by iteration.
  virtual void iterate(StepPart<D>) {}
  /// Positions and velocities at the end of the substep.
  virtual void advance(StepPart<D> part) = 0;
  /// Positions back onto the constraints.
  virtual void project(StepPart<D>) {}

  /// Forces of the step, into the state.
  virtual void report(StepPart<D>) {}
  /// Puts to sleep what rests.
  virtual void sleep(StepPart<D>) {}
};

/// A contact solver as scenes name it. To add one: a class that overrides the stages above, a name in Solver,
/// and a row in the table of sim/step/make_contact_solver.cpp, without which it does not compile.
struct SolverKind {
  Solver kind;
  std::string_view name;  // the word of `physics.solver`
  std::string_view doc;   // what follows the name on the page of keys
  bool exact;             // events, chains in reduced coordinates, energy without an allowance
};

/// All solvers, in the order of Solver from `direct` on.
std::span<const SolverKind> solver_kinds();

/// The row of a solver. Requires one that is not `automatic`.
const SolverKind& solver_kind(Solver solver);

/// The largest number of bodies for which the direct solver is chosen by default: moving bodies that have an
/// extent, and points. A few hundred rows if all lie in one heap; fewer in space, where faces have more
/// vertices and friction has more directions. Points touch walls and bodies, not one another.
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

/// The solver of a model, by how many bodies may touch: chosen when the model is built, not step by step.
/// `event` and chains in reduced coordinates need the direct solver; for the iterative one the scene builds
/// chains of joints instead.
template <int D>
Solver solver(const Model<D>& model);

/// That solver. Both are kept by reference; steps are ContactStep's.
template <int D>
std::unique_ptr<ContactSolver<D>> make_contact_solver(const Model<D>& model,
                                                      const std::vector<Path<D>>& paths);

}  // namespace obscura::sim
