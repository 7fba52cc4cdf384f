#pragma once

#include <concepts>
#include <optional>
#include <type_traits>
#include <variant>
#include <vector>

#include "sim/shape/form.h"

namespace obscura::sim {

/// The functions that a form of D dimensions must have (sim/shape/form.h says what each is). shape.cpp
/// asserts this for all Forms, so a form that lacks one fails to compile with the name of this concept.
template <class F, int D>
concept FormInterface = requires(const F& it, const Vec<D>& x, const Rotation<D>& axes,
                                 const Orientation<D>& turn, const Placing<D>& placing,
                                 std::vector<SupportVertex<D>>& all) {
  { it.spread() } -> std::same_as<Spread<D>>;
  it.add_support_vertices(all);
  { it.half_thickness() } -> std::same_as<double>;
  { it.bounding_radius() } -> std::same_as<double>;
  { it.bounds(x, axes) } -> std::same_as<Bounds<D>>;
  { it.outside(x) } -> std::same_as<double>;
  { it.moved(placing, turn) } -> std::same_as<Shape<D>>;
  { it.side(x) } -> std::same_as<std::optional<Vec<D>>>;
  { it.hold() } -> std::same_as<Vec<D>>;
  { it.drawn() } -> std::same_as<std::vector<DrawnForm>>;
};

/// The same of what collides as it is: all but a compound, whose parts do.
template <class F, int D>
concept ConvexFormInterface = FormInterface<F, D> && requires(const F& it) {
  { it.core() } -> std::same_as<Core<D>>;
};

/// Whether all forms of D dimensions answer.
template <int D>
constexpr bool all_forms_answer() {
  return []<class... F>(std::variant<F...>*) {
    return ((ConvexFormInterface<F, D> || (std::is_same_v<F, Compound<D>> && FormInterface<F, D>)) && ...);
  }(static_cast<Forms<D>*>(nullptr));
}

}  // namespace obscura::sim
