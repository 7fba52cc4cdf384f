// Conservative advancement. What keeps two shapes apart at fraction s of the step is an axis: a face of one
// and its n, or, fixed in the room, the line between two corners. Along it each corner p of the other is
//   g = n . (p - p_face)       g' = n . (v_p - v_face at p)        |g''| <= M  until the end of the step
// apart. The separation is at least the least g: any axis falls short of it or meets it. So the shapes stay
// farther apart than t at least for the least d > 0 of all corners with
//   g - t + g' d - M d^2 / 2 = 0.
// Then a new axis. Where the corner that comes first stays the same this is Newton's method from the safe
// side. For a face that turns at w', seen from its body,
//   M = |a| + r (w'^2 + |w''|) + 2 W' V + (W'^2 + |W''|) L
//     a  relative acceleration of the centres, V greatest relative speed of a corner, r its arm, w its spin,
//     W  the face's, L greatest distance of the corner from the face's centre
// Rates are by the fraction. The line between corners does not turn: W counts for the other corners' arms.

#include "sim/first_touch.h"

#include <algorithm>
#include <cmath>

#include "sim/outline.h"

namespace obscura::sim {

namespace {

constexpr int kLooks = 200;

double size(double x) { return std::abs(x); }
double size(const Vec<2>& x) { return x.norm(); }

// a cubic from 0 to 1 by its value at 0 and the three numbers that its rate is a Bernstein sum of
template <class T>
struct Cubic {
  T x0, d0, d1, d2;

  Cubic(const T& from, const T& rate0, const T& to, const T& rate1)
      : x0(from), d0(rate0), d1(3 * (to - from) - rate0 - rate1), d2(rate1) {}

  T value(double s) const { return x0 + s * (d0 + s * ((d1 - d0) + s / 3 * (d0 - 2 * d1 + d2))); }
  T rate(double s) const { return (1 - s) * ((1 - s) * d0 + 2 * s * d1) + s * s * d2; }
  T second(double s) const { return 2 * ((1 - s) * (d1 - d0) + s * (d2 - d1)); }

  // greatest from s to 1: the rate stays within the hull of its three numbers there
  double fastest(double s) const {
    return std::max({size(rate(s)), size(T((1 - s) * d1 + s * d2)), size(d2)});
  }
  double most_bent(double s) const { return std::max(size(second(s)), size(second(1))); }
};

struct Course {
  Cubic<Vec<2>> place;
  Cubic<double> turn;

  explicit Course(const Motion<2>& of)
      : place(of.x0, of.h * of.v0, of.x1, of.h * of.v1),
        turn(of.turn0[0], of.h * of.w0[0], of.turn1[0], of.h * of.w1[0]) {}

  Stance<2> at(double s) const {
    Stance<2> here;
    here.x = place.value(s);
    here.v = place.rate(s);
    here.room_from_body = rotation<2>(Turn<2>(turn.value(s)));
    here.w[0] = turn.rate(s);
    return here;
  }

  // w'^2 + |w''|: what an arm of one metre is bent by
  double whirl(double s) const {
    const double spin = turn.fastest(s);
    return spin * spin + turn.most_bent(s);
  }
};

// the least d > 0 with g + rate d - bend d^2 / 2 = 0, for g > 0
double safe(double g, double rate, double bend) {
  const double root = std::sqrt(rate * rate + 2 * bend * g);
  if (rate < 0) return 2 * g / (root - rate);
  return bend > 0 ? (rate + root) / bend : 1e300;
}

double arm(const Outline& outline) {
  double most = 0;
  for (int i = 0; i < outline.corners(); ++i) most = std::max(most, outline.corner(i).norm());
  return most;
}

Course difference(const Motion<2>& a, const Motion<2>& b) {
  Motion<2> both = a;
  both.x0 -= b.x0;
  both.x1 -= b.x1;
  both.v0 = a.h * a.v0 - b.h * b.v0;
  both.v1 = a.h * a.v1 - b.h * b.v1;
  both.h = 1;
  return Course(both);
}

// Two outlines that move, and how far they may go.
struct Chase {
  const Outline &a, &b;
  Course of_a, of_b, apart;  // a - b; its turn is not used
  double arm_a, arm_b;

  // by the face of one against all corners of the other, without the radii
  double safe_by_face(const Axis& axis, const Stance<2>& at_a, const Stance<2>& at_b, double s,
                      double target) const {
    const Outline &base = axis.of_b ? b : a, &other = axis.of_b ? a : b;
    const Stance<2>&at_base = axis.of_b ? at_b : at_a, &at_other = axis.of_b ? at_a : at_b;
    const Course &of_base = axis.of_b ? of_b : of_a, &of_other = axis.of_b ? of_a : of_b;
    const double arm_other = axis.of_b ? arm_a : arm_b;

    const double speed = apart.place.fastest(s) + arm_other * of_other.turn.fastest(s);
    const double distance = (at_other.x - at_base.x).norm() + arm_other + apart.place.fastest(s) * (1 - s);
    const double bend = apart.place.most_bent(s) + arm_other * of_other.whirl(s) +
                        2 * of_base.turn.fastest(s) * speed + of_base.whirl(s) * distance;

    const Vec<2> n = at_base.arm(base.normal(axis.face)), face = at_base.arm(base.corner(axis.face));
    double least = 1e300;
    for (int i = 0; i < other.corners(); ++i) {
      const Vec<2> p = at_other.arm(other.corner(i)), from_base = at_other.x - at_base.x + p;
      const double g = n.dot(from_base - face);
      const double rate = n.dot(at_other.velocity(p) - at_base.velocity(from_base));
      least = std::min(least, safe(std::max(g - target, 0.0), rate, bend));
    }
    return least;
  }

