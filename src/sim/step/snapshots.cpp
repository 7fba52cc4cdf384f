#include "sim/step/snapshots.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "sim/collide/rails.h"
#include "sim/constraint/joints/joint.h"
#include "sim/constraint/joints/pulley.h"
#include "sim/constraint/material.h"
#include "sim/energy/energy.h"
#include "sim/force/explosion.h"
#include "sim/force/forces.h"
#include "sim/force/spring.h"
#include "sim/math/limits.h"
#include "sim/model/body_motion.h"
#include "sim/shape/shape.h"

namespace obscura::sim {

namespace {

constexpr double kPathRate = 60;  // places a second of a mouse's way
constexpr int kPathMost = 600;

constexpr double kFineCurve = 1e-5;  // of a track: how far its line may be from it

// of a spin, a torque: in the plane (0, 0, w)
template <int D>
Vec3 turning_3d(const AngularVec<D>& w) {
  if constexpr (D == 2) {
    return {0, 0, w[0]};
  } else {
    return w;
  }
}

// one form if that stands as its body does, else several
template <int D>
SceneInfo::Body shown(const Body<D>& body) {
  SceneInfo::Body it;
  it.name = body.name;
  it.mass = body.mass;
  it.friction = body.friction, it.static_friction = body.static_friction.value_or(body.friction);
  it.fixed = body.fixed, it.turns = body.turns(), it.bare = body.bare;
  std::vector<DrawnForm> forms = of_form(body.shape, [](const auto& form) { return form.drawn(); });
  if (forms.size() > 1 || form<Compound<D>>(body.shape)) {
    it.kind = ShapeKind::compound;
    it.parts = std::move(forms);
    return it;
  }
  DrawnForm& only = forms[0];
  it.kind = only.kind, it.radius = only.radius, it.half = only.half;
  it.vertices = std::move(only.vertices), it.faces = std::move(only.faces);
  return it;
}

template <int D>
Snapshot::Contact shown(const Model<D>& model, const Contact<D>& contact) {
  Snapshot::Contact it;
  it.body = contact.key.a;
  if (contact.key.b < 0) {
    it.wall = -1 - contact.key.b;
  } else {
    it.other = contact.key.b;
  }
  it.point = to_3d<D>(contact.point), it.normal = to_3d<D>(contact.normal);
  it.impulse = to_3d<D>(contact.impulse), it.force = to_3d<D>(contact.force);
  it.gap = contact.gap;
  it.sliding = contact.touching == ContactMode::slide;
  it.holds = contact.touching != ContactMode::open;
  if (const Rail<D>* rail = rail_of(model, contact.key)) it.rail = int(rail - model.rails.data());
  return it;
}

// the force of explosions on each body: as held through their interval, or at this instant
template <int D>
void blow(const Model<D>& model, const State<D>& state, Snapshot& now) {
  const Blasts<D> blasts(model);
  for (std::size_t i = 0; i < state.blasts.size(); ++i) {
    const Blast<D>& it = state.blasts[i];
    if (!it.on) continue;
    for (int body = 0; body < int(model.bodies.size()); ++body) {
      if (model.bodies[body].fixed) continue;
      const bool held = it.forces.size() == model.bodies.size();
      const Wrench<D> push = held ? Wrench<D>{it.torques[std::size_t(body)], it.forces[std::size_t(body)]}
                                  : blasts.push(model.explosions[i], body, body_motion(state, body));
      now.bodies[std::size_t(body)].blast += to_3d<D>(push.f);
      now.bodies[std::size_t(body)].torque += turning_3d<D>(push.n);
    }
  }
}

// what drags on each body: all of its motion, and along the ground where it stands on it
template <int D>
void drag(const Model<D>& model, const State<D>& state, Snapshot& now) {
  std::optional<SupportVertices<D>> vertices;
  // as far as it falls between two impacts of the handout's rest, as in sim/motion/forward_dynamics.cpp
  const double h = 1 / value(model.rate), g = std::sqrt(model.gravity.squaredNorm());
  const double near = kOnGround * model.scale + g * h * h;
  for (int i = 0; i < int(model.bodies.size()); ++i) {
    const Body<D>& body = model.bodies[i];
    if (body.fixed || (body.drag == 0 && body.ground_drag == 0)) continue;
    Vec<D> force = -body.drag * state.v[i];
    for (const Wall<D>& wall : body.ground_drag != 0 ? model.walls : std::vector<Wall<D>>()) {
      // ground is what gravity presses on
      if (g > 0 && !(wall.normal.dot(model.gravity) < 0)) continue;
      if (!vertices) vertices.emplace(model.bodies);
      const BodyMotion<D> at = body_motion(state, i);
      double least = 1e300;
      for (const SupportVertex<D>& vertex : (*vertices)[i])
        least = std::min(least, (at.x + at.arm(vertex.at) - wall.point).dot(wall.normal) - vertex.radius);
      if (least > near) continue;
      force -= body.ground_drag * (state.v[i] - wall.normal * wall.normal.dot(state.v[i]));
      break;
    }
    now.bodies[std::size_t(i)].drag = to_3d<D>(force);
  }
}

// what the forces of the scene give each body: the air's with the other drag
template <int D>
void field(const Model<D>& model, const State<D>& state, double t, Snapshot& now) {
  if (model.forces.empty()) return;
  Forces<D> forces(model);
  forces.gather(state);
  std::vector<BodyMotion<D>> motions;
  stand(state, motions);
  std::vector<Wrench<D>> wrenches;
  for (const bool drag : {true, false}) {
    wrenches.assign(motions.size(), {});
    forces.apply_drag(t, drag, motions, wrenches);
    for (std::size_t i = 0; i < motions.size(); ++i) {
      if (model.bodies[i].fixed) continue;
      (drag ? now.bodies[i].drag : now.bodies[i].field) += to_3d<D>(wrenches[i].f);
      now.bodies[i].torque += turning_3d<D>(wrenches[i].n);
    }
  }
}

// what joints put on each body that they hold
template <int D>
void hold(const Model<D>& model, const State<D>& state, Snapshot& now) {
  std::vector<BodyMotion<D>> motions;
  for (std::size_t i = 0; i < model.joints.size() && i < state.joint_forces.size(); ++i) {
    const Joint<D>& joint = model.joints[i];
    if (state.broken[i] || one_with_another(state, i)) continue;
    const auto push = [&](int body, const Wrench<D>& by) {
      if (body < 0) return;
      now.bodies[std::size_t(body)].held += to_3d<D>(by.f);
      now.bodies[std::size_t(body)].torque += turning_3d<D>(by.n);
    };
    const Wrench<D> on_a{state.joint_torques[i], state.joint_forces[i]};
    if (!equations<D>(joint.kind).mechanism) {
      const Vec<D> at = place(state, joint.a);
      for (const auto& [body, sign] : {std::pair(joint.a.body, 1.0), std::pair(joint.b.body, -1.0)}) {
        if (body >= 0) push(body, transformed_to_origin(on_a, Vec<D>(at - state.x[body])) * sign);
      }
      continue;
    }
    // its one row, from what it puts on a
    if (motions.empty()) stand(state, motions);
    Row<D> row[kMostHeld<D>];
    double error[kMostHeld<D>];
    static const BodyMotion<D> room;
    const auto at = [&](int body) -> const BodyMotion<D>& {
      return body < 0 ? room : motions[std::size_t(body)];
    };
    rows(joint, i, state, motions, row, error);
    if (one_sided(joint)) now.joints[i].slack = std::max(0.0, error[0]);
    const Wrench<D> unit = load_on_a(joint, row[0], at(joint.a.body), at(joint.b.body));
    const double size = unit.f.squaredNorm() + unit.n.squaredNorm();
    if (!(size > 0)) continue;
    const double drag = wound(state, i).drag;
    const double f = (unit.f.dot(on_a.f) + unit.n.dot(on_a.n)) / size - drag / 2;
    const auto holds = [&](double force, int body, const Vec<D>& along, const AngularVec<D>& angular) {
      push(body, Wrench<D>{angular, along} * force);
      // where it holds it: the end about whose place it turns it least
      Snapshot::Joint::Hold held;
      held.body = body, held.place = to_3d<D>(state.x[body]), held.force = to_3d<D>(Vec<D>(force * along));
      double least = 1e300;
      const auto end = [&](const End<D>& it) {
        if (it.body != body) return;
        const Vec<D> point = place(state, it);
        const AngularVec<D> rest = angular - moment<D>(Vec<D>(point - state.x[body]), along);
        if (rest.squaredNorm() >= least) return;
        least = rest.squaredNorm();
        held.place = to_3d<D>(point), held.torque = turning_3d<D>(AngularVec<D>(force * rest));
      };
      end(joint.a), end(joint.b);
      for (const End<D>& it : joint.over) end(it);
      for (int k = 1; k <= now.joints[i].with; ++k) {
        end((&joint)[k].b);
        for (const End<D>& it : (&joint)[k].over) end(it);
      }
      held.at = held.place;
      // teeth push wheels and racks, where they meet; what turns on a body is only reckoned from it
      if (joint.geared && body != (*joint.geared)[0].a.body && body != (*joint.geared)[1].a.body) return;
      // and a rope pulls at a wheel where it leaves it
      if (joint.geared || joint.kind == JointKind::pulley)
        if (const double square = held.force.squaredNorm(); square > 0)
          held.at += held.force.cross(held.torque) / square;
      for (Snapshot::Joint::Hold& known : now.joints[i].holds) {
        if (known.body != body || known.place != held.place) continue;
        known.force += held.force, known.torque += held.torque;
        return;
      }
      now.joints[i].holds.push_back(held);
    };
    each_side(row[0], [&](int body, const Vec<D>& along, const AngularVec<D>& angular) {
      holds(f, body, along, angular);
    });
    if (drag == 0) continue;
    hold_drag<D>(
        {joint, at(joint.a.body), at(joint.b.body), turn_between(joint, i, state), motions, wound(state, i)},
        row[0]);
    each_side(row[0], [&](int body, const Vec<D>& along, const AngularVec<D>& angular) {
      holds(drag, body, along, angular);
    });
  }
}

}  // namespace

double mass(const SceneInfo& cast, const Snapshot& now, int body) {
  return now.masses.empty() ? cast.bodies[std::size_t(body)].mass : now.masses[std::size_t(body)];
}

double friction(const SceneInfo& cast, const Snapshot::Contact& contact) {
  const auto of = [&](const auto& it) { return contact.sliding ? it.friction : it.static_friction; };
  if (contact.rail >= 0) {
    const SceneInfo::Rail& rail = cast.rails[std::size_t(contact.rail)];
    const int other = contact.body == rail.body ? contact.other : contact.body;
    return mixed(of(cast.bodies[std::size_t(other)]), of(rail));
  }
  const double own = of(cast.bodies[std::size_t(contact.body)]);
  if (contact.other >= 0) return mixed(own, of(cast.bodies[std::size_t(contact.other)]));
  return mixed(own, of(cast.walls[std::size_t(contact.wall)]));
}

template <int D>
SceneInfo cast(const Model<D>& model, const State<D>& start, const std::vector<Path<D>>& paths) {
  SceneInfo cast;
  const auto way = [&](const End<D>& a, const End<D>& b) {
    return to_3d<D>(place(start, b) - place(start, a));
  };
  cast.dimension = D;
  cast.scale = model.scale;
  cast.gravity = to_3d<D>(model.gravity);
  for (const Bond<D>& bond : model.bonds) cast.bonds.push_back({bond.a, bond.b});
  for (const Force<D>& force : model.forces)
    if (force.law == Force<D>::Law::buoyancy) cast.surface = force.level;
  cast.forces = !model.forces.empty() ||
                std::any_of(model.changes.begin(), model.changes.end(), [](const Change<D>& change) {
                  return change.of == Change<D>::Of::force || change.of == Change<D>::Of::gravity;
                });
  cast.books_work = model.books_work();
  for (const Body<D>& body : model.bodies) cast.bodies.push_back(shown(body));
  for (const Drive<D>& drive : model.drives) cast.bodies[std::size_t(drive.body)].fixed = false;
  for (const Wall<D>& wall : model.walls)
    cast.walls.push_back({to_3d<D>(wall.point), to_3d<D>(wall.normal), wall.friction,
                          wall.static_friction ? wall.static_friction : wall.friction});
  // both ways are drawn as lines; beads of one wire share it
  std::vector<const Curve<D>*> drawn;
  const auto add_curve = [&](const std::string& name, int body, const Curve<D>& curve) -> SceneInfo::Rail* {
    if (std::find(drawn.begin(), drawn.end(), &curve) != drawn.end()) return nullptr;
    drawn.push_back(&curve);
    SceneInfo::Rail& it = cast.rails.emplace_back();
    it.name = name, it.body = body, it.closed = curve.closed();
    for (const Vec<D>& x : curve.places(kFineCurve * curve.length())) it.places.push_back(to_3d<D>(x));
    return &it;
  };
  for (const Rail<D>& rail : model.rails) {
    SceneInfo::Rail* it = add_curve(rail.name, rail.body, *rail.curve);
    // of space from all sides
    if (it) it->left = D == 3 || rail.left, it->right = D == 3 || rail.right;
    if (it)
      it->friction = rail.friction,
      it->static_friction = rail.static_friction ? rail.static_friction : rail.friction;
  }
  for (const Joint<D>& joint : model.joints)
    if (joint.curve) add_curve(joint.name, joint.b.body, *joint.curve);
  for (const Spring<D>& s : model.springs)
    cast.springs.push_back({s.a.body, s.b.body, s.rest_length, s.stiffness, way(s.a, s.b)});
  for (const Joint<D>& j : model.joints) {
    cast.joints.push_back({j.name, j.kind, j.a.body, j.b.body, j.length, to_3d<D>(j.axis), j.lower, j.upper});
    cast.joints.back().start = way(j.a, j.b), cast.joints.back().later = j.later;
    if (!equations<D>(j.kind).mechanism) continue;
    SceneInfo::Joint& it = cast.joints.back();
    const auto add = [&](const End<D>& end) { it.places.push_back({end.body, to_3d<D>(end.local)}); };
    const bool gear = j.kind == JointKind::gear;
    add(j.a);
    if (gear) add(j.b);
    for (const End<D>& end : j.over) add(end);
    if (!gear) add(j.b);
    it.offset_a = j.on_a.offset, it.offset_b = j.on_b.offset, it.rope = j.rope;
    it.around = j.around, it.rounds = j.whole_turns, it.belt = j.belt;
    it.tooth_a = to_3d<D>(j.on_a.start), it.tooth_b = to_3d<D>(j.on_b.start);
  }
  for (std::size_t i = 0; i < model.mice.size(); ++i) {
    const Path<D>& path = paths[i];
    SceneInfo::Mouse mouse{path.start(), path.end(), model.mice[i].rest_length, {}};
    const double span = path.end() - path.start();
    const int pieces = std::clamp(int(std::ceil(std::min(span, 1e6) * kPathRate)), 1, kPathMost);
    for (int k = 0; k <= pieces; ++k) {
      mouse.path.push_back(to_3d<D>(path.place(k == pieces ? path.end() : path.start() + span * k / pieces)));
    }
    cast.mice.push_back(std::move(mouse));
  }
  return cast;
}

template <int D>
Snapshot snapshot(const Model<D>& scene, const State<D>& state, const Stepper<D>& stepper, TimeStamp at,
                  double t) {
  const Model<D>& model = scene.drives.empty() && scene.whens.empty() ? scene : stepper.model(state);
  Snapshot now;
  now.gravity = to_3d<D>(stepper.model(state).gravity);
  now.time = t;
  now.step = state.step, now.bonds = state.intact;
  if (std::any_of(scene.changes.begin(), scene.changes.end(),
                  [](const Change<D>& it) { return it.of == Change<D>::Of::mass; }))
    for (const Body<D>& body : model.bodies) now.masses.push_back(body.mass);
  now.bodies.resize(model.bodies.size());
  for (int i = 0; i < int(model.bodies.size()); ++i) {
    Snapshot::Body& body = now.bodies[i];
    body.position = to_3d<D>(state.x[i]);
    body.velocity = to_3d<D>(state.v[i]);
    if (D == 2) body.surface = model.bodies[i].belt[0];
    body.at_rest = i < int(state.frozen.size()) && state.frozen[i] != 0;
    if (!model.bodies[i].fixed)
      body.kinetic = kinetic(model, state, i), body.gravity = gravity_energy(model, state, i);
    if (const int k = turning(state, i); k >= 0) {
      body.spin = turning_3d<D>(state.spin[k]);
      if (D == 2) body.angle = state.turn[k][0];
      body.orientation = quaternion<D>(state.turn[k]);
    }
  }
  if (blasting(state)) blow(model, state, now);
  drag(model, state, now);
  try {
    field(model, state, t, now);
  } catch (const NotFinite&) {
    // the step tells of it
  }
  for (const Spring<D>& s : model.springs) {
    const Vec<D> a = place(state, s.a), b = place(state, s.b);
    now.springs.push_back(
        {to_3d<D>(a), to_3d<D>(b), s.a.body, s.b.body, -s.stiffness * ((b - a).norm() - s.rest_length),
         to_3d<D>(pull<D>(law(s), a, velocity(state, s.a), b, velocity(state, s.b))), s.loose});
  }
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const Joint<D>& j = model.joints[i];
    Snapshot::Joint joint{to_3d<D>(place(state, j.a)), to_3d<D>(place(state, j.b))};
    if (i < state.joint_forces.size()) {
      joint.force = to_3d<D>(state.joint_forces[i]);
      joint.torque = turning_3d<D>(state.joint_torques[i]);
    }
    joint.broken = i < state.broken.size() && state.broken[i] != 0;
    const Wound rope = wound(state, i);
    joint.off_a = rope.off_a, joint.off_b = rope.off_b, joint.with = rope.with;
    now.joints.push_back(joint);
  }
  hold(model, state, now);
  for (int i = 0; i < int(model.mice.size()); ++i) {
    Snapshot::Mouse mouse;
    mouse.pressed = stepper.pressed(i, at);
    mouse.pointer = to_3d<D>(stepper.paths()[i].place(t));
    mouse.held = mouse.pointer;
    if (const Grip<D>& grip = state.grips[i]; grip.body >= 0) {
      mouse.body = grip.body;
      const End<D> held{grip.body, grip.local};
      const auto hand = stepper.paths()[i].at(t);
      const Vec<D> point = place(state, held);
      mouse.held = to_3d<D>(point);
      mouse.force =
          to_3d<D>(pull<D>(law(model.mice[i]), point, velocity(state, held), hand.place, hand.velocity));
    }
    now.mice.push_back(mouse);
  }
  for (const Touch<D>& touch : state.touches) {
    const Wall<D>& wall = model.walls[touch.wall];
    Snapshot::Contact contact;
    contact.body = touch.body, contact.wall = touch.wall;
    contact.point = to_3d<D>(touch.point), contact.normal = to_3d<D>(wall.normal);
    contact.impulse = to_3d<D>(touch.impulse);
    contact.force = contact.impulse * value(model.rate);  // the mean over the step
    contact.gap = (touch.point - wall.point).dot(wall.normal);
    now.contacts.push_back(contact);
  }
  for (const Contact<D>& contact : state.contacts) {
    // some are carried along before they touch
    if (contact.touching != ContactMode::open || contact.impulse != Vec<D>::Zero())
      now.contacts.push_back(shown(model, contact));
  }
  now.energies = energies(model, state, stepper.paths(), t);
  now.momentum = to_3d<D>(momentum(model, state));
  now.angular_momentum = turning_3d<D>(angular_momentum(model, state));
  return now;
}

template SceneInfo cast<2>(const Model<2>&, const State<2>&, const std::vector<Path<2>>&);
template Snapshot snapshot<2>(const Model<2>&, const State<2>&, const Stepper<2>&, TimeStamp, double);
template SceneInfo cast<3>(const Model<3>&, const State<3>&, const std::vector<Path<3>>&);
template Snapshot snapshot<3>(const Model<3>&, const State<3>&, const Stepper<3>&, TimeStamp, double);

}  // namespace obscura::sim
