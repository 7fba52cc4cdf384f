#pragma once

#include <string>
#include <string_view>

#include "scene/document.h"
#include "scene/table.h"
#include "sim/math/rational.h"
#include "sim/math/vec.h"

namespace obscura::scene {

/// A checked table, read by the names of its keys; keys that are absent have the default of the table of
/// keys.
class Fields {
 public:
  Fields(const Node& table, std::string owner) : table_(&table), owner_(std::move(owner)) {}
  /// The table under a key of the top, or an empty one.
  static Fields of(const Node& top, const std::string& owner);

  Place place() const { return table_->place; }
  /// The place where a value was written; if it was not, the place where its table begins.
  Place place(std::string_view key) const;
  const Node* given(std::string_view key) const { return table_->find(key); }
  /// The value; if it is absent, the default in the plane, or in space.
  const Node& node(std::string_view key, int dimension = 2) const;
  const Node& table() const { return *table_; }

  double number(std::string_view key) const { return node(key).number(); }
  template <int D>
  sim::Vec<D> vector(std::string_view key) const;
  sim::Rational rational(std::string_view key) const;
  bool flag(std::string_view key) const { return std::get<bool>(node(key).value); }
  const std::string& text(std::string_view key) const { return node(key).text(); }

 private:
  const Node* table_;
  std::string owner_;
};

/// Two numbers, or three. Requires a checked list of as many.
template <int D>
sim::Vec<D> vector(const Node& node);

/// The exact time of a checked number or fraction.
sim::Rational exact(const Node& node);

/// The number that the i-th of n has: itself, one of a list, or on the way { from, to }.
double number(const Node& node, int i, int n);
template <int D>
sim::Vec<D> vector(const Node& node, int i, int n);

/// A spin in radians a second from one in degrees: a number in the plane, a vector in space.
template <int D>
sim::AngularVec<D> spin(const Node& node, int i, int n);
template <>
sim::AngularVec<2> spin<2>(const Node& node, int i, int n);
template <>
sim::AngularVec<3> spin<3>(const Node& node, int i, int n);

/// The orientation that `angle` (in the plane) or `orientation` (in space) of a table gives, in radians or as
/// a unit quaternion; for the i-th of n copies. The identity if neither is given.
template <int D>
sim::Orientation<D> turn(const Fields& fields, int i = 0, int n = 1);
template <>
sim::Orientation<2> turn<2>(const Fields& fields, int i, int n);
template <>
sim::Orientation<3> turn<3>(const Fields& fields, int i, int n);

/// Degrees, as a person types them, as radians.
double radians(double degrees);

/// Radians as degrees.
double degrees(double radians);

}  // namespace obscura::scene
