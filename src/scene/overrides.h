#pragma once

#include <string>
#include <vector>

#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/path.h"

namespace obscura::scene {

/// A value set from outside on one of several copies: it waits until the copies are made.
struct CopySet {
  std::string kind;  // "particle", "box"
  int table = 0;     // which [[particle]] of the file
  int copy = 0;
  std::vector<Step> path;  // under the copy
  Node value;
  Place place;
};

/// Writes the overrides ("crate.elasticity=0.5") into a document, before it is checked, so that their faults
/// are found with all others. Returns those that mean one copy ("ball[3].mass=2").
std::vector<CopySet> apply(const std::vector<std::string>& sets, Node& top, Diagnostics& complaints);

/// Writes a value under a table of the language ("box", "room") along a path, of a scene in the plane or in
/// space.
void write(Node& table, const std::string& owner, const std::vector<Step>& path, Node value, Place place,
           int dimension, Diagnostics& complaints);

}  // namespace obscura::scene
