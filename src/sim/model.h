#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/rational.h"
#include "sim/vec.h"

namespace obscura::sim {

enum class Integrator { rk4, midpoint, euler, semi_implicit };
enum class Collision { handout };
enum class ShapeKind { point, ball, box };

/// The form of a body about its centre of mass, in its own frame.
template <int D>
struct Shape {
  ShapeKind kind = ShapeKind::point;
  double radius = 0;             // ball, m
  Vec<D> half = Vec<D>::Zero();  // box: half its sides, m
};

/// What stays true of a body while the room moves. A particle is a point or a ball that does not turn; a
/// rigid body is a particle that also turns.
template <int D>
struct Body {
  std::string name;
  Shape<D> shape;
  double mass = 1;                    // kg
  Spin<D> inertia = Spin<D>::Zero();  // principal moments, kg m^2; zero: does not turn
  double elasticity = 1;              // the handout's e, 0 <= e <= 1
  double drag = 0;                    // c of f = -c v at the centre of mass, N s/m
  bool fixed = false;                 // held where it starts; as heavy as the room

  bool turns() const { return shape.kind == ShapeKind::box; }
};

/// An immobile half space: what has (q - point) . normal < 0 is on the wrong side. Handout §2.3.
template <int D>
struct Wall {
  Vec<D> point = Vec<D>::Zero();
  Vec<D> normal = Vec<D>::Unit(1);   // unit, into the room
  std::optional<double> elasticity;  // none: the body's own holds
};

/// One end of a spring: a point of a body, or a place in the room.
template <int D>
struct End {
  int body = -1;                  // index; -1: the room
  Vec<D> local = Vec<D>::Zero();  // in the body's frame from its centre; for the room, the place
};

/// f = -(k (l - l_rest) + c dl/dt) d, handout §2.2 with a dashpot along the axis.
template <int D>
struct Spring {
  End<D> a, b;
  double rest_length = 0;  // m
  double stiffness = 0;    // k, N/m
  double damping = 0;      // c, N s/m
};

/// The hand of the scripted mouse: pressed at the first knot, released at the last.
template <int D>
struct Knot {
  Rational time;  // s
  Vec<D> place;
};

/// A spring from a moving pointer to the closest particle or box vertex, taken once, when pressed. Handout
/// §2.2.
template <int D>
struct Mouse {
  std::vector<Knot<D>> path;  // at least two, times strictly increasing
  double rest_length = 0;     // m
  double stiffness = 0;       // N/m
  double damping = 0;         // N s/m
};

/// What does not change while the room runs. Bodies are ordered: those that do not turn first, then those
/// that do; a body's index here is its index everywhere.
template <int D>
struct Model {
  Rational rate = {600, 1};  // steps per second
  Integrator integrator = Integrator::rk4;
  Collision collision = Collision::handout;
  Vec<D> gravity = Vec<D>::Unit(1) * -9.81;  // m/s^2
  double scale = 1;                          // the room's height, m: what "far" and "fast" are measured by
  std::vector<Body<D>> bodies;
  std::vector<Wall<D>> walls;
  std::vector<Spring<D>> springs;
  std::vector<Mouse<D>> mice;

  int particles() const {  // bodies that do not turn
    int n = 0;
    while (n < int(bodies.size()) && !bodies[n].turns()) ++n;
    return n;
  }
};

}  // namespace obscura::sim
