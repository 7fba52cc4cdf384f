// Curves from pieces: the nearest place to a point p is where f(u) = (c - p) . c' = 0 with
//   f' = |c'|^2 + (c - p) . c'' > 0                      Newton's method; closed forms of lines and arcs
//   T = c' / |c'|,   k = (c'' - T T . c'') / |c'|^2      tangent and curvature
// Formulas become pieces of the fifth degree that have their places and first two derivatives at both ends
// (Hermite), as short as it takes for them to agree to rounding.
// Source: do Carmo, Differential Geometry of Curves and Surfaces (1976), §1; de Boor, A Practical Guide to
// Splines (1978), §4.

#include "sim/shape/curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "sim/math/elementary.h"
#include "sim/math/trig.h"

namespace obscura::sim {

namespace {

constexpr double kRightAngle = std::numbers::pi / 2;
constexpr double kMostTurn = 0.25;  // rad: of a polynomial piece
constexpr double kHermite = 1e-13;  // of the size: how far a formula's pieces may be from it
constexpr int kFirstPieces = 32;    // of a formula
constexpr int kMostHalvings = 12;   // of those
constexpr int kMostPieces = 32000;
constexpr double kTouch = 1e-7;              // of the length: places of a crossing are no farther apart
constexpr int kLooksForCrossings = 8;        // a piece
constexpr double kSamePlaceOfCurve = 1e-10;  // of the length: how far over its end a piece has feet

// nodes and weights of Gauss and Legendre on [0, 1], eight of them
struct GaussNode {
  double at, weight;
};
constexpr GaussNode kGauss[] = {
    {0.019855071751231884, 0.050614268145188129}, {0.101666761293186630, 0.111190517226687235},
    {0.237233795041835507, 0.156853322938943644}, {0.408282678752175098, 0.181341891689180991},
    {0.591717321247824902, 0.181341891689180991}, {0.762766204958164493, 0.156853322938943644},
    {0.898333238706813370, 0.111190517226687235}, {0.980144928248768116, 0.050614268145188129}};

template <int D>
double length_of(const Vec<D>& v) {
  return std::sqrt(v.squaredNorm());
}

template <int D>
double angle_of(const Vec<D>& u, const Vec<D>& v) {
  const double c = u.dot(v);
  return elementary::atan2(length_of<D>(v - c * u), c);
}

// c(u), c'(u) and c''(u)
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

// the same piece from u0 to u1, as one from 0 to 1
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

// how far a piece turns, rad, about
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

}  // namespace

template <int D>
Curve<D>::Curve(std::vector<Piece> pieces, bool closed) : pieces_(std::move(pieces)), closed_(closed) {
  for (int i = 0; i < size(); ++i) {
    Piece& piece = pieces_[std::size_t(i)];
    piece.start = length_, piece.length = partial_length<D>(piece, piece.end);
    length_ += piece.length;
    piece.center = at(i, piece.end / 2).x;
    for (const double u : {0.0, piece.end})
      piece.reach = std::max(piece.reach, length_of<D>(at(i, u).x - piece.center));
    if (piece.kind == Kind::polynomial) piece.reach = std::max(piece.reach, piece.length);
    if (i == 0 || piece.run != pieces_[std::size_t(i - 1)].run) first_.push_back(i), last_.push_back(i);
    last_.back() = i;
  }
  // runs are numbered as they come
  for (std::size_t run = 0; run < first_.size(); ++run)
    for (int i = first_[run]; i <= last_[run]; ++i) pieces_[std::size_t(i)].run = int(run);
  find_crossings();
}

template <int D>
double Curve<D>::reach() const {
  double most = 0;
  for (const Piece& piece : pieces_) most = std::max(most, length_of<D>(piece.center) + piece.reach);
  return most;
}

template <int D>
void Curve<D>::derivatives(int piece, double u, Vec<D>& first, Vec<D>& second) const {
  Vec<D> x;
  place_on<D>(pieces_[std::size_t(piece)], u, x, first, second);
}

template <int D>
typename Curve<D>::Point Curve<D>::at(int piece, double u) const {
  Point point;
  Vec<D> first, second;
  place_on<D>(pieces_[std::size_t(piece)], u, point.x, first, second);
  const double speed2 = first.squaredNorm();
  point.tangent = first / std::sqrt(speed2);
  point.curvature = (second - point.tangent * point.tangent.dot(second)) / speed2;
  return point;
}

template <int D>
double Curve<D>::along(int piece, double u) const {
  const Piece& it = pieces_[std::size_t(piece)];
  return it.start + partial_length<D>(it, u);
}

// the nearest place on what a piece goes on as at both of its ends
template <int D>
typename Curve<D>::Foot Curve<D>::on(int number, const Vec<D>& p) const {
  const Piece& piece = pieces_[std::size_t(number)];
  Foot foot;
  foot.piece = number;
  switch (piece.kind) {
    case Kind::line:
      foot.u = (p - piece.c[0]).dot(piece.c[1]);
      break;
    case Kind::arc: {
      const Vec<D> out = p - piece.c[0];
      const double x = out.dot(piece.c[1]), y = out.dot(piece.c[2]), middle = piece.end / 2;
      foot.u = x == 0 && y == 0 ? middle : elementary::atan2(y, x);
      if (foot.u < middle - std::numbers::pi) foot.u += 2 * std::numbers::pi;
      if (foot.u > middle + std::numbers::pi) foot.u -= 2 * std::numbers::pi;
      break;
    }
    case Kind::polynomial: {
      Vec<D> x, first, second;
      Vec<D> chord = Vec<D>::Zero();
      for (int k = 1; k < 6; ++k) chord += piece.c[k];
      double u = std::clamp((p - piece.c[0]).dot(chord) / chord.squaredNorm(), -1.0, 2.0);
      for (int i = 0; i < 40; ++i) {
        place_on<D>(piece, u, x, first, second);
        const double slope2 = first.squaredNorm(), bend = slope2 + (x - p).dot(second);
        const double step = -(x - p).dot(first) / (bend > 0.1 * slope2 ? bend : slope2);
        u = std::clamp(u + std::clamp(step, -0.5, 0.5), -1.0, 2.0);
        if (std::abs(step) < 1e-15) break;
      }
      foot.u = u;
      break;
    }
  }
  foot.at = at(number, foot.u);
  foot.along = before(piece, foot.u);
  return foot;
}

// how far along a place is, about
template <int D>
double Curve<D>::before(const Piece& piece, double u) const {
  return piece.start + piece.length * (u / piece.end);
}

// the place that `on` finds on a piece, or on those beside it of the same run
template <int D>
template <class On>
typename Curve<D>::Foot Curve<D>::walk(int piece, On&& on) const {
  int way = 0;
  for (int i = 0;; ++i) {
    Foot foot = on(piece);
    const int to = foot.u > pieces_[std::size_t(piece)].end ? 1 : foot.u < 0 ? -1 : 0;
    // at the joint of two pieces rounding may send it back and forth
    if (to == 0 || to == -way || i > size()) return foot;
    int other = piece + to;
    if (closed_) other = (other + size()) % size();
    if (other < 0 || other >= size() || pieces_[std::size_t(other)].run != pieces_[std::size_t(piece)].run)
      return foot;
    // what has a run alone and is closed goes around
    if (other == piece) return foot;
    piece = other, way = to;
  }
}

template <int D>
typename Curve<D>::Foot Curve<D>::foot(int piece, const Vec<D>& p) const {
  return walk(piece, [&](int each) { return on(each, p); });
}

template <int D>
typename Curve<D>::Foot Curve<D>::under_face(int piece, const Vec<D>& normal) const {
  return walk(piece, [&](int each) { return flat_on(each, normal); });
}

// where a piece, or what it goes on as, runs across a normal and bends along it
template <int D>
typename Curve<D>::Foot Curve<D>::flat_on(int number, const Vec<D>& normal) const {
  const Piece& piece = pieces_[std::size_t(number)];
  Foot foot;
  foot.piece = number, foot.u = piece.end / 2;
  if (piece.kind == Kind::arc) {
    foot.u = elementary::atan2(-normal.dot(piece.c[2]), -normal.dot(piece.c[1]));
    if (foot.u < piece.end / 2 - std::numbers::pi) foot.u += 2 * std::numbers::pi;
    if (foot.u > piece.end / 2 + std::numbers::pi) foot.u -= 2 * std::numbers::pi;
  } else if (piece.kind == Kind::polynomial) {
    for (int i = 0; i < 40; ++i) {
      Vec<D> x, first, second;
      place_on<D>(piece, foot.u, x, first, second);
      const double bend = second.dot(normal);
      const double step = bend != 0 ? -first.dot(normal) / bend : 0;
      foot.u = std::clamp(foot.u + std::clamp(step, -0.5, 0.5), -1.0, 2.0);
      if (std::abs(step) < 1e-15) break;
    }
  }
  foot.at = at(number, foot.u);
  foot.along = before(piece, foot.u);
  return foot;
}

template <int D>
void Curve<D>::under_faces(const Vec<D>& normal, const Vec<D>& p, double far, std::vector<Foot>& out) const {
  const double slack = kSamePlaceOfCurve * length_;
  for (int i = 0; i < size(); ++i) {
    const Piece& piece = pieces_[std::size_t(i)];
    if (piece.kind == Kind::line) continue;
    const double reach = piece.reach + far;
    if ((p - piece.center).squaredNorm() > reach * reach) continue;
    Foot foot = flat_on(i, normal);
    const double over = slack * piece.end / piece.length;
    if (!(foot.u >= -over && foot.u <= piece.end + over)) continue;
    if (!(foot.at.curvature.dot(normal) > 0) || std::abs(foot.at.tangent.dot(normal)) > 1e-9) continue;
    const auto same = [&](const Foot& other) {
      return pieces_[std::size_t(other.piece)].run == piece.run &&
             apart(other.along, foot.along) <= 4 * slack;
    };
    if (!out.empty() && std::any_of(out.begin(), out.end(), same)) continue;
    out.push_back(foot);
  }
}

template <int D>
double Curve<D>::beyond(const Foot& foot) const {
  const Piece& piece = pieces_[std::size_t(foot.piece)];
  const auto run = std::size_t(piece.run);
  if (closed_ && first_.size() == 1) return 0;
  double u = 0, end = 0;
  if (foot.piece == last_[run] && foot.u > piece.end)
    u = foot.u - piece.end, end = piece.end;
  else if (foot.piece == first_[run] && foot.u < 0)
    u = foot.u;
  else
    return 0;
  Vec<D> first, second;
  derivatives(foot.piece, end, first, second);
  return u * length_of<D>(first);
}

template <int D>
std::optional<int> Curve<D>::next(int piece, bool forward) const {
  const auto run = std::size_t(pieces_[std::size_t(piece)].run);
  int other = forward ? last_[run] + 1 : first_[run] - 1;
  if (closed_) other = (other + size()) % size();
  if (other < 0 || other >= size()) return {};
  return other;
}

template <int D>
void Curve<D>::feet(const Vec<D>& p, double far, std::vector<Foot>& out) const {
  const double slack = kSamePlaceOfCurve * length_;
  for (int i = 0; i < size(); ++i) {
    const Piece& piece = pieces_[std::size_t(i)];
    const double reach = piece.reach + far + slack;
    if ((p - piece.center).squaredNorm() > reach * reach) continue;
    Foot foot = on(i, p);
    const double over = slack * piece.end / piece.length;
    if (!(foot.u >= -over && foot.u <= piece.end + over)) continue;
    const Vec<D> e = p - foot.at.x;
    if (e.squaredNorm() > far * far || !(foot.at.curvature.dot(e) < 1)) continue;
    // at the joint of two pieces of a run it is one foot
    const auto same = [&](const Foot& other) {
      return pieces_[std::size_t(other.piece)].run == piece.run &&
             apart(other.along, foot.along) <= 4 * slack;
    };
    if (!out.empty() && std::any_of(out.begin(), out.end(), same)) continue;
    out.push_back(foot);
  }
}

template <int D>
typename Curve<D>::Foot Curve<D>::nearest(const Vec<D>& p) const {
  Foot best;
  double least = 1e300;
  for (int i = 0; i < size(); ++i) {
    const Piece& piece = pieces_[std::size_t(i)];
    const double gap = length_of<D>(p - piece.center) - piece.reach;
    if (gap > 0 && gap * gap > least) continue;
    Foot foot = on(i, p);
    if (!(foot.u >= 0 && foot.u <= piece.end)) {
      foot.u = foot.u < 0 ? 0 : piece.end;
      const Vec<D> other = at(i, piece.end - foot.u).x;
      if ((p - other).squaredNorm() < (p - at(i, foot.u).x).squaredNorm()) foot.u = piece.end - foot.u;
      foot.at = at(i, foot.u), foot.along = before(piece, foot.u);
    }
    const double far = (p - foot.at.x).squaredNorm();
    if (far < least) least = far, best = foot;
  }
  return best;
}

template <int D>
std::vector<Vec<D>> Curve<D>::places(double least) const {
  std::vector<Vec<D>> all;
  for (int i = 0; i < size(); ++i) {
    const Piece& piece = pieces_[std::size_t(i)];
    const double turn = turning_of<D>(piece);
    const int n = std::clamp(int(std::ceil(std::sqrt(piece.length * turn / (8 * least)))), 1, 200);
    for (int k = 0; k < n; ++k) all.push_back(at(i, piece.end * k / n).x);
  }
  all.push_back(closed_ ? all.front() : at(size() - 1, pieces_.back().end).x);
  return all;
}

template <int D>
double Curve<D>::apart(double along, double other) const {
  const double d = std::abs(along - other);
  return closed_ ? std::min(d, std::abs(length_ - d)) : d;
}

template <int D>
bool Curve<D>::conflict(double along, double other) const {
  for (const Crossing& it : crossings_) {
    if ((apart(along, it.first) < it.span && apart(other, it.second) < it.span) ||
        (apart(along, it.second) < it.span && apart(other, it.first) < it.span))
      return true;
  }
  return false;
}

// places at which the curve meets itself: from pairs of places that are near each other, one after the other
// to the place nearest to its partner
template <int D>
void Curve<D>::find_crossings() {
  struct Look {
    int piece;
    double u, along;
    Vec<D> x;
  };
  std::vector<Look> looks;
  const int each = std::max(1, std::min(kLooksForCrossings, 4000 / std::max(1, size())));
  for (int i = 0; i < size(); ++i) {
    const Piece& piece = pieces_[std::size_t(i)];
    for (int k = 0; k < each; ++k) {
      const double u = piece.end * k / each;
      looks.push_back({i, u, before(piece, u), at(i, u).x});
    }
  }
  if (!closed_)
    looks.push_back({size() - 1, pieces_.back().end, length_, at(size() - 1, pieces_.back().end).x});
  double step = 0;
  for (std::size_t i = 1; i < looks.size(); ++i) step = std::max(step, looks[i].along - looks[i - 1].along);
  const double touch = kTouch * length_;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    for (std::size_t j = i + 1; j < looks.size(); ++j) {
      if ((looks[i].x - looks[j].x).squaredNorm() > step * step) continue;
      if (apart(looks[i].along, looks[j].along) < std::max(4 * step, 0.01 * length_)) continue;
      const auto known = [&](const Crossing& it) {
        const auto is = [&](double first, double second) {
          return apart(first, looks[i].along) < 2 * step && apart(second, looks[j].along) < 2 * step;
        };
        return is(it.first, it.second) || is(it.second, it.first);
      };
      if (std::any_of(crossings_.begin(), crossings_.end(), known)) continue;
      // each in turn to the nearest place on its own piece, and those beside it
      Foot p, q;
      p.piece = looks[i].piece, p.u = looks[i].u, p.along = looks[i].along, p.at = at(p.piece, p.u);
      q.piece = looks[j].piece, q.u = looks[j].u, q.along = looks[j].along, q.at = at(q.piece, q.u);
      const auto move = [&](Foot& foot, const Vec<D>& to) {
        for (int tries = 0; tries < 3; ++tries) {
          foot = on(foot.piece, to);
          const double end = pieces_[std::size_t(foot.piece)].end;
          const int way = foot.u > end ? 1 : foot.u < 0 ? -1 : 0;
          int other = foot.piece + way;
          if (closed_) other = (other + size()) % size();
          if (way == 0 || other < 0 || other >= size()) break;
          foot.u = std::clamp(foot.u, 0.0, end);
          foot.at = at(foot.piece, foot.u), foot.along = before(pieces_[std::size_t(foot.piece)], foot.u);
          if (tries < 2) foot.piece = other;
        }
      };
      for (int round = 0; round < 60 && (p.at.x - q.at.x).squaredNorm() > 1e-4 * touch * touch; ++round) {
        move(q, p.at.x);
        move(p, q.at.x);
      }
      if ((p.at.x - q.at.x).squaredNorm() > touch * touch) continue;
      const double between = apart(p.along, q.along);
      if (between < std::max(4 * step, 0.01 * length_)) continue;
      crossings_.push_back({p.along, q.along, 0.25 * between});
    }
  }
}

