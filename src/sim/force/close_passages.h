#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sim/collide/may_touch.h"
#include "sim/model/drives.h"
#include "sim/model/model.h"
#include "sim/model/state.h"

namespace obscura::sim {

/// How fast bodies pass each other, or a centre, under forces that grow without bound on the way there:
/// attractors, gravitation, Coulomb's force, and formulas that go as A / r^n, n from 1/2 on. Such a force
/// changes by as much as itself within
///   tau = min(r/(e v), sqrt(r/(e a))),   r^2 = d^2 + s^2,   e = max(1, n/2)
/// where d is the distance (m), v the relative speed (m/s), a the relative acceleration (m/s^2) and s the
/// softening (m). r/v counts only where the force changes the velocity by more than a millionth in a step.
/// Two that may touch, near each other, pass no more: contacts stop them. Nor do two on one body or joint.
template <int D>
class ClosePassages {
 public:
  /// Kept by reference.
  explicit ClosePassages(const Model<D>& model);

  /// Whether there are such forces.
  bool any() const { return !pairs_.empty() || !groups_.empty(); }

  /// The largest h/tau in a step of h (s) as the bodies are at time t (s), of pairs with a body that is a
  /// member (a number from 0 on, one a body); 0 where no passage is close. Throws NotFinite.
  double fastest(const State<D>& state, double t, double h, std::span<const int> member);
  /// The same of one body that only centres which are places pull.
  double fastest(const State<D>& state, double h, int body);

 private:
  struct Point {
    int body;
    Vec<D> local;
    double inverse;     // of the mass, 1/kg; 0 where the body does not yield
    double weight = 1;  // mass or charge
  };
  // |f| = strength / r^n
  struct Law {
    double strength;  // N m^n; of a group, for two units of weight
    int twice;        // 2n
    double softening2;
  };
  struct Pair {
    Point a, b;
    Law law;
  };
  struct Group {
    std::vector<Point> points;
    Law law;
  };
  struct Place {
    Vec<D> x, v;
  };

  Point point(const Subject<D>& subject) const;
  Place place(const State<D>& state, double t, const Point& point);
  bool meet(int a, int b, double r2) const;
  double of_pair(const State<D>& state, double t, double h, const Pair& pair);
  double of_group(const State<D>& state, double t, double h, const Group& group, std::span<const int> member);
  void add(Point a, Point b, const Law& law);
  void add_formula(const Force<D>& force);

  const Model<D>& model_;
  Drives<D> drives_;
  MayTouch<D> may_touch_;
  std::vector<std::pair<int, int>> joined_;  // bodies on one joint, a < b, sorted
  std::vector<double> radius_;               // bounding radius of each body, m
  std::vector<Pair> pairs_;
  std::vector<Group> groups_;
  std::vector<std::vector<int>> of_body_;  // pairs with a place
  std::vector<int> order_;                 // of a group: members first
  std::vector<double> rows_;               // of a group: x, v, weight and inverse of each
};

/// The limits of step_by_passages().
struct PassageLimits {
  static constexpr double kFar = 0.1;      // h/tau up to which a step is taken whole
  static constexpr double kPiece = 0.05;   // of tau: the longest piece of others
  static constexpr double kCoarse = 0.25;  // h/tau beyond which the step of another scheme follows no passage
  static constexpr int kHalvings = 40;     // of the step, to its shortest piece
  static constexpr int kMost = 2000;       // pieces; after them a piece has fewer halvings
  static constexpr int kFewHalvings = 8;
};

/// Takes a step of h (s) from time t (s). Runge-Kutta goes in pieces that are short against the passages in
/// it, each a half of a half ... of the step; other schemes go whole. `ratio(now)` tells h/tau as the bodies
/// are at that time; go(from, length) takes a piece, both in s. Notes in `met` a passage that is not
/// followed: a piece longer than the limits ask for, or a step of another scheme beyond kCoarse.
template <class Ratio, class Go>
void step_by_passages(Integrator integrator, double t, double h, std::int64_t step, LimitMet& met,
                      Ratio&& ratio, Go&& go) {
  if (integrator != Integrator::rk4) {
    if (ratio(t) > PassageLimits::kCoarse) met.note(step);
    return go(t, h);
  }
  double done = 0;
  for (int pieces = 0; done < 1; ++pieces) {
    const double whole = ratio(t + done * h);
    int halvings = 0;
    if (whole > PassageLimits::kFar) {
      const int most = pieces < PassageLimits::kMost ? PassageLimits::kHalvings : PassageLimits::kFewHalvings;
      while (halvings < most && std::ldexp(whole, -halvings) > PassageLimits::kPiece) ++halvings;
      if (std::ldexp(whole, -halvings) > PassageLimits::kPiece) met.note(step);
    }
    // pieces grow only where they end at a multiple of themselves
    double part = std::ldexp(1.0, -halvings);
    while (std::fmod(done, part) != 0) part *= 0.5;
    go(t + done * h, part * h);
    done += part;
  }
}

}  // namespace obscura::sim
