// Piles of boxes beside Box2D and Chipmunk at their usual settings (60 steps a second, 8 + 3 and 10
// iterations), one thread: with sleeping off, and, of ours and Box2D, as they come: Chipmunk's bodies sleep
// only where that is asked for. Of each the processor time of a sixtieth of a second, in all and while most
// of the boxes fall, land and lie; the deepest penetration, how far the farthest body has come from its
// place, and how many times longer it takes than ours, awake: of the least times of each sixtieth in all
// rounds, and the median of the rounds, so that what else the machine does counts little.

#include <box2d/box2d.h>
#include <chipmunk/chipmunk.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "sim/shape/shape.h"
#include "sim/solve/iterate/plane.h"

namespace {

using obscura::sim::Vec;

constexpr int kRate = 60;  // ours: steps a second, of four stretches each

struct Box {
  double side, x, y, angle;
};
struct Scene {
  std::string name;
  std::vector<Box> boxes;
  double wide = 0;  // half the room's width, m; 0: no walls but the floor
  double friction = 0.6;
};
struct Result {
  std::vector<double> ms;  // of each sixtieth
  double penetration = 0;  // m
  double moved = 0;        // m

  double mean(double from = 0, double to = 1e9) const {
    double sum = 0;
    int count = 0;
    for (int i = int(60 * from); i < std::min(double(ms.size()), 60 * to); ++i) sum += ms[i], ++count;
    return count > 0 ? sum / count : 0;
  }
};

Scene pyramid(int base) {
  Scene scene{"pyramid of base " + std::to_string(base), {}, 0};
  for (int row = 0; row < base; ++row) {
    for (int i = 0; i < base - row; ++i) scene.boxes.push_back({1, 1.125 * (i + 0.5 * row), 0.5 + row, 0});
  }
  return scene;
}

Scene dropped(int count) {
  Scene scene{std::to_string(count) + " boxes dropped", {}, 20};
  for (int i = 0; i < count; ++i)
    scene.boxes.push_back(
        {0.5, -18 + 0.9 * (i % 40) + 0.1 * ((i / 40) % 3), 1 + 0.9 * (i / 40), 0.1 * (i % 7)});
  return scene;
}

// processor time of this thread, ms
double spent() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * double(now.tv_sec) + 1e-6 * double(now.tv_nsec);
}

// times each sixtieth of `seconds`
template <class Step>
std::vector<double> timed(double seconds, Step&& step) {
  std::vector<double> ms;
  for (int i = 0; i < std::lround(60 * seconds); ++i) {
    const double begun = spent();
    step();
    ms.push_back(spent() - begun);
  }
  return ms;
}

Result ours(const Scene& scene, double seconds, int rate, bool awake) {
  namespace sim = obscura::sim;
  sim::World<2> world;
  world.model.rate = {rate, 1}, world.model.scale = 10;
  const auto wall = [&](Vec<2> point, Vec<2> normal) {
    world.model.walls.push_back({point, normal, {}, scene.friction});
  };
  wall({0, 0}, {0, 1});
  if (scene.wide > 0) wall({-scene.wide, 0}, {1, 0}), wall({scene.wide, 0}, {-1, 0});
  for (const Box& box : scene.boxes) {
    sim::Body<2> body;
    body.shape = sim::Box<2>{Vec<2>::Constant(box.side / 2)};
    body.mass = box.side * box.side, body.inertia = sim::inertia(body.shape, body.mass);
    body.friction = scene.friction, body.elasticity = 0;
    world.model.bodies.push_back(body);
    world.state.x.push_back({box.x, box.y}), world.state.v.push_back({0, 0});
    world.state.turn.push_back(sim::Orientation<2>(box.angle)),
        world.state.spin.push_back(sim::AngularVec<2>(0.0));
  }
  const std::vector<sim::Path<2>> paths;
  sim::PlaneIterative solver(world.model, paths);
  Result result;
  int sixtieths = 0;
  result.ms = timed(seconds, [&] {
    for (++sixtieths; 60 * world.state.step < std::int64_t(rate) * sixtieths; ++world.state.step) {
      solver.step(world.state, double(world.state.step) / rate, 1.0 / rate);
      if (awake) std::fill(world.state.quiet.begin(), world.state.quiet.end(), 0);
    }
  });
  for (const auto& contact : world.state.contacts)
    result.penetration = std::max(result.penetration, -contact.gap);
  for (std::size_t i = 0; i < scene.boxes.size(); ++i)
    result.moved = std::max(result.moved, std::hypot(world.state.x[i][0] - scene.boxes[i].x,
                                                     world.state.x[i][1] - scene.boxes[i].y));
  return result;
}

Result box2d(const Scene& scene, double seconds, bool awake) {
  b2World world({0, -9.81f});
  world.SetAllowSleeping(!awake);
  const b2BodyDef still;
  b2Body* ground = world.CreateBody(&still);
  const auto wall = [&](b2Vec2 from, b2Vec2 to) {
    b2EdgeShape edge;
    edge.SetTwoSided(from, to);
    b2FixtureDef fixture;
    fixture.shape = &edge, fixture.friction = float(scene.friction);
    ground->CreateFixture(&fixture);
  };
  const float wide = float(scene.wide);
  wall({-1000, 0}, {1000, 0});
  if (wide > 0) wall({-wide, 0}, {-wide, 1000}), wall({wide, 0}, {wide, 1000});
  std::vector<b2Body*> bodies;
  for (const Box& box : scene.boxes) {
    b2BodyDef body;
    body.type = b2_dynamicBody, body.angle = float(box.angle);
    body.position.Set(float(box.x), float(box.y));
    b2PolygonShape shape;
    shape.SetAsBox(float(box.side / 2), float(box.side / 2));
    b2FixtureDef fixture;
    fixture.shape = &shape, fixture.density = 1, fixture.friction = float(scene.friction);
    bodies.push_back(world.CreateBody(&body));
    bodies.back()->CreateFixture(&fixture);
  }
  Result result;
  result.ms = timed(seconds, [&] { world.Step(1 / 60.0f, 8, 3); });
  for (b2Contact* contact = world.GetContactList(); contact; contact = contact->GetNext()) {
    if (!contact->IsTouching()) continue;
    b2WorldManifold manifold;
    contact->GetWorldManifold(&manifold);
    for (int k = 0; k < contact->GetManifold()->pointCount; ++k)
      result.penetration = std::max(result.penetration, -double(manifold.separations[k]));
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const b2Vec2 at = bodies[i]->GetPosition();
    result.moved = std::max(result.moved, std::hypot(at.x - scene.boxes[i].x, at.y - scene.boxes[i].y));
  }
  return result;
}

