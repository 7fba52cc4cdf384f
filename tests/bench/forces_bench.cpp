// 10,000 particles under a force that was written as text, against the same under gravity alone, in both
// modes that serve so many: the bar is 3. And 1,000 bodies that attract each other, against a plain double
// loop with the same scheme: 1.5.

#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <variant>
#include <vector>

#include "sim/force/formula.h"
#include "sim/step/stepper.h"

namespace {

using obscura::sim::Vec;
using obscura::sim::World;

constexpr int kMany = 10000, kMasses = 1000;
constexpr double kStep = 1.0 / 600;

obscura::sim::Subject<2> subject(int body) {
  obscura::sim::Subject<2> made;
  made.body = body;
  return made;
}

// scattered without walls, so that nothing but the force differs
World<2> dust(int many, obscura::sim::Collision collision) {
  World<2> world;
  world.model.collision = collision;
  world.model.scale = 100;
  for (int i = 0; i < many; ++i) {
    world.model.bodies.emplace_back();
    world.state.x.push_back({0.01 * i, std::sin(i)}), world.state.v.push_back({std::cos(i), std::sin(2 * i)});
  }
  return world;
}

void run(benchmark::State& state, World<2>& world, int many) {
  obscura::sim::Stepper<2> stepper(world.model);
  stepper.begin(world.state);
  for (auto _ : state) {
    if (stepper.step(world.state)) state.SkipWithError("trouble");
  }
  state.counters["ns a body and step"] = benchmark::Counter(
      double(many), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void gravity(benchmark::State& state, obscura::sim::Collision collision) {
  World<2> world = dust(kMany, collision);
  run(state, world, kMany);
}

// the example of the language: drag with the square of the speed
void text(benchmark::State& state, obscura::sim::Collision collision) {
  World<2> world = dust(kMany, collision);
  obscura::sim::Force<2> force;
  auto made =
      obscura::sim::force_formula<2>({.potential = "", .components = {"-0.3*vx*speed", "-0.3*vy*speed"}}, {});
  force.formula = std::make_shared<obscura::sim::ForceFormula>(std::get<obscura::sim::ForceFormula>(made));
  for (int i = 0; i < kMany; ++i) force.subjects.push_back(subject(i));
  world.model.forces.push_back(force);
  run(state, world, kMany);
}

BENCHMARK_CAPTURE(gravity, handout, obscura::sim::Collision::handout);
BENCHMARK_CAPTURE(text, handout, obscura::sim::Collision::handout);
BENCHMARK_CAPTURE(gravity, contact, obscura::sim::Collision::contact);
BENCHMARK_CAPTURE(text, contact, obscura::sim::Collision::contact);

void attraction(benchmark::State& state) {
  World<2> world = dust(kMasses, obscura::sim::Collision::handout);
  obscura::sim::Force<2> force;
  force.on = obscura::sim::Force<2>::On::among, force.law = obscura::sim::Force<2>::Law::gravitation;
  force.strength = 1e-6, force.softening = 0.01;
  for (int i = 0; i < kMasses; ++i) force.subjects.push_back(subject(i));
  world.model.forces.push_back(force);
  run(state, world, kMasses);
}
BENCHMARK(attraction);

// by hand: classical Runge-Kutta, and each pair once in two loops
struct Plain {
  std::vector<Vec<2>> x, v;

  void accelerations(const std::vector<Vec<2>>& at, std::vector<Vec<2>>& a) const {
    a.assign(at.size(), Vec<2>(0, -9.81));
    for (std::size_t i = 0; i < at.size(); ++i) {
      for (std::size_t j = i + 1; j < at.size(); ++j) {
        const double dx = at[j][0] - at[i][0], dy = at[j][1] - at[i][1];
        const double r2 = dx * dx + dy * dy + 1e-4, k = 1e-6 / (r2 * std::sqrt(r2));
        a[i][0] += k * dx, a[i][1] += k * dy;
        a[j][0] -= k * dx, a[j][1] -= k * dy;
      }
    }
  }
  void step() {
    const std::size_t n = x.size();
    std::vector<Vec<2>> k[4], u[4], at = x;
    u[0] = v;
    for (int stage = 0; stage < 4; ++stage) {
      accelerations(at, k[stage]);
      if (stage == 3) break;
      const double h = stage == 2 ? kStep : 0.5 * kStep;
      u[stage + 1] = v;
      for (std::size_t i = 0; i < n; ++i) at[i] = x[i] + h * u[stage][i], u[stage + 1][i] += h * k[stage][i];
    }
    for (std::size_t i = 0; i < n; ++i) {
      x[i] += kStep / 6 * (u[0][i] + 2 * (u[1][i] + u[2][i]) + u[3][i]);
      v[i] += kStep / 6 * (k[0][i] + 2 * (k[1][i] + k[2][i]) + k[3][i]);
    }
  }
};

void double_loop(benchmark::State& state) {
  const World<2> world = dust(kMasses, obscura::sim::Collision::handout);
  Plain plain{world.state.x, world.state.v};
  for (auto _ : state) plain.step();
  benchmark::DoNotOptimize(plain.x[0][0]);
  state.counters["ns a body and step"] = benchmark::Counter(
      double(kMasses), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(double_loop);

}  // namespace
