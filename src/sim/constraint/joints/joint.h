#pragma once

// Joints: the relative motions of two bodies, of a mechanism of several, that they forbid, C(q) = 0 row by
// row, and those that they leave free. To add one: a file beside pin.h, a name in JointKind, and a row in
// each of three tables, without which it does not compile: joint.cpp here, its word in scene/joint_words.h,
// its look in draw/picture/joint_look.h. All solvers, limits, motors, dry friction, breaking, messages and
// the page of keys work from these:
//   limit     lower <= c <= upper              a row along the free coordinate c, of one sign
//   motor     c' = speed, |f| <= most          the same row, bounded both ways
//   friction  c' = 0, |f| <= friction          likewise
//   breaks    |sum of f_i s_i| > breaks        s_i  linear part of row i: the force of its rows, N
//             |sum of f_i t_i| > breaks_torque t_i  its torque on a about the place of a, N m

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "sim/constraint/row.h"
#include "sim/math/spatial.h"
#include "sim/model/state.h"

namespace obscura::sim {

/// How a joint is turned, as far as poses do not tell.
template <int D>
struct JointTurn {
  AngularVec<D> between = AngularVec<D>::Zero();  // Joint::turn_between(). Of a wire see wire.h
  Wound wound;                                    // of a pulley, as State::wound

  template <class Turn>
  JointTurn(const Eigen::MatrixBase<Turn>& turn, const Wound& of = {}) : between(turn), wound(of) {}
};

/// A joint with the poses and velocities of its two sides. A side that is the room stands still.
template <int D>
struct JointPose {
  const Joint<D>& joint;
  const BodyMotion<D>&a, &b;
  const AngularVec<D>& turn;                // of a against b, rad; in space the poses tell it. Of a wire see
                                            // wire.h
  std::span<const BodyMotion<D>> all = {};  // of all bodies, by number: of a mechanism, which holds more
  Wound wound = {};                         // a pulley: near which angles its rope is on its wheels

  /// Any of its bodies; below zero: the room.
  const BodyMotion<D>& side(int body) const {
    static const BodyMotion<D> room;
    return body < 0 ? room : all[std::size_t(body)];
  }

