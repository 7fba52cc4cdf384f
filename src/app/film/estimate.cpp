// Estimates for a film, fitted to the shipped scenes, from drafts to 4k, in bytes and ns:
//   disk, a movie    u (90 H a second, of space half as much again, + 9.3 L^0.63 a frame)
//         a GIF      0.08 (space 0.25) a pixel once a second, + 22 L^0.63 a frame
//         pictures   0.058 a pixel, + 3.5 a px of outlines; space 0.062 a pixel, + 93 H, + 2 a px of outlines
//                      H  lines of the picture
//                      L  px of outlines of bodies and springs, times the px that they move from frame to
//                         frame, 20 at most: the pixels that are encoded anew
//                         and, where cameras move in space, of the lines of its ground, times the px that
//                         the picture moves
//                      u  2 of the quickest presets, times 2^((18 - crf) / 6)
//   drawing          9 a pixel (quick presets 5, GIF 20, pictures 12); space 20 (GIF 25) and 6 ms a frame;
//                    and 0.3 s to begin with
// on a processor that takes kReference for a loop of known work; others are as much slower or faster.
// A worker keeps three layers of its picture, a copy of the pixels, and the encoder's: 60 bytes a pixel at
// most.

#include "app/film/estimate.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "app/console/interrupt.h"
#include "app/console/memory.h"
#include "app/film/film.h"
#include "app/run/compared.h"
#include "media/error.h"
#include "sim/shape/shape.h"

namespace obscura::app {

namespace {

constexpr double kProgram = 120e6;      // bytes: Mesa, LLVM, the encoder
constexpr double kWorker = 20e6;        // a context and its programs
constexpr double kPixel = 60;           // bytes a pixel of one worker
constexpr double kTrackPoint = 2 * 32;  // bytes, with what a growing vector has to spare
constexpr double kTrackRate = 120;      // points a second, as in sim/step/run.cpp
constexpr double kOpen = 2 << 20;       // bytes a frame while its shutter is open, as in simulation.cpp

double size_of(const sim::Snapshot& moment) {
  return double(sizeof(sim::Snapshot) + moment.bodies.size() * sizeof(sim::Snapshot::Body) +
                moment.springs.size() * sizeof(sim::Snapshot::Spring) +
                moment.joints.size() * sizeof(sim::Snapshot::Joint) +
                moment.contacts.size() * sizeof(sim::Snapshot::Contact));
}

// the memory of a run: the world twice, and the data that the solvers keep
template <int D>
double size_of(const sim::World<D>& world) {
  const sim::Model<D>& model = world.model;
  return 3.0 *
         double(model.bodies.size() * (sizeof(sim::Body<D>) + 64 * D) +
                model.springs.size() * sizeof(sim::Spring<D>) + model.joints.size() * sizeof(sim::Joint<D>));
}

struct Measured {
  double step = 0;      // s
  double moment = 0;    // bytes of an instant
  double outlines = 0;  // px of outlines, all
  double moving = 0;    // px of outlines times px that they move from one frame to the next, mean
};

// The outlines of a scene's bodies and springs on the picture, and how far they move from frame to frame.
class Outlines {
 public:
  explicit Outlines(const scene::Scene& scene) : fps_(sim::value(scene.film.fps)) {
    const sim::Vec3 size = scene.extent.high - scene.extent.low;
    scale_ =
        std::min(scene.film.width / std::max(size.x(), 1e-9), scene.film.height / std::max(size.y(), 1e-9));
    const auto add = [&](const auto& world) {
      for (const auto& body : world.model.bodies)
        reach_.push_back(std::max(sim::bounding_radius(body.shape), kSmallest / scale_));
    };
    std::visit(add, scene.world);
  }

  double all() const {
    double sum = 0;
    for (const double reach : reach_) sum += 6 * reach * scale_;
    return sum;
  }

