#pragma once

#include <array>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/math/expression.h"
#include "sim/math/rational.h"
#include "sim/math/vec.h"
#include "sim/shape/curve.h"
#include "sim/shape/form.h"

namespace obscura::sim {

class Workers;

enum class Integrator { rk4, midpoint, euler, semi_implicit };

/// How contact is treated. `contact` and `event` keep bodies apart by forces, see sim/model/contact.h;
/// `event` locates every impact and every change of a contact in time, `contact` a bounded number in each
/// step.
enum class Collision { handout, contact, event };

/// The solver for contact forces (sim/model/contact.h). `automatic` decides from the scene.
enum class Solver { automatic, direct, iterative, count };

/// Which law holds for impacts in one instant: solved together, or one pair after another until none
/// approaches.
enum class Impacts { simultaneous, sequential };

/// The treatment of bodies that overlap at the start: an error, or a gentle push apart.
enum class Overlap { refuse, separate };

/// The constant properties of a body. A particle is a point or a ball that does not turn; a rigid body is a
/// particle that also turns.
template <int D>
struct Body {
  std::string name;
  Shape<D> shape;
  double mass = 1;                                // kg
  AngularVec<D> inertia = AngularVec<D>::Zero();  // principal moments, kg m^2; zero: does not turn
  double elasticity = 1;                          // the handout's e, 0 <= e <= 1
  double friction = 0;                            // Coulomb's mu >= 0; of a pair, the root of the product
  std::optional<double> static_friction;          // of what does not slip, >= friction; none: the same
  double drag = 0;                                // c of f = -c v at the centre of mass, N s/m
  double ground_drag = 0;     // the same along the ground while it stands there, beside mu; N s/m
  double quadratic_drag = 0;  // c of f = -c |v| v, N s^2/m^2
  double charge = 0;          // C
  int copy = 0;               // its number among the copies of its kind
  int group = 0;              // for Model::ignore
  bool fixed = false;         // held where it starts; as heavy as the room
  bool linked = false;        // a link of a chain, which moves it
  bool handout = false;       // meets walls by the handout's law, and no bodies, whatever `collision` says
  bool driven = false;        // fixed, but moved by a Drive
  bool bare = false;          // it has no form but the rails on it
  AngularVec<D> belt =
      AngularVec<D>::Zero();  // m/s of its surface: in the plane around it, clockwise; in space in its frame

  /// Whether what touches it may be set in motion by it, though it is fixed.
  bool carries() const { return driven || belt != AngularVec<D>::Zero(); }
  bool turns() const { return inertia != AngularVec<D>::Zero(); }
};

/// An immobile half space: places q with (q - point) . normal < 0 are on the wrong side. Handout §2.3.
template <int D>
struct Wall {
  Vec<D> point = Vec<D>::Zero();
  Vec<D> normal = Vec<D>::Unit(1);          // unit, into the room
  std::optional<double> elasticity;         // none: the body's own holds
  std::optional<double> friction;           // none: the body's own holds
  std::optional<double> static_friction{};  // none: as friction
};

/// A smooth curve that is part of a body: others slide and roll on it.
template <int D>
struct Rail {
  std::string name;
  int body = -1;
  std::shared_ptr<const Curve<D>> curve;  // in the body's frame
  bool left = true, right = false;        // the sides that are touched, seen along it; in space all are
  std::optional<double> elasticity;       // none: the other body's own holds
  std::optional<double> friction;         // likewise
  std::optional<double> static_friction;  // none: as friction
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
  bool loose = false;      // it holds nothing: an event has let it go, or will join it
};

/// The kinds of joint, by the relative motions of two ends that they forbid. Numbers of rows: weld D +
/// D(D-1)/2, pin D, slider, hinge and screw one less than a weld, wire D - 1, rod and rope one. In space a
/// pin is a ball joint; in the plane a pin and a hinge are the same. Mechanisms hold more than two bodies by
/// one row: a pulley, a gear.
enum class JointKind { pin, weld, slider, rod, rope, hinge, pulley, gear, screw, wire, count };
inline constexpr int kJointKinds = int(JointKind::count);

/// Whether a table has one row for each kind of joint, in the order of JointKind.
constexpr bool in_order(const auto& table) {
  for (int i = 0; i < int(std::size(table)); ++i)
    if (table[i].kind != JointKind(i)) return false;
  return std::size(table) == std::size_t(kJointKinds);
}

/// Where the rope of a pulley meets a wheel, without slipping. Of a gear: the pitch circle.
template <int D>
struct Winding {
  // radius of the wheel, m; negative: the rope runs around it clockwise; 0: the rope is tied to a point
  double offset = 0;
  // pulley: the direction of the rope at the start; gear: where the teeth meet then, in the body's frame
  Vec<D> start = Vec<D>::Unit(0);
};

/// A joint between two bodies, or a body and the room, as it stood at the start.
template <int D>
struct Joint {
  struct Motor {
    double speed = 0;  // rad/s of a hinge, m/s of a slider: of a against b
    double most = 0;   // N m or N
    // Instead of `speed` a function of the time, the angle of a drive_formula<2>. It is the target of the
    // speed or, if `follows`, of the coordinate itself, rad or m. See sim/constraint/joints/motors.h.
    std::shared_ptr<const Program> aim = nullptr;
    bool follows = false;
  };
  /// A spring along its free coordinate c: f = -k (c - rest) - d c', N m of a hinge, N of a slider.
  struct Coil {
    double stiffness = 0, damping = 0;  // N m/rad or N/m, N m s/rad or N s/m
    double rest = 0;                    // rad or m

