#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/math/vec.h"
#include "sim/model/model.h"

namespace obscura::sim {

// One instant, without a dimension: above it nothing knows D. The plane lies at z = 0, seen from +z.

/// All that is the same at every instant: names, shapes and masses of everything in the room.
struct SceneInfo {
  using Part = DrawnForm;  // of a body of several, in the body's frame
  struct Body {
    std::string name;
    ShapeKind kind = ShapeKind::point;
    double radius = 0;         // m
    Vec3 half = Vec3::Zero();  // m
    double mass = 0;           // kg
    bool fixed = false;
    bool turns = false;
    std::vector<Vec3> vertices;    // of a polygon or hull, in its own frame from its centre of mass, m
    std::vector<DrawnForm> parts;  // of a compound
    std::vector<std::vector<int>> faces = {};  // of a hull: loops of vertices, counter-clockwise from outside
    double friction = 0, static_friction = 0;  // Coulomb's mu, and that of what does not slip
    bool bare = false;                         // it has no form but its rails
  };
  /// A curve on which others roll and slide, or which runs through them.
  struct Rail {
    std::string name;
    int body = -1;             // -1: the room
    std::vector<Vec3> places;  // along it, in the body's frame, m
    bool closed = false;
    bool left = false, right = false;                     // the sides that are touched; neither: a wire
    std::optional<double> friction{}, static_friction{};  // none: the other body's own holds
  };
  struct Wall {
    Vec3 point, normal;
    std::optional<double> friction{}, static_friction{};  // none: the body's own holds
  };
  struct Spring {
    int a = -1, b = -1;  // bodies; -1: the room
    double rest_length = 0, stiffness = 0;
    Vec3 start = Vec3::Zero();  // from its a to its b at the start of the run, m
  };
  struct Joint {
    std::string name;
    JointKind kind = JointKind::pin;
    int a = -1, b = -1;                    // bodies; -1: the room
    double length = 0;                     // of a rod or rope, m
    Vec3 axis = Vec3::UnitX();             // of a slider, in b's frame
    double lower = -1e300, upper = 1e300;  // of a slider's way, m
    struct Place {
      int body = -1;  // -1: the room
      Vec3 local = Vec3::Zero();
    };
    std::vector<Place> places = {};  // of a pulley: all that its rope goes over, from a to b; of a gear: the
                                     // ends of both joints
    // of a pulley: the wheels at its ends, as sim::Winding has them; of a gear: its pitch circles
    double offset_a = 0, offset_b = 0;
    std::vector<double> around = {};  // of a pulley with friction: those of what its rope slides over
    int rounds = 0;                   // its: whole turns more around each
    bool later = false;               // not there at the start
    bool belt = false;                // of a gear: it is one, around wheels of these radii
    int rope = 0;                     // of a pulley: pieces of one rope have the same number
    Vec3 tooth_a = Vec3::UnitX(), tooth_b = Vec3::UnitX();  // of a gear, in the bodies' frames
    Vec3 start = Vec3::Zero();                              // from its a to its b at the start of the run, m
  };
  struct Bond {
    int a = -1, b = -1;  // bodies; b = -1: the room
  };
  struct Mouse {
    double press = 0, release = 0;  // s
    double rest_length = 0;
    std::vector<Vec3> path;  // the whole way of the hand, finely sampled, equal times
  };

