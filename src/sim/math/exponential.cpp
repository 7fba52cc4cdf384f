// The exponential map of rotations. Hairer, Lubich and Wanner, Geometric Numerical Integration, 2006, §IV.7
// and IV.8; Munthe-Kaas, High order Runge-Kutta methods on manifolds, 1999. With theta = |d|, q = q0 exp(d)
// and the spin w seen from what turns (dexp of -d in their letters):
//   exp(d)   = (sin(theta/2) d/theta, cos(theta/2))
//   w        = d' - (1 - cos theta)/theta^2 d x d' + (theta - sin theta)/theta^3 d x (d x d')
//   d'       = w + d x w / 2 + (1 - theta/2 cot(theta/2))/theta^2 d x (d x w)
// Seen from the body and not from the room because the spin of a tumbling body varies less there: classical
// Runge-Kutta at 1/1000 s keeps the Dzhanibekov top for 10 s to 2e-11, in the room's axes to 6e-9. Each
// quotient has a series about zero, used where the closed form would cancel.

#include "sim/math/exponential.h"

#include <cmath>

#include "sim/math/trig.h"

namespace obscura::sim {

namespace {

// sum c[i] z^i
template <int N>
double series(const double (&c)[N], double z) {
  double sum = c[N - 1];
  for (int i = N - 2; i >= 0; --i) sum = sum * z + c[i];
  return sum;
}

// below this theta^2 the series are as good as the closed forms, above it the closed forms are
constexpr double kSmall = 0.25;

// sin(theta/2)/theta; next term left out is below 2^-60 of the first
double half_sine(double theta2, double theta, double sin_half) {
  constexpr double c[] = {1.0 / 2, -1.0 / 48, 1.0 / 3840, -1.0 / 645120, 1.0 / 185794560, -1.0 / 81749606400};
  return theta2 < kSmall ? series(c, theta2) : sin_half / theta;
}

// (1 - theta/2 cot(theta/2))/theta^2 = sum |B_2n| theta^(2n-2) / (2n)!
double inverse_coefficient(double theta2) {
  constexpr double c[] = {1.0 / 12,          1.0 / 720,
                          1.0 / 30240,       1.0 / 1209600,
                          1.0 / 47900160,    691.0 / 1307674368000,
                          1.0 / 74724249600, 3617.0 / 10670622842880000};
  if (theta2 < kSmall) return series(c, theta2);
  const double half = 0.5 * std::sqrt(theta2);
  const auto [s, co] = sin_cos(half);
  return (1 - half * co / s) / theta2;
}

// the angle whose sine and cosine are s and c, s >= 0: a first guess within 0.005, bettered twice by the
// small angle between
double half_angle(double s, double c) {
  const double r = s < std::fabs(c) ? s / std::fabs(c) : std::fabs(c) / s;
  const double first = r * (0.785398163397448 + 0.273 * (1 - r));
  const double acute = s < std::fabs(c) ? first : 1.5707963267948966 - first;
  double angle = c < 0 ? 3.141592653589793 - acute : acute;
  for (int pass = 0; pass < 2; ++pass) {
    const auto [sa, ca] = sin_cos(angle);
    const double off = s * ca - c * sa;  // sine of what is missing
    angle += off + off * off * off / 6;
  }
  return angle;
}

}  // namespace

Eigen::Vector4d product(const Eigen::Vector4d& a, const Eigen::Vector4d& b) {
  return {a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
          a[3] * b[1] + a[1] * b[3] + a[2] * b[0] - a[0] * b[2],
          a[3] * b[2] + a[2] * b[3] + a[0] * b[1] - a[1] * b[0],
          a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
}

Eigen::Vector4d exponential(const Vec3& turn) {
  const double theta2 = turn.squaredNorm();
  const double theta = std::sqrt(theta2);
  const auto [s, c] = sin_cos(0.5 * theta);
  const double k = half_sine(theta2, theta, s);
  return {k * turn[0], k * turn[1], k * turn[2], c};
}

Vec3 logarithm(const Eigen::Vector4d& q) {
  const double sign = q[3] < 0 ? -1 : 1;
  const Vec3 axis = sign * q.head<3>();
  const double s = axis.norm();
  if (s == 0) return Vec3::Zero();
  return axis * (2 * half_angle(s, sign * q[3]) / s);
}

Eigen::Vector4d turned(const Eigen::Vector4d& q, const Vec3& by) {
  if (by.isZero(0)) return q;
  const Eigen::Vector4d to = product(q, exponential(by));
  return to / std::sqrt(to.squaredNorm());
}

Vec3 turn_rate(const Vec3& d, const Vec3& w) {
  const Vec3 dw = d.cross(w);
  return w + 0.5 * dw + inverse_coefficient(d.squaredNorm()) * d.cross(dw);
}

Vec3 spin_of(const Vec3& d, const Vec3& rate) {
  const double theta2 = d.squaredNorm();
  double first, second;
  if (theta2 < kSmall) {
    constexpr double a[] = {1.0 / 2,       -1.0 / 24,        1.0 / 720,        -1.0 / 40320,
                            1.0 / 3628800, -1.0 / 479001600, 1.0 / 87178291200};
    constexpr double b[] = {1.0 / 6,        -1.0 / 120,        1.0 / 5040,         -1.0 / 362880,
                            1.0 / 39916800, -1.0 / 6227020800, 1.0 / 1307674368000};
    first = series(a, theta2);
    second = series(b, theta2);
  } else {
    const double theta = std::sqrt(theta2);
    const auto [s, c] = sin_cos(theta);
    first = (1 - c) / theta2;
    second = (theta - s) / (theta2 * theta);
  }
  const Vec3 dr = d.cross(rate);
  return rate - first * dr + second * d.cross(dr);
}

Eigen::Matrix3d matrix(const Eigen::Vector4d& q) {
  return Eigen::Quaterniond(q[3], q[0], q[1], q[2]).toRotationMatrix();
}

Eigen::Matrix3d about(const Vec3& axis, double sin, double cos) {
  const Vec3 versed = (1 - cos) * axis;
  Eigen::Matrix3d turn = versed * axis.transpose();
  turn.diagonal().array() += cos;
  const Vec3 s = sin * axis;
  turn(0, 1) -= s[2];
  turn(1, 0) += s[2];
  turn(0, 2) += s[1];
  turn(2, 0) -= s[1];
  turn(1, 2) -= s[0];
  turn(2, 1) += s[0];
  return turn;
}

}  // namespace obscura::sim
