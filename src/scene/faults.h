#pragma once

#include <string>

#include "scene/complaints.h"
#include "scene/dimension.h"
#include "scene/document.h"
#include "scene/table.h"

namespace obscura::scene {

/// Words the faults of a value in a scene of the plane or of space. Its functions that complain return false,
/// so that a check may end with them.
class Reporter {
 public:
  Reporter(const Dimension& told, Diagnostics& complaints) : told_(told), complaints_(complaints) {}

  bool wrong(const Node& node, std::string message);
  /// "'mass': expected a number of kilograms, got a list": another type than the key takes, or than `what`.
  bool mistyped(const Node& node, const Key& key) { return mistyped(node, key, expected(key)); }
  bool mistyped(const Node& node, const Key& key, const std::string& what);
  /// The same with words for what there is: "got 3 of them".
  bool instead(const Node& node, const Key& key, const std::string& got) {
    return instead(node, key, expected(key), got);
  }
  bool instead(const Node& node, const Key& key, const std::string& what, const std::string& got);
  /// "unknown key 'axes' in an orientation" and a hint: an entry of a table that has no such key.
  bool unknown(const Entry& entry, const std::string& in, const std::string& hint);

  /// "'size' at a.toml:2:8 has 3": why the scene has the dimension that it has.
  std::string because() const;
  /// The values that a key takes in this scene.
  std::string expected(const Key& key) const { return scene::expected(key, dimension()); }
  int dimension() const { return told_.n; }
  /// Whether a key is of scenes such as this one.
  bool has(const Key& key) const { return key.dimension == 0 || key.dimension == dimension(); }

 protected:
  Diagnostics& complaints() { return complaints_; }

 private:
  const Dimension& told_;
  Diagnostics& complaints_;
};

}  // namespace obscura::scene
