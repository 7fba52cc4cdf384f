#pragma once

#include <vector>

#include "sim/model/snapshot.h"

namespace obscura::draw {

/// How far the bodies of a run reach in each of many directions: what a camera fits. Of all their places at
/// all instants it keeps one for each direction, the outmost.
class OutmostPlaces {
 public:
  /// Adds the forms of all bodies that are drawn, as they lie at an instant.
  void add(const sim::SceneInfo& cast, const sim::Snapshot& now);
  /// Adds the places on the ground under them, where their drop-lines end: on the most upright of the walls.
  void add_feet(const sim::SceneInfo& cast, const sim::Snapshot& now);
  void add(const OutmostPlaces& other);

  /// The outmost places, m, world frame; none before an instant is added. A direction between two of them
  /// may have a place farther out, by at most a thirtieth of the way across.
  std::vector<sim::Vec3> places() const;

 private:
  struct Outmost {
    double far = -1e300;  // along its direction, m
    sim::Vec3 at = sim::Vec3::Zero();
  };
  void offer(std::size_t k, const sim::Vec3& at);

  std::vector<Outmost> all_;  // one a direction
};

}  // namespace obscura::draw
