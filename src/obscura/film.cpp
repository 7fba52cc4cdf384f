// What a film's options leave of a scene, whole films, stills, pages, figures and sweeps.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <thread>

#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/figure/figure_builder.h"
#include "app/figure/figure_raster.h"
#include "app/film/film_page.h"
#include "app/film/ordered_pipeline.h"
#include "app/film/pages.h"
#include "app/run/measures.h"
#include "app/run/origin.h"
#include "app/run/run_marks.h"
#include "app/run/trouble.h"
#include "app/run/variation.h"
#include "obscura/inside.h"
#include "page/page.h"

namespace obscura {

namespace {

constexpr double kLitDpi = 300;
constexpr int kMostPixels = 16384;

void finish(int exit) {
  if (exit == app::kInterrupted) throw Interrupted("interrupted");
}

scene::Scene with(const FilmOptions& options, const Scene& of) {
  scene::Scene scene = app::with_run_marks(of.inside().scene);
  scene::Film& film = scene.film;
  for (const int side : {options.width, options.height})
    if (side < 0 || side > kMostPixels)
      throw UsageError(fmt::format("a picture of {} pixels is not between 1 and {}", side, kMostPixels));
  if (options.jobs < 0)
    throw UsageError(fmt::format("jobs {}: expected 0 (all cores) or more", options.jobs));
  if (options.width > 0) film.width = options.width;
  if (options.height > 0) film.height = options.height;
  if (!options.fps.empty()) {
    const auto fps = sim::parse_rational(options.fps);
    if (!fps || fps->num <= 0 || sim::value(*fps) > 1000)
      throw UsageError(fmt::format("fps {}: expected frames a second, as in 60 or 30000/1001", options.fps));
    film.fps = *fps;
  }
  if (!options.theme.empty()) {
    if (options.theme != "paper" && options.theme != "screen")
      throw UsageError(fmt::format("theme {}: expected paper or screen", options.theme));
    scene.look.theme = options.theme == "screen" ? draw::Theme::screen : draw::Theme::paper;
  }
  if (!options.camera.empty()) app::choose_camera(options.camera, scene);
  if (options.crf) film.crf = *options.crf;
  if (!options.preset.empty()) film.preset = options.preset;
  if (!options.codec.empty()) film.codec = options.codec;
  return scene;
}

app::FilmOptions how(const FilmOptions& options) {
  app::FilmOptions how;
  how.progress = app::ProgressKind::none;
  how.transparent = options.transparent;
  how.workers = options.jobs;
  return how;
}

bool ends_with(const std::string& out, const char* ending) { return out.ends_with(ending); }

}  // namespace

sim::Rational exact(double t, const char* what) {
  if (const auto found = std::isfinite(t) ? sim::from_double(t) : std::nullopt; found && t >= 0)
    return *found;
  throw UsageError(fmt::format("{} {}: expected seconds, 0 or more", what, t));
}

Filmed filmed(const Scene& scene, const FilmOptions& options) {
  scene::Scene its = with(options, scene);
  app::Shots shots = app::Shots::film(its.duration, its.film.fps, its.film.speed);
  if (shots.size() == 0) throw UsageError(its.file + ": a film of 0 s has no frames");
  if (options.from || options.to)
    shots.between(options.from ? exact(*options.from, "from") : sim::Rational{0, 1},
                  options.to ? exact(*options.to, "to") : its.duration);
  return {std::move(its), std::move(shots), how(options)};
}

Filmed filmed_at(const Scene& scene, const FilmOptions& options, sim::Rational t) {
  scene::Scene its = with(options, scene);
  app::Shots shots = app::Shots::still(t, its.film.fps, its.film.speed);
  return {std::move(its), std::move(shots), how(options)};
}

void film(const Scene& scene, const std::string& out, const FilmOptions& options) {
  guarded([&] {
    const Filmed it = filmed(scene, options);
    if (ends_with(out, ".html")) return finish(app::film_page(it.scene, it.shots, out, it.how));
    if (ends_with(out, ".pdf")) return finish(app::film_pages(it.scene, it.shots, out, it.how));
    if (out == "-") throw UsageError("a film of a program has a name: a Renderer hands out its frames");
    finish(app::film(it.scene, it.shots, app::output(out, it.scene.name, false, it.shots.size()), it.how));
  });
}

void still(const Scene& scene, double t, const std::string& out, const FilmOptions& options) {
  guarded([&] {
    const Filmed it = filmed_at(scene, options, exact(t, "t"));
    finish(app::film(it.scene, it.shots, app::output(out, it.scene.name, true, 1), it.how));
  });
}

std::string film_page(const Scene& scene, const FilmOptions& options) {
  return guarded([&] {
    const Filmed it = filmed(scene, options);
    app::PageFilm film(it.scene, it.shots);
    while (film.next()) {
    }
    if (film.trouble()) throw app::TroubleError(it.scene.file, *film.trouble(), "");
    if (app::interrupted()) throw app::Interrupted();
    return film.html(it.how.context);
  });
}

std::string figure_svg(const Scene& scene, const std::vector<double>& at, const FilmOptions& options) {
  return guarded([&] {
    app::AlbumOptions album;
    for (const double t : at) album.at.push_back(exact(t, "at"));
    if (!options.theme.empty()) album.theme = with(options, scene).look.theme;
    const app::FigureBuilder builder(scene.inside().scene, album);
    const app::Page made = builder.page();
    const auto under = app::lit_surfaces(made, builder.width(), kLitDpi, {});
    const auto bytes =
        page::page(made.picture, page::Form::svg, {builder.width(), builder.title(), builder.text()},
                   under ? std::optional(under->raster()) : std::nullopt);
    return std::string(bytes.begin(), bytes.end());
  });
}

Sweep sweep(const Scene& scene, const std::vector<std::string>& vary, const std::vector<std::string>& measure,
            int jobs) {
  if (jobs < 0) throw UsageError(fmt::format("jobs {}: expected 0 (all cores) or more", jobs));
  return guarded([&] {
    const scene::Scene& base = scene.inside().scene;
    const app::Variations all(vary);
    std::vector<app::Question> asked;
    for (const std::string& each : measure)
      for (app::Question& question : app::questions(each)) asked.push_back(std::move(question));
    app::check(asked, base.again(all.sets(0, base.sets)));

    Sweep made;
    for (const app::Variation& key : all.keys) made.heads.push_back(key.path);
    for (const app::Question& question : asked) made.heads.push_back(question.text);
    made.heads.push_back("trouble");

    using Row = std::vector<std::string>;
    std::int64_t next = 0;
    // workers are threads of their own: what the caller's function says goes on to them
    std::atomic<bool> ended = false;
    app::Conduct<std::int64_t, Row> parts;
    parts.produce = [&]() -> std::optional<std::int64_t> {
      if (next == all.size || ended || app::interrupted()) return {};
      return next++;
    };
    parts.wait = [&] { ended = ended || app::interrupted(); };
    parts.hire = [&] {
      app::interrupt_by([&] { return ended.load(); });
      return [&](std::int64_t run) {
        Row row = all[run];
        app::Answers answers;
        try {
          answers = app::answers(base.again(all.sets(run, base.sets)), asked);
        } catch (const scene::Error& error) {
          answers.values.assign(asked.size(), "");
          row.insert(row.end(), answers.values.begin(), answers.values.end());
          row.push_back(error.complaints.front().text());
          return row;
        }
        row.insert(row.end(), answers.values.begin(), answers.values.end());
        row.push_back(answers.trouble ? app::text(*answers.trouble) : "");
        return row;
      };
    };
    parts.consume = [&](Row row) {
      made.rows.push_back(std::move(row));
      return true;
    };
    const int cores = jobs > 0 ? jobs : std::max(1, int(std::thread::hardware_concurrency()));
    app::conduct(parts, int(std::min<std::int64_t>(cores, all.size)));
    if (ended || std::int64_t(made.rows.size()) < all.size) throw app::Interrupted();
    return made;
  });
}

}  // namespace obscura
