#include "app/film/pages.h"

#include <filesystem>

#include <fmt/format.h>

#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/console/memory.h"
#include "app/console/say.h"
#include "app/film/frame_renderer.h"
#include "app/film/output.h"
#include "app/run/ahead.h"
#include "app/run/simulation.h"
#include "app/run/trouble.h"
#include "draw/picture/prose.h"
#include "media/error.h"
#include "media/file.h"
#include "page/page.h"

namespace obscura::app {

namespace {

constexpr double kSlide = 160 * 72 / 25.4;  // pt: the width of a wide slide of Beamer
constexpr std::int64_t kMostPages = 2000;

}  // namespace

int film_pages(const scene::Scene& scene, const Shots& shots, const std::string& path,
               const FilmOptions& options) {
  if (!page::writes(page::Form::pdf))
    throw UsageError(fmt::format("-o {}: this obscura was built without Cairo and cannot write PDF", path));
  if (shots.size() > kMostPages)
    throw UsageError(fmt::format("-o {}: {} pages are more than {}: --fps, --from and --to leave some out",
                                 path, shots.size(), kMostPages));
  if (!options.overwrite) require_fresh(path);
  media::make_folder_of(path);

  const Ahead ahead = app::ahead(scene);
  Simulation simulation(scene, shots, ahead, {.frames = 1});
  FrameRenderer artist(scene, ahead, options.context);
  const double aspect = double(scene.film.width) / scene.film.height;
  page::Pages pages({.width = kSlide, .title = draw::in_letters(scene.look.title)}, aspect);
  Progress progress(options.progress, path, shots.size(), 1 / sim::value(shots.fps()));
  std::int64_t done = 0;
  while (const auto take = simulation.next()) {
    if (interrupted()) return kInterrupted;
    draw::Picture picture = artist.frame(*take, 0);
    picture.transparent = options.transparent;
    std::optional<page::Raster> raster;
    if (!picture.solids.empty()) {
      // surfaces are pixels, lines over them are not
      draw::List lines;
      std::swap(lines, picture.moving);
      const media::Image& image = artist.pixels(picture);
      std::swap(lines, picture.moving);
      raster = page::Raster{image.width, image.height, kSlide / image.width, image.pixels.data()};
      pages.add(picture, raster);
    } else {
      pages.add(picture);
    }
    progress.at(++done);
  }
  if (simulation.trouble()) throw TroubleError(scene.file, *simulation.trouble(), "");
  if (interrupted()) return kInterrupted;
  const std::vector<std::uint8_t> bytes = pages.finish();
  media::File file(path);
  file.write(bytes);
  file.place(false);
  progress.finish(done,
                  fmt::format("{}: {} pages at {:g} a second, {}", path, done, sim::value(shots.fps()),
                              bytes_text(double(bytes.size()))),
                  true);
  return kDone;
}

}  // namespace obscura::app
