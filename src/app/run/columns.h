#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "sim/model/snapshot.h"

namespace obscura::app {

/// A number that every state has, under the path that --set and --measure know it by.
struct Column {
  std::string name;  // "energy.total", "crate.position.x"
  std::function<double(const sim::Snapshot&)> read;
};

/// The columns of a run's states as `states --format csv` has them, in its order and without the hash: time,
/// step, energies, momenta, contacts, then bodies and joints. `axes`: those in which each body was typed
/// (scene::Scene); an orientation is read as it was typed, not as its principal axes lie.
std::vector<Column> columns(const sim::SceneInfo& cast, const std::vector<Eigen::Quaterniond>& axes);

}  // namespace obscura::app
