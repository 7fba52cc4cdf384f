#pragma once

#include <cmath>

#include "sim/shape/curve.h"

namespace obscura::sim {

// One piece of a curve (sim/shape/curve.h), u from 0 to its end.

/// How far a polynomial piece may turn, rad.
inline constexpr double kMostTurn = 0.25;

template <int D>
double length_of(const Vec<D>& v) {
  return std::sqrt(v.squaredNorm());
}

/// The angle between two directions, rad. Requires unit vectors.
template <int D>
double angle_of(const Vec<D>& u, const Vec<D>& v);

/// c(u), c'(u) and c''(u).
template <int D>
void place_on(const typename Curve<D>::Piece& piece, double u, Vec<D>& x, Vec<D>& first, Vec<D>& second);

/// How long it is from its beginning to u, m.
template <int D>
double partial_length(const typename Curve<D>::Piece& piece, double u);

/// The same polynomial piece from u0 to u1, as one from 0 to 1.
template <int D>
typename Curve<D>::Piece part_of(const typename Curve<D>::Piece& piece, double u0, double u1);

/// How far a piece turns, rad, about.
template <int D>
double turning_of(const typename Curve<D>::Piece& piece);

}  // namespace obscura::sim
