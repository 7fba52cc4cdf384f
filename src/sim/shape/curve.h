#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "sim/math/expression.h"
#include "sim/math/vec.h"

namespace obscura::sim {

/// A smooth curve: pieces, of which each goes on in the direction of the one before it.
///   line         c(u) = c0 + c1 u                       |c1| = 1, u in metres
///   arc          c(u) = c0 + r (cos(u) c1 + sin(u) c2)  u in rad, at most a right angle
///   polynomial   c(u) = c0 + c1 u + ... + c5 u^5        0 <= u <= 1
/// Pieces between which nothing changes but their numbers, as those of one arc, are a run: within a run the
/// curve is smooth enough for a step of any order, from run to run its curvature jumps.
template <int D>
class Curve {
 public:
  enum class Kind : char { line, arc, polynomial };
  struct Piece {
    Kind kind = Kind::line;
    Vec<D> c[6];
    double radius = 0;               // of an arc, m
    double end = 1;                  // u from 0 to this
    double start = 0, length = 0;    // m along the curve: where it begins, and its own
    int run = 0;                     // number of its run
    Vec<D> center = Vec<D>::Zero();  // of a ball around it
    double reach = 0;                // and its radius, m
  };

  /// The curve at a place of it.
  struct Point {
    Vec<D> x = Vec<D>::Zero();          // m
    Vec<D> tangent = Vec<D>::Unit(0);   // unit
    Vec<D> curvature = Vec<D>::Zero();  // d tangent / d length, 1/m
  };

  /// The nearest place to a point: dx . tangent = 0.
  struct Foot {
    int piece = 0;
    double u = 0;
    double along = 0;  // m from the beginning of the curve, about
    Point at;
  };

  /// Two places on the curve that lie at one place, where it crosses or touches itself: near one of them it
  /// is not touched by what is on the other.
  struct Crossing {
    double first = 0, second = 0;  // m along
    double span = 0;               // m: how far to either side of them
  };

  /// Pieces in order; their `start`, `length`, `center` and `reach` are found here. `closed`: the last goes
  /// on in the first.
  Curve(std::vector<Piece> pieces, bool closed);

  int size() const { return int(pieces_.size()); }
  const Piece& piece(int i) const { return pieces_[std::size_t(i)]; }
  bool closed() const { return closed_; }
  double length() const { return length_; }
  const std::vector<Crossing>& crossings() const { return crossings_; }
  /// The farthest that it reaches from the origin, m.
  double reach() const;

  Point at(int piece, double u) const;
  /// The velocity dx/du there, and d2x/du2.
  void derivatives(int piece, double u, Vec<D>& first, Vec<D>& second) const;
  /// How far along the curve a place is, m, to rounding.
  double along(int piece, double u) const;

  /// The nearest place to p on the run of `piece`; beyond the ends of the run, on what it goes on as.
  Foot foot(int piece, const Vec<D>& p) const;
  /// In the plane: the place on the run of `piece` over which a flat face with this outward normal lies, if
  /// the run bends away from it; beyond the ends of the run, as foot().
  Foot under_face(int piece, const Vec<D>& normal) const;
  /// The same on each piece that has such a place and comes nearer than `far` to p.
  void under_faces(const Vec<D>& normal, const Vec<D>& p, double far, std::vector<Foot>& out) const;
  /// Where a foot lies beyond its run: metres past its end, or before its beginning as a negative number; 0:
  /// within it.
  double beyond(const Foot& foot) const;
  /// The piece that follows the run of `piece`, or comes before it; none at an open end.
  std::optional<int> next(int piece, bool forward) const;

  /// All nearest places to p, up to `far` (m) from it: one for each part of the curve that comes near. Ends
  /// of an open curve are none.
  void feet(const Vec<D>& p, double far, std::vector<Foot>& out) const;
  /// The nearest place of all, ends among them.
  Foot nearest(const Vec<D>& p) const;

  /// Places so close that straight lines between them are no farther than `least` (m) from the curve.
  std::vector<Vec<D>> places(double least) const;

  /// How far apart two places are along the curve, m.
  double apart(double along, double other) const;
  /// Whether what is at one of two places is not touched by the other part of the curve.
  bool conflict(double along, double other) const;

 private:
  Foot on(int piece, const Vec<D>& p) const;
  Foot flat_on(int piece, const Vec<D>& normal) const;
  template <class On>
  Foot walk(int piece, On&& on) const;
  double before(const Piece& piece, double u) const;
  void find_crossings();

  std::vector<Piece> pieces_;
  bool closed_ = false;
  double length_ = 0;
  std::vector<int> first_, last_;  // pieces of each run
  std::vector<Crossing> crossings_;
};

/// What makes a curve from places, piece by piece. Directions are unit vectors.
template <int D>
class CurvePath {
 public:
  explicit CurvePath(const Vec<D>& from) : at_(from), start_(from) {}

  const Vec<D>& place() const { return at_; }
  /// The direction at its end; none before its first piece.
  const std::optional<Vec<D>>& direction() const { return direction_; }

  void line(const Vec<D>& to);
  /// An arc through one place to another; false: they lie in a line.
  bool arc(const Vec<D>& through, const Vec<D>& to);
  /// An arc that leaves as the piece before it ends; false: there is none such.
  bool arc(const Vec<D>& to);
  /// A cubic spline through places, whose second derivative is continuous; `leave`: its direction at its end,
  /// if that is known.
  void spline(const std::vector<Vec<D>>& places, const std::optional<Vec<D>>& leave);
  /// A closed one, from where the path is back to it.
  void loop(const std::vector<Vec<D>>& places);

  /// Angle by which the last piece left the direction of the one before, rad.
  double kink() const { return kink_; }
  /// The same between the last piece and the first, if the path ends where it began.
  std::optional<double> closing_kink() const;

  std::vector<typename Curve<D>::Piece> pieces() const { return pieces_; }

 private:
  using Piece = typename Curve<D>::Piece;
  void arc(const Vec<D>& center, double radius, const Vec<D>& u, const Vec<D>& v, double angle,
           const Vec<D>& to);
  void add(Piece piece);

  Vec<D> at_, start_;
  std::optional<Vec<D>> direction_, first_;
  std::vector<Piece> pieces_;
  int runs_ = 0;
  double kink_ = 0;
};

/// The direction in which an arc through three places leaves the first; none where they lie in a line.
template <int D>
std::optional<Vec<D>> arc_direction(const Vec<D>& from, const Vec<D>& through, const Vec<D>& to);

/// A curve as formulas of s: one an axis, with its first two derivatives, as curve_formula() has them.
/// Answers the curve from `from` to `to`, or what is wrong with it.
template <int D>
std::variant<std::vector<typename Curve<D>::Piece>, std::string> curve_pieces(const Program& formula,
                                                                              double from, double to);

/// The formula of a curve: each coordinate, its derivative by s and the second one. Its variable is s.
template <int D>
std::variant<Program, std::pair<int, ExpressionFault>> curve_formula(
    const std::vector<std::string>& coordinates,
    const std::vector<std::pair<std::string, double>>& constants);

}  // namespace obscura::sim