  Vec<D> arm_a() const { return a.arm(joint.a.local); }
  Vec<D> arm_b() const { return b.arm(joint.b.local); }
};

/// A kind of joint as the solvers see it.
template <int D>
struct JointEquations {
  JointKind kind = JointKind::pin;
  int rows = 0;            // equations, at most kMostHeld<D>
  bool one_sided = false;  // C >= 0 (m) instead of C = 0
  bool apart = false;      // its ends are a length apart; else they start at one place
  bool axis = false;       // it has an axis, fixed in b
  bool turning = false;    // both of its bodies must be able to turn
  bool mechanism = false;  // it may hold more than two bodies; its row has them in Row::more
  bool angle = false;      // its free coordinate is an angle (rad); else a distance (m)
  /// Writes J and C (m or rad), one a row.
  void (*hold)(const JointPose<D>& at, Row<D>* J, double* C) = nullptr;
  /// Writes J of the free coordinate and returns its value, m or rad. Null: the joint has none that it can
  /// tell.
  double (*coordinate)(const JointPose<D>& at, Row<D>& J) = nullptr;
};

/// The row of the table.
template <int D>
const JointEquations<D>& equations(JointKind kind);

/// The most rows that a joint holds.
template <int D>
inline constexpr int kMostHeld = D + kAngular<D>;

/// Whether a model has wires.
template <int D>
bool has_wires(const Model<D>& model) {
  return std::any_of(model.joints.begin(), model.joints.end(),
                     [](const Joint<D>& joint) { return joint.kind == JointKind::wire; });
}

/// Writes the rows that a joint constrains and their errors C (m or rad). Returns their number. `turn`: the
/// angle of a relative to b (rad), for joints that constrain it; in space the poses give it. `all`: pose and
/// velocity of every body, by number, for mechanisms that hold more bodies than a and b.
template <int D>
int rows(const Joint<D>& joint, const BodyMotion<D>& a, const BodyMotion<D>& b,
         const std::type_identity_t<JointTurn<D>>& turn, Row<D>* out, double* off,
         std::type_identity_t<std::span<const BodyMotion<D>>> all = {});

/// Its relative angle in a state, Joint::turn_between().
template <int D>
AngularVec<D> turn_between(const Joint<D>& joint, const State<D>& state);
/// The same of one of the model, by its number, with the pieces of its rope that are one with it.
template <int D>
AngularVec<D> turn_between(const Joint<D>& joint, std::size_t number, const State<D>& state);

/// rows() of a joint, by its number, of the model of a state. `at`: pose and velocity of every body, or of
/// its bodies, by number.
template <int D>
int rows(const Joint<D>& joint, std::size_t number, const State<D>& state,
         std::type_identity_t<std::span<const BodyMotion<D>>> at, Row<D>* out, double* off);

/// Whether a joint is a rope on wheels, or with friction.
template <int D>
bool winds(const Joint<D>& joint) {
  return joint.kind == JointKind::pulley &&
         (joint.on_a.offset != 0 || joint.on_b.offset != 0 || !joint.around.empty());
}
template <int D>
bool has_wound_ropes(const Model<D>& model) {
  return std::any_of(model.joints.begin(), model.joints.end(), winds<D>);
}

/// Whether it has ropes that run over something.
template <int D>
bool has_pulleys(const Model<D>& model) {
  return std::any_of(model.joints.begin(), model.joints.end(),
                     [](const Joint<D>& joint) { return joint.kind == JointKind::pulley; });
}

/// Whether it has ropes with friction.
template <int D>
bool has_rubbing_ropes(const Model<D>& model) {
  return std::any_of(model.joints.begin(), model.joints.end(),
                     [](const Joint<D>& joint) { return !joint.around.empty(); });
}

/// Where the rope of a joint is on its wheels.
template <int D>
Wound wound(const State<D>& state, std::size_t joint) {
  return joint < state.wound.size() ? state.wound[joint] : Wound{};
}

/// Whether a joint holds nothing, as its piece of a rope is one with one before it.
template <int D>
bool one_with_another(const State<D>& state, std::size_t joint) {
  return wound(state, joint).with < 0;
}

// Of a joint that is an element of Model::joints, with the pieces of its rope that are one with it, which
// follow it there.

/// act(body) for each body that it holds.
template <int D, class Act>
void each_body_held(const Joint<D>& joint, const Wound& rope, Act&& act) {
  for (int k = 0; k <= std::max(0, rope.with); ++k) (&joint)[k].each_body(act);
}
template <int D, class Act>
void each_body_held(const Model<D>& model, const State<D>& state, std::size_t joint, Act&& act) {
  each_body_held(model.joints[joint], wound(state, joint), act);
}

/// Joint::turn_between() of all.
template <int D, class Rounds>
AngularVec<D> turn_between(const Joint<D>& joint, const Wound& rope, Rounds&& rounds) {
  AngularVec<D> sum = joint.turn_between(rounds);
  for (int k = 1; k <= rope.with; ++k) sum += (&joint)[k].turn_between(rounds);
  return sum;
}

/// How long its rope is, m.
template <int D>
double length_held(const Joint<D>& joint, const Wound& rope) {
  double sum = joint.length;
  for (int k = 1; k <= rope.with; ++k) sum += (&joint)[k].length;
  return sum;
}

/// A joint whose rope cannot go on, and whether that is as it comes to the other side of a wheel that it has
/// left.
struct EndOfRope {
  int joint = 0;
  bool beyond = false;
};

/// Follows State::wound to where ropes are now, at the end of a step: from where they were by less than half
/// a round; they leave wheels that they are straight at, and come back to them. Returns the first joint whose
/// rope cannot go on: it will have no straight piece left within the next step, as its end comes to the rim
/// of a wheel, or is tight and comes to a point that it runs over; or its end was on a rim since its bodies
/// stood as in `begun`, by number, `done` s ago; or it is tight and comes to the other side of a wheel that
/// it has left.
template <int D>
std::optional<EndOfRope> follow_ropes(const Model<D>& model, State<D>& state,
                                      std::type_identity_t<std::span<const BodyMotion<D>>> begun = {},
                                      double done = 0);

/// The same of wheels alone, before any step: ropes that stand past a wheel have left it.
template <int D>
void leave_wheels(const Model<D>& model, State<D>& state);

/// When the first rope will leave a wheel, or come back to one, if its bodies go straight on: s from now,
/// within `most`. None where that is so soon that follow_ropes() has it do so already.
template <int D>
std::optional<double> wheel_time(const Model<D>& model, const State<D>& state, double most);

/// What breaks with what is broken: all pulleys of one rope, and a gear with either of its joints.
template <int D>
void break_dependents(const Model<D>& model, std::vector<char>& broken) {
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const int rope = model.joints[i].rope;
    if (rope < 0 || !broken[i]) continue;
    for (std::size_t j = 0; j < model.joints.size(); ++j)
      if (model.joints[j].rope == rope) broken[j] = 1;
  }
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    if (!model.joints[i].geared || broken[i]) continue;
    for (const Joint<D>& held : *model.joints[i].geared)
      for (std::size_t j = 0; j < model.joints.size(); ++j)
        if (broken[j] && model.joints[j].name == held.name) broken[i] = 1;
  }
}

