// Curves from lines, arcs and splines, each of which goes on as the one before.
// Source: de Boor, A Practical Guide to Splines (1978), §4.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/math/elementary.h"
#include "sim/math/trig.h"
#include "sim/shape/curve_piece.h"

namespace obscura::sim {

namespace {

constexpr double kRightAngle = std::numbers::pi / 2;

}  // namespace

template <int D>
void CurvePath<D>::add(Piece piece) {
  piece.run = runs_++;
  Vec<D> x, first, second;
  place_on<D>(piece, 0, x, first, second);
  first /= length_of<D>(first);
  kink_ = direction_ ? angle_of<D>(*direction_, first) : 0;
  if (!first_) first_ = first;
  place_on<D>(piece, piece.end, x, first, second);
  direction_ = first / length_of<D>(first);

  // in parts that hardly bend
  int parts = 1;
  if (piece.kind == Curve<D>::Kind::arc)
    parts = std::max(1, int(std::ceil(piece.end / kRightAngle - 1e-9)));
  else if (piece.kind == Curve<D>::Kind::polynomial)
    parts = std::clamp(int(std::ceil(turning_of<D>(piece) / kMostTurn)), 1, 64);
  for (int k = 0; k < parts; ++k) {
    Piece part = piece;
    if (piece.kind == Curve<D>::Kind::arc) {
      const SinCos by = sin_cos(piece.end * k / parts);
      part.c[1] = by.cos * piece.c[1] + by.sin * piece.c[2];
      part.c[2] = by.cos * piece.c[2] - by.sin * piece.c[1];
      part.end = piece.end / parts;
    } else if (piece.kind == Curve<D>::Kind::polynomial) {
      part = part_of<D>(piece, double(k) / parts, double(k + 1) / parts);
    }
    pieces_.push_back(part);
  }
}

template <int D>
void CurvePath<D>::line(const Vec<D>& to) {
  Piece piece;
  piece.end = length_of<D>(to - at_);
  piece.c[0] = at_, piece.c[1] = (to - at_) / piece.end;
  at_ = to;
  add(piece);
}

// from direction u of the centre, v across it the way that it goes
template <int D>
void CurvePath<D>::arc(const Vec<D>& center, double radius, const Vec<D>& u, const Vec<D>& v, double angle,
                       const Vec<D>& to) {
  Piece piece;
  piece.kind = Curve<D>::Kind::arc;
  piece.c[0] = center, piece.c[1] = u, piece.c[2] = v;
  piece.radius = radius, piece.end = angle;
  at_ = to;
  add(piece);
}

namespace {

// the circle through three places
template <int D>
struct Circle {
  Vec<D> center = Vec<D>::Zero(), u = Vec<D>::Zero(), v = Vec<D>::Zero();  // u to the first; v the way on
  double radius = 0;
};

template <int D>
std::optional<Circle<D>> circle_through(const Vec<D>& a, const Vec<D>& b, const Vec<D>& c) {
  const Vec<D> p = b - a, q = c - a;
  const double pp = p.squaredNorm(), qq = q.squaredNorm(), pq = p.dot(q), det = pp * qq - pq * pq;
  // the whole circle, where it comes back to where it began
  if (qq == 0) return {};
  if (!(det > 1e-18 * pp * qq)) return {};
  Circle<D> it;
  const Vec<D> to = (qq * (pp - pq) * p + pp * (qq - pq) * q) / (2 * det);
  it.center = a + to;
  it.radius = length_of<D>(to);
  it.u = -to / it.radius;
  // across u, towards the second place
  const Vec<D> across = p - it.u * it.u.dot(p);
  it.v = across / length_of<D>(across);
  // the way from the first over the second to the third: of the two the one that meets the second before
  const auto angle = [&](const Vec<D>& x) {
    const Vec<D> out = x - it.center;
    const double phi = elementary::atan2(out.dot(it.v), out.dot(it.u));
    return phi < 0 ? phi + 2 * std::numbers::pi : phi;
  };
  if (angle(b) > angle(c)) it.v = -it.v;
  return it;
}

template <int D>
double angle_on(const Circle<D>& circle, const Vec<D>& x) {
  const Vec<D> out = x - circle.center;
  const double phi = elementary::atan2(out.dot(circle.v), out.dot(circle.u));
  return phi < 0 ? phi + 2 * std::numbers::pi : phi;
}

}  // namespace

template <int D>
bool CurvePath<D>::arc(const Vec<D>& through, const Vec<D>& to) {
  const auto circle = circle_through<D>(at_, through, to);
  if (!circle) return false;
  arc(circle->center, circle->radius, circle->u, circle->v, angle_on<D>(*circle, to), to);
  return true;
}

template <int D>
bool CurvePath<D>::arc(const Vec<D>& to) {
  if (!direction_) return false;
  const Vec<D> chord = to - at_, t = *direction_;
  Vec<D> across = chord - t * t.dot(chord);
  const double off = length_of<D>(across);
  if (!(off > 1e-9 * length_of<D>(chord))) return false;
  across /= off;
  Circle<D> circle;
  circle.radius = chord.squaredNorm() / (2 * off);
  circle.center = at_ + circle.radius * across, circle.u = -across, circle.v = t;
  arc(circle.center, circle.radius, circle.u, circle.v, angle_on<D>(circle, to), to);
  return true;
}

template <int D>
std::optional<Vec<D>> arc_direction(const Vec<D>& from, const Vec<D>& through, const Vec<D>& to) {
  const auto circle = circle_through<D>(from, through, to);
  if (!circle) return {};
  return circle->v;
}

namespace {

// a cubic from p to q with these derivatives by a length of h
template <int D>
typename Curve<D>::Piece cubic(const Vec<D>& p, const Vec<D>& q, const Vec<D>& dp, const Vec<D>& dq,
                               double h) {
  typename Curve<D>::Piece piece;
  piece.kind = Curve<D>::Kind::polynomial;
  const Vec<D> a = h * dp, b = h * dq;
  piece.c[0] = p, piece.c[1] = a;
  piece.c[2] = 3 * (q - p) - 2 * a - b, piece.c[3] = a + b - 2 * (q - p);
  piece.c[4].setZero(), piece.c[5].setZero();
  return piece;
}

// first derivatives at places that are h apart, of which the first and last equations are given:
//   m_i-1 / h_i + 2 m_i (1 / h_i + 1 / h_i+1) + m_i+1 / h_i+1 = 3 (d_i / h_i^2 + d_i+1 / h_i+1^2)
// Gauss's elimination of a matrix with three diagonals
template <int D>
std::vector<Vec<D>> tridiagonal(std::vector<double> low, std::vector<double> middle, std::vector<double> high,
                                std::vector<Vec<D>> right) {
  const std::size_t n = middle.size();
  for (std::size_t i = 1; i < n; ++i) {
    const double by = low[i] / middle[i - 1];
    middle[i] -= by * high[i - 1], right[i] -= by * right[i - 1];
  }
  right[n - 1] /= middle[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) right[i] = (right[i] - high[i] * right[i + 1]) / middle[i];
  return right;
}

}  // namespace

template <int D>
void CurvePath<D>::spline(const std::vector<Vec<D>>& places, const std::optional<Vec<D>>& leave) {
  std::vector<Vec<D>> x{at_};
  x.insert(x.end(), places.begin(), places.end());
  const std::size_t n = x.size();
  std::vector<double> h(n), low(n), middle(n), high(n);
  std::vector<Vec<D>> right(n);
  for (std::size_t i = 1; i < n; ++i) h[i] = length_of<D>(x[i] - x[i - 1]);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    low[i] = 1 / h[i], high[i] = 1 / h[i + 1], middle[i] = 2 * (low[i] + high[i]);
    right[i] = 3 * ((x[i] - x[i - 1]) * (low[i] * low[i]) + (x[i + 1] - x[i]) * (high[i] * high[i]));
  }
  // given directions; free ends do not bend
  if (direction_)
    middle[0] = 1, high[0] = 0, right[0] = *direction_;
  else
    middle[0] = 2, high[0] = 1, right[0] = 3 / h[1] * (x[1] - x[0]);
  if (leave)
    middle[n - 1] = 1, low[n - 1] = 0, right[n - 1] = *leave;
  else
    middle[n - 1] = 2, low[n - 1] = 1, right[n - 1] = 3 / h[n - 1] * (x[n - 1] - x[n - 2]);
  const std::vector<Vec<D>> m = tridiagonal<D>(low, middle, high, right);
  double kink = 0;
  for (std::size_t i = 1; i < n; ++i) {
    add(cubic<D>(x[i - 1], x[i], m[i - 1], m[i], h[i]));
    if (i == 1) kink = kink_;
  }
  kink_ = kink, at_ = x.back();
}

