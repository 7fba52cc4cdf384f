// Links as sides of rows: what chains and contacts make of each other, against free bodies and against the
// same joints as rows.

#include <gtest/gtest.h>

#include <cmath>

#include "sim/energy/energy.h"
#include "sim/jointed.h"
#include "sim/multibody/chains.h"
#include "sim/space_rooms.h"

namespace obscura::sim {
namespace {

using sim::pin;

Joint<2> pin(End<2> a, End<2> b, double turn) {
  Joint<2> joint = pin(a, b);
  joint.turn = AngularVec<2>(turn);
  return joint;
}

template <int D>
std::vector<int> everyone(const World<D>& world) {
  std::vector<int> all;
  for (int i = 0; i < int(world.model.bodies.size()); ++i) {
    if (!world.model.bodies[i].fixed) all.push_back(i);
  }
  return all;
}

template <int D>
World<D> chained(World<D> world, std::vector<int> bodies) {
  articulate(world, bodies);
  return world;
}

// the largest distance of two states' centres, m
template <int D>
double apart(const State<D>& a, const State<D>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i) most = std::max(most, (a.x[i] - b.x[i]).norm());
  return most;
}

TEST(Linked, AFreeLinkIsAFreeBody) {
  for (const auto collision : {Collision::contact, Collision::event}) {
    World<2> world = touching_room(collision);
    add_walls(world, 4, 4);
    add_box(world, {0.5, 0.3}, 2, {1, 1}, {2.5, 1}, 7, 4, 0.5);
    add_ball(world, 0.2, 0.5, {3.3, 0.2}, {0, 0}, 0, 0.5);
    rub(world, 0.4);
    const World<2> linked = chained(world, {0});
    for (const int steps : {300, 600, 2400}) {
      const State<2> body = stepped(world, steps), link = stepped(linked, steps);
      // the same scheme: rounding, and what impacts make of it
      EXPECT_LE(apart(body, link), 1e-10) << steps;
      EXPECT_NEAR(body.turn[0][0], link.turn[0][0], 1e-10) << steps;
      EXPECT_EQ(body.contacts.size(), link.contacts.size()) << steps;
      EXPECT_EQ(body.frozen, link.frozen) << steps;
    }
    EXPECT_TRUE(stepped(linked, 2400).frozen[0]) << "it must come to rest";
  }
}

TEST(Linked, AFreeLinkInSpaceIsAFreeBody) {
  World<3> world = space();
  world.model.collision = Collision::contact, world.model.rate = {600, 1}, world.model.scale = 4;
  add_wall(world, {0, 0, 0}, {0, 1, 0}), add_wall(world, {2, 0, 0}, {-1, 0.2, 0});
  add_solid(world, brick({0.5, 0.3, 0.4}), 2, {0, 1, 0}, {2.5, 1, 0.4}, no_rotation<3>(), {4, -2, 3}, 0.4);
  for (auto& body : world.model.bodies) body.friction = 0.4;
  const World<3> linked = chained(world, {0});
  for (const int steps : {240, 480}) {
    const State<3> body = stepped(world, steps), link = stepped(linked, steps);
    // rounding, and what impacts make of it
    EXPECT_LE(apart(body, link), 1e-9) << steps;
    EXPECT_LE((body.turn[0] - link.turn[0]).norm(), 1e-9) << steps;
  }
}

// A trunk and four limbs on pins with limits, of which two rub, over a floor with a block on it.
World<2> figure(Collision collision, Vec2 v, double spin) {
  World<2> world = touching_room(collision);
  add_walls(world, 4, 4);
  const Vec2 at(1, 1.5);
  const auto limb = [&](Vec2 place, double angle) {
    return add_box(world, {0.5, 0.1}, 1, at + place, v, angle, 0, 0.3);
  };
  add_box(world, {0.3, 0.7}, 6, at, v, 0, spin, 0.3);
  limb({0.4, 0.25}, 0), limb({-0.4, 0.25}, 0), limb({0.1, -0.6}, -std::acos(-1) / 2);
  limb({-0.1, -0.6}, -std::acos(-1) / 2);
  const auto hold = [&](int i, Vec2 on_limb, Vec2 on_trunk) {
    Joint<2> joint = pin({i, on_limb}, {0, on_trunk}, world.state.turn[i][0]);
    joint.lower = -0.8, joint.upper = 1.1, joint.friction = i < 3 ? 0.2 : 0;
    world.model.joints.push_back(joint);
  };
  hold(1, {-0.25, 0}, {0.15, 0.25}), hold(2, {0.25, 0}, {-0.15, 0.25});
  hold(3, {-0.25, 0}, {0.1, -0.35}), hold(4, {-0.25, 0}, {-0.1, -0.35});
  for (Body<2>& body : world.model.bodies) body.group = 1;
  world.model.ignore = {{1, 1}};
  add_box(world, {0.5, 0.5}, 3, {2.5, 0.25}, {0, 0}, 0, 0, 0.3);
  rub(world, 0.5);
  return world;
}
const std::vector<int> kFigure = {0, 1, 2, 3, 4};

TEST(Linked, AFigureOfLinksIsAFigureOfRows) {
  const World<2> rows = figure(Collision::event, {3, 1}, 2), links = chained(rows, kFigure);
  ASSERT_EQ(links.model.chains.size(), 1u);
  ASSERT_EQ(links.model.chains[0].joints, (std::vector<int>{-1, 0, 1, 2, 3}));
  for (const int steps : {1, 240, 600}) {
    const State<2> a = stepped(rows, steps), b = stepped(links, steps);
    // one scheme on two sets of numbers; impacts make more of the difference: 3e-9 after the third
    EXPECT_LE(apart(a, b), steps < 250 ? 1e-10 : 1e-7) << steps;
    EXPECT_EQ(a.contacts.size(), b.contacts.size()) << steps;
    for (std::size_t i = 0; i < rows.model.joints.size() && steps < 250; ++i)
      EXPECT_LE((a.joint_forces[i] - b.joint_forces[i]).norm(), 1e-6) << steps << " joint " << i;
  }
}

// A pendulum on a limit, a lift with a motor, and a hinge that rubs.
TEST(Linked, LimitsMotorsAndFrictionOfChainsAreThoseOfRows) {
  World<2> world = touching_room();
  add_box(world, {0.1, 1}, 1, {0.5, 0}, {0, 0}, std::acos(-1) / 2);
  Joint<2> limit = pin({0, {0, 0.5}}, {-1, {0, 0}}, std::acos(-1) / 2);
  limit.lower = -0.7, limit.upper = 0.5;
  add_box(world, {0.2, 0.2}, 1, {3, 0});
  Joint<2> lift = pin({1, {0, 0}}, {-1, {3, 0}});
  lift.kind = JointKind::slider, lift.axis = {0, 1}, lift.motor = Joint<2>::Motor{0.5, 11};
  add_box(world, {0.1, 1}, 1, {6, 0}, {0, 0}, std::acos(-1) / 2);
  Joint<2> rubs = pin({2, {0, 0.5}}, {-1, {5.5, 0}}, std::acos(-1) / 2);
  rubs.friction = 1;
  world.model.joints = {limit, lift, rubs};
  const World<2> links = chained(world, {0, 1, 2});
  EXPECT_EQ(links.model.chains.size(), 3u);
  for (const int steps : {120, 600, 1200}) {
    const State<2> a = stepped(world, steps), b = stepped(links, steps);
    EXPECT_LE(apart(a, b), 1e-8) << steps << ": what rows inside the stages err by";
    for (int i = 0; i < 3; ++i)
      EXPECT_LE((a.joint_forces[i] - b.joint_forces[i]).norm(), 1e-6) << steps << " joint " << i;
  }
}

TEST(Linked, ALoopIsClosedByRows) {
  // four bars: three links between two pins in the room
  World<2> world = touching_room();
  world.model.gravity = {0, -9.81};
  const double quarter = std::acos(-1) / 2;
  add_box(world, {0.05, 1}, 1, {0, -0.5}), add_box(world, {0.05, 1.2}, 1.5, {0.6, -1}, {0, 0}, quarter);
  add_box(world, {0.05, 1}, 1, {1.2, -0.5});
  world.model.joints = {pin({0, {0, 0.5}}, {-1, {0, 0}}), pin({1, {0, 0.6}}, {0, {0, -0.5}}, quarter),
                        pin({2, {0, -0.5}}, {1, {0, -0.6}}, -quarter), pin({2, {0, 0.5}}, {-1, {1.2, 0}})};
  for (Body<2>& body : world.model.bodies) body.group = 1;
  world.model.ignore = {{1, 1}};
  for (int i = 0; i < 3; ++i)
    world.state.spin[i][0] = i == 1 ? 0 : 3, world.state.v[i] = {i == 1 ? 3.0 : 1.5, 0};
  const World<2> links = chained(world, {0, 1, 2});
  int held = 0;
  for (const Joint<2>& joint : links.model.joints) held += joint.linked;
  EXPECT_EQ(held, 3);
  const State<2> a = stepped(world, 1200), b = stepped(links, 1200);
  EXPECT_LE(apart(a, b), 1e-7) << "of both, Runge-Kutta's error after two swings";
  for (const Joint<2>& joint : links.model.joints)
    EXPECT_LE((place(b, joint.a) - place(b, joint.b)).norm(), 1e-12) << "no joint drifts, nor does the loop";
  EXPECT_NEAR(sim::energies(links.model, b, {}, 0).total(),
              sim::energies(links.model, links.state, {}, 0).total(), 1e-6);
}

TEST(Linked, AnImpactKeepsMomenta) {
  World<2> world = figure(Collision::event, {0, 0}, 0);
  world.model.gravity.setZero(), world.model.walls.clear();
  world.state.v[5] = {-3, 4};  // the block at the figure
  world.state.x[5] = {2, 0.4};
  for (auto& body : world.model.bodies) body.elasticity = 1;
  for (auto& joint : world.model.joints) joint.friction = 0;
  const World<2> links = chained(world, kFigure);
  const Eigen::Vector3d before = momenta(links, links.state);
  const double energy = kinetic(links.model, links.state);
  bool struck = false;
  State<2> state = links.state;
  Stepper<2> stepper(links.model);
  stepper.begin(state);
  for (int i = 0; i < 600; ++i) {
    ASSERT_FALSE(stepper.step(state));
    for (const auto& contact : state.contacts) struck = struck || contact.impulse.norm() > 1;
  }
  EXPECT_TRUE(struck);
  // rounding of the impact, and of joints at their limits
  EXPECT_LE((momenta(links, state) - before).norm(), 1e-10 * before.norm());
  EXPECT_LE(kinetic(links.model, state), energy * (1 + 1e-9));
}

TEST(Linked, AThrownFigureLosesEnergyOnly) {
  const World<2> links = chained(figure(Collision::contact, {3, 1}, 2), kFigure);
  State<2> state = links.state;
  Stepper<2> stepper(links.model);
  stepper.begin(state);
  double before = energy(links, state);
  for (int i = 0; i < 1800; ++i) {
    ASSERT_FALSE(stepper.step(state));
    const double now = energy(links, state);
    EXPECT_LE(now, before + 1e-6) << state.step;
    before = now;
  }
  EXPECT_LE(deepest(state), 1e-6);
}

TEST(Linked, WhatHasFallenLiesStillAndWakes) {
  World<2> world = figure(Collision::contact, {1, 0}, 0);
  world.state.x[5] = {3.5, 0.25};
  for (auto& body : world.model.bodies) body.elasticity = 0;
  for (auto& joint : world.model.joints) joint.friction = 0.5;
  const World<2> links = chained(world, kFigure);
  State<2> state = links.state;
  Stepper<2> stepper(links.model);
  stepper.begin(state);
  int steps = 0;
  for (; steps < 600 * 20 && !state.frozen[0]; ++steps) ASSERT_FALSE(stepper.step(state));
  ASSERT_TRUE(state.frozen[0]) << "it must come to rest";
  const State<2> resting = state;
  for (int i = 0; i < 600; ++i) ASSERT_FALSE(stepper.step(state));
  EXPECT_EQ(state.x, resting.x);
  EXPECT_EQ(state.turn, resting.turn);
  EXPECT_EQ(state.chain_states, resting.chain_states);
  Vec2 carried(0, 0);
  for (const auto& contact : state.contacts) {
    if (contact.key.a < 5 && contact.key.b < 0) carried += contact.force;
  }
  EXPECT_NEAR(carried.y(), 10 * 9.81, 1e-6) << "the floor carries all of it";

  // the block slides into it
  state.frozen[5] = 0, state.v[5] = {-6, 0};
  for (int i = 0; i < 600 && state.frozen[0]; ++i) ASSERT_FALSE(stepper.step(state));
  EXPECT_FALSE(state.frozen[0]);
  EXPECT_FALSE(state.frozen[4]) << "all of it";
}

// Of two masses on a spring, of which one is a link, the error falls by sixteen where the step halves.
TEST(Linked, ASpringFromALinkToABodyIsOfFourthOrder) {
  const auto swung = [](int rate) {
    World<2> world = touching_room(Collision::contact);
    world.model.rate = {rate, 1};
    add_box(world, {0.1, 1}, 1, {0, -0.5}), add_box(world, {0.2, 0.2}, 0.5, {1, -1.5});
    world.model.joints = {pin({0, {0, 0.5}}, {-1, {0, 0}})};
    add_spring(world, {0, {0, -0.5}}, {1, {0.1, 0.1}}, 20, 0.3);
    for (Body<2>& body : world.model.bodies) body.group = 1;
    world.model.ignore = {{1, 1}};
    return stepped(chained(world, {0}), rate);
  };
  const State<2> exact = swung(12800);
  const double coarse = apart(swung(800), exact), fine = apart(swung(1600), exact);
  EXPECT_GT(coarse / fine, 14);
  EXPECT_LT(coarse, 1e-7);
}

TEST(Linked, VelocitiesThatJointsForbidArePutRightByImpulses) {
  // as a weld makes one of two: the momenta are kept
  World<2> world = touching_room(Collision::contact, {0, 0});
  add_box(world, {1, 0.5}, 2, {0, 0}, {1, 0}), add_box(world, {1, 0.5}, 2, {1, 0}, {1, 0.6});
  Joint<2> weld = pin({0, {0.5, 0}}, {1, {-0.5, 0}});
  weld.kind = JointKind::weld;
  world.model.joints = {weld};
  const World<2> links = chained(world, {1, 0});
  const State<2> now = stepped(links, 600);
  EXPECT_LE((momenta(links, now) - momenta(world, world.state)).norm(), 1e-12);
  EXPECT_NEAR(now.spin[0][0], 2 * 0.6 * 0.5 / (2 * (2 * 1.25 / 12 + 2 * 0.25)), 1e-12);
  EXPECT_LE(apart(now, stepped(world, 600)), 1e-10);
}

TEST(Linked, ADollInSpaceIsADollOfRows) {
  const World<3> world = doll();
  const World<3> links = chained(world, {0, 1, 2});
  for (const int steps : {240, 360}) {
    const State<3> a = stepped(world, steps), b = stepped(links, steps);
    // one scheme on two sets of numbers, and after 250 steps the first impacts
    EXPECT_LE(apart(a, b), 1e-9) << steps;
    EXPECT_EQ(a.contacts.size(), b.contacts.size()) << steps;
    for (int i = 0; i < 2; ++i)
      EXPECT_LE((a.joint_forces[i] - b.joint_forces[i]).norm(), 1e-6) << steps << " joint " << i;
  }
}

}  // namespace
}  // namespace obscura::sim