/// How the ends of a joint stand: an end on b where the one on a is, unless a length is between them, and
/// the turn of a against b. Of a mechanism what makes its C zero: a pulley's length, a gear's turn, in space
/// its Joint::lower as `length`. `number`: that of the joint, for State::wound.
template <int D>
Made<D> as_it_stands(const Joint<D>& joint, const State<D>& state, std::size_t number);

/// The joint that an event has made so: from now on it holds.
template <int D>
void join_as(Joint<D>& joint, const Made<D>& so);

/// Whether a model has joints that events make.
template <int D>
bool has_later_joints(const Model<D>& model) {
  return std::any_of(model.joints.begin(), model.joints.end(),
                     [](const Joint<D>& joint) { return joint.later; });
}

/// Whether a joint holds C >= 0 only: a rope, with what it has left.
template <int D>
bool one_sided(const Joint<D>& joint) {
  return equations<D>(joint.kind).one_sided;
}

/// Whether a joint leaves one coordinate free that it can tell: the angle of a hinge (in the plane also
/// called a pin), the way of a slider.
template <int D>
bool has_free_row(const Joint<D>& joint) {
  return equations<D>(joint.kind).coordinate != nullptr;
}

/// The row of that, for motors, limits and friction; and its value (rad or m). False where there is none.
template <int D>
bool free_row(const Joint<D>& joint, const BodyMotion<D>& a, const BodyMotion<D>& b,
              const std::type_identity_t<JointTurn<D>>& turn, Row<D>& out, double& way);

/// What a row of a joint puts on its a for a unit of its force: the force that is shown (N), and the torque
/// about the place of that end (N m).
template <int D>
Wrench<D> load_on_a(const Joint<D>& joint, const Row<D>& row, const BodyMotion<D>& a, const BodyMotion<D>& b);

/// What the spring of a joint puts on its a, as load_on_a(); nothing where there is none.
template <int D>
Wrench<D> coil_load(const Joint<D>& joint, const BodyMotion<D>& a, const BodyMotion<D>& b,
                    const std::type_identity_t<JointTurn<D>>& turn);

/// Whether it bears no such load: it breaks.
template <int D>
bool overloaded(const Joint<D>& joint, const Wrench<D>& load) {
  return std::sqrt(load.f.squaredNorm()) > joint.breaks ||
         std::sqrt(load.n.squaredNorm()) > joint.breaks_torque;
}

}  // namespace obscura::sim