    double force(double c, double rate) const { return -stiffness * (c - rest) - damping * rate; }
  };

  std::string name;
  JointKind kind = JointKind::pin;
  End<D> a, b;
  Vec<D> axis = Vec<D>::Unit(0);  // slider: the way of a; hinge of space: what it turns about. Unit, in
                                  // b's frame
  AngularVec<D> turn =
      AngularVec<D>::Zero();             // weld, slider: the turn of a against b to be kept; hinge: where its
                                         // angle is zero, rad. In space a rotation vector in b's frame
  double length = 0;                     // rod: the distance; rope: the largest, m
  double lower = -1e300, upper = 1e300;  // of a hinge's angle (rad, in space within pi) or a slider's way (m)
  std::optional<Motor> motor;
  std::optional<Coil> coil;
  double friction = 0;    // dry: the largest torque (N m) of a hinge or force (N) of a slider; of a wire
                          // or the rope of a pulley Coulomb's mu
  double breaks = 1e300;  // N: a larger force on the joint breaks it
  double breaks_torque = 1e300;  // N m: so does a larger torque, about the place of a
  bool touching = false;         // whether the two bodies may touch each other
  bool later = false;            // an event makes it: until then it holds nothing
  bool linked = false;           // a chain holds it: of its own it has limits, a motor and friction

  // a pulley: the points that its rope slides over, from a to b. A gear: the ends of its second joint
  std::vector<End<D>> over;
  Winding<D> on_a, on_b;  // a pulley in the plane: wheels about its ends, which its rope runs onto
  std::vector<double>
      around;                 // a pulley with friction: as Winding::offset, of each that its rope slides over
  double wrap = 0;            // its: the angle of the rope on those that are wheels, at the start, rad
  std::vector<double> wraps;  // its: the same of each, 0 of points
  int whole_turns = 0;        // its: those of that around each
  int rope = -1;              // a pulley: its number; those of one rope have the same, and break together
  double ratio = 1;  // a gear: of the first joint's coordinate, and the second's; a screw: m a radian
  std::shared_ptr<const std::array<Joint, 2>> geared;  // and both
  bool belt = false;  // a gear: instead of teeth, around wheels of the radii on_a.offset and on_b.offset
  std::shared_ptr<const Curve<D>> curve;  // a wire: in b's frame; for the room, in the room
  bool lets_go = false;                   // a wire: at its open ends, where others stop
  // the terms of its relative angle, as bodies and factors; empty: angle of a less angle of b
  std::vector<std::pair<int, double>> turns;