template <int D>
void CurvePath<D>::loop(const std::vector<Vec<D>>& places) {
  // the cyclic system as one with three diagonals and a matrix of rank one (Sherman and Morrison)
  std::vector<Vec<D>> x{at_};
  x.insert(x.end(), places.begin(), places.end());
  const std::size_t n = x.size();
  const auto next = [&](std::size_t i) { return (i + 1) % n; };
  std::vector<double> h(n), low(n), middle(n), high(n);
  std::vector<Vec<D>> right(n);
  for (std::size_t i = 0; i < n; ++i) h[i] = length_of<D>(x[next(i)] - x[i]);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t before = (i + n - 1) % n;
    low[i] = 1 / h[before], high[i] = 1 / h[i], middle[i] = 2 * (low[i] + high[i]);
    right[i] = 3 * ((x[i] - x[before]) * (low[i] * low[i]) + (x[next(i)] - x[i]) * (high[i] * high[i]));
  }
  const double gamma = -middle[0], corner_low = low[0], corner_high = high[n - 1];
  middle[0] -= gamma, middle[n - 1] -= corner_low * corner_high / gamma;
  std::vector<Vec<D>> ends(n, Vec<D>::Zero());
  ends[0] = Vec<D>::Constant(gamma), ends[n - 1] = Vec<D>::Constant(corner_high);
  std::vector<Vec<D>> m = tridiagonal<D>(low, middle, high, right);
  const std::vector<Vec<D>> z = tridiagonal<D>(low, middle, high, ends);
  const double share = 1 + z[0][0] + corner_low / gamma * z[n - 1][0];
  const Vec<D> by = (m[0] + corner_low / gamma * m[n - 1]) / share;
  for (std::size_t i = 0; i < n; ++i) m[i] -= z[i][0] * by;
  for (std::size_t i = 0; i < n; ++i) add(cubic<D>(x[i], x[next(i)], m[i], m[next(i)], h[i]));
  kink_ = 0;
}

template <int D>
std::optional<double> CurvePath<D>::closing_kink() const {
  double size = 0;
  for (const Piece& piece : pieces_) size += piece.kind == Curve<D>::Kind::line ? piece.end : 1;
  if (!first_ || length_of<D>(at_ - start_) > 1e-9 * size) return {};
  return angle_of<D>(*direction_, *first_);
}

template class CurvePath<2>;
template class CurvePath<3>;
template std::optional<Vec<2>> arc_direction<2>(const Vec<2>&, const Vec<2>&, const Vec<2>&);
template std::optional<Vec<3>> arc_direction<3>(const Vec<3>&, const Vec<3>&, const Vec<3>&);

}  // namespace obscura::sim
