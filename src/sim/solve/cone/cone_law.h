#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>

namespace obscura::sim {

/// The tangential part of a contact: one component in the plane, two in space.
template <int D>
using Tangent = Eigen::Matrix<double, D - 1, 1>;

/// The law between a block's force f and its response w = K f + b.
enum class Law : std::uint8_t {
  equal,    // one row: w = 0, f free. Joints
  bounded,  // one row: lower <= f <= upper; w = 0 inside, w >= 0 at lower, w <= 0 at upper. Motors, limits
  contact   // D rows, normal first: f_n >= 0, w_n >= 0, f_n w_n = 0, and Coulomb's cone |f_t| <= mu f_n
};

/// How a block obeys its law.
enum class ModeKind : std::uint8_t {
  free,               // w = 0: equal, or bounded between its bounds
  at_lower,           // bounded: f = lower
  at_upper,           // bounded: f = upper
  open,               // contact: f = 0
  stick,              // contact: w = 0, f inside the cone
  at_friction_limit,  // contact: on the cone's surface, f_t = -mu f_n d, and w = 0 all the same
  slide               // contact: w_n = 0, f_t = -mu f_n d
};

/// One block of rows. A block's rows follow those of the block before it.
template <int D>
struct ConeBlock {
  Law law = Law::contact;
  double lower = -std::numeric_limits<double>::infinity();  // bounded
  double upper = std::numeric_limits<double>::infinity();   // bounded
  double mu = 0;                                            // contact
  bool sliding = false;                       // contact: moves already, so f_t = -mu f_n d whatever w_t
  Tangent<D> direction = Tangent<D>::Zero();  // d where it is sliding: unit, of its tangential velocity

  int rows() const { return law == Law::contact ? D : 1; }
};

/// The state of a block: its mode, and d for a contact on the cone's surface.
template <int D>
struct ConeMode {
  ModeKind kind = ModeKind::stick;
  Tangent<D> along =
      Tangent<D>::Zero();  // unit at the friction limit and where it slides: where it (would) slip to

  bool operator==(const ConeMode&) const = default;
};

}  // namespace obscura::sim