  /// act(body) for each body that it holds; below zero: the room.
  template <class Act>
  void each_body(Act&& act) const {
    act(a.body), act(b.body);
    for (const End<D>& end : over) act(end.body);
  }
  /// Whether its(body) is true of any.
  template <class Its>
  bool any_body(Its&& its) const {
    bool any = false;
    each_body([&](int body) { any = any || its(body); });
    return any;
  }
  /// Its relative angle from the angles of bodies, rounds(body), whole rounds included; zero in space. Of a
  /// pulley: metres of rope.
  template <class Rounds>
  AngularVec<D> turn_between(Rounds&& rounds) const {
    if (turns.empty()) return rounds(a.body) - rounds(b.body);
    AngularVec<D> sum = AngularVec<D>::Zero();
    for (const auto& [body, factor] : turns) sum += factor * rounds(body);
    return sum;
  }
};

/// Makes two bodies one as they stand at the start, until it is loaded beyond its strength: see
/// sim/fracture/bond_load.h.
template <int D>
struct Bond {
  int a = -1, b = -1;              // bodies; b = -1: the room
  double strength = 1e300;         // N
  double impact_duration = 0.001;  // s: an impulse counts as a force of that over this
};

/// The hand of the scripted mouse: pressed at the first knot, released at the last.
template <int D>
struct Knot {
  Rational time;  // s
  Vec<D> place;
};

/// A body that is fixed until it is let go, or moved as functions of time say: it has a prescribed velocity
/// and acceleration, and infinite mass. See sim/model/drives.h.
template <int D>
struct Drive {
  int body = -1;
  std::shared_ptr<const Program> formula;        // of the time: its outputs as drive_formula() has them
  std::vector<Knot<D>> path;                     // its ways, instead of a formula's; beside its angle
  Vec<D> start = Vec<D>::Zero();                 // its centre where the formula is zero
  Vec<D> pivot = Vec<D>::Zero();                 // from there to the place that the formula moves, m
  Orientation<D> turn = Orientation<D>::Zero();  // where the angle is zero
  AngularVec<D> axis = AngularVec<D>::Ones();    // what the angle turns about; in space a unit vector
  std::optional<Rational> release;               // s: when it is let go
  bool by_event = false;                         // or by an event

  bool moves() const { return formula || !path.empty(); }
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

/// A force from a point, F = S r / (|r|^2 + eps^2)^(3/2), on each point of each body: see
/// sim/force/explosion.h.
template <int D>
struct Explosion {
  /// How the force goes with the motion: as the integrator sees it, or held through each interval as the
  /// explosion paper does.
  enum class Scheme { smooth, paper };

  Vec<D> center = Vec<D>::Zero();
  double strength = 0;                                              // S, N m^2
  Rational start = {0, 1}, duration = {1, 1}, interval = {1, 100};  // s
  double softening = 0;                                             // eps, m: 0 is singular at the centre
  Scheme scheme = Scheme::smooth;
};

/// What a force acts on, or comes from: a body, or the part of one that bonds hold; or a place.
template <int D>
struct Subject {
  int body = -1;                        // -1: a place in the room
  Vec<D> local = Vec<D>::Zero();        // in the body's frame from its centre; for the room, the place
  double turn = 0;                      // in the plane: of the part against its body, rad
  double mass = 1, charge = 0;          // kg, C
  double drag = 0, quadratic_drag = 0;  // N s/m, N s^2/m^2
  int copy = 0;
};

/// A force as formulas, made by sim/force/formula.h.
struct ForceFormula {
  Program force;   // its components, N; of those with a torque that too, N m
  Program energy;  // its potential, J; of those that have one
  bool torque = false;
  bool potential = false;
  bool timed = false;   // the time is in it
  bool resting = true;  // it may act on what does not move
  bool works = true;    // without a potential: whether it does work
  bool feeds = true;    // and may give energy, not only take it
};

/// All bodies at an instant within a step, as a force that a program computes is given them: one entry a body
/// of the model, room's frame.
template <int D>
struct ForceStage {
  double time = 0;                                            // s
  std::vector<Vec<D>> x, v;                                   // centres of mass: m, m/s
  std::vector<AngularVec<D>> w;                               // rad/s
  std::vector<Eigen::Matrix<double, D, D>> room_from_body{};  // columns: the body's axes
};

/// A force that a program computes: adds to the forces at the centres (N) and the torques about them (N m),
/// one entry a body. The same stage must always give the same answer; what it throws leaves the step.
template <int D>
using ForceFunction = std::function<void(const ForceStage<D>& stage, std::vector<Vec<D>>& forces,
                                         std::vector<AngularVec<D>>& torques)>;

/// A force on each of its subjects, or between each two of them.
template <int D>
struct Force {
  enum class On { each, among, between };  // between: the first and second, the third and fourth, ...
  /// `inverse_square`: c w1 w2 d / (d^2 + s^2)^(3/2) on the second, w its mass or charge and d the way to it.
  /// `buoyancy`: density g times what of each body lies below `level`.
  /// `function`: what a program computes for all bodies at once; its subjects are all bodies in their order.
  enum class Law { formula, gravitation, coulomb, buoyancy, function };

