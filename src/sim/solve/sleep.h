#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "sim/constraint/mobility.h"
#include "sim/math/islands.h"
#include "sim/model/state.h"
#include "sim/solve/cone/statics.h"

namespace obscura::sim {

/// The stages `wake` and `sleep` of a step, for all solvers: decides which islands of bodies fall asleep and
/// which wake, by the rule of sim/constraint/mobility.h. The solver supplies its contacts, as in
/// State::contacts, and the forces under which a candidate would stay at rest.
///
///     at the start of a step     wake(), then at_start() in the first
///     at its end                 advance_timer() of each body that moves
///     where it is due()          candidates(): islands that have been quiet; the solver finds their forces
///                                put_to_sleep(): which of them stay at rest
///
/// All that is carried from step to step is in the state: frozen, quiet, contacts.
template <int D>
class Sleep {
 public:
  /// How a solver finds forces.
  enum class Forces {
    iterated,  // to a millionth of gravity, of contacts and joints alone
    exact      // to rounding, springs and explosions among them, and so are its velocities
  };

  /// Times as fast as it moves: so much sooner a body counts as reaching another, so that one that meets it
  /// where the span ends, but for rounding, finds it awake.
  static constexpr double kSooner = 1.001;

  /// As a fraction of g: the acceleration that iterated forces may leave an island in equilibrium.
  static constexpr double kBalanced = 1e-6;

  /// Bodies that contacts, springs and joints join, which may fall asleep together.
  struct Island {
    std::span<const int> bodies;    // ascending
    std::span<const int> contacts;  // their numbers among the solver's, ascending
    bool jointed = false;           // a joint is among what joins them
    double quiet = 0;               // s: how long none of them has moved
    double residual = 0;            // m/s^2: what the solver's forces leave any point at most; written by it
  };

  /// Keeps `model` by reference. `deepest`: relative to the larger bounding radius of two; islands with
  /// deeper overlaps do not rest.
  Sleep(const Model<D>& model, Forces forces, double deepest = std::numeric_limits<double>::infinity());

  /// Whether to look for candidates after this step: sixty times a second, or with exact forces each time.
  bool due(const State<D>& state) const { return state.step % every_ == 0; }

  /// Counts how long a body has been quiet, after a step of h (s): its speed and angular speed, squared.
  void advance_timer(State<D>& state, int body, double v2, double w2, double h) const {
    const double radius = bounding_radius_[body];
    state.quiet[body] = v2 + w2 * (radius * radius) <= still2_ ? state.quiet[body] + h : 0;
  }

  /// Whether any body sleeps.
  static bool any(const State<D>& state) {
    return std::any_of(state.frozen.begin(), state.frozen.end(), [](char frozen) { return frozen != 0; });
  }

  /// Wakes islands that something awake reaches within `span` s, by steps of h (s), or pulls at by a spring,
  /// joint or hand. `near`: contacts, with their gaps, of what may come near; those of the state join the
  /// islands. True where any woke.
  bool wake(State<D>& state, std::span<const Contact<D>> near, double span, double h);

  /// Wakes these bodies, each with its island, and begins to count anew how long they are quiet.
  void wake(State<D>& state, std::span<const int> bodies);

  /// Wakes all islands near kinematic bodies and belts. travel(body): how far such a body gets in the step,
  /// m. True if any woke.
  template <class Travel>
  bool wake_near_driven(State<D>& state, Travel&& travel) {
    if (carriers_.empty()) return false;
    near_carriers_.clear();
    for (const int carrier : carriers_) {
      const double reach = 2 * travel(carrier) + kCarrierMargin * bounding_radius_[carrier];
      for (int i = 0; i < int(model_.bodies.size()); ++i) {
        if (model_.bodies[i].fixed) continue;
        const double far = bounding_radius_[carrier] + (1 + kCarrierMargin) * bounding_radius_[i] + reach;
        if ((state.x[i] - state.x[carrier]).squaredNorm() <= far * far) near_carriers_.push_back(i);
      }
    }
    woken_.clear();
    for (const int i : near_carriers_)
      if (state.frozen[i]) woken_.push_back(i);
    if (woken_.empty()) return false;
    wake(state, std::vector<int>(woken_));
    return true;
  }

  /// Sets at rest what begins without speed and in equilibrium: islands without joints, springs and hands, of
  /// Statics::kMost contacts at most. Their contacts take the forces of it. True where any fell asleep.
  bool at_start(State<D>& state, std::span<Contact<D>> contacts);

  /// The islands that may be put to sleep: no point of theirs has been faster than the solver's limit for
  /// kWait. The solver then finds forces for each, writes them into state.contacts and the remaining
  /// acceleration into `residual`, and shows the bearing joints by add_joint_row().
  std::span<Island> candidates(const State<D>& state);

  /// Stops the bodies of an island.
  void halt(State<D>& state, const Island& island) const;

  /// A row of a joint of a candidate; `spare` as in Mobility::add_row.
  void add_joint_row(const Island& island, const Row<D>& row, double spare) {
    rows_.push_back({int(&island - candidates_.data()), spare, row});
  }

  /// Puts to sleep those candidates that are in equilibrium and whose motion is held. If the solver's forces
  /// are not enough, those of a few contacts are found exactly and written into the state. True if any fell
  /// asleep.
  bool put_to_sleep(State<D>& state);

 private:
  struct JointRow {
    int island;
    double spare;
    Row<D> row;
  };

  bool moves(const State<D>& state, int body) const {
    return body >= 0 && !model_.bodies[body].fixed && !state.frozen[body];
  }
  double thickness(const ContactKey& key) const;
  bool joins(const Contact<D>& contact) const;
  template <class Alike>
  void build_islands(const State<D>& state, std::span<const Contact<D>> contacts, Alike&& alike);
  void disturb(int body);
  void disturb_pulled(const State<D>& state);
  double reach(const State<D>& state, const Contact<D>& contact, int awake, double span, double h) const;
  void list_candidates(const State<D>& state, std::span<const Contact<D>> contacts);
  bool due_at_waits(double quiet) const;
  bool due_at_doubled_waits(double quiet) const;
  bool in_equilibrium(const State<D>& state, const Island& island, std::span<Contact<D>> contacts, int most);
  BearingContact<D> bearing(const State<D>& state, const Contact<D>& contact) const;
  Mobile mobile(const State<D>& state, const Island& island);
  void freeze(State<D>& state, const Island& island) const;

  static constexpr double kCarrierMargin = 0.05;  // of a bounding radius

  const Model<D>& model_;
  std::vector<int> carriers_, near_carriers_;  // kinematic bodies and belts; bodies near them
  const std::vector<int> driven_;              // bodies that forces push: they never rest
  const std::vector<int> restless_at_start_;   // bodies that at_start() leaves out
  const bool exact_;
  const double deepest_;
  std::int64_t every_ = 1;     // steps between two checks
  double interval_ = 0;        // and s
  double g_ = 0, still2_ = 0;  // m/s^2, m^2/s^2
  std::vector<double> bounding_radius_, half_thickness_;
  Statics<D> statics_;
  Mobility<D> mobility_;

  Islands roots_;
  std::vector<char> restless_;  // by root: something in it is not at rest
  std::vector<std::pair<int, int>> bodies_by_root_, contacts_by_root_;
  std::vector<int> bodies_, contacts_;  // of the candidates, side by side
  std::vector<Island> candidates_;
  std::vector<JointRow> rows_;
  std::vector<int> woken_, bearing_;
  std::vector<BearingContact<D>> touches_;
  std::vector<Rotation<D>> rotations_;
};

}  // namespace obscura::sim