// --- paths

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

// --- formulas

namespace {

// place and two derivatives of a curve at s
template <int D>
struct Jet {
  double s = 0;
  Vec<D> x[3];
};

template <int D>
typename Curve<D>::Piece quintic(const Jet<D>& a, const Jet<D>& b) {
  typename Curve<D>::Piece piece;
  piece.kind = Curve<D>::Kind::polynomial;
  const double h = b.s - a.s;
  const Vec<D> d = b.x[0] - a.x[0], p1 = h * a.x[1], q1 = h * b.x[1], p2 = h * h * a.x[2],
               q2 = h * h * b.x[2];
  piece.c[0] = a.x[0], piece.c[1] = p1, piece.c[2] = 0.5 * p2;
  piece.c[3] = 10 * d - 6 * p1 - 4 * q1 - 1.5 * p2 + 0.5 * q2;
  piece.c[4] = -15 * d + 8 * p1 + 7 * q1 + 1.5 * p2 - q2;
  piece.c[5] = 6 * d - 3 * (p1 + q1) - 0.5 * p2 + 0.5 * q2;
  return piece;
}

template <int D>
class FormulaCurve {
 public:
  FormulaCurve(const Program& formula, double from, double to) : evaluation_(formula), from_(from), to_(to) {}

  std::variant<std::vector<typename Curve<D>::Piece>, std::string> pieces() {
    std::vector<Jet<D>> jets;
    for (int i = 0; i <= kFirstPieces; ++i) {
      jets.push_back(at(from_ + (to_ - from_) * i / kFirstPieces));
      if (!check(jets.back())) return wrong_;
      fastest_ = std::max(fastest_, length_of<D>(jets.back().x[1]));
      size_ =
          std::max({size_, length_of<D>(jets.back().x[0]), length_of<D>(jets.back().x[0] - jets[0].x[0])});
    }
    for (int i = 0; i < kFirstPieces; ++i)
      if (!add(jets[std::size_t(i)], jets[std::size_t(i + 1)], 0)) return wrong_;
    return std::move(pieces_);
  }