  std::string name;
  On on = On::each;
  Law law = Law::formula;
  std::shared_ptr<const ForceFormula> formula;
  std::shared_ptr<const ForceFunction<D>> function;
  std::vector<Subject<D>> subjects;
  std::optional<Subject<D>> center;    // of `each`: where d is measured from; a body feels the opposite
  double strength = 0, softening = 0;  // c, N m^2/kg^2 or N m^2/C^2; s, m; of an attractor -S, m^3/s^2
  double level = 0, density = 0;       // m; kg/m^2, in space kg/m^3
  bool drag = false;                   // of the air, beside that of Body::drag

  /// Whether it has a potential, which may change with the time.
  bool has_potential() const { return formula ? formula->potential : law != Law::function; }
  /// Whether its formula is that of an attractor, -S m / sqrt(d^2 + s^2): other formulas have no strength.
  bool attractor() const { return law == Law::formula && center && strength != 0; }
  /// Whether it may turn bodies about their centres.
  bool turns() const { return formula ? formula->torque : law == Law::function; }
  /// Whether it has none and does work.
  bool does_work() const { return formula ? !formula->potential && formula->works : law == Law::function; }
};

template <int D>
class Chain;

/// A tree of links in reduced coordinates, whose joints hold exactly: see sim/multibody/chains.h. A link's
/// frame is its body's.
template <int D>
struct Articulation {
  std::shared_ptr<const Chain<D>> tree;
  std::vector<int> bodies;      // one a link, each `linked`
  std::vector<int> joints;      // one a link: the joint of the model that holds it to its parent, or -1
  std::vector<double> offsets;  // one a link, in the plane: its angle where all q are zero, rad
};

/// A quantity of a body or joint, as the condition of an event reads it.
struct Reading {
  enum class Of {
    x,
    y,
    z,
    vx,
    vy,
    vz,
    speed,
    angle,
    spin,
    // lengths of sums of forces, known at the ends of steps
    contact,
    normal_force,
    friction,
    spring_force,
    joint_force,
    force,  // of a joint
    torque
  };
  int body = -1;  // or joint
  Of of = Of::x;

  bool of_forces() const { return of >= Of::contact; }
};

/// A change of the room that an event makes, for the rest of the run.
template <int D>
struct Change {
  enum class Of {
    hold,
    motor,
    gravity,
    force,
    join,
    loose,  // and other values of a spring
    stiffness,
    damping,
    rest_length,
    mass,  // and other values of a body
    charge,
    drag,
    quadratic_drag,
    rub,       // the dry friction of a joint
    belt,      // the speed of a body's surface
    velocity,  // these two at that instant alone
    spin
  };
  Of of = Of::hold;
  // of the body that is held where it is or gets another value, the joint that gets one or is made, the
  // force, or the spring
  int index = -1;
  double value = 0;                            // SI units; of `loose` whether it is
  Vec<D> velocity = Vec<D>::Zero();            // m/s
  AngularVec<D> spin = AngularVec<D>::Zero();  // rad/s, in space in the room's axes; of a belt as Body::belt
  // of a kick that is a formula: its components, SI units, of what is read and the time
  std::shared_ptr<const Program> formula;
  std::vector<Reading> reads;
  typename Joint<D>::Motor motor;
  Vec<D> gravity = Vec<D>::Zero();
  std::shared_ptr<const Force<D>> force;

