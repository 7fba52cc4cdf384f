// Cubic Hermite interpolation with the slopes of parabolas (Bessel's tangents).
//   secant_i = (p_{i+1} - p_i) / h_i                                   h_i  from knot i to the next, s
//   slope_i  = (h_i secant_{i-1} + h_{i-1} secant_i) / (h_{i-1} + h_i)
//   slope_0  = 2 secant_0 - slope_1, and likewise at the end

#include "sim/model/path.h"

#include <algorithm>
#include <cassert>

namespace obscura::sim {

template <int D>
Path<D>::Path(const std::vector<Knot<D>>& knots, bool from_rest) {
  assert(knots.size() >= 2);
  for (const Knot<D>& knot : knots) {
    times_.push_back(value(knot.time));
    places_.push_back(knot.place);
  }
  const std::size_t n = knots.size();
  const auto span = [&](std::size_t i) { return times_[i + 1] - times_[i]; };
  const auto secant = [&](std::size_t i) { return Vec<D>((places_[i + 1] - places_[i]) / span(i)); };
  slopes_.assign(n, secant(0));
  if (n == 2) {
    if (from_rest) slopes_.assign(n, Vec<D>::Zero());
    return;
  }
  for (std::size_t i = 1; i + 1 < n; ++i) {
    slopes_[i] = (span(i) * secant(i - 1) + span(i - 1) * secant(i)) / (span(i - 1) + span(i));
  }
  slopes_[0] = 2 * secant(0) - slopes_[1];
  slopes_[n - 1] = 2 * secant(n - 2) - slopes_[n - 2];
  if (from_rest) slopes_.front().setZero(), slopes_.back().setZero();
}

template <int D>
typename Path<D>::Motion Path<D>::at(double t) const {
  if (t < times_.front()) return {places_.front(), Vec<D>::Zero()};
  if (t > times_.back()) return {places_.back(), Vec<D>::Zero()};
  const auto after = std::upper_bound(times_.begin(), times_.end(), t);
  const std::size_t i = std::min<std::size_t>(after - times_.begin(), times_.size() - 1) - 1;
  const double h = times_[i + 1] - times_[i];
  const double u = (t - times_[i]) / h;

  // p(u) = p + h u (m + u (b + u a)),  u = 0 .. 1 between the knots
  const Vec<D> rise = (places_[i + 1] - places_[i]) / h;
  const Vec<D> a = slopes_[i] + slopes_[i + 1] - 2 * rise;
  const Vec<D> b = rise - slopes_[i] - a;
  return {places_[i] + h * u * (slopes_[i] + u * (b + u * a)), slopes_[i] + u * (2 * b + 3 * u * a),
          (2 * b + 6 * u * a) / h};
}

template class Path<2>;
template class Path<3>;

}  // namespace obscura::sim
