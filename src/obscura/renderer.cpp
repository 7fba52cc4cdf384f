#include <unistd.h>

#include <atomic>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/console/interrupt.h"
#include "app/film/frame_renderer.h"
#include "app/run/ahead.h"
#include "app/run/origin.h"
#include "app/run/trouble.h"
#include "gl/context.h"
#include "media/file.h"
#include "media/png.h"
#include "obscura/inside.h"

namespace obscura {

struct Renderer::Inside {
  Inside(const Scene& scene, const FilmOptions& asked)
      : of(scene), film(filmed(scene, asked)), transparent(asked.transparent), ahead(app::ahead(film.scene)) {
    gl::ready(film.how.context);
    painter.emplace(film.scene, ahead, film.how.context);
  }

  Work work() { return {going, "this Renderer"}; }
  void refuse_fork() const {
    if (::getpid() != process)
      throw UsageError(
          "this Renderer was made before fork(): OpenGL does not outlive it; make one in the child");
  }

  Frame shown(const app::FilmSegment& take) {
    image = painter->print(take, 0, transparent);
    // a picture without alpha reads as opaque
    if (!transparent)
      for (std::size_t i = 3; i < image.pixels.size(); i += 4) image.pixels[i] = 255;
    return {image.width,         image.height,         image.pixels,
            take.shots[0].frame, take.moments[0].time, take.states[0]};
  }

  Frame at(sim::Rational t);

  Scene of;
  Filmed film;
  bool transparent;
  pid_t process = ::getpid();
  app::Ahead ahead;
  std::optional<app::FrameRenderer> painter;
  std::optional<app::Simulation> simulation;  // of next()
  std::vector<std::uint64_t> saved;           // where the last at() began, to go on from
  std::int64_t saved_step = 0;
  media::Image image;
  std::atomic<bool> going = false;
};

Renderer::Renderer(const Scene& scene, const FilmOptions& options)
    : inside_(guarded([&] { return std::make_unique<Inside>(scene, options); })) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer::~Renderer() {
  // the context of a parent is left to it
  if (inside_ && ::getpid() != inside_->process) (void)inside_.release();
}

Renderer::Inside& Renderer::inside() const { return held(inside_, "this Renderer"); }

int Renderer::width() const { return inside().film.scene.film.width; }
int Renderer::height() const { return inside().film.scene.film.height; }
double Renderer::fps() const { return sim::value(inside().film.scene.film.fps); }
std::string Renderer::fps_text() const { return sim::text(inside().film.scene.film.fps); }
std::int64_t Renderer::frames() const { return inside().film.shots.size(); }

std::optional<Frame> Renderer::next() {
  return guarded([&]() -> std::optional<Frame> {
    Inside& it = inside();
    it.refuse_fork();
    const Work here = it.work();
    if (!it.simulation)
      it.simulation.emplace(it.film.scene, it.film.shots, it.ahead,
                            app::SimulationOptions{.frames = 1, .hash_each = true});
    const auto take = it.simulation->next();
    if (it.simulation->trouble()) throw app::TroubleError(it.film.scene.file, *it.simulation->trouble(), "");
    if (!take) {
      if (app::interrupted()) throw app::Interrupted();
      return {};
    }
    return it.shown(*take);
  });
}

void Renderer::rewind() {
  const Work here = inside().work();
  inside().simulation.reset();
}

// from the state before the last one's, where that is not too late
Frame Renderer::Inside::at(sim::Rational t) {
  const app::Shots shots = app::Shots::still(t, film.scene.film.fps, film.scene.film.speed);
  app::SimulationOptions how{.frames = 1, .hash_each = true};
  how.nearer = [&](std::size_t run, std::int64_t since, std::int64_t until) -> std::unique_ptr<sim::Run> {
    if (run > 0 || ahead.runs || saved.empty() || saved_step <= since || saved_step > until) return {};
    return film.scene.shown_run(saved);
  };
  how.begin_take = [&](const std::vector<const sim::Run*>& runs) {
    saved = runs.front()->saved();
    saved_step = sim::floor(runs.front()->now() * runs.front()->rate());
  };
  app::Simulation one(film.scene, shots, ahead, how);
  const auto take = one.next();
  if (one.trouble()) throw app::TroubleError(film.scene.file, *one.trouble(), "");
  if (!take) throw app::Interrupted();
  return shown(*take);
}

Frame Renderer::at(double t) {
  return guarded([&] {
    inside().refuse_fork();
    const Work here = inside().work();
    return inside().at(exact(t, "t"));
  });
}

Frame Renderer::draw(const World& world) {
  return guarded([&] {
    Inside& it = inside();
    it.refuse_fork();
    const Work here = it.work();
    if (it.ahead.runs) throw UsageError("a film of several runs (film.vary) shows its own: next() or at()");
    const World::Inside& shown = world.inside();
    if (&shown.scene.inside() != &it.of.inside() && world.scene().hash() != it.of.hash())
      throw UsageError("this Renderer draws another scene than the world's");
    app::FilmSegment take;
    take.moments.push_back(shown.now());
    take.fates.push_back(app::fate(*shown.run));
    take.open.emplace_back();
    take.ways = shown.ways;
    const sim::Rational t = shown.run->now();
    take.shots.push_back(app::Shots::still(t, it.film.scene.film.fps, it.film.scene.film.speed)[0]);
    take.states.push_back(world.hash());
    return it.shown(take);
  });
}

std::vector<std::uint8_t> Renderer::take(std::vector<std::uint8_t> memory) {
  const Work here = inside().work();
  return std::exchange(inside().image.pixels, std::move(memory));
}

std::vector<std::uint8_t> png(const Frame& frame, bool transparent) {
  return guarded([&] {
    if (frame.width < 1 || frame.height < 1 ||
        frame.pixels.size() != std::size_t(4) * std::size_t(frame.width) * std::size_t(frame.height))
      throw UsageError(
          fmt::format("a frame of {}x{} with {} bytes", frame.width, frame.height, frame.pixels.size()));
    media::Image image{frame.width, frame.height, {frame.pixels.begin(), frame.pixels.end()}};
    return media::encode_png(image,
                             {.alpha = transparent, .tags = {{"Software", "obscura " OBSCURA_VERSION}}});
  });
}

void write_png(const std::string& path, const Frame& frame, bool transparent) {
  guarded([&] {
    media::File file(path);
    file.write(png(frame, transparent));
    file.place(false);
  });
}

}  // namespace obscura