  /// Whether it takes the place of another.
  bool replaces(const Change& other) const { return of == other.of && index == other.index; }
};

/// A condition, and what is done when it becomes true: see sim/step/events.h.
template <int D>
struct When {
  enum class On { touches, leaves, crosses, value, time, breaks };
  struct Action {
    enum class Do { mark, let_go, part, change, stop };
    Do what = Do::mark;
    std::string mark;
    std::vector<int> of;   // drives that are let go, joints that are parted, or changes of the model
    bool of_pair = false;  // only that of the pair that came to touch, in the order of `pairs`
  };

  std::string name;
  On on = On::time;
  std::vector<std::pair<int, int>> pairs;  // of touches and leaves: two bodies, the first below the second,
                                           // or a body and a wall as -1 - wall
  std::vector<int> those;                  // of crosses bodies, of breaks joints; a bond as -1 - bond
  // of crosses: two ends of a segment; in space opposite corners of a rectangle along two axes of the room
  Vec<D> from = Vec<D>::Zero(), to = Vec<D>::Zero();
  // of value: whether it is true, and margins that change their sign where it may become so
  std::shared_ptr<const Program> value;
  std::vector<Reading> reads;  // its slots; after them the time
  Rational time{0, 1};         // s
  bool again = false;          // fires each time
  std::vector<Action> actions;

  /// For how many things its truth is known apart.
  int things() const {
    return on == On::touches || on == On::leaves ? int(pairs.size()) : those.empty() ? 1 : int(those.size());
  }
  /// Whether it reads forces.
  bool of_forces() const {
    for (const Reading& it : reads)
      if (it.of_forces()) return true;
    return false;
  }
  /// Whether it only notes when it fires.
  bool only_marks() const {
    for (const Action& action : actions)
      if (action.what != Action::Do::mark) return false;
    return true;
  }
};

/// All that is constant in a run. Order of the bodies: first those that do not turn, then those that do; a
/// body's index here is its index everywhere.
template <int D>
struct Model {
  // each compiled once, in model.cpp
  Model();
  Model(const Model&);
  Model(Model&&) noexcept;
  Model& operator=(const Model&);
  Model& operator=(Model&&) noexcept;
  ~Model();

  Rational rate = {600, 1};  // steps per second
  Integrator integrator = Integrator::rk4;
  Collision collision = Collision::handout;
  Solver solver = Solver::automatic;
  Impacts impacts = Impacts::simultaneous;
  Overlap overlap = Overlap::refuse;
  Vec<D> gravity = Vec<D>::Unit(1) * -9.81;  // m/s^2
  double scale = 1;                          // the room's height, m: what "far" and "fast" are measured by
  std::vector<Body<D>> bodies;
  std::vector<Wall<D>> walls;
  std::vector<Rail<D>> rails;
  std::vector<Spring<D>> springs;
  std::vector<Mouse<D>> mice;
  std::vector<Joint<D>> joints;
  std::vector<Explosion<D>> explosions;
  std::vector<Force<D>> forces;
  std::vector<Drive<D>> drives;  // of bodies in ascending order
  std::vector<Bond<D>> bonds;
  std::vector<Articulation<D>> chains;      // none where there are bonds
  std::vector<std::pair<int, int>> ignore;  // groups that do not touch each other
  std::vector<When<D>> whens;               // in the order of the file
  std::vector<Change<D>> changes;           // that they make
  bool changed = false;                     // whether events may change what this model is
  // threads that share its steps; none: the caller's alone. No bit hangs on them
  std::shared_ptr<Workers> workers = nullptr;

  /// Whether the books have a place for work: of forces and drag, of bodies that are moved, of motors.
  bool books_work() const {
    bool any = !forces.empty() || !drives.empty() || changed;
    for (const Body<D>& body : bodies) any = any || body.carries() || body.drag != 0 || body.ground_drag != 0;
    for (const Joint<D>& joint : joints) any = any || joint.motor;
    return any;
  }

  int particles() const {  // bodies that do not turn
    int n = 0;
    while (n < int(bodies.size()) && !bodies[n].turns()) ++n;
    return n;
  }
};

}  // namespace obscura::sim
