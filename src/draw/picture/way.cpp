// The way of a point l of a body between two points a, b of its track, u = 0 to 1, T apart.
//   p(u) = x(u) + exp(d(u)) R_a l
//   x    = the cubic with x_a, T v_a at 0 and x_b, T v_b at 1
//   d    = the cubic with 0, T w_a at 0 and D, T dexp^-1(D) w_b at 1        exp(D) R_a = R_b
// R says a turn only up to whole ones: of exp(D) the one nearest to T (w_a + w_b) / 2. A chord of n pieces is
// off by at most (|T (v_b - v_a)| + |l| |D|²) / 8 n².

#include "draw/picture/way.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/math/exponential.h"

namespace obscura::draw {
namespace {

using sim::Vec3;
using Sample = sim::Track::Point;

constexpr int kMostPieces = 200;
constexpr double kLikely =
    0.3;  // of the mean speed: so far the mean velocity of one motion is from its ends'
constexpr double kCorner = 0.1;  // of the way: nearer to each other two straight motions meet
constexpr double kBend = 0.98;   // cosine of a turn that is no corner
constexpr double kFarTurn = 2;   // rad: of more it is taken to turn evenly

Eigen::Vector4d coefficients(const Sample& p) { return p.orientation.coeffs(); }

// from 0 to `to`, with the slopes at both ends
Vec3 cubic(double u, const Vec3& from_slope, const Vec3& to, const Vec3& to_slope) {
  return u * (1 - u) * ((1 - u) * from_slope - u * to_slope) + u * u * (3 - 2 * u) * to;
}

// the rotation vector from a to b
Vec3 turn_between(const Sample& a, const Sample& b, double T) {
  Eigen::Vector4d inverse = coefficients(a);
  inverse.head<3>() *= -1;
  const Vec3 least = sim::logarithm(sim::product(coefficients(b), inverse)),
             likely = T / 2 * (a.spin + b.spin);
  const double by = likely.norm();
  const Vec3 axis = least.norm() > 1e-9 ? Vec3(least.normalized())
                    : by > 0            ? Vec3(likely / by)
                                        : Vec3::UnitZ();
  const double whole = 2 * std::numbers::pi;
  return least + whole * std::round((likely.dot(axis) - least.dot(axis)) / whole) * axis;
}

struct Piece {
  Piece(const Sample& from, const Sample& to, const Vec3& at)
      : a(from), b(to), local(at), T(to.time - from.time), way(to.place - from.place) {
    if (local.isZero(0)) return;
    D = turn_between(a, b, T), from_turn = T * a.spin, to_turn = T * b.spin;
    if (D.norm() < kFarTurn)
      to_turn = sim::turn_rate(-D, to_turn);
    else
      from_turn = to_turn = D;
  }

  // the velocities at both ends are those of one motion
  bool smooth() const {
    const double speed = (a.velocity.norm() + b.velocity.norm()) / 2;
    return b.smooth && (way / T - (a.velocity + b.velocity) / 2).norm() < kLikely * speed;
  }

  int pieces(double tolerance) const {
    const double off = (T * (b.velocity - a.velocity).norm() + local.norm() * D.squaredNorm()) / 8;
    return std::clamp(int(std::ceil(std::sqrt(off / tolerance))), 1, kMostPieces);
  }

  Vec3 at(double u) const {
    Vec3 arm = a.orientation * local;
    if (!D.isZero(0)) arm = sim::matrix(sim::exponential(cubic(u, from_turn, D, to_turn))) * arm;
    return a.place + cubic(u, T * a.velocity, way, T * b.velocity) + arm;
  }

  const Sample &a, &b;
  const Vec3& local;
  double T;
  Vec3 way, D = Vec3::Zero(), from_turn = Vec3::Zero(), to_turn = Vec3::Zero();
};

// the point's own place and velocity
Sample of_point(Sample p, const Vec3& local) {
  const Vec3 arm = p.orientation * local;
  p.place += arm, p.velocity += p.spin.cross(arm);
  return p;
}

// where two straight motions from a and to b meet
bool corner(const Sample& a, const Sample& b, Sample& met) {
  const double T = b.time - a.time;
  const Vec3 apart = a.place - b.place + T * b.velocity, closing = a.velocity - b.velocity;
  const double fast = a.velocity.norm() * b.velocity.norm();
  if (!(fast > 0) || a.velocity.dot(b.velocity) > kBend * fast) return false;
  const double t = std::clamp(-apart.dot(closing) / closing.squaredNorm(), 0.0, T);
  if ((apart + t * closing).norm() > kCorner * T * std::sqrt(fast)) return false;
  met = a;
  met.time = a.time + t;
  met.place = (a.place + t * a.velocity + b.place - (T - t) * b.velocity) / 2;
  return t > 0 && t < T;
}

}  // namespace

std::vector<Sample> refined(const std::vector<Sample>& track, const Vec3& local, double tolerance) {
  std::vector<Sample> way;
  way.reserve(track.size());
  for (std::size_t k = 0; k < track.size(); ++k) {
    const Sample& b = track[k];
    const Sample end = of_point(b, local);
    if (k > 0) {
      const Sample& a = track[k - 1];
      Sample between = a;
      if (const Piece piece(a, b, local); piece.smooth()) {
        const int n = piece.pieces(tolerance);
        for (int i = 1; i < n; ++i) {
          between.time = a.time + (b.time - a.time) * i / n, between.place = piece.at(double(i) / n);
          way.push_back(between);
        }
      } else if (corner(way.back(), end, between)) {
        way.push_back(between);
      }
    }
    way.push_back(end);
  }
  return way;
}

Sample end_of_way(int body, const sim::Snapshot& now) {
  const sim::Snapshot::Body& at = now.bodies[std::size_t(body)];
  const bool struck = std::any_of(now.contacts.begin(), now.contacts.end(), [&](const auto& each) {
    return (each.body == body || each.other == body) && !each.impulse.isZero(0);
  });
  return {now.time, at.position, at.orientation, at.velocity, at.spin, !struck};
}

}  // namespace obscura::draw
