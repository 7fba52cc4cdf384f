// A heap of boxes in space beside Bullet and ODE, where they are installed, and Box3D, where OBSCURA_BOX3D
// names its sources, sixty steps a second (Box3D: with 4 substeps), one thread, sleeping switched off in
// theirs: heap [BOXES]. Of each the processor time of a step from 1 to 3 s, while they fall on each other and
// settle.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <utility>
#include <vector>

#ifdef OBSCURA_BULLET
#include <btBulletDynamicsCommon.h>
#endif
#ifdef OBSCURA_ODE
#include <ode/ode.h>
#endif
#ifdef OBSCURA_BOX3D
#include <box3d/box3d.h>
#endif

#include "sim/math/exponential.h"
#include "sim/shape/shape.h"
#include "sim/step/stepper.h"

namespace {

using obscura::sim::Vec3;

constexpr int kRate = 60;
constexpr double kHalf = 0.125, kRoom = 1.7, kMass = 15.625, kFriction = 0.5;

struct Crate {
  Vec3 place, turn;
};

std::vector<Crate> heap(int count) {
  std::mt19937 bits(7);
  const auto any = [&] { return double(bits()) / 2147483648.0 - 1; };
  std::vector<Crate> all;
  for (int i = 0; i < count; ++i) {
    Crate box;
    box.place = {-1.4 + 0.4 * (i % 8), 0.3 + 0.4 * (i / 64), -1.4 + 0.4 * (i / 8 % 8)};
    for (int axis = 0; axis < 3; ++axis) box.turn[axis] = any();
    all.push_back(box);
  }
  return all;
}

const std::vector<std::pair<Vec3, double>> kWalls = {
    {{0, 1, 0}, 0}, {{-1, 0, 0}, -kRoom}, {{1, 0, 0}, -kRoom}, {{0, 0, -1}, -kRoom}, {{0, 0, 1}, -kRoom}};

// ms a step
template <class Step>
double timed(Step&& step) {
  for (int i = 0; i < kRate; ++i) step();
  const std::clock_t begun = std::clock();
  for (int i = 0; i < 2 * kRate; ++i) step();
  return 1e3 * double(std::clock() - begun) / CLOCKS_PER_SEC / (2 * kRate);
}

double ours(const std::vector<Crate>& boxes) {
  using namespace obscura::sim;
  World<3> world;
  world.model.rate = {kRate, 1};
  world.model.collision = Collision::contact, world.model.solver = Solver::iterative;
  world.model.scale = 4;
  for (const auto& [normal, d] : kWalls) world.model.walls.push_back({d * normal, normal, {}, {}});
  for (const Crate& box : boxes) {
    Body<3> body;
    body.shape = Box<3>{Vec3::Constant(kHalf)};
    body.mass = kMass, body.elasticity = 0, body.friction = kFriction;
    body.inertia = inertia(body.shape, kMass);
    world.model.bodies.push_back(body);
    world.state.x.push_back(box.place), world.state.v.push_back(Vec3::Zero());
    world.state.turn.push_back(exponential(box.turn)), world.state.spin.push_back(Vec3::Zero());
  }
  Stepper<3> stepper(world.model);
  stepper.begin(world.state);
  return timed([&] { stepper.step(world.state); });
}

#ifdef OBSCURA_BULLET
double bullet(const std::vector<Crate>& boxes) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broad;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broad, &solver, &configuration);
  world.setGravity({0, -9.81, 0});
  const double rough = std::sqrt(kFriction);  // Bullet takes the product of a pair
  for (const auto& [n, d] : kWalls) {
    auto* body = new btRigidBody(0, nullptr, new btStaticPlaneShape(btVector3(n[0], n[1], n[2]), d));
    body->setFriction(rough), world.addRigidBody(body);
  }
  auto* shape = new btBoxShape({kHalf, kHalf, kHalf});
  shape->setMargin(0.005);
  btVector3 inertia;
  shape->calculateLocalInertia(kMass, inertia);
  for (const Crate& box : boxes) {
    const auto q = obscura::sim::exponential(box.turn);
    const btTransform at(btQuaternion(q[0], q[1], q[2], q[3]),
                         btVector3(box.place[0], box.place[1], box.place[2]));
    auto* body = new btRigidBody(kMass, new btDefaultMotionState(at), shape, inertia);
    body->setFriction(rough), body->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(body);
  }
  return timed([&] { world.stepSimulation(1.0 / kRate, 0, 1.0 / kRate); });
}

