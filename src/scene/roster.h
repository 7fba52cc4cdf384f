#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "scene/complaints.h"
#include "sim/math/orientation.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// The bodies of one [[particle]], [[box]], ...: one, or its copies in a row.
struct Group {
  std::string name;          // as given, or "box[0]"
  Place place;               // of its name, or of its table
  Place at;                  // of its position, or of its table
  int first = 0, count = 1;  // bodies [first, first + count) of the model
  std::vector<int> grid;     // copies: how many in each direction; empty: none asked for
};

/// The scene's bodies, springs and joints by name.
struct NameTable {
  std::vector<Group> groups;
  std::map<std::string, int, std::less<>> index;     // name -> group
  std::set<std::string, std::less<>> wrong;          // names of bodies that could not be made, which is told
  std::map<std::string, int, std::less<>> families;  // what `group` says -> Body::group

  /// The bodies that a reference means ("ball", "ball[3]", "ball[*]"). Complains at `place` and gives none
  /// where there are none such.
  std::vector<int> bodies(const std::string& reference, Place place, Diagnostics& complaints) const;
  /// The group of a name. Complains at `place` where there is none, and has been none wrong.
  const Group* group(const std::string& name, Place place, Diagnostics& complaints) const;
};

/// How a body's frame lies in the one that was typed: its centre of mass, and in space its principal axes.
template <int D>
struct Seat {
  sim::Vec<D> center = sim::Vec<D>::Zero();
  sim::Orientation<D> axes = sim::no_rotation<D>();

  /// A point of the frame that was typed, in the body's.
  sim::Vec<D> seen(const sim::Vec<D>& typed) const;
};

/// The same, and how each body lies in what was typed.
template <int D>
struct Seating : NameTable {
  std::vector<Seat<D>> seats;  // one a body
};

/// A point of a body in the room at the start.
template <int D>
sim::Vec<D> place(const sim::World<D>& world, int body, const sim::Vec<D>& local);

/// How a body is turned at the start.
template <int D>
sim::Orientation<D> turn_of(const sim::World<D>& world, int body);

/// `v` turned.
template <int D>
sim::Vec<D> turned(const sim::Vec<D>& v, const sim::Orientation<D>& turn);

}  // namespace obscura::scene
