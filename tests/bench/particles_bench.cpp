// 100,000 particles in a room: sim's step against a plain structure-of-arrays loop that does the same
// arithmetic. Prints both and the ratio of their times; the aim is 2, the bar 3.

#include <benchmark/benchmark.h>

#include <cstdint>
#include <ctime>
#include <vector>

#include "sim/step/stepper.h"

namespace {

using obscura::sim::Vec;

constexpr int kMany = 100000;
constexpr double kWide = 40, kHigh = 22.5, kElasticity = 0.9, kGravity = -9.81, kStep = 1.0 / 600;

// a number in 0 .. 1 for particle i
double scattered(int i, int salt) {
  std::uint64_t bits =
      (std::uint64_t(i) * 2654435761u + std::uint64_t(salt) * 40503u + 1) * 6364136223846793005u;
  bits ^= bits >> 29;
  return double((bits * 1442695040888963407u) >> 11) / 9007199254740992.0;
}
Vec<2> place(int i) { return {kWide * scattered(i, 1), kHigh * scattered(i, 2)}; }
Vec<2> speed(int i) { return {10 * scattered(i, 3) - 5, 10 * scattered(i, 4) - 5}; }

obscura::sim::World<2> room() {
  obscura::sim::World<2> world;
  world.model.scale = kHigh;
  world.model.walls = {
      {{0, 0}, {0, 1}, {}}, {{0, kHigh}, {0, -1}, {}}, {{0, 0}, {1, 0}, {}}, {{kWide, 0}, {-1, 0}, {}}};
  for (int i = 0; i < kMany; ++i) {
    obscura::sim::Body<2> body;
    body.elasticity = kElasticity;
    world.model.bodies.push_back(body);
    world.state.x.push_back(place(i)), world.state.v.push_back(speed(i));
  }
  return world;
}

// by hand: x, y, vx, vy in arrays, all stages of a particle in registers
struct Plain {
  struct Wall {
    double px, py, nx, ny;
  };
  std::vector<double> x, y, vx, vy;
  std::vector<Wall> walls = {{0, 0, 0, 1}, {0, kHigh, 0, -1}, {0, 0, 1, 0}, {kWide, 0, -1, 0}};
  double g = kGravity, h = kStep;

  Plain() {
    for (int i = 0; i < kMany; ++i) {
      x.push_back(place(i)[0]), y.push_back(place(i)[1]), vx.push_back(speed(i)[0]),
          vy.push_back(speed(i)[1]);
    }
  }

  static double sum(double k1, double k2, double k3, double k4, double h) {
    return h * (k1 + 2 * (k2 + k3) + k4) / 6;
  }

  void step() {
    for (int i = 0; i < kMany; ++i) {
      const double u = vx[i], v = vy[i];
      const double v2 = v + 0.5 * h * g, v3 = v + 0.5 * h * g, v4 = v + h * g;
      x[i] += sum(u, u, u, u, h);
      y[i] += sum(v, v2, v3, v4, h);
      vy[i] += sum(g, g, g, g, h);
      for (const Wall& w : walls) {
        const double distance = (x[i] - w.px) * w.nx + (y[i] - w.py) * w.ny;
        if (!(distance < 0)) continue;
        const double vn = vx[i] * w.nx + vy[i] * w.ny;
        if (!(vn < 0)) continue;
        x[i] -= distance * w.nx, y[i] -= distance * w.ny;
        vx[i] -= (1 + kElasticity) * vn * w.nx, vy[i] -= (1 + kElasticity) * vn * w.ny;
      }
    }
  }
};

void plain_loop(benchmark::State& state) {
  Plain plain;
  for (auto _ : state) plain.step();
  state.counters["ns/particle"] = benchmark::Counter(
      double(state.iterations()) * kMany * 1e-9, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void room_step(benchmark::State& state) {
  const auto world = room();
  obscura::sim::Stepper<2> stepper(world.model);
  auto at = world.state;
  stepper.begin(at);
  for (auto _ : state) {
    if (stepper.step(at)) state.SkipWithError("trouble");
  }
  state.counters["ns/particle"] = benchmark::Counter(
      double(state.iterations()) * kMany * 1e-9, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// processor time of this thread, s
double spent() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

// both in turn, so that a busy machine slows them alike
void room_against_plain(benchmark::State& state) {
  Plain plain;
  const auto world = room();
  obscura::sim::Stepper<2> stepper(world.model);
  auto at = world.state;
  stepper.begin(at);
  double ours = 0, theirs = 0;
  for (auto _ : state) {
    const double begun = spent();
    plain.step();
    const double between = spent();
    if (stepper.step(at)) state.SkipWithError("trouble");
    theirs += between - begun, ours += spent() - between;
  }
  state.counters["ratio"] = ours / theirs;
}

BENCHMARK(plain_loop)->Unit(benchmark::kMillisecond)->Iterations(600);
BENCHMARK(room_step)->Unit(benchmark::kMillisecond)->Iterations(600);
BENCHMARK(room_against_plain)->Unit(benchmark::kMillisecond)->Iterations(600);

}  // namespace

BENCHMARK_MAIN();