  double moving(const sim::Snapshot& now) const {
    const auto speed = [&](int body) {  // px a frame
      if (body < 0 || std::size_t(body) >= reach_.size()) return 0.0;
      const sim::Snapshot::Body& it = now.bodies[std::size_t(body)];
      const double fastest = it.velocity.norm() + it.spin.norm() * reach_[std::size_t(body)];
      return std::min(kFarthest, fastest * scale_ / fps_);
    };
    double sum = 0;
    for (int i = 0; i < int(now.bodies.size()); ++i) sum += 6 * reach_[std::size_t(i)] * scale_ * speed(i);
    for (const sim::Snapshot::Spring& spring : now.springs)
      if (!spring.loose)
        sum += (spring.b - spring.a).norm() * scale_ * std::max(speed(spring.holds_a), speed(spring.holds_b));
    return sum;
  }

 private:
  static constexpr double kSmallest = 3, kFarthest = 20;  // px

  double fps_, scale_ = 1;     // px a metre
  std::vector<double> reach_;  // m, one a body
};

// How far the moves of a camera carry the lines of a ground until `end` (s), px at a place half way to the
// edge, times how many more lines, and how much closer, it shows than at first. Moves sideways cost little:
// encoders foresee them.
double carried(const draw::Camera& camera, double width, double end) {
  const double out = width / 4;
  double sum = std::fabs(camera.orbit) * end * out;
  for (std::size_t i = 1; i < camera.keys.size(); ++i) {
    const draw::CameraKey &a = camera.keys[i - 1], &b = camera.keys[i];
    const double part = std::clamp((end - a.time) / std::max(b.time - a.time, 1e-9), 0.0, 1.0);
    double more = 1;
    if (a.width && b.width && camera.keys[0].width) {
      more = *a.width * *b.width / std::pow(*camera.keys[0].width, 2);
      sum += part * more * out * std::fabs(std::log(*b.width / *a.width));
    }
    if (a.azimuth && b.azimuth) sum += part * more * out * std::fabs(*b.azimuth - *a.azimuth);
  }
  return sum;
}

// Px of the ground's lines times the px that cameras move them from one frame to the next, mean, in so many
// frames that show the run until `end` (s).
double moving_ground(const scene::Scene& scene, double end, double frames) {
  constexpr double kLines = 50;  // widths of a picture: the length of a ground's lines
  if (scene.dimension() != 3 || !scene.look.ground) return 0;
  const double width = scene.film.width / double(scene.cameras.size());
  double sum = 0;
  for (const draw::Camera& camera : scene.cameras) sum += carried(camera, width, end) / frames;
  return kLines * width * sum;
}

// The processor time of this thread, s: the time that other programs take does not count.
double own_time() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

// this processor's time over that of the processor on which the model was measured
double slowness() {
  constexpr double kReference = 0.4e-3;  // s
  static const double found = [] {
    std::vector<float> pixels(1 << 16, 0.5f);
    double least = 1e300;
    for (int round = 0; round < 8; ++round) {
      const double began = own_time();
      for (int pass = 0; pass < 16; ++pass)
        for (float& pixel : pixels) pixel = pixel * 0.999f + 0.001f * float(pass);
      volatile float kept = pixels[std::size_t(round)];
      (void)kept;
      least = std::min(least, own_time() - began);
    }
    return std::clamp(least / kReference, 0.1, 20.0);
  }();
  return found;
}

// the first steps, as many as there is patience for
Measured measure(const scene::Scene& scene, std::int64_t steps, double patience) {
  const Outlines outlines(scene);
  const auto run = scene.run();
  Measured found;
  found.outlines = outlines.all();
  const auto start = run->at({0, 1});
  if (const auto* now = std::get_if<sim::Snapshot>(&start)) found.moment = size_of(*now);
  if (scene.trajectory) return found;
  const double began = own_time();
  const auto since = [&] { return own_time() - began; };
  std::int64_t done = 0;
  double moved = 0;
  run->heed([&] { return interrupted() || (done > 0 && since() > patience); });
  const std::int64_t longest = std::max<std::int64_t>(1, steps / 64);
  for (std::int64_t stride = 1; done < steps && since() < patience; stride = std::min(2 * stride, longest)) {
    const std::int64_t to = std::min(done + stride, steps);
    const auto moment = run->at(sim::rational(to) / run->rate());
    const auto* now = std::get_if<sim::Snapshot>(&moment);
    if (!now) break;
    moved += outlines.moving(*now) * double(to - done);
    done = to;
    found.step = since() / double(done);
    found.moment = std::max(found.moment, size_of(*now));
    found.moving = moved / double(done);
  }
  return found;
}

// the properties of an output on which the estimates depend
struct Kind {
  bool movie = false, gif = false, pipe = false, quick = false, space = false;

