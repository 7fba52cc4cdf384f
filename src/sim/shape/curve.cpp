// Curves from pieces: the nearest place to a point p is where f(u) = (c - p) . c' = 0 with
//   f' = |c'|^2 + (c - p) . c'' > 0                      Newton's method; closed forms of lines and arcs
//   T = c' / |c'|,   k = (c'' - T T . c'') / |c'|^2      tangent and curvature
// Source: do Carmo, Differential Geometry of Curves and Surfaces (1976), §1.

#include "sim/shape/curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/math/elementary.h"
#include "sim/shape/curve_piece.h"

namespace obscura::sim {

namespace {

constexpr double kTouch = 1e-7;              // of the length: places of a crossing are no farther apart
constexpr int kLooksForCrossings = 8;        // a piece
constexpr double kSamePlaceOfCurve = 1e-10;  // of the length: how far over its end a piece has feet

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

template class Curve<2>;
template class Curve<3>;

}  // namespace obscura::sim
