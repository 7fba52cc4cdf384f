#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/complaints.h"
#include "scene/fields.h"
#include "sim/math/orientation.h"

namespace obscura::scene {

/// How a body begins, seen from the frame that was typed.
template <int D>
struct Start {
  sim::Vec<D> position = sim::Vec<D>::Zero(), velocity = sim::Vec<D>::Zero();  // m, m/s
  sim::Orientation<D> turn = sim::no_rotation<D>();
  sim::AngularVec<D> spin = sim::AngularVec<D>::Zero();  // rad/s
  bool fixed = false;
};

/// How the copies of one body lie: along a grid, then turned about a place, then a little aside.
template <int D>
struct Copies {
  bool asked = false;                      // false: there is but the one
  std::vector<int> sides{1};               // how many in each direction of the grid
  std::vector<sim::Vec<D>> steps;          // one in each, m
  double turn = 0;                         // of each from the one before, deg
  sim::Vec<D> axis = sim::Vec<D>::Zero();  // of that, unit; of the plane there is but one way
  std::optional<sim::Vec<D>> around{};
  double jitter = 0;                  // m
  std::vector<sim::Vec<D>> places{};  // of each, if the table gives them

  int count() const;
  /// The orientation of the i-th copy, for a body whose table is `fields`.
  sim::Orientation<D> orientation(const Fields& fields, int i) const;
  /// Moves what begins as it was typed to where the i-th does; the random numbers are those of a stream.
  void move(Start<D>& start, int i, std::uint64_t seed, std::uint64_t stream) const;
};

/// The copies that a body's table asks for. Complains, and returns nothing, if with `so_far` there would be
/// too many bodies, or if a list over copies has another number of values than there are copies.
template <int D>
std::optional<Copies<D>> copies(const Fields& fields, const std::string& kind, int so_far,
                                Diagnostics& complaints);

/// The key that says how a body is turned, of the kinds that are.
template <int D>
constexpr const char* kTurnKey = D == 2 ? "angle" : "orientation";

/// The table of the i-th of n copies as it would have been typed alone, with its own place and values; with
/// its turn where `turn`.
template <int D>
Node single(const Fields& fields, const std::string& kind, int i, int n, const Start<D>& start, bool turn);

}  // namespace obscura::scene
