#include "sim/shape/curve_piece.h"

#include "sim/math/elementary.h"
#include "sim/math/trig.h"

namespace obscura::sim {

namespace {

// nodes and weights of Gauss and Legendre on [0, 1], eight of them
struct GaussNode {
  double at, weight;
};
constexpr GaussNode kGauss[] = {
    {0.019855071751231884, 0.050614268145188129}, {0.101666761293186630, 0.111190517226687235},
    {0.237233795041835507, 0.156853322938943644}, {0.408282678752175098, 0.181341891689180991},
    {0.591717321247824902, 0.181341891689180991}, {0.762766204958164493, 0.156853322938943644},
    {0.898333238706813370, 0.111190517226687235}, {0.980144928248768116, 0.050614268145188129}};

}  // namespace

template <int D>
double angle_of(const Vec<D>& u, const Vec<D>& v) {
  const double c = u.dot(v);
  return elementary::atan2(length_of<D>(v - c * u), c);
}

template <int D>
void place_on(const typename Curve<D>::Piece& piece, double u, Vec<D>& x, Vec<D>& first, Vec<D>& second) {
  const Vec<D>* c = piece.c;
  switch (piece.kind) {
    case Curve<D>::Kind::line:
      x = c[0] + u * c[1], first = c[1], second.setZero();
      break;
    case Curve<D>::Kind::arc: {
      const SinCos at = sin_cos(u);
      const Vec<D> out = at.cos * c[1] + at.sin * c[2];
      x = c[0] + piece.radius * out;
      first = piece.radius * (at.cos * c[2] - at.sin * c[1]);
      second = -piece.radius * out;
      break;
    }
    case Curve<D>::Kind::polynomial:
      x = c[0] + u * (c[1] + u * (c[2] + u * (c[3] + u * (c[4] + u * c[5]))));
      first = c[1] + u * (2 * c[2] + u * (3 * c[3] + u * (4 * c[4] + u * (5 * c[5]))));
      second = 2 * c[2] + u * (6 * c[3] + u * (12 * c[4] + u * (20 * c[5])));
      break;
  }
}

template <int D>
double partial_length(const typename Curve<D>::Piece& piece, double u) {
  if (piece.kind == Curve<D>::Kind::line) return u;
  if (piece.kind == Curve<D>::Kind::arc) return piece.radius * u;
  double sum = 0;
  for (const GaussNode& node : kGauss) {
    Vec<D> x, first, second;
    place_on<D>(piece, u * node.at, x, first, second);
    sum += node.weight * length_of<D>(first);
  }
  return u * sum;
}

template <int D>
typename Curve<D>::Piece part_of(const typename Curve<D>::Piece& piece, double u0, double u1) {
  typename Curve<D>::Piece it = piece;
  const double h = u1 - u0;
  // Taylor's series at u0
  static constexpr int kBinomial[6][6] = {{1, 1, 1, 1, 1, 1},  {0, 1, 2, 3, 4, 5}, {0, 0, 1, 3, 6, 10},
                                          {0, 0, 0, 1, 4, 10}, {0, 0, 0, 0, 1, 5}, {0, 0, 0, 0, 0, 1}};
  double scale = 1;
  for (int k = 0; k < 6; ++k) {
    Vec<D> sum = Vec<D>::Zero();
    for (int n = 5; n >= k; --n) sum = u0 * sum + kBinomial[k][n] * piece.c[n];
    it.c[k] = scale * sum;
    scale *= h;
  }
  return it;
}

template <int D>
double turning_of(const typename Curve<D>::Piece& piece) {
  double sum = 0;
  Vec<D> before = Vec<D>::Zero();
  for (int k = 0; k <= 4; ++k) {
    Vec<D> x, first, second;
    place_on<D>(piece, 0.25 * k * piece.end, x, first, second);
    const double speed = length_of<D>(first);
    if (!(speed > 0)) return 10;
    first /= speed;
    if (k > 0) sum += angle_of<D>(before, first);
    before = first;
  }
  return sum;
}

template double angle_of<2>(const Vec<2>&, const Vec<2>&);
template void place_on<2>(const Curve<2>::Piece&, double, Vec<2>&, Vec<2>&, Vec<2>&);
template double partial_length<2>(const Curve<2>::Piece&, double);
template Curve<2>::Piece part_of<2>(const Curve<2>::Piece&, double, double);
template double turning_of<2>(const Curve<2>::Piece&);
template double angle_of<3>(const Vec<3>&, const Vec<3>&);
template void place_on<3>(const Curve<3>::Piece&, double, Vec<3>&, Vec<3>&, Vec<3>&);
template double partial_length<3>(const Curve<3>::Piece&, double);
template Curve<3>::Piece part_of<3>(const Curve<3>::Piece&, double, double);
template double turning_of<3>(const Curve<3>::Piece&);

}  // namespace obscura::sim
