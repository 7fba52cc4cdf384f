#pragma once

#include <string>
#include <vector>

#include "scene/when_names.h"
#include "sim/math/expression.h"

namespace obscura::scene {

/// What expressions of a [[when]] read of bodies and joints: "ball.vx", "axle.force". Each is a slot, in the
/// order in which they are met.
template <int D>
class Readings {
 public:
  /// Kept by reference.
  explicit Readings(const WhenNames<D>& names) : names_(names) {}

  /// Finds those of a text, which is at `node` under `key`. False where a name means several; told.
  bool read(const Node& node, const char* key, const std::string& text);

  const std::vector<std::string>& words() const { return words_; }
  const std::vector<sim::Reading>& all() const { return all_; }
  /// Words that are none, and why.
  const std::vector<sim::Symbol>& refused() const { return refused_; }
  /// Names that there are, to tell the most similar.
  std::vector<std::string> known() const;

 private:
  std::string refusal(int body, const std::string& quantity) const;

  const WhenNames<D>& names_;
  std::vector<std::string> words_;
  std::vector<sim::Reading> all_;
  std::vector<sim::Symbol> refused_;
};

}  // namespace obscura::scene