  int dimension = 2;
  double scale = 1;  // the room's height, m
  Vec3 gravity = Vec3::Zero();
  std::vector<Body> bodies;
  std::vector<Wall> walls;
  std::vector<Spring> springs;
  std::vector<Mouse> mice;
  std::vector<Joint> joints;
  std::vector<Bond> bonds = {};
  std::vector<Rail> rails;
  std::optional<double> surface{};  // the y of a fluid's, m
  bool forces = false;              // beside gravity, drag, springs and explosions; then or by events
  bool books_work = false;          // Energies::work is kept
};

struct Energies {
  double kinetic = 0, gravity = 0, springs = 0;  // J
  double fields = 0;                             // potentials of forces, J
  double hand = 0;                               // in the springs of pressed mice, beside the total, J
  double work = 0;                       // of forces without one and of drag, beside them, J since t = 0
  double displacement = 0, impacts = 0;  // the ledger of `handout`, J since t = 0
  double potential() const { return gravity + springs + fields; }
  double total() const { return kinetic + potential(); }
};

struct Snapshot {
  struct Body {
    Vec3 position = Vec3::Zero();
    Vec3 velocity = Vec3::Zero();
    Vec3 spin = Vec3::Zero();  // rad/s; in the plane (0, 0, w)
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
    double angle = 0;            // plane: rad, not wrapped
    bool at_rest = false;        // frozen: steps leave it alone
    Vec3 blast = Vec3::Zero();   // what explosions push it with, N
    Vec3 drag = Vec3::Zero();    // of the air, and of the ground, N
    Vec3 field = Vec3::Zero();   // the sum of all other forces of the scene: formulas, attraction, charges, N
    Vec3 held = Vec3::Zero();    // of all joints, N
    Vec3 torque = Vec3::Zero();  // of joints, explosions and forces of the scene about its centre, N m
    double kinetic = 0, gravity = 0;  // its parts of the energies, J; of what does not move none
    double surface = 0;               // m/s of its surface, in the plane, clockwise around it
  };
  struct Spring {
    Vec3 a = Vec3::Zero(), b = Vec3::Zero();  // where its ends are
    int holds_a = -1, holds_b = -1;           // bodies; -1: the room
    double push = 0;                          // of its stiffness, N; negative: it pulls
    Vec3 force = Vec3::Zero();                // on its a, with its damping, N
    bool loose = false;                       // it holds nothing
  };
  struct Mouse {
    bool pressed = false;
    Vec3 pointer = Vec3::Zero();
    int body = -1;              // what it holds
    Vec3 held = Vec3::Zero();   // the point of the body it holds
    Vec3 force = Vec3::Zero();  // on that, N
  };
  struct Joint {
    Vec3 a = Vec3::Zero(), b = Vec3::Zero();  // where its ends are
    Vec3 force = Vec3::Zero();                // on its a, N
    Vec3 torque = Vec3::Zero();               // on its a about its place, N m
    struct Hold {
      int body = -1;
      Vec3 place = Vec3::Zero();   // where it holds it, m
      Vec3 at = Vec3::Zero();      // where its force acts, m
      Vec3 force = Vec3::Zero();   // N
      Vec3 torque = Vec3::Zero();  // about `place`, N m
    };
    std::vector<Hold> holds{};  // of a mechanism: what it puts on each body, where it holds it
    bool broken = false;
    double slack = 0;  // of a pulley: how much of its rope hangs loose, m
    // of a pulley that has left wheels, as sim::Wound has them
    int off_a = 0, off_b = 0, with = 0;
  };
  struct Contact {
    int body = -1, wall = -1;                          // wall: -1 where `other` is what it touches
    Vec3 point = Vec3::Zero(), normal = Vec3::Zero();  // towards `body`
    Vec3 impulse = Vec3::Zero();                       // on `body`, N s, in the last step
    double gap = 0;                                    // m, negative when inside
    int other = -1;                                    // a body
    Vec3 force = Vec3::Zero();                         // on `body`, N
    bool sliding = false;
    bool holds = false;  // false: an impact alone
    int rail = -1;       // of `other`, or of `body`
  };

  double time = 0;           // s
  std::int64_t step = 0;     // whole steps done
  std::vector<Body> bodies;  // in the order of SceneInfo::bodies
  std::vector<Spring> springs;
  std::vector<Mouse> mice;
  std::vector<Joint> joints;
  std::vector<Contact> contacts;
  std::vector<char> bonds = {};  // whether each is whole
  Energies energies;
  std::vector<double> masses = {};       // of bodies now, kg; none: as at the start
  std::optional<Vec3> gravity = {};      // of the room now, m/s^2; none: as at the start
  Vec3 momentum = Vec3::Zero();          // kg m/s
  Vec3 angular_momentum = Vec3::Zero();  // about the origin, kg m^2/s; in the plane (0, 0, L)
};

/// The mass of a body now, kg.
double mass(const SceneInfo& cast, const Snapshot& now, int body);

/// Coulomb's mu between the two that touch, as they slip or not.
double friction(const SceneInfo& cast, const Snapshot::Contact& contact);

/// The paths of chosen bodies on the physics clock, the same for every frame rate; trails are drawn from
/// them. Points come at equal steps and at each impact, so that a bounce keeps its cusp.
struct Track {
  struct Point {
    double time = 0;
    Vec3 place = Vec3::Zero();
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
    Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();  // of the centre of mass, m/s; rad/s
    bool smooth = false;  // no impact since the point before: both have the velocities of one motion
  };
  std::vector<int> bodies;
  std::vector<std::vector<Point>> points;  // one list a body of `bodies`, times increasing
};

}  // namespace obscura::sim
