#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/complaints.h"
#include "scene/document.h"
#include "sim/force/formula.h"

namespace obscura::scene {

/// An expression as it was typed; a number stands for itself.
std::string typed(const Node& node);

/// Complains of an expression under `key`, at its column, with the most similar of `names`.
void complain(const Node& node, std::string_view key, const sim::ExpressionFault& fault,
              const std::vector<std::string>& names, Diagnostics& complaints);

/// [constants]: numbers, or expressions of those before.
class Constants {
 public:
  Constants(const Node& top, Diagnostics& complaints);

  const sim::NamedNumbers& numbers() const { return numbers_; }

  /// An expression of the scene, which may read some.
  void read_by(std::string text) { texts_.push_back(std::move(text)); }

  /// Complains of a constant that --set adds and no expression reads: another was meant.
  void refuse_unused() const;

 private:
  const Node& top_;
  Diagnostics& complaints_;
  sim::NamedNumbers numbers_;
  std::vector<std::string> texts_;
};

}  // namespace obscura::scene