#endif

#ifdef OBSCURA_ODE
dWorldID world;
dJointGroupID touches;

void meet(void*, dGeomID a, dGeomID b) {
  dContact contacts[8] = {};
  const int n = dCollide(a, b, 8, &contacts[0].geom, sizeof(dContact));
  for (int i = 0; i < n; ++i) {
    contacts[i].surface.mode = dContactApprox1, contacts[i].surface.mu = kFriction;
    dJointAttach(dJointCreateContact(world, touches, &contacts[i]), dGeomGetBody(a), dGeomGetBody(b));
  }
}

double ode(const std::vector<Crate>& boxes) {
  dInitODE();
  world = dWorldCreate(), touches = dJointGroupCreate(0);
  dWorldSetGravity(world, 0, -9.81, 0);
  const dSpaceID space = dHashSpaceCreate(nullptr);
  for (const auto& [n, d] : kWalls) dCreatePlane(space, n[0], n[1], n[2], d);
  for (const Crate& box : boxes) {
    const dBodyID body = dBodyCreate(world);
    dMass mass;
    dMassSetBoxTotal(&mass, kMass, 2 * kHalf, 2 * kHalf, 2 * kHalf);
    dBodySetMass(body, &mass);
    dGeomSetBody(dCreateBox(space, 2 * kHalf, 2 * kHalf, 2 * kHalf), body);
    dBodySetPosition(body, box.place[0], box.place[1], box.place[2]);
    const auto q = obscura::sim::exponential(box.turn);
    const dQuaternion turn = {q[3], q[0], q[1], q[2]};
    dBodySetQuaternion(body, turn);
  }
  return timed([&] {
    dSpaceCollide(space, nullptr, meet);
    dWorldQuickStep(world, 1.0 / kRate);
    dJointGroupEmpty(touches);
  });
}

#endif

#ifdef OBSCURA_BOX3D
double box3d(const std::vector<Crate>& boxes) {
  b3WorldDef settings = b3DefaultWorldDef();
  settings.gravity = {0, -9.81f, 0}, settings.enableSleep = false;
  const b3WorldId world = b3CreateWorld(&settings);
  b3ShapeDef shape = b3DefaultShapeDef();
  shape.baseMaterial.friction = float(kFriction), shape.baseMaterial.restitution = 0;
  // walls are boxes: the floor lies below 0, the others are beyond their planes
  for (const auto& [n, d] : kWalls) {
    b3BodyDef wall = b3DefaultBodyDef();
    const Vec3 middle = (d - 1) * n;
    wall.position = {float(middle[0]), float(middle[1]), float(middle[2])};
    const auto half = [&](int axis) { return n[axis] != 0 ? 1.0f : 40.0f; };
    const b3BoxHull hull = b3MakeBoxHull(half(0), half(1), half(2));
    b3CreateHullShape(b3CreateBody(world, &wall), &shape, &hull.base);
  }
  const b3BoxHull hull = b3MakeBoxHull(float(kHalf), float(kHalf), float(kHalf));
  shape.density = float(kMass / (8 * kHalf * kHalf * kHalf));
  for (const Crate& box : boxes) {
    b3BodyDef body = b3DefaultBodyDef();
    body.type = b3_dynamicBody;
    body.position = {float(box.place[0]), float(box.place[1]), float(box.place[2])};
    const auto q = obscura::sim::exponential(box.turn);
    body.rotation = {{float(q[0]), float(q[1]), float(q[2])}, float(q[3])};
    b3CreateHullShape(b3CreateBody(world, &body), &shape, &hull.base);
  }
  const double took = timed([&] { b3World_Step(world, 1.0f / kRate, 4); });
  b3DestroyWorld(world);
  return took;
}

#endif

}  // namespace

int main(int argc, char** argv) {
  const auto boxes = heap(argc > 1 ? std::atoi(argv[1]) : 1000);
  const double own = ours(boxes);
  std::printf("%zu boxes: obscura %.1f ms a step", boxes.size(), own);
  const auto beside = [&](const char* name, double other) {
    std::printf(", %s %.1f (%.2f)", name, other, other / own);
  };
#ifdef OBSCURA_BULLET
  beside("Bullet", bullet(boxes));
#endif
#ifdef OBSCURA_ODE
  beside("ODE", ode(boxes));
#endif
#ifdef OBSCURA_BOX3D
  beside("Box3D", box3d(boxes));
#endif
  std::printf("\n");
}
