#pragma once

#include <memory>
#include <vector>

#include "sim/model/state.h"
#include "sim/step/run.h"

namespace obscura::sim {

/// A body's pose at an instant, as another program says.
struct Sighting {
  Vec3 position = Vec3::Zero();                                     // of the centre of mass, m
  Vec3 velocity = Vec3::Zero();                                     // m/s
  Vec3 spin = Vec3::Zero();                                         // rad/s; in the plane (0, 0, w)
  double angle = 0;                                                 // in the plane: rad, not wrapped
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // in space: of the body's own frame
};

/// The result of another program: poses of every body, in the model's order, at increasing times.
struct Trajectory {
  std::vector<double> times;                 // s
  std::vector<std::vector<Sighting>> poses;  // one list an instant
  bool interpolate = false;  // between two times on straight lines, turning at a constant rate
  double same = 5e-7;        // s: times so near are one

  /// Whether it says where bodies are at time t.
  bool has(double t) const;
  std::vector<Sighting> at(double t) const;  // requires has(t)
};

/// A run that steps nothing: it hands out the instants of a trajectory, with the springs, joints and hands of
/// a world where they then are. Forces and contacts there are none. An instant that the trajectory has not is
/// Trouble.
std::unique_ptr<Run> playback(World<2> world, std::shared_ptr<const Trajectory> trajectory);
std::unique_ptr<Run> playback(World<3> world, std::shared_ptr<const Trajectory> trajectory);

}  // namespace obscura::sim
