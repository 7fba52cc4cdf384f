#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "sim/model/model.h"
#include "sim/model/state.h"

namespace obscura::sim {

/// How fast bodies pass each other, or a centre, under forces that grow without bound on the way there:
/// attractors, gravitation, Coulomb's force, and formulas that go as A / r^n, n from 1/2 on. Such a force
/// changes by as much as itself within
///   tau = min(r/v, sqrt(r/a)),   r^2 = d^2 + s^2
/// where d is the distance (m), v the relative speed (m/s), a the relative acceleration (m/s^2) and s the
/// softening (m). r/v counts only where the force changes the velocity by more than a millionth in a step.
template <int D>
class ClosePassages {
 public:
  /// Kept by reference.
  explicit ClosePassages(const Model<D>& model);

  /// Whether there are such forces.
  bool any() const { return !pairs_.empty() || !groups_.empty(); }

  /// The largest h/tau in a step of h (s), of all bodies; 0 where no passage is close.
  double fastest(const State<D>& state, double h);
  /// The same of one body, about centres that are places.
  double fastest(const State<D>& state, double h, int body) const;

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
  Place place(const State<D>& state, const Point& point) const;
  double of_pair(const State<D>& state, double h, const Pair& pair) const;
  double of_group(const State<D>& state, double h, const Group& group);
  void add(Point a, Point b, const Law& law);
  void add_formula(const Force<D>& force);

  const Model<D>& model_;
  std::vector<Pair> pairs_;
  std::vector<Group> groups_;
  std::vector<std::vector<int>> of_body_;  // pairs with a place
  std::vector<double> rows_;               // of a group: x, v, weight and inverse of each
};

/// The limits of step_by_passages().
struct PassageLimits {
  static constexpr double kFar = 0.1;     // h/tau up to which a step is taken whole
  static constexpr double kPiece = 0.05;  // of tau: the longest piece of others
  static constexpr int kHalvings = 40;    // of the step, to its shortest piece
  static constexpr int kMost = 10000;     // pieces; what is then left of the step is taken in pieces of
  static constexpr int kFewHalvings = 10;
  static constexpr double kCoarse = 0.25;  // h/tau beyond which the step of another scheme follows no passage
};

/// Takes a step of h (s) from time t (s). Runge-Kutta goes in pieces that are short against the passages in
/// it, each a half of a half ... of the step; other schemes go whole. `ratio()` tells h/tau as the bodies are
/// now; go(from, length) takes a piece, both in s. Notes in `met` a passage that is not followed: a piece
/// longer than the limits ask for, or a step of another scheme beyond kCoarse.
template <class Ratio, class Go>
void step_by_passages(Integrator integrator, double t, double h, std::int64_t step, LimitMet& met,
                      Ratio&& ratio, Go&& go) {
  if (integrator != Integrator::rk4) {
    if (ratio() > PassageLimits::kCoarse) met.note(step);
    return go(t, h);
  }
  double done = 0;
  for (int pieces = 0; done < 1; ++pieces) {
    const double whole = ratio();
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
