#include "sim/step/snapshots.h"

#include <algorithm>
#include <utility>

#include "sim/constraint/material.h"
#include "sim/energy/energy.h"
#include "sim/force/explosion.h"

namespace obscura::sim {

namespace {

constexpr double kPathRate = 60;  // places a second of a mouse's way
constexpr int kPathMost = 600;

// in the plane (0, 0, w)
template <int D>
Vec3 inertia_times(const AngularVec<D>& w) {
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
  it.mass = body.mass, it.friction = body.friction;
  it.fixed = body.fixed, it.turns = body.turns();
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
Snapshot::Contact shown(const Contact<D>& contact) {
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
      const Vec<D> push = held ? it.forces[std::size_t(body)]
                               : blasts.push(model.explosions[i], body, body_motion(state, body)).f;
      now.bodies[std::size_t(body)].blast += to_3d<D>(push);
    }
  }
}

}  // namespace

double friction(const SceneInfo& cast, const Snapshot::Contact& contact) {
  const double own = cast.bodies[std::size_t(contact.body)].friction;
  if (contact.other >= 0) return mixed(own, cast.bodies[std::size_t(contact.other)].friction);
  return mixed(own, cast.walls[std::size_t(contact.wall)].friction);
}

template <int D>
SceneInfo cast(const Model<D>& model, const std::vector<Path<D>>& paths) {
  SceneInfo cast;
  cast.dimension = D;
  cast.scale = model.scale;
  cast.gravity = to_3d<D>(model.gravity);
  cast.forces = !model.forces.empty();
  for (const Body<D>& body : model.bodies) cast.bodies.push_back(shown(body));
  for (const Wall<D>& wall : model.walls)
    cast.walls.push_back({to_3d<D>(wall.point), to_3d<D>(wall.normal), wall.friction});
  for (const Spring<D>& s : model.springs)
    cast.springs.push_back({s.a.body, s.b.body, s.rest_length, s.stiffness});
  for (const Joint<D>& j : model.joints)
    cast.joints.push_back({j.name, j.kind, j.a.body, j.b.body, j.length, to_3d<D>(j.axis), j.lower, j.upper});
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
Snapshot snapshot(const Model<D>& model, const State<D>& state, const Stepper<D>& stepper, TimeStamp at,
                  double t) {
  Snapshot now;
  now.time = t;
  now.step = state.step;
  now.bodies.resize(model.bodies.size());
  for (int i = 0; i < int(model.bodies.size()); ++i) {
    Snapshot::Body& body = now.bodies[i];
    body.position = to_3d<D>(state.x[i]);
    body.velocity = to_3d<D>(state.v[i]);
    body.at_rest = i < int(state.frozen.size()) && state.frozen[i] != 0;
    if (const int k = turning(state, i); k >= 0) {
      body.spin = inertia_times<D>(state.spin[k]);
      if (D == 2) body.angle = state.turn[k][0];
      body.orientation = quaternion<D>(state.turn[k]);
    }
  }
  if (blasting(state)) blow(model, state, now);
  for (const Spring<D>& s : model.springs) {
    const Vec<D> a = place(state, s.a), b = place(state, s.b);
    now.springs.push_back(
        {to_3d<D>(a), to_3d<D>(b), s.a.body, s.b.body, -s.stiffness * ((b - a).norm() - s.rest_length)});
  }
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const Joint<D>& j = model.joints[i];
    Snapshot::Joint joint{to_3d<D>(place(state, j.a)), to_3d<D>(place(state, j.b))};
    if (i < state.joint_forces.size()) joint.force = to_3d<D>(state.joint_forces[i]);
    joint.broken = i < state.broken.size() && state.broken[i] != 0;
    now.joints.push_back(joint);
  }
  for (int i = 0; i < int(model.mice.size()); ++i) {
    Snapshot::Mouse mouse;
    mouse.pressed = stepper.pressed(i, at);
    mouse.pointer = to_3d<D>(stepper.paths()[i].place(t));
    mouse.held = mouse.pointer;
    if (const Grip<D>& grip = state.grips[i]; grip.body >= 0) {
      mouse.body = grip.body;
      mouse.held = to_3d<D>(place(state, End<D>{grip.body, grip.local}));
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
      now.contacts.push_back(shown(contact));
  }
  now.energies = energies(model, state, stepper.paths(), t);
  now.momentum = to_3d<D>(momentum(model, state));
  now.angular_momentum = inertia_times<D>(angular_momentum(model, state));
  return now;
}

template SceneInfo cast<2>(const Model<2>&, const std::vector<Path<2>>&);
template Snapshot snapshot<2>(const Model<2>&, const State<2>&, const Stepper<2>&, TimeStamp, double);
template SceneInfo cast<3>(const Model<3>&, const std::vector<Path<3>>&);
template Snapshot snapshot<3>(const Model<3>&, const State<3>&, const Stepper<3>&, TimeStamp, double);

}  // namespace obscura::sim
