#pragma once

#include <cstdint>
#include <vector>

#include "sim/iterative_cores.h"
#include "sim/iterative_pairs.h"
#include "sim/iterative_rows.h"
#include "sim/tied.h"

namespace obscura::sim {

/// Contact for thousands of bodies: pairs are found a tenth as often as steps are taken, forces by a few warm
/// sweeps a step. What is carried from step to step is in the state: contacts, all pairs that may touch soon
/// among them, hold forces and name their features. Scratch follows from these, so a run cut in two is the
/// run in one.
template <int D>
class Iterative {
 public:
  /// Both are kept by reference.
  explicit Iterative(const Model<D>& model, const std::vector<Path<D>>& paths);

  /// Moves `state` from t to t + h (s): forces, impacts, contacts with friction, rest. Uses and writes
  /// state.contacts, frozen, quiet.
  void step(State<D>& state, double t, double h);

 private:
  using Motion = sweep::Motion;

  void gather(const State<D>& state);
  void fall(State<D>& state, double t, double h);
  void colour(const State<D>& state);
  void prepare(State<D>& state, double h);
  void strike(State<D>& state, double h);
  void solve(double h);
  void project();
  void advance(State<D>& state, double h);
  void keep(State<D>& state, double h);
  bool outran(const State<D>& state, double h) const;

  bool lively(const sweep::Pair& pair) const;
  void struck(int body, double after, double h);
  bool hit(int pair, double h);

  const Model<D>& model_;
  sweep::Cores cores_;
  sweep::Pairs pairs_;
  Tied<D> tied_;
  Stages stages_;
  double span_ = 0;        // s, between two looks for pairs
  double rest_speed_ = 0;  // m/s: slower approaches do not bounce
  bool drag_ = false;

  // of bodies; one more that never moves, for walls and what is fixed
  std::vector<sweep::Pose> poses_;
  std::vector<double> turns_;           // that the poses are of, rad
  std::vector<double> im_, ii_;         // 1/kg, 1/(kg m^2); 0 where asleep or fixed
  std::vector<Motion> v_, old_;         // now, and when the step began
  std::vector<Motion> dv_, dx_;         // what the step would do without contacts
  std::vector<Motion> push_;            // by projection
  std::vector<char> closing_;           // a slow touch closed in this step
  std::vector<double> tau_;             // when in the step it was struck, s; -1: not
  std::vector<Motion> before_, after_;  // the blow
  std::vector<int> hit_;                // bodies struck
  std::vector<char> frozen_;            // that the rows are of

  // of pairs
  struct Approach {
    double vn[2] = {0, 0}, gap[2] = {0, 0};
    double n[2] = {0, 0}, t[2] = {0, 0};  // impulses of blows, N s
    bool struck[2] = {false, false};
    char waiting = 0;
  };
  std::vector<Approach> approach_;
  std::vector<int> queue_;
  std::vector<int> around_, around_start_;  // the awake pairs of each body
  std::vector<std::uint64_t> colours_;      // used on each body
  std::vector<int> count_;

  std::vector<sweep::Group> groups_;
  std::vector<sweep::Projection> projections_;
  long version_ = -1;
  int awake_pairs_ = 0;
};

}  // namespace obscura::sim
