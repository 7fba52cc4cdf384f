#pragma once

#include <array>
#include <vector>

#include "sim/math/expression.h"
#include "sim/model/model.h"

namespace obscura::sim {

/// Forces on bodies that fly: those on which nothing but formulas of their own place and velocity act, no
/// spring, no other body and no torque. They are evaluated for many bodies at a time, without their poses.
template <int D>
class FlyingForces {
 public:
  /// Kept by reference.
  explicit FlyingForces(const Model<D>& model);

  /// Whether a body flies: forces act on it, and all of them are such.
  bool flies(int body) const { return flies_[std::size_t(body)] != 0; }
  /// Whether forces act on the model, and all bodies on which they act fly and do not turn.
  bool all() const { return all_; }

  /// Adds to `rates` the accelerations (m/s^2) at time t (s) of `count` bodies from body `first` on, of those
  /// that fly. They are at x + d (m) with velocities v (m/s). All four hold D rows of `count` numbers: all x,
  /// then all y. Answers the power of what is booked as work, drag with it, W. Throws NotFinite.
  double accelerate(double t, int first, int count, const double* x, const double* d, const double* v,
                    double* rates);

 private:
  // a force on some of them
  struct One {
    const Force<D>* force;
    std::vector<int> bodies;  // ascending
    std::vector<std::vector<double>> fixed;
    Evaluation evaluation;
    std::array<bool, 16> reads{};
    std::vector<double> inverse;  // of the masses, 1/kg, where all are exact; else none
    bool booked = false;          // its work is
  };

  void find();
  void gather(const One& force);

  const Model<D>& model_;
  std::vector<char> flies_;
  bool all_ = false;
  std::vector<One> forces_;
  std::vector<double> drags_;  // N s/m, one a body; empty where there is none
  std::vector<double> lanes_;  // rows of Program::kLanes
};

}  // namespace obscura::sim
