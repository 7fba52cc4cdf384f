// What a film takes, by what films took on machines like ours (1080p, two cores), in bytes and ns a pixel:
//                    disk    drawing and encoding
//   movie            0.0016  6
//   picture          0.07    12
//   in space         the same, and 8 more
// A worker has three layers of its picture, what was read back, and the encoder's: 60 bytes a pixel at most.

#include "app/needs.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include <fmt/format.h>

#include "app/film.h"
#include "app/memory.h"
#include "media/error.h"

namespace obscura::app {

namespace {

constexpr double kProgram = 120e6;      // bytes: Mesa, LLVM, the encoder
constexpr double kWorker = 20e6;        // a context and its programs
constexpr double kPixel = 60;           // bytes a pixel of one worker
constexpr double kTrackPoint = 2 * 32;  // bytes, with what a growing vector has to spare
constexpr double kTrackRate = 120;      // points a second, as in sim/run.cpp
constexpr double kOpen = 2 << 20;       // bytes a frame while its shutter is open, as in simulation.cpp

double size_of(const sim::Snapshot& moment) {
  return double(sizeof(sim::Snapshot) + moment.bodies.size() * sizeof(sim::Snapshot::Body) +
                moment.springs.size() * sizeof(sim::Snapshot::Spring) +
                moment.joints.size() * sizeof(sim::Snapshot::Joint) +
                moment.contacts.size() * sizeof(sim::Snapshot::Contact));
}

// what a run is made of, as large as it is in memory: the world twice, and what the solvers keep
template <int D>
double size_of(const sim::World<D>& world) {
  const sim::Model<D>& model = world.model;
  return 3.0 *
         double(model.bodies.size() * (sizeof(sim::Body<D>) + 64 * D) +
                model.springs.size() * sizeof(sim::Spring<D>) + model.joints.size() * sizeof(sim::Joint<D>));
}

struct Measured {
  double step = 0;    // s
  double moment = 0;  // bytes of an instant
};

// the first steps, as many as there is patience for
Measured measure(const scene::Scene& scene, std::int64_t steps, double patience) {
  using Clock = std::chrono::steady_clock;
  const auto run = scene.run();
  Measured found;
  const auto start = run->at({0, 1});
  if (const auto* now = std::get_if<sim::Snapshot>(&start)) found.moment = size_of(*now);
  if (scene.trajectory) return found;
  const Clock::time_point began = Clock::now();
  const auto since = [&] { return std::chrono::duration<double>(Clock::now() - began).count(); };
  std::int64_t done = 0;
  run->heed([&] { return done > 0 && since() > patience; });
  for (std::int64_t stride = 1; done < steps && since() < patience; stride *= 2) {
    const std::int64_t to = std::min(done + stride, steps);
    const auto moment = run->at(sim::rational(to) / run->rate());
    const auto* now = std::get_if<sim::Snapshot>(&moment);
    if (!now) break;
    done = to;
    found.step = since() / double(done);
    found.moment = std::max(found.moment, size_of(*now));
  }
  return found;
}

}  // namespace

double Needs::seconds(int workers) const { return std::max(simulate, (simulate + draw) / workers); }

Needs needs(const scene::Scene& scene, const Shots& shots, Output::Form form, double patience) {
  Needs all;
  all.frames = shots.size();
  if (all.frames == 0) return all;
  const bool movie = form == Output::Form::movie, space = scene.dimension() == 3;
  const double pixels = double(scene.film.width) * scene.film.height;

  // the run, up to the last instant that is shown
  const sim::Rational end = shots[shots.size() - 1].time;
  const sim::Rational rate = std::visit([](const auto& world) { return world.model.rate; }, scene.world);
  const double steps = sim::value(end) * sim::value(rate);
  const Measured run = measure(scene, std::int64_t(std::min(steps, 1e15)), patience);
  // charts are of the whole run, which is made once more for them
  const double charts = scene.film.charts.empty() ? 0 : sim::value(scene.duration) * sim::value(rate);
  all.simulate = run.step * (steps + charts);

  const double moments = scene.film.shutter > 0 ? 8 : 1;
  all.draw = double(all.frames) * moments *
             (pixels * 1e-9 * ((movie ? 6 : 12) + (space ? 8 : 0)) + 1e-6 * (run.moment / 200));
  all.disk = form == Output::Form::pipe ? 0 : double(all.frames) * pixels * (movie ? 0.0016 : 0.07);

  // in memory: a take for each worker and two more, the pictures of each worker, the ways that trails need
  const double of_take = double(std::min<std::int64_t>(take_frames(form, movie_spec(scene)), all.frames)) *
                         (run.moment + (scene.film.shutter > 0 ? kOpen : 0));
  double trails = 0;
  for (const draw::BodyLook& look : scene.look.bodies)
    trails += std::min(look.trail, sim::value(end)) * kTrackRate * kTrackPoint;
  const double world = std::visit([](const auto& it) { return size_of(it); }, scene.world);
  all.fixed = kProgram + world + trails + 2 * of_take;
  all.worker = kWorker + kPixel * pixels + of_take;
  return all;
}

void refuse_beyond_memory(const scene::Scene& scene, double bytes) {
  if (bytes <= memory_limit()) return;
  throw media::Error(fmt::format("{}: needs about {} of memory, and may have {} (--memory-limit)", scene.file,
                                 bytes_text(bytes), bytes_text(memory_limit())));
}

int fitting_workers(const scene::Scene& scene, const Needs& needs, int workers) {
  if (workers <= 0) workers = std::max(1, int(std::thread::hardware_concurrency()));
  refuse_beyond_memory(scene, needs.memory(1));
  while (needs.memory(workers) > memory_limit()) --workers;
  return workers;
}

std::string time_text(double seconds) {
  if (seconds < 100) return fmt::format("{:.{}f} s", seconds, seconds < 10 ? 1 : 0);
  if (seconds < 100 * 60) return fmt::format("{:.0f} min", seconds / 60);
  if (seconds < 48 * 3600) return fmt::format("{:.0f} h", seconds / 3600);
  if (seconds < 1000.0 * 24 * 3600) return fmt::format("{:.0f} days", seconds / 24 / 3600);
  return fmt::format("{:.0f} years", seconds / 24 / 3600 / 365.25);
}

}  // namespace obscura::app