Result chipmunk(const Scene& scene, double seconds) {
  cpSpace* space = cpSpaceNew();
  cpSpaceSetGravity(space, cpv(0, -9.81));
  cpBody* ground = cpSpaceGetStaticBody(space);
  const double friction = std::sqrt(scene.friction);  // a pair has the product
  std::vector<cpShape*> shapes;
  const auto wall = [&](cpVect from, cpVect to) { shapes.push_back(cpSegmentShapeNew(ground, from, to, 0)); };
  wall(cpv(-1000, 0), cpv(1000, 0));
  if (scene.wide > 0) {
    wall(cpv(-scene.wide, 0), cpv(-scene.wide, 1000));
    wall(cpv(scene.wide, 0), cpv(scene.wide, 1000));
  }
  std::vector<cpBody*> bodies;
  for (const Box& box : scene.boxes) {
    const double mass = box.side * box.side;
    bodies.push_back(cpBodyNew(mass, cpMomentForBox(mass, box.side, box.side)));
    cpBodySetPosition(bodies.back(), cpv(box.x, box.y)), cpBodySetAngle(bodies.back(), box.angle);
    cpSpaceAddBody(space, bodies.back());
    shapes.push_back(cpBoxShapeNew(bodies.back(), box.side, box.side, 0));
  }
  for (cpShape* shape : shapes) cpShapeSetFriction(shape, friction), cpSpaceAddShape(space, shape);
  Result result;
  result.ms = timed(seconds, [&] { cpSpaceStep(space, 1 / 60.0); });
  const auto deepest = [](cpBody*, cpArbiter* touch, void* out) {
    double& deep = *static_cast<double*>(out);
    for (int k = 0; k < cpArbiterGetCount(touch); ++k) deep = std::max(deep, -cpArbiterGetDepth(touch, k));
  };
  for (cpBody* body : bodies) cpBodyEachArbiter(body, deepest, &result.penetration);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const cpVect at = cpBodyGetPosition(bodies[i]);
    result.moved = std::max(result.moved, std::hypot(at.x - scene.boxes[i].x, at.y - scene.boxes[i].y));
  }
  for (cpShape* shape : shapes) cpSpaceRemoveShape(space, shape), cpShapeFree(shape);
  for (cpBody* body : bodies) cpSpaceRemoveBody(space, body), cpBodyFree(body);
  cpSpaceFree(space);
  return result;
}

}  // namespace

// piles [SECONDS [ROUNDS [PILE [RATE]]]]: with a rate only ours, at that many steps a second
int main(int count, char** words) {
  const double seconds = count > 1 ? std::atof(words[1]) : 8;
  const int rounds = count > 2 ? std::atoi(words[2]) : 3, only = count > 3 ? std::atoi(words[3]) : -1;
  const int rate = count > 4 ? std::atoi(words[4]) : 0;
  std::printf("%-22s %-16s %8s %8s %8s %8s %12s %8s %8s %8s\n", "pile, ms a sixtieth", "", "all", "1st s",
              "to 3 s", "rest", "penetration", "moved", "ratio", "median");
  int number = 0;
  for (const Scene& scene : {pyramid(100), dropped(2000)}) {
    if (only >= 0 && number++ != only) continue;
    const auto run = [&](int who) {
      switch (who) {
        case 0:
          return ours(scene, seconds, rate > 0 ? rate : kRate, true);
        case 1:
          return box2d(scene, seconds, true);
        case 2:
          return chipmunk(scene, seconds);
        case 3:
          return ours(scene, seconds, kRate, false);
        default:
          return box2d(scene, seconds, false);
      }
    };
    std::vector<Result> best(rate > 0 ? 1 : 5);
    std::vector<std::vector<double>> ratios(best.size());
    for (int round = 0; round < rounds; ++round) {
      double us = 0;
      for (int who = 0; who < int(best.size()); ++who) {
        const Result result = run(who);
        if (who == 0) us = result.mean();
        ratios[who].push_back(result.mean() / us);
        std::vector<double> least = round == 0 ? result.ms : best[who].ms;
        for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], result.ms[i]);
        best[who] = result, best[who].ms = least;
      }
    }
    for (int who = 0; who < int(best.size()); ++who) {
      const Result& r = best[who];
      std::sort(ratios[who].begin(), ratios[who].end());
      const char* const names[] = {"ours", "Box2D", "Chipmunk", "ours, may rest", "Box2D, may sleep"};
      std::printf("%-22s %-16s %8.2f %8.2f %8.2f %8.2f %12.2g %8.2g %8.2f %8.2f\n", scene.name.c_str(),
                  names[who], r.mean(), r.mean(0, 1), r.mean(1, 3), r.mean(3), r.penetration, r.moved,
                  r.mean() / best[0].mean(), ratios[who][ratios[who].size() / 2]);
    }
  }
}
