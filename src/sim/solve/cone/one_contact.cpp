// Three cases:
//   open    p = 0                                              where b_n >= 0
//   stick   K p = -b                                           where p lies within the cone
//   slide   p_t = -mu p_n d, w_n = 0, w_t along d              d a unit vector
// In the last case w_n = 0 gives p_n for each d, and d is a root of the cross product of d and w_t. The root
// is bracketed in sectors, beginning at the slip that the sticking force would oppose, and found by
// bisection.

#include "sim/solve/cone/one_contact.h"

#include <cmath>

namespace obscura::sim {

namespace {

constexpr int kSectors = 24;  // of half a circle, each of which is searched for a root
constexpr double kCosine = 0.99144486137381041, kSine = 0.13052619222005159;  // of the angle of one
constexpr int kHalvings = 60;                                                 // of a sector
constexpr double kSingular = 1e-10;  // of a diagonal element of K: a smaller pivot is rounding

using Flat = Eigen::Vector2d;

double cross(const Flat& p, const Flat& q) { return p[0] * q[1] - p[1] * q[0]; }

// a contact that slides along d
struct Slide {
  const Eigen::Matrix3d& K;
  const Vec3& b;
  double mu;

  // of the normal; negative: nothing holds it
  double normal(const Flat& d) const { return -b[0] / (K(0, 0) - mu * (K(0, 1) * d[0] + K(0, 2) * d[1])); }
  Flat slip(const Flat& d) const {
    const double p = normal(d), x = -mu * p * d[0], y = -mu * p * d[1];
    return {b[1] + K(1, 0) * p + K(1, 1) * x + K(1, 2) * y, b[2] + K(2, 0) * p + K(2, 1) * x + K(2, 2) * y};
  }
  // how far the slip turns from d
  double turn(const Flat& d) const { return cross(d, slip(d)); }
};

}  // namespace

bool solve_one_contact(const Eigen::Matrix3d& K, const Vec3& b, double mu, Vec3& p) {
  p.setZero();
  if (b[0] >= 0) return true;
  if (!(K(0, 0) > 0)) return false;
  if (mu == 0) {
    p[0] = -b[0] / K(0, 0);
    return true;
  }

  // stick: K = L L'
  const double d0 = K(0, 0), l10 = K(1, 0) / d0, l20 = K(2, 0) / d0;
  const double d1 = K(1, 1) - l10 * K(1, 0), l21 = (K(2, 1) - l20 * K(1, 0)) / d1;
  const double d2 = K(2, 2) - l20 * K(2, 0) - l21 * l21 * d1;
  if (!(d1 > kSingular * K(1, 1)) || !(d2 > kSingular * K(2, 2))) return false;
  const double y1 = -b[1] + l10 * b[0], y2 = -b[2] + l20 * b[0] - l21 * y1;
  p[2] = y2 / d2, p[1] = y1 / d1 - l21 * p[2], p[0] = -b[0] / d0 - l10 * p[1] - l20 * p[2];
  const Flat wanted(-p[1], -p[2]);
  if (p[0] >= 0 && wanted.squaredNorm() <= mu * mu * p[0] * p[0]) return true;

  const Slide slide{K, b, mu};
  if (!(K(0, 0) > mu * std::sqrt(K(0, 1) * K(0, 1) + K(0, 2) * K(0, 2)))) return false;  // it may jam
  const Flat first = wanted / std::sqrt(wanted.squaredNorm());
  const double begun = slide.turn(first);
  // w_t has turned from d towards the root
  const double side = begun > 0 ? 1 : -1;
  const Flat by(kCosine, side * kSine);
  Flat low = first, high = first;
  for (int i = 0; begun != 0; ++i) {
    if (i == kSectors) return false;
    high = Flat(low[0] * by[0] - low[1] * by[1], low[0] * by[1] + low[1] * by[0]);
    if (side * slide.turn(high) <= 0) break;
    low = high;
  }
  for (int i = 0; i < kHalvings; ++i) {
    Flat mid = low + high;
    mid /= std::sqrt(mid.squaredNorm());
    if (mid == low || mid == high) break;
    (side * slide.turn(mid) > 0 ? low : high) = mid;
  }
  if (slide.slip(low).dot(low) < 0) return false;
  p[0] = slide.normal(low), p[1] = -mu * p[0] * low[0], p[2] = -mu * p[0] * low[1];
  return true;
}

}  // namespace obscura::sim