 private:
  Jet<D> at(double s) {
    Jet<D> jet;
    jet.s = s;
    const double slot[] = {s};
    evaluation_.begin(slot);
    evaluation_.run(1, {});
    for (int axis = 0; axis < D; ++axis)
      for (int k = 0; k < 3; ++k) jet.x[k][axis] = evaluation_.output(3 * axis + k)[0];
    return jet;
  }

  static std::string number(double s) {
    std::string text = std::to_string(s);
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
    return text == "-0" ? "0" : text;
  }

  bool check(const Jet<D>& jet) {
    for (const Vec<D>& x : jet.x) {
      if (x.allFinite()) continue;
      wrong_ = "the track, or a derivative of it, is no finite number at s = " + number(jet.s);
      return false;
    }
    return true;
  }

  bool add(const Jet<D>& a, const Jet<D>& b, int halvings) {
    for (const Jet<D>* jet : {&a, &b}) {
      if (length_of<D>(jet->x[1]) > 1e-9 * fastest_) continue;
      wrong_ = "the track has no direction at s = " + number(jet->s) +
               ", where its derivative is zero; begin or end it a little beside";
      return false;
    }
    typename Curve<D>::Piece piece = quintic<D>(a, b);
    double worst = 0;
    for (const double part : {0.25, 0.5, 0.75}) {
      const Jet<D> jet = at(a.s + part * (b.s - a.s));
      if (!check(jet)) return false;
      Vec<D> x, first, second;
      place_on<D>(piece, part, x, first, second);
      worst = std::max(worst, length_of<D>(x - jet.x[0]));
    }
    if (worst <= kHermite * size_ && turning_of<D>(piece) <= kMostTurn) {
      pieces_.push_back(piece);
      return true;
    }
    if (halvings == kMostHalvings || int(pieces_.size()) > kMostPieces) {
      wrong_ = "the track is not smooth near s = " + number(a.s) +
               ": a corner, or a bend too sharp to follow; write it as 'points', or begin or end it a little "
               "beside";
      return false;
    }
    const Jet<D> middle = at(0.5 * (a.s + b.s));
    return add(a, middle, halvings + 1) && add(middle, b, halvings + 1);
  }

