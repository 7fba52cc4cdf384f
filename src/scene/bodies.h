#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "draw/look.h"
#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/overrides.h"
#include "scene/room.h"
#include "sim/state.h"

namespace obscura::scene {

/// The bodies of one [[particle]], [[box]], ...: one, or its copies in a row.
struct Group {
  std::string name;          // as given, or "box[0]"
  Place place;               // of its name, or of its table
  Place at;                  // of its position, or of its table
  int first = 0, count = 1;  // bodies [first, first + count) of the model
  std::vector<int> grid;     // copies: how many in each direction; empty: none asked for
};

/// Who is in the scene, by name.
struct Roster {
  std::vector<Group> groups;
  std::map<std::string, int, std::less<>> index;  // name -> group
  std::vector<sim::Vec<2>> centers;               // one a body: its centre of mass, seen from its own origin
  std::map<std::string, int, std::less<>> families;  // what `group` says -> Body::group

  /// The bodies that a reference means ("ball", "ball[3]", "ball[*]"). Complains at `place` and gives none
  /// where there are none such.
  std::vector<int> bodies(const std::string& reference, Place place, Complaints& complaints) const;
  /// The group of a name. Complains at `place` where there is none.
  const Group* group(const std::string& name, Place place, Complaints& complaints) const;
};

/// Puts the bodies of a scene into a world and says what they look like. Complains of bodies outside the
/// room.
Roster bodies(const Node& top, const Room& room, std::uint64_t seed, const std::vector<CopySet>& sets,
              sim::World<2>& world, std::vector<draw::BodyLook>& looks, Complaints& complaints);

/// A point of a body in the room at the start.
sim::Vec<2> place(const sim::World<2>& world, int body, const sim::Vec<2>& local);

/// Degrees, as a person types them, as radians.
double radians(double degrees);

/// `v` turned by an angle (rad) counter-clockwise.
sim::Vec<2> turned(const sim::Vec<2>& v, double angle);

}  // namespace obscura::scene
