#pragma once

#include <utility>
#include <vector>

#include "sim/collide/core_shapes.h"
#include "sim/constraint/material.h"
#include "sim/model/state.h"
#include "sim/solve/iterate/contact_rows.h"
#include "sim/solve/iterate/near_pairs.h"

namespace obscura::sim::plane {

/// Two cores, or a core and a wall, that may touch before pairs are looked for again. Its touches are entries
/// `first` and the next of State::contacts.
struct Pair {
  int a = -1, b = -1;            // bodies; b = -1 - wall
  int core_a = -1, core_b = -1;  // -1: a wall
  int first = 0, touches = 1;
  int words[2] = {0, 0};   // of the features of its touches, ascending
  int slot = -1;           // lane + kLanes * group; -1: asleep
  int colour = -1;         // of its lane
  bool alone = false;      // colours ran out: it has a batch of its own
  bool fresh = false;      // its features have changed since it took its lane
  float impact_speed = 0;  // m/s: no slower approach is an impact
  Material material;
};

/// What touches, or will.
class Pairs {
 public:
  explicit Pairs(const Model<2>& model, const CoreShapes& cores);

  /// Finds the pairs nearer than their bodies can come within `span` s, and writes their touches into
  /// state.contacts; forces of the same touches stay. A pair whose two sides rest, or are calm for `patience`
  /// spans, stays as it is. False where nothing was changed.
  bool find(State<2>& state, const std::vector<Pose>& poses, double span, int patience);

  /// Makes the pairs those of state.contacts, where they are not already.
  void adopt(const State<2>& state);

  /// Pairs whose features are others than their lanes say, `share` of the time between two pair searches
  /// after the last. They are not changed yet.
  const std::vector<Outdated>& outdated(const std::vector<ContactBatch>& batches,
                                        const std::vector<Motion>& v, const std::vector<Pose>& poses,
                                        double share);
  /// Changes the features of a pair to these. Forces move with their keys or, failing that, their places.
  void renew(const Outdated& found, State<2>& state, const std::vector<Pose>& poses);
  bool boxes(const Pair& pair) const { return pair.b >= 0 && near_.boxes(pair.a, pair.b); }

  const std::vector<Pair>& all() const { return pairs_; }
  std::vector<Pair>& all() { return pairs_; }

  /// Grows whenever the pairs change.
  long version() const { return version_; }

  ContactPoint place(const Pair& pair, const std::vector<Pose>& poses, Feature feature) const;

  /// Words of the features nearest to each other where its bodies stand so, ascending.
  void features(const Pair& pair, const Pose& a, const Pose& b, int words[2]) const;
  /// Features into the pair's lane of its lanes, or of others like them; forces are let be.
  void put(const Pair& pair, const int words[2], ContactBatch& batches) const;

  /// How far a body may come by speed (m/s) that it may gain within `span` s, by impacts.
  double spare(int body, double speed, double span) const { return near_.spare(body, speed, span); }
  /// How far a body that is moved gets in the next span from where its velocity takes it, m.
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

  std::vector<Outdated> outdated_;
  Found others_;
};

}  // namespace obscura::sim::plane