  Evaluation evaluation_;
  double from_, to_, fastest_ = 0, size_ = 0;
  std::vector<typename Curve<D>::Piece> pieces_;
  std::string wrong_;
};

}  // namespace

template <int D>
std::variant<std::vector<typename Curve<D>::Piece>, std::string> curve_pieces(const Program& formula,
                                                                              double from, double to) {
  return FormulaCurve<D>(formula, from, to).pieces();
}

template <int D>
std::variant<Program, std::pair<int, ExpressionFault>> curve_formula(
    const std::vector<std::string>& coordinates,
    const std::vector<std::pair<std::string, double>>& constants) {
  ExpressionGraph graph;
  const int s = graph.variable(0, true);
  std::vector<Symbol> symbols{{"s", s}};
  for (const auto& [name, value] : constants) symbols.push_back({name, graph.number(value)});
  for (const char* name : {"x", "y", "z", "t", "vx", "vy", "vz", "speed", "r", "dx", "dy", "dz", "angle"})
    symbols.push_back({name, -1, "changes with the run: a track depends on s alone"});
  std::vector<int> outputs;
  for (int axis = 0; axis < D; ++axis) {
    const auto found = parse_expression(coordinates[std::size_t(axis)], symbols, graph);
    if (const auto* fault = std::get_if<ExpressionFault>(&found)) return std::pair(axis, *fault);
    int node = std::get<int>(found);
    for (int k = 0; k < 3; ++k) {
      outputs.push_back(node);
      if (k < 2) node = graph.derivative(node, s);
    }
  }
  return Program(graph, outputs);
}

#define OBSCURA_INSTANTIATE(D)                                                                             \
  template class Curve<D>;                                                                                 \
  template class CurvePath<D>;                                                                             \
  template std::optional<Vec<D>> arc_direction<D>(const Vec<D>&, const Vec<D>&, const Vec<D>&);            \
  template std::variant<std::vector<Curve<D>::Piece>, std::string> curve_pieces<D>(const Program&, double, \
                                                                                   double);                \
  template std::variant<Program, std::pair<int, ExpressionFault>> curve_formula<D>(                        \
      const std::vector<std::string>&, const std::vector<std::pair<std::string, double>>&)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim
