#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "sim/math/expression.h"

namespace obscura::sim {

/// The formula of a condition: whether it is true, then a margin of each of its comparisons, above zero where
/// that is true. `quantities` are its slots, the time t follows them. Requires names with a dot, or refusals.
std::variant<Program, ExpressionFault> condition_formula(
    std::string_view text, std::span<const std::string> quantities, std::span<const Symbol> refused,
    std::span<const std::pair<std::string, double>> constants);

/// The formulas of several values, one output each, times `unit`; the same slots. A fault is of the text of
/// that number.
std::variant<Program, std::pair<int, ExpressionFault>> value_formulas(
    std::span<const std::string> texts, double unit, std::span<const std::string> quantities,
    std::span<const Symbol> refused, std::span<const std::pair<std::string, double>> constants);

}  // namespace obscura::sim
