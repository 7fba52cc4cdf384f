#pragma once

#include <vector>

#include "draw/picture/look.h"
#include "sim/math/rational.h"

namespace obscura::draw {

/// How fast a run goes by from one time of it on.
struct PaceKey {
  sim::Rational time;                              // s of the run, >= 0
  sim::Rational speed{1, 1};                       // seconds of the run in a second of the film, above 0
  CameraKey::Ease ease = CameraKey::Ease::in_out;  // how it comes here from the key before
};

/// Where the film stands still.
struct Freeze {
  sim::Rational time;     // s of the run
  sim::Rational seconds;  // of the film, above 0
};

/// Which instant of a run each instant of its film shows: slow motion, and what is quicker than life. Times
/// are exact where their denominator is a million at most, and else the nearest microsecond.
class Pace {
 public:
  /// As fast as it happens, or evenly at a speed (above 0).
  Pace() = default;
  explicit Pace(sim::Rational speed);
  /// Before the first key its speed, after the last key that one's. Requires times that increase.
  explicit Pace(const std::vector<PaceKey>& keys);

  /// The film stands still there as well. Requires times that increase, from one call to the next too.
  void freeze(const Freeze& freeze);

  /// Whether film and run are one in time.
  bool plain() const { return stretches_.empty() && frozen_.empty(); }
  /// The instant of the run that the film shows at `film` (s, >= 0). Never goes back.
  sim::Rational world(sim::Rational film) const;
  /// When the film shows an instant of the run first.
  sim::Rational film(sim::Rational world) const;
  /// How fast the run goes by there: seconds of it in a second of the film; 0 where it stands still.
  double speed(double film) const;
  /// How long the film stands still at an instant of the run, s.
  sim::Rational frozen_at(sim::Rational world) const;

  /// Where it stands still: from when on (s of the film), at which instant of the run, how long.
  struct Frozen {
    sim::Rational film, world, seconds;
  };
  const std::vector<Frozen>& frozen() const { return frozen_; }

 private:
  /// From one key on, up to the next.
  struct Stretch {
    sim::Rational film, world;  // where it begins, s
    sim::Rational from, to;     // speeds
    CameraKey::Ease ease;
    double seconds = 0, length = 0;  // of the film and of the run, where the speed changes
    bool even() const { return from == to; }
    double gone(double u) const;
  };
  sim::Rational moving_world(sim::Rational film) const;
  sim::Rational moving_film(sim::Rational world) const;

  std::vector<Stretch> stretches_;  // by time; none: as fast as it happens
  std::vector<Frozen> frozen_;      // by time
};

}  // namespace obscura::draw