  // by the line between two corners, fixed in the room
  double safe_by_line(const Axis& axis, const Stance<2>& at_a, const Stance<2>& at_b, double s,
                      double target) const {
    const double bend = apart.place.most_bent(s) + arm_a * of_a.whirl(s) + arm_b * of_b.whirl(s);
    const Vec<2> n = at_b.arm(axis.normal);
    double least = 1e300;
    for (int i = 0; i < a.corners(); ++i) {
      const Vec<2> p = at_a.arm(a.corner(i));
      for (int k = 0; k < b.corners(); ++k) {
        const Vec<2> q = at_b.arm(b.corner(k));
        const double g = n.dot(at_a.x - at_b.x + p - q);
        const double rate = n.dot(at_a.velocity(p) - at_b.velocity(q));
        least = std::min(least, safe(std::max(g - target, 0.0), rate, bend));
      }
    }
    return least;
  }
};

struct Seen {
  double apart, step;  // m; how far it is safe to go on
};

// Goes on from s = 0 while `look(s, goal)` tells what is seen there.
template <class Look>
std::optional<double> advance(double target, double tolerance, const Look& look) {
  Seen seen = look(0.0, target);
  const double goal = std::min(target, seen.apart - 2 * tolerance);
  if (goal < target) seen = look(0.0, goal);
  double s = 0;
  for (int i = 0; i < kLooks; ++i) {
    if (!(s + seen.step <= 1)) return {};
    s += seen.step;
    seen = look(s, goal);
    if (seen.apart <= goal + tolerance) return s;
  }
  return s;
}

std::optional<double> touch(const Outline& a, const Motion<2>& of_a, const Outline& b, const Motion<2>& of_b,
                            double target, double tolerance) {
  const double radii = a.radius() + b.radius();
  if (a.faces() + b.faces() == 0 && radii == 0) return {};
  const Chase chase{a, b, Course(of_a), Course(of_b), difference(of_a, of_b), arm(a), arm(b)};
  const double path = chase.apart.place.fastest(0), arms = chase.arm_a + chase.arm_b;
  if (chase.apart.place.x0.norm() - path - arms > std::max(target, 0.0) + radii) return {};
  return advance(target + radii, tolerance, [&](double s, double goal) {
    const Stance<2> at_a = chase.of_a.at(s), at_b = chase.of_b.at(s);
    const Axis axis = widest_axis(a, b, lie(at_a, at_b));
    const double step = axis.face >= 0 ? chase.safe_by_face(axis, at_a, at_b, s, goal)
                                       : chase.safe_by_line(axis, at_a, at_b, s, goal);
    return Seen{axis.value, step};
  });
}

void earliest(std::optional<double>& so_far, const std::optional<double>& other) {
  if (other && (!so_far || *other < *so_far)) so_far = other;
}

}  // namespace

template <int D>
Stance<D> Motion<D>::at(double fraction) const {
  static_assert(D == 2, "space comes with its own turns");
  Stance<D> here = Course(*this).at(fraction);
  here.v = h > 0 ? Vec<D>(here.v / h) : v0;
  here.w = h > 0 ? Spin<D>(here.w / h) : w0;
  return here;
}

template <int D>
Motion<D> motion(const State<D>& from, const State<D>& to, int body, double h) {
  Motion<D> of;
  of.x0 = from.x[body];
  of.x1 = to.x[body];
  of.v0 = from.v[body];
  of.v1 = to.v[body];
  if (const int k = turning(from, body); k >= 0) {
    of.turn0 = from.turn[k];
    of.turn1 = to.turn[k];
    of.w0 = from.spin[k];
    of.w1 = to.spin[k];
  }
  of.h = h;
  return of;
}

template <int D>
std::optional<double> first_touch(const Shape<D>& a, const Motion<D>& of_a, const Shape<D>& b,
                                  const Motion<D>& of_b, double target, double tolerance) {
  std::optional<double> first;
  for (int i = 0; i < parts(a); ++i) {
    const Outline part_a(part(a, i));
    for (int k = 0; k < parts(b); ++k) {
      const Outline part_b(part(b, k));
      earliest(first, touch(part_a, of_a, part_b, of_b, target, tolerance));
    }
  }
  return first;
}

template <int D>
std::optional<double> first_touch(const Shape<D>& shape, const Motion<D>& of, const Wall<D>& wall,
                                  double target, double tolerance) {
  const Course course(of);
  std::optional<double> first;
  for (int i = 0; i < parts(shape); ++i) {
    const Outline outline(part(shape, i));
    const double long_arm = arm(outline);
    const auto look = [&](double s, double goal) {
      const Stance<D> at = course.at(s);
      const double bend = course.place.most_bent(s) + long_arm * course.whirl(s);
      Seen seen{1e300, 1e300};
      for (int k = 0; k < outline.corners(); ++k) {
        const Vec<D> p = at.arm(outline.corner(k));
        const double g = wall.normal.dot(at.x + p - wall.point) - outline.radius();
        seen.apart = std::min(seen.apart, g);
        seen.step = std::min(seen.step, safe(std::max(g - goal, 0.0), wall.normal.dot(at.velocity(p)), bend));
      }
      return seen;
    };
    earliest(first, advance(target, tolerance, look));
  }
  return first;
}

template struct Motion<2>;
template Motion<2> motion(const State<2>&, const State<2>&, int, double);
template std::optional<double> first_touch(const Shape<2>&, const Motion<2>&, const Shape<2>&,
                                           const Motion<2>&, double, double);
template std::optional<double> first_touch(const Shape<2>&, const Motion<2>&, const Wall<2>&, double, double);

}  // namespace obscura::sim
