#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/when_names.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// What is before the last key of a path, where that is `key`: "gate[2]" of "gate[2].fixed".
std::optional<std::string> owner(const std::string& path, std::string_view key);

/// The number of the drive of a body that is fixed or moved, or -1.
template <int D>
int drive_of(const sim::Model<D>& model, int body) {
  for (std::size_t i = 0; i < model.drives.size(); ++i)
    if (model.drives[i].body == body) return int(i);
  return -1;
}

/// The changes that actions of conditions make, on their way into a world.
template <int D>
class Changes {
 public:
  using Change = sim::Change<D>;
  using When = sim::When<D>;

  /// All are kept by reference.
  Changes(const WhenNames<D>& known, sim::World<D>& world, Diagnostics& told)
      : names(known), model(world.model), complaints(told) {}

  const WhenNames<D>& names;
  sim::Model<D>& model;
  Diagnostics& complaints;

  /// Whether the scene has bonds, and events cannot change it; complains at the place.
  bool bonded(Place place);
  /// Whether a body is free, or moved, or let go some time.
  bool moves(int body) const;
  /// Lets go of the bodies of a name.
  void let_go(Place place, const std::string& text, When& when);

  /// A change of one thing, SI units.
  static Change of(typename Change::Of of, int index, double value = 0);
  /// The number that a change gets.
  int number(Change change);
  /// One action that makes all of these changes; false, and none, where there are none.
  bool give(const std::vector<Change>& changes, When& when);
};

}  // namespace obscura::scene
