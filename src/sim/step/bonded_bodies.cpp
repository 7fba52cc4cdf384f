// Bonded parts form a rigid body of mass M, centre c, tensor I,
//   M = sum m_i,   c = sum m_i x_i / M,   I = sum R_i I_i R_i' + m_i (|d_i|^2 - d_i d_i'),   d_i = x_i - c
//   v = sum m_i v_i / M,   w = I^-1 sum (R_i I_i R_i' w_i + m_i d_i x v_i)
// and a piece that comes off it, with the centre c', has
//   v' = v + w x (c' - c),   w' = w

#include "sim/step/bonded_bodies.h"

#include <algorithm>
#include <cmath>

#include "sim/math/islands.h"
#include "sim/math/spatial.h"
#include "sim/step/archive.h"
#include "sim/step/stepper.h"

namespace obscura::sim {

namespace {

constexpr double kLeastMoment = 1e-6;  // of the largest

// for each part, the lowest part that bonds connect it with
template <int D>
std::vector<int> roots(const Model<D>& model, const std::vector<char>& holds) {
  Islands held;
  held.reset(int(model.bodies.size()));
  for (std::size_t k = 0; k < model.bonds.size(); ++k) {
    if (holds[k] && model.bonds[k].b >= 0) held.join(model.bonds[k].a, model.bonds[k].b);
  }
  std::vector<int> root(model.bodies.size());
  for (int i = 0; i < int(root.size()); ++i) root[i] = held.root(i);
  return root;
}

// several parts as one, in the frame that their places are told in
template <int D>
struct Solid {
  double mass = 0;
  Vec<D> center = Vec<D>::Zero();
  Orientation<D> axes = no_rotation<D>();
  AngularVec<D> inertia = AngularVec<D>::Zero();
};

// parts that do not turn in the paper's linear motion make a body that does not turn
template <int D>
bool may_turn(const Model<D>& model, const std::vector<int>& parts) {
  bool extended = false;
  for (const int i : parts) {
    if (model.bodies[i].turns()) return true;
    extended = extended || !round_radius(model.bodies[i].shape);
  }
  return !extended;
}

template <int D>
Solid<D> solid(const Model<D>& model, const std::vector<int>& parts, const std::vector<PartPose<D>>& places) {
  Solid<D> out;
  if (parts.size() == 1) {
    const Body<D>& body = model.bodies[parts[0]];
    return {body.mass, places[parts[0]].x, places[parts[0]].turn, body.inertia};
  }
  for (const int i : parts) {
    out.mass += model.bodies[i].mass;
    out.center += model.bodies[i].mass * places[i].x;
  }
  out.center /= out.mass;
  if (!may_turn(model, parts)) return out;
  SpinTensor<D> tensor = SpinTensor<D>::Zero();
  for (const int i : parts) {
    const Body<D>& body = model.bodies[i];
    const Eigen::Matrix<double, D, kAngular<D>> k = lever<D>(places[i].x - out.center);
    tensor += body.mass * (k.transpose() * k);
    if constexpr (D == 2) {
      tensor += body.inertia;
    } else {
      const Rotation<D> turn = rotation<D>(places[i].turn);
      tensor += turn * body.inertia.asDiagonal() * turn.transpose();
    }
  }
  if constexpr (D == 3) out.axes = principal_axes(tensor);
  out.inertia = tensor.diagonal();
  // particles in a row turn about their row as lightly as numbers allow
  out.inertia = out.inertia.cwiseMax(kLeastMoment * out.inertia.maxCoeff());
  return out;
}

// a place in the frame of a bonded body
template <int D>
PartPose<D> seen(const Solid<D>& from, const PartPose<D>& place) {
  return {rotation<D>(from.axes).transpose() * (place.x - from.center),
          composed<D>(inverse<D>(from.axes), place.turn)};
}

// a shape where its part sits, as parts of a compound
template <int D>
void add_seated(const Shape<D>& shape, const PartPose<D>& pose, std::vector<Shape<D>>& parts) {
  const Rotation<D> turn = rotation<D>(pose.turn);
  const auto placing = [&](const Vec<D>& x) { return Vec<D>(pose.x + turn * x); };
  for (int i = 0; i < sim::parts(shape); ++i) {
    const Shape<D>& own = part(shape, i);
    if constexpr (D == 2) {
      // in the plane a box that is a part stands upright: this one is a polygon, even where it is not turned
      if (const Box<2>* box = form<Box<2>>(own)) {
        parts.push_back(moved<2>(box->outline(), placing, pose.turn));
        continue;
      }
    }
    parts.push_back(moved<D>(own, placing, pose.turn));
  }
}

}  // namespace

template <int D>
BondedBodies<D>::BondedBodies(const Model<D>& model, const std::vector<Path<D>>& paths)
    : model_(model), loads_(model, paths) {}

template <int D>
BondedBodies<D>::~BondedBodies() = default;

// the rigid bodies that the bonds of a state make, and their stepper
template <int D>
void BondedBodies<D>::gather(const State<D>& state) {
  if (stepper_ && known_ == state.intact) return;
  known_ = state.intact;
  stepper_.reset();
  const int n = int(model_.bodies.size());
  const std::vector<int> root = roots(model_, state.intact);

  whole_ = {};
  Model<D>& made = whole_.model;
  made = model_;
  made.bodies.clear(), made.joints.clear(), made.bonds.clear();
  whole_.body.assign(n, -1), whole_.alone.assign(n, 0);
  parts_.clear();
  // those that do not turn first, each kind in the order of their lowest parts
  for (const bool turning : {false, true}) {
    for (int first = 0; first < n; ++first) {
      if (root[first] != first) continue;
      std::vector<int> parts;
      for (int i = first; i < n; ++i) {
        if (root[i] == first) parts.push_back(i);
      }
      Body<D> body = model_.bodies[first];
      if (parts.size() > 1) {
        const Solid<D> one = solid(model_, parts, state.part_poses);
        body.mass = one.mass, body.inertia = one.inertia;
        Compound<D> whole;
        body.elasticity = body.friction = body.drag = body.ground_drag = 0;
        bool stick = false;
        double at_rest = 0;
        for (const int i : parts) {
          const Body<D>& part = model_.bodies[i];
          add_seated(part.shape, state.part_poses[i], whole.parts);
          // surfaces by mass
          body.elasticity += part.elasticity * part.mass / one.mass;
          body.friction += part.friction * part.mass / one.mass;
          at_rest += part.static_friction.value_or(part.friction) * part.mass / one.mass;
          stick = stick || part.static_friction;
          body.drag += part.drag, body.ground_drag += part.ground_drag;
          body.fixed = body.fixed || part.fixed, body.handout = body.handout || part.handout;
        }
        if (stick) body.static_friction = at_rest;
        body.shape = std::move(whole);
      }
      if (body.turns() != turning) continue;
      whole_.alone[first] = parts.size() == 1;
      for (const int i : parts) whole_.body[i] = int(made.bodies.size());
      made.bodies.push_back(body);
      parts_.push_back(parts);
    }
  }
  for (std::size_t k = 0; k < model_.bonds.size(); ++k) {
    if (state.intact[k] && model_.bonds[k].b < 0) made.bodies[whole_.body[model_.bonds[k].a]].fixed = true;
  }

  // ends on parts become ends on the bodies that the parts belong to
  const auto moved = [&](End<D>& end) {
    if (end.body < 0) return;
    const PartPose<D>& pose = state.part_poses[end.body];
    if (!whole_.alone[end.body]) end.local = pose.x + rotation<D>(pose.turn) * end.local;
    end.body = whole_.body[end.body];
  };
  for (Spring<D>& spring : made.springs) moved(spring.a), moved(spring.b);
  for (Force<D>& force : made.forces) {
    if (force.law == Force<D>::Law::buoyancy) {
      force.subjects.clear();
      for (int i = 0; i < int(made.bodies.size()); ++i) {
        if (!made.bodies[i].fixed) force.subjects.push_back({.body = i, .mass = made.bodies[i].mass});
      }
      continue;
    }
    const auto move = [&](Subject<D>& subject) {
      if (subject.body < 0) return;
      const PartPose<D>& seat = state.part_poses[subject.body];
      if (!whole_.alone[subject.body]) {
        subject.local = seat.x;
        if (D == 2) subject.turn = seat.turn[0];
      }
      subject.body = whole_.body[subject.body];
    };
    for (Subject<D>& subject : force.subjects) move(subject);
    if (force.center) move(*force.center);
  }
  whole_.kept.assign(model_.joints.size(), -1);
  for (std::size_t k = 0; k < model_.joints.size(); ++k) {
    Joint<D> joint = model_.joints[k];
    const int a = joint.a.body, b = joint.b.body;
    if (a >= 0 && b >= 0 && whole_.body[a] == whole_.body[b]) continue;
    const Orientation<D> on_a = a < 0 || whole_.alone[a] ? no_rotation<D>() : state.part_poses[a].turn;
    const Orientation<D> on_b = b < 0 || whole_.alone[b] ? no_rotation<D>() : state.part_poses[b].turn;
    joint.axis = rotation<D>(on_b) * joint.axis;
    if constexpr (D == 2) {
      joint.turn += on_b - on_a;
    } else {
      joint.turn = logarithm(product(product(on_b, exponential(joint.turn)), inverse<D>(on_a)));
    }
    moved(joint.a), moved(joint.b);
    whole_.kept[k] = int(made.joints.size());
    whole_.joints.push_back(int(k));
    made.joints.push_back(joint);
  }
  stepper_ = std::make_unique<Stepper<D>>(made);
}

template <int D>
void BondedBodies<D>::begin(State<D>& state) {
  const int n = int(model_.bodies.size());
  if (state.bonded.empty()) {
    state.intact.assign(model_.bonds.size(), 1);
    // poses in the room; then in the bonded body
    state.part_poses.resize(n);
    for (int i = 0; i < n; ++i) {
      const int k = turning(state, i);
      state.part_poses[i] = {state.x[i], k < 0 ? no_rotation<D>() : state.turn[k]};
    }
    const std::vector<PartPose<D>> places = state.part_poses;
    const std::vector<int> root = roots(model_, state.intact);
    std::vector<Solid<D>> solids(n);
    std::vector<std::vector<int>> parts(n);
    for (int i = 0; i < n; ++i) parts[root[i]].push_back(i);
    for (int first = 0; first < n; ++first) {
      if (parts[first].empty()) continue;
      solids[first] = solid(model_, parts[first], places);
      for (const int i : parts[first])
        state.part_poses[i] = parts[first].size() == 1 ? PartPose<D>{} : seen(solids[first], places[i]);
    }
    known_.clear(), stepper_.reset();
    gather(state);

    State<D> made;
    made.step = state.step;
    for (const std::vector<int>& members : parts_) {
      const Solid<D>& one = solids[root[members[0]]];
      const Body<D>& body = whole_.model.bodies[made.x.size()];
      Vec<D> p = Vec<D>::Zero();
      AngularVec<D> L = AngularVec<D>::Zero();
      for (const int i : members) {
        const Body<D>& part = model_.bodies[i];
        p += part.mass * state.v[i];
        L += part.mass * moment<D>(places[i].x - one.center, state.v[i]);
        if (const int k = turning(state, i); k >= 0) {
          const Rotation<D> axes = rotation<D>(state.turn[k]);
          L += to_room<D>(axes, part.inertia.cwiseProduct(from_room<D>(axes, state.spin[k])));
        }
      }
      const bool alone = members.size() == 1;
      made.x.push_back(one.center);
      made.v.push_back(alone ? state.v[members[0]] : Vec<D>(p / one.mass));
      if (!body.turns()) continue;
      made.turn.push_back(one.axes);
      made.spin.push_back(alone ? state.spin[turning(state, members[0])]
                                : inverse_inertia_times<D>(one.inertia, rotation<D>(one.axes), L));
    }
    state.bonded = {made};
  } else {
    gather(state);
  }
  stepper_->begin(state.bonded[0]);
  tell(state);
}

// the part of body `body` that a place in the room belongs to
template <int D>
int BondedBodies<D>::part_at(int body, const Vec<D>& point, const State<D>& state) const {
  if (parts_[body].size() == 1) return parts_[body][0];
  int nearest = parts_[body][0];
  double least = 1e300;
  for (const int i : parts_[body]) {
    BodyMotion<D> at = body_motion(state, i);
    const double far = of_form(model_.bodies[i].shape, [&](const auto& form) {
      return form.outside(at.room_from_body.transpose() * (point - at.x));
    });
    if (far < least) least = far, nearest = i;
  }
  return nearest;
}

// the parts as the state of the whole has them
template <int D>
void BondedBodies<D>::tell(State<D>& state) const {
  const State<D>& whole = state.bonded[0];
  state.step = whole.step, state.beyond = whole.beyond, state.ledger = whole.ledger,
  state.limits_met = whole.limits_met, state.energy_budget = whole.energy_budget;
  for (int i = 0; i < int(whole_.body.size()); ++i) {
    const int body = whole_.body[i], k = turning(state, i), kw = turning(whole, body);
    if (whole_.alone[i]) {
      state.x[i] = whole.x[body], state.v[i] = whole.v[body];
      if (k >= 0) state.turn[k] = whole.turn[kw], state.spin[k] = whole.spin[kw];
      continue;
    }
    const BodyMotion<D> at = body_motion(whole, body);
    const Vec<D> arm = at.arm(state.part_poses[i].x);
    state.x[i] = at.x + arm, state.v[i] = at.velocity(arm);
    if (k < 0) continue;
    state.turn[k] = kw < 0 ? state.part_poses[i].turn : composed<D>(whole.turn[kw], state.part_poses[i].turn);
    state.spin[k] = at.w;
  }
  state.frozen.clear(), state.quiet.clear();
  if (!whole.frozen.empty()) {
    for (const int body : whole_.body) {
      state.frozen.push_back(whole.frozen[body]), state.quiet.push_back(whole.quiet[body]);
    }
  }
  state.grips = whole.grips;
  for (Grip<D>& grip : state.grips) {
    if (grip.body < 0) continue;
    const BodyMotion<D> at = body_motion(whole, grip.body);
    const Vec<D> point = at.x + at.arm(grip.local);
    const int part = part_at(grip.body, point, state);
    if (!whole_.alone[part]) {
      const BodyMotion<D> own = body_motion(state, part);
      grip.local = own.room_from_body.transpose() * (point - own.x);
    }
    grip.body = part;
  }
  state.touches = whole.touches;
  for (Touch<D>& touch : state.touches) touch.body = part_at(touch.body, touch.point, state);
  state.contacts = whole.contacts;
  for (Contact<D>& contact : state.contacts) {
    contact.key.a = part_at(contact.key.a, contact.point, state);
    if (contact.key.b < 0) continue;
    contact.key.b = part_at(contact.key.b, contact.point, state);
    if (contact.key.a < contact.key.b) continue;
    std::swap(contact.key.a, contact.key.b);
    contact.normal *= -1, contact.force *= -1, contact.impulse *= -1;
  }
  state.broken.assign(model_.joints.size(), 0);
  state.joint_forces.assign(model_.joints.size(), Vec<D>::Zero());
  state.joint_torques.assign(model_.joints.size(), AngularVec<D>::Zero());
  for (std::size_t k = 0; k < whole_.joints.size() && k < whole.broken.size(); ++k) {
    state.broken[whole_.joints[k]] = whole.broken[k];
    state.joint_forces[whole_.joints[k]] = whole.joint_forces[k];
    state.joint_torques[whole_.joints[k]] = whole.joint_torques[k];
  }
  state.work = whole.work;
  state.blasts.resize(whole.blasts.size());
  for (std::size_t k = 0; k < whole.blasts.size(); ++k) state.blasts[k].on = whole.blasts[k].on;
}

template <int D>
bool BondedBodies<D>::fits(const State<D>& state) {
  gather(state);
  // at the same step: it would be stepped until it were
  return state.bonded[0].step == state.step && stepper_->fits(state.bonded[0]);
}

template <int D>
std::optional<Trouble> BondedBodies<D>::step(State<D>& state) {
  gather(state);
  std::vector<AngularVec<D>> spins;
  for (int i = 0; i < int(whole_.model.bodies.size()); ++i)
    spins.push_back(body_motion(state.bonded[0], i).w);
  auto trouble = stepper_->step(state.bonded[0]);
  tell(state);
  if (trouble) return trouble;
  const double t = time({state.step, 0}, model_.rate), h = 1 / value(model_.rate);
  if (loads_.snap(state, whole_.model, whole_.body, spins, t, h)) split(state);
  return {};
}

template <int D>
std::optional<Trouble> BondedBodies<D>::partial_step(State<D>& state, double fraction) {
  gather(state);
  auto trouble = stepper_->partial_step(state.bonded[0], fraction);
  tell(state);
  return trouble;
}

// bodies anew, after bonds have broken
template <int D>
void BondedBodies<D>::split(State<D>& state) {
  const State<D> before = std::move(state.bonded[0]);
  const std::vector<int> body_before = whole_.body, kept_before = whole_.kept;
  const std::vector<std::vector<int>> parts_before = parts_;
  const std::vector<PartPose<D>> poses = state.part_poses;
  const std::vector<Grip<D>> grips = state.grips;

  // seats in what stays together
  const int n = int(model_.bodies.size());
  const std::vector<int> root = roots(model_, state.intact);
  std::vector<std::vector<int>> parts(n);
  std::vector<Solid<D>> solids(n);
  for (int i = 0; i < n; ++i) parts[root[i]].push_back(i);
  for (int first = 0; first < n; ++first) {
    if (parts[first].empty() || parts[first] == parts_before[body_before[first]]) continue;
    solids[first] = solid(model_, parts[first], poses);
    for (const int i : parts[first])
      state.part_poses[i] = parts[first].size() == 1 ? PartPose<D>{} : seen(solids[first], poses[i]);
  }
  gather(state);

  State<D> made;
  made.step = before.step, made.ledger = before.ledger, made.work = before.work,
  made.limits_met = before.limits_met;
  std::vector<int> same(parts_before.size(), -1);  // where bodies went that are what they were
  for (int body = 0; body < int(parts_.size()); ++body) {
    const int first = parts_[body][0], old = body_before[first], k = turning(before, old);
    if (parts_[body] == parts_before[old]) {
      same[old] = body;
      made.x.push_back(before.x[old]), made.v.push_back(before.v[old]);
      if (k < 0) continue;
      made.turn.push_back(before.turn[k]), made.spin.push_back(before.spin[k]);
      made.body_spin.push_back(before.body_spin.empty() ? BodySpin<D>{} : before.body_spin[k]);
      continue;
    }
    const BodyMotion<D> at = body_motion(before, old);
    const Vec<D> arm = at.arm(solids[first].center);
    made.x.push_back(at.x + arm), made.v.push_back(at.velocity(arm));
    if (!whole_.model.bodies[body].turns()) continue;
    const Orientation<D> turn = k < 0 ? solids[first].axes : composed<D>(before.turn[k], solids[first].axes);
    made.turn.push_back(D == 2 ? turn : Orientation<D>(turn / std::sqrt(turn.squaredNorm())));
    made.spin.push_back(at.w), made.body_spin.push_back({});
  }
  if (D == 2) made.body_spin.clear();

  // hands keep their grips; contacts of unchanged bodies stay
  for (const Grip<D>& grip : grips) {
    Grip<D> now = grip;
    if (grip.body >= 0) {
      now.body = whole_.body[grip.body];
      const PartPose<D>& pose = state.part_poses[grip.body];
      if (!whole_.alone[grip.body]) now.local = pose.x + rotation<D>(pose.turn) * grip.local;
    }
    made.grips.push_back(now);
  }
  for (Contact<D> contact : before.contacts) {
    contact.key.a = same[contact.key.a];
    if (contact.key.b >= 0 && same[contact.key.b] < 0) continue;
    if (contact.key.a < 0) continue;
    if (contact.key.b >= 0) contact.key.b = same[contact.key.b];
    made.contacts.push_back(contact);
  }
  std::sort(made.contacts.begin(), made.contacts.end(),
            [](const Contact<D>& a, const Contact<D>& b) { return a.key < b.key; });
  for (const int joint : whole_.joints) {
    const int old = kept_before[joint];
    made.broken.push_back(old < 0 || before.broken.empty() ? 0 : before.broken[old]);
    made.joint_forces.push_back(old < 0 || before.joint_forces.empty() ? Vec<D>(Vec<D>::Zero())
                                                                       : before.joint_forces[old]);
    made.joint_torques.push_back(old < 0 || before.joint_torques.empty()
                                     ? AngularVec<D>(AngularVec<D>::Zero())
                                     : before.joint_torques[old]);
  }
  state.bonded = {made};
  // explosions push the pieces; nothing is at rest any more
  const Blasts<D> blasts(whole_.model);
  state.bonded[0].blasts.resize(before.blasts.size());
  for (std::size_t k = 0; k < before.blasts.size(); ++k) {
    if (before.blasts[k].on) blasts.begin(state.bonded[0], int(k));
  }
  stepper_->begin(state.bonded[0]);
  const std::vector<Touch<D>> touches = std::move(state.touches);
  const std::vector<Contact<D>> contacts = std::move(state.contacts);
  tell(state);
  state.touches = touches;
  if (!contacts.empty() && state.contacts.empty()) state.contacts = contacts;
}

template class BondedBodies<2>;
template class BondedBodies<3>;

}  // namespace obscura::sim
