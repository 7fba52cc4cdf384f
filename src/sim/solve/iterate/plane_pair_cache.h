#pragma once

#include <utility>
#include <vector>

#include "sim/collide/core_shapes.h"
#include "sim/constraint/material.h"
#include "sim/model/state.h"
#include "sim/solve/iterate/plane_contact_rows.h"
#include "sim/solve/iterate/plane_near_pairs.h"

namespace obscura::sim::plane {

/// Two cores, or a core and a wall, that may touch before the next pair search. It has one or two contact
/// points (touches): the entries of State::contacts from `first` on.
struct Pair {
  int a = -1, b = -1;            // bodies; b = -1 - wall
  int core_a = -1, core_b = -1;  // -1: a wall
  int first = 0, touches = 1;
  int words[2] = {0, 0};   // Feature::word() of its contact points, ascending
  int slot = -1;           // lane + kLanes * group; -1: asleep
  int colour = -1;         // of its lane
  bool alone = false;      // colours ran out: it has a batch of its own
  bool fresh = false;      // its features have changed since it took its lane
  float impact_speed = 0;  // m/s: no slower approach is an impact
  Material material;
};

/// The pairs of cores that touch or may soon, kept from step to step, with their features.
class Pairs {
 public:
  explicit Pairs(const Model<2>& model, const CoreShapes& cores);

  /// Finds the pairs that may touch within `span` s, and writes their contact points into state.contacts.
  /// Points of the same features keep their forces. A pair whose two bodies rest, or are calm for `patience`
  /// spans, stays as it is. False if nothing changed.
  bool find(State<2>& state, const std::vector<Pose>& poses, double span, int patience);

  /// Rebuilds the pairs from state.contacts, if they do not agree.
  void adopt(const State<2>& state);

  /// Finds the pairs whose features differ from those in their lanes; changes nothing. `share`: the time
  /// since the last pair search, as a part of the time between two.
  const std::vector<ChangedPair>& outdated(const std::vector<ContactBatch>& batches,
                                           const std::vector<Motion>& v, const std::vector<Pose>& poses,
                                           double share);
  /// Gives a pair these features. Forces go to the point of the same features, else to the nearest.
  void renew(const ChangedPair& found, State<2>& state, const std::vector<Pose>& poses);
  bool boxes(const Pair& pair) const { return pair.b >= 0 && near_.boxes(pair.a, pair.b); }

  const std::vector<Pair>& all() const { return pairs_; }
  std::vector<Pair>& all() { return pairs_; }

  /// Grows whenever the pairs change.
  long version() const { return version_; }

  ContactPoint place(const Pair& pair, const std::vector<Pose>& poses, Feature feature) const;

  /// Feature::word() of the nearest features at these poses, ascending.
  void features(const Pair& pair, const Pose& a, const Pose& b, int words[2]) const;
  /// Writes the features into the pair's lane of a batch. Forces stay as they are.
  void put(const Pair& pair, const int words[2], ContactBatch& batches) const;

  /// How far a body of `speed` m/s may come by what it gains in impacts within `span` s, m.
  double spare(int body, double speed, double span) const { return near_.spare(body, speed, span); }
  /// How far a kinematic body may be, in the next span, from where its present velocity takes it, m.
  void foresee(int body, double farther) { near_.foresee(body, farther); }

 private:
  void inherit(const Pair& pair, const std::vector<Pose>& poses, const Contact<2>* old, int count,
               Contact<2>* now) const;
  Pair pair(int a, int b, int core_a, int core_b) const;
  int feature(const Pair& pair, int word) const;
  void gather_found(const std::vector<Pose>& poses);

  const Model<2>& model_;
  const CoreShapes& cores_;
  NearPairs near_;
  std::vector<Material> materials_;  // of bodies

  std::vector<Pair> pairs_, found_;
  long version_ = 0;
  std::vector<Contact<2>> contacts_;
  bool compounds_ = false;

  std::vector<ChangedPair> outdated_;
  LaneList others_;
};

}  // namespace obscura::sim::plane