  Kind(const scene::Scene& scene, const Output& output)
      : movie(output.form == Output::Form::movie),
        gif(movie && output.path.ends_with(".gif")),
        pipe(output.form == Output::Form::pipe),
        quick(movie && (scene.film.preset == "ultrafast" || scene.film.preset == "superfast")),
        space(scene.dimension() == 3) {}
};

double disk(const Kind& kind, const scene::Film& film, double frames, const Measured& run) {
  const double pixels = double(film.width) * film.height, seconds = frames / sim::value(film.fps);
  const double anew = std::pow(run.moving, 0.63);
  if (kind.pipe) return 0;
  if (kind.gif) return std::max(seconds, 1.0) * pixels * (kind.space ? 0.25 : 0.08) + frames * 22 * anew;
  if (!kind.movie)
    return frames * (kind.space ? 0.062 * pixels + 93 * film.height + 2 * run.outlines
                                : 0.058 * pixels + 3.5 * run.outlines);
  const double quality = (kind.quick ? 2 : 1) * std::exp2((18 - film.crf.value_or(18)) / 6);
  return quality * (std::max(seconds, 1.0) * 90 * film.height * (kind.space ? 1.5 : 1) + frames * 9.3 * anew);
}

// s of drawing and encoding a picture
double drawing(const Kind& kind, const scene::Film& film, const Measured& run) {
  double nanoseconds = kind.gif ? 20 : kind.quick ? 5 : kind.movie ? 9 : 12;
  if (kind.space) nanoseconds = kind.gif ? 25 : 20;
  return 1e-9 * nanoseconds * film.width * film.height + (kind.space ? 6e-3 : 0) + 1e-6 * (run.moment / 200);
}

}  // namespace

double Needs::seconds(int workers) const { return begin + std::max(simulate, (simulate + draw) / workers); }

Needs needs(const scene::Scene& scene, const Shots& shots, const Output& output, double patience) {
  Needs all;
  all.frames = shots.size();
  if (all.frames == 0) return all;
  const Kind kind(scene, output);
  const double pixels = double(scene.film.width) * scene.film.height;

  // the run, up to the last instant that is shown
  const sim::Rational end = shots[shots.size() - 1].time;
  const sim::Rational rate = std::visit([](const auto& world) { return world.model.rate; }, scene.world);
  const double steps = sim::value(end) * sim::value(rate);
  Measured run = measure(scene, std::int64_t(std::min(steps, 1e15)), patience);
  run.moving += moving_ground(scene, sim::value(end), double(all.frames));
  // charts and marks are of the whole run, which is made once more for them
  const bool ahead = !scene.film.charts.empty() || !scene.film.marks.empty();
  const double charts = !ahead ? 0 : sim::value(scene.duration) * sim::value(rate);
  const double runs = double(runs_of(scene));
  all.simulate = runs * run.step * (steps + charts);

  const double moments = scene.film.shutter > 0 ? 8 : 1;
  all.begin = 0.3 * slowness();
  all.draw = slowness() * double(all.frames) * moments * drawing(kind, scene.film, run);
  all.disk = disk(kind, scene.film, double(all.frames), run);

  // in memory: a take for each worker and two more, the pictures of each worker, the ways that trails need
  const double of_take =
      double(std::min<std::int64_t>(take_frames(output.form, movie_spec(scene)), all.frames)) * runs *
      (run.moment + (scene.film.shutter > 0 ? kOpen : 0));
  double trails = 0;
  for (const draw::BodyLook& look : scene.look.bodies)
    trails += std::min(look.trail, sim::value(end)) * kTrackRate * kTrackPoint;
  const double world = std::visit([](const auto& it) { return size_of(it); }, scene.world);
  all.fixed = kProgram + runs * (world + trails) + 2 * of_take;
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
