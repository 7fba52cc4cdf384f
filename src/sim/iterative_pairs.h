#pragma once

#include <tuple>
#include <utility>
#include <vector>

#include "sim/iterative_cores.h"
#include "sim/iterative_grid.h"
#include "sim/iterative_rows.h"
#include "sim/state.h"

namespace obscura::sim::sweep {

/// Two cores, or a core and a wall, that may touch before pairs are looked for again. Its touches are entries
/// `first` and the next of State::contacts.
struct Pair {
  int a = -1, b = -1;            // bodies; b = -1 - wall
  int core_a = -1, core_b = -1;  // -1: a wall
  int first = 0, touches = 1;
  int slot = -1;       // lane + kLanes * group; -1: asleep
  int colour = -1;     // of its seat
  bool alone = false;  // colours ran out: nobody sits beside it
  double friction = 0, elasticity = 0;
};

/// What is the same for all pairs of a model: who may touch whom.
class Pairs {
 public:
  explicit Pairs(const Model<2>& model, const Cores& cores);

  /// Finds the pairs nearer than their bodies can come within `span` s, and writes their touches into
  /// state.contacts; forces of the same touches stay. A pair whose two sides rest stays as it is; unless
  /// `all`, also one whose sides are calm: so slow that they come nowhere until the next look at all, which
  /// is no more than kCalmLooks spans away. False where nothing was changed.
  bool find(State<2>& state, const std::vector<Pose>& poses, double span, bool all);
  static constexpr int kCalmLooks = 16;

  /// Makes the pairs those of state.contacts, where they are not already.
  void adopt(const State<2>& state);

  /// Features of a pair anew, false where they stay; its forces move with their keys or, failing that, their
  /// places.
  /// `report(pair)` is asked for the forces of a pair before they are moved.
  template <class Report>
  bool renew(const Pair& pair, State<2>& state, const std::vector<Pose>& poses, Report&& report) {
    int words[2];
    if (same_features(pair, state, poses, words)) return false;
    report(pair);
    replace(pair, state, poses, words);
    return true;
  }

  const std::vector<Pair>& all() const { return pairs_; }
  std::vector<Pair>& all() { return pairs_; }

  /// Grows whenever the pairs change.
  long version() const { return version_; }

  Place place(const Pair& pair, const std::vector<Pose>& poses, Feature feature) const;

  /// How far a body may come within `span` s by itself, m.
  double room_to_move(const State<2>& state, int body, double span) const;

  /// What of this is for speed (m/s) that it may gain meanwhile, by blows.
  double spare(int body, double speed, double span) const;

 private:
  bool may_touch(int a, int b) const;
  bool same_features(const Pair& pair, const State<2>& state, const std::vector<Pose>& poses,
                     int words[2]) const;
  void replace(const Pair& pair, State<2>& state, const std::vector<Pose>& poses, const int words[2]);
  double speed(const State<2>& state, int body) const;
  void expose(const State<2>& state, const std::vector<Pose>& poses, double span);
  void inherit(const Pair& pair, const std::vector<Pose>& poses, const Contact<2>* old, int count,
               Contact<2>* now) const;
  Pair pair(int a, int b, int core_a, int core_b) const;

  const Model<2>& model_;
  const Cores& cores_;
  bool still(int body) const { return body < 0 || still_[body] != 0; }

  std::vector<Pair> pairs_, found_;
  long version_ = 0;

  Grid grid_;
  std::vector<Bounds> bounds_;  // of cores
  std::vector<double> margin_;  // of bodies, m
  std::vector<int> near_;
  std::vector<char> still_;    // bodies that pairs need not be looked for
  std::vector<char> exposed_;  // bodies that may be struck within the span
  struct Candidate {
    int a, b;  // cores
    bool close;
  };
  std::vector<Candidate> candidates_;
  double calm_ = 0;  // m/s, times the span
  std::vector<Contact<2>> contacts_;
  std::vector<std::pair<int, int>> joined_;  // sorted
  bool compounds_ = false;
};

}  // namespace obscura::sim::sweep
