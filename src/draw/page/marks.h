#pragma once

#include <optional>
#include <string>
#include <vector>

#include "draw/picture/color.h"
#include "sim/math/rational.h"
#include "sim/model/snapshot.h"

namespace obscura::draw {

// What a figure or a film says about its run, over the picture: names, measures and arrows. Values are the
// run's.

/// A place of the room, or of a body that takes it along.
struct Site {
  int body = -1;                        // -1: the room
  sim::Vec3 local = sim::Vec3::Zero();  // in the body's frame, or the room's, m
};

/// Where a site is at an instant.
sim::Vec3 place(const Site& site, const sim::Snapshot& now);

/// The quantity of an arrow.
enum class Quantity {
  position,
  velocity,
  acceleration,
  momentum,
  weight,
  normal_force,
  friction,
  net_force,
  spring_force,
  joint_force,
  drag,
  field,
  spring,
  contact,
  impulse,
  blast,
  normal,
  spin,
  torque,
  joint_torque
};

/// An instant of the run, and perhaps some seconds of the film after it.
struct Cue {
  double time = 0;     // s of the run
  bool after = false;  // `film` counts, not `time`
  double film = 0;     // s of the film
};

/// From when on and until when a mark is shown: always where neither is said.
struct Interval {
  std::optional<Cue> start, end;
  std::string panels{};  // of a figure, by their letters; empty: all

  /// Whether a figure's panel has it.
  bool in(int panel) const {
    return panels.empty() || (panel < 26 && panels.find(char('a' + panel)) != std::string::npos);
  }
  /// Whether it is shown at an instant of the run, `film` seconds into its film (not a number: of no film).
  bool has(double time, double film) const;
  /// Whether it may be shown at an instant of the run, where seconds of the film are not known.
  bool may_have(double time) const {
    return (!start || time >= start->time - 1e-9) && (!end || end->after || time < end->time - 1e-9);
  }
};

struct Marks {
  // each compiled once, in marks.cpp
  Marks();
  Marks(const Marks&);
  Marks(Marks&&) noexcept;
  Marks& operator=(const Marks&);
  Marks& operator=(Marks&&) noexcept;
  ~Marks();

  struct Point {
    Site at;
    std::string label;
    bool dot = true;
    std::optional<Color> color{};
    Interval shown{};
  };
  struct Vector {
    Quantity quantity = Quantity::position;
    int body = -1;             // whose
    std::optional<Site> at{};  // where its tail is: of a position needed; of a velocity, which point's it is
    std::optional<Site> to{};  // the tip of a position
    std::string label;
    std::optional<Color> color{};
    Interval shown{};
    // of what its body touches and what holds it, Reading::part: these alone; empty: all
    std::vector<int> with{};
    // where it has several arrows at once: what they are of, in the order of their numbers
    std::vector<int> numbered{};
    bool quiet = false;  // grey, for others than its body are to be looked at
  };
  struct Angle {
    int body = -1;                     // its own angle, or
    std::optional<Site> at, from, to;  // between two directions from a place
    std::string label;
    Interval shown{};
  };
  struct Length {
    Site from, to;
    std::string label;
    double offset = 0;  // mm to the left of the way from one to the other
    Interval shown{};
  };
  struct Cone {
    int body = -1;  // the body with the contacts
    std::string label;
    Interval shown{};
  };
  struct Label {
    Site at;
    std::string text;
    std::string quantity{};  // of its value: a measure's name (draw/page/measure.h); empty: none
    int body = -1;           // whose
    Interval shown{};
  };
  /// The words of a body, which go with it.
  struct Name {
    int body = -1;
    std::string text;    // as mathematics
    bool quiet = false;  // grey, for others are to be looked at
  };
  struct Path {
    Site at;
    double lasting = 0;  // s of the run; 0: all of it
    bool front = false;  // over the bodies
    std::optional<Color> color{};
    Interval shown{};
  };
  struct Ghost {
    sim::Rational time{};     // s: the earlier instant
    std::vector<int> bodies;  // those drawn; none: all that move
    Interval shown{};
  };

  bool axes = false;  // the room's
  std::vector<Point> points;
  std::vector<Vector> vectors;
  std::vector<Angle> angles;
  std::vector<Length> lengths;
  std::vector<Cone> cones;
  std::vector<Label> labels;
  std::vector<Name> names;
  std::vector<Path> paths;
  std::vector<Ghost> ghosts;

  bool empty() const;
  /// Whether all of them are words at places of the room, without values: they say the same of every run.
  bool fixed() const;
};

}  // namespace obscura::draw
