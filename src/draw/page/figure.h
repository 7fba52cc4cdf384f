#pragma once

#include <optional>
#include <string>
#include <vector>

#include "draw/page/measure.h"
#include "draw/picture/color.h"
#include "sim/math/rational.h"
#include "sim/model/snapshot.h"

namespace obscura::draw {

// The parts of a figure besides the picture: names, measures and drawings on it. Values are the run's.

/// A place of the room, or of a body that takes it along.
struct Site {
  int body = -1;                        // -1: the room
  sim::Vec3 local = sim::Vec3::Zero();  // in the body's frame, or the room's, m
};

/// The quantity of an arrow.
enum class Quantity { position, velocity, weight, spring, contact, impulse, blast, normal, spin, torque };

struct Figure {
  struct Point {
    Site at;
    std::string label;
    bool dot = true;
    std::optional<Color> color{};
  };
  struct Vector {
    Quantity quantity = Quantity::position;
    int body = -1;             // whose
    std::optional<Site> at{};  // where its tail is: of a position needed; of a velocity, which point's it is
    std::optional<Site> to{};  // the tip of a position
    std::string label;
    std::optional<Color> color{};
  };
  struct Angle {
    int body = -1;                     // its own angle, or
    std::optional<Site> at, from, to;  // between two directions from a place
    std::string label;
  };
  struct Length {
    Site from, to;
    std::string label;
    double offset = 0;  // mm to the left of the way from one to the other
  };
  struct Cone {
    int body = -1;  // the body with the contacts
    std::string label;
  };
  struct Label {
    Site at;
    std::string text;
  };
  struct Plot : Measured {
    sim::Rational from, to;  // s
    double height = 36;      // mm
    std::string against;     // a quantity, instead of time
    std::string over;        // "physics.rate=10,20,40": the end of a run for each, instead of time
    std::string reference;   // "physics.rate=6400; physics.integrator=rk4": plotted is how far the end is
                             // from that run's
    bool log = false;
  };

  std::vector<sim::Rational> at;       // s, one a panel; after the impact, where there is one
  int impact = -1;                     // the body whose first impact it is about
  std::optional<double> width;         // mm
  std::optional<sim::Vec3> low, high;  // m: what of the world is shown
  std::optional<sim::Rational> every;
  std::string vary;  // "crate.elasticity=0,0.5,1": a panel and a line of each plot for each value
  int columns = 0;
  bool room = true;  // the run's picture; false: plots alone
  bool scale_bar = false;
  bool axes = false;    // the room's
  std::string formula;  // above the picture
  std::vector<Point> points;
  std::vector<Vector> vectors;
  std::vector<Angle> angles;
  std::vector<Length> lengths;
  std::vector<Cone> cones;
  std::vector<Label> labels;
  std::vector<Plot> plots;
};

/// The place of a site at an instant.
sim::Vec3 place(const Site& site, const sim::Snapshot& now);

}  // namespace obscura::draw
