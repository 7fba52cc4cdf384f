#include "app/study/mosaic.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/console/say.h"
#include "app/film/film.h"
#include "app/film/ordered_pipeline.h"
#include "app/film/output.h"
#include "app/run/compared.h"
#include "app/run/shots.h"
#include "app/run/simulation.h"
#include "draw/page/layout.h"
#include "draw/picture/prose.h"
#include "draw/picture/theme.h"
#include "draw/picture/type.h"
#include "gl/renderer.h"
#include "media/file.h"
#include "media/movie.h"
#include "media/png.h"

namespace obscura::app {

namespace {

constexpr int kLeastWidth = 64, kLeastHeight = 36;  // px of a tile

// the same piece of all runs
using Together = std::vector<FilmSegment>;

// The caption of the page on which the runs are, and how high it is, page units: that of the first run's
// film.
struct Head {
  draw::Look look;
  draw::Layout layout;
  double height = 0;

  explicit Head(const scene::Scene& scene) : look(scene.look) {
    layout.aspect = double(scene.film.width) / scene.film.height;
    layout.width = 1080 * layout.aspect, layout.weight = draw::page_weight(layout.aspect);
    height = draw::lay_caption(layout, look);
  }

  // in a picture of this strip alone, so many px high on a page of `page` px
  draw::Picture picture(double time, int high, int page) const {
    draw::List words;
    draw::draw_words(layout, words);
    if (layout.caption && look.clock) {
      draw::Text clock = layout.clock;
      clock.spans[0].text = draw::clock_text(time, look.duration);
      words.add(clock);
    }
    draw::set_decimal_mark(words, look.decimal);
    draw::Picture strip;
    strip.aspect = layout.aspect * page / high;
    strip.ground = draw::palette(look.theme).ground;
    strip.moving.add(words, double(page) / high, {0, 0});
    return strip;
  }
};

// puts the runs' pictures beside each other; used from one thread
class Wall {
 public:
  Wall(const std::vector<Tile>& tiles, const Head& head, const Mosaic& mosaic, int width, int height,
       const gl::ContextOptions& context)
      : mosaic_(mosaic), head_(head), renderer_(mosaic.width, mosaic.height, context) {
    if (mosaic.head > 0) strip_.emplace(width, mosaic.head, context);
    for (const Tile& tile : tiles) artists_.push_back(depictor(tile.scene, {}));

    // the ground, and the words, which are the same in every frame
    const draw::Palette colours = draw::palette(tiles.front().scene.look.theme);
    const double unit = 1080.0 / height;
    draw::Picture ground;
    ground.aspect = double(width) / height;
    ground.ground = colours.ground;
    for (int i = 0; i < int(tiles.size()); ++i) {
      draw::Text line;
      line.at = {unit * mosaic.left(i), unit * (mosaic.top(i) - 0.3 * mosaic.words)};
      const Tile& tile = tiles[std::size_t(i)];
      line.spans.push_back({.text = draw::with_decimal_mark(tile.words, tile.scene.look.decimal),
                            .size = 0.68 * unit * mosaic.words,
                            .color = colours.ink,
                            .tabular = true});
      const double room = unit * mosaic.width / std::max(1e-9, draw::shape(line).width);
      line.spans[0].size *= std::min(1.0, room);
      ground.moving.add(line);
    }
    gl::Renderer(width, height, context).draw(ground, whole_);
  }

  const media::Image& frame(const Together& takes, std::size_t n) {
    // those that cannot go on are behind
    double time = 0;
    for (const FilmSegment& take : takes)
      if (n < take.moments.size()) time = std::max(time, take.moments[n].time);
    if (strip_) {
      const media::Image& strip = strip_->draw(head_.picture(time, mosaic_.head, whole_.height));
      std::memcpy(whole_.row(0), strip.row(0), std::size_t(4) * strip.width * strip.height);
    }
    for (std::size_t i = 0; i < takes.size(); ++i) {
      if (n >= takes[i].moments.size()) continue;
      const media::Image& own = renderer_.draw(artists_[i].depict(takes[i].moments[n], takes[i].ways));
      for (int y = 0; y < own.height; ++y)
        std::memcpy(whole_.row(mosaic_.top(int(i)) + y) + std::size_t(4) * mosaic_.left(int(i)), own.row(y),
                    std::size_t(4) * own.width);
    }
    return whole_;
  }

 private:
  Mosaic mosaic_;
  Head head_;
  gl::Renderer renderer_;
  std::optional<gl::Renderer> strip_;
  std::vector<draw::Illustrator> artists_;
  media::Image whole_;
};

// as a tile shows it: without caption and charts, by one camera, with words as large as the page's
void suit(const Mosaic& mosaic, std::vector<Tile>& tiles) {
  const scene::Film page = tiles.front().scene.film;
  for (Tile& tile : tiles) {
    scene::Scene& scene = tile.scene;
    scene.look.caption = false;
    scene.film.width = mosaic.width, scene.film.height = mosaic.height;
    suit_panel(double(page.width) / page.height, 1080.0 * mosaic.height / page.height, scene);
    scene.film.shutter = 0;
    scene.film.charts.clear();
    if (scene.cameras.size() > 1) scene.cameras.resize(1);
  }
}

/// Simulates all runs in step.
class Runs {
 public:
  Runs(const std::vector<Tile>& tiles, const Shots& shots, int frames, int workers) : workers_(workers) {
    for (const Tile& tile : tiles)
      runs_.push_back(
          std::make_unique<Simulation>(tile.scene, shots, Ahead{}, SimulationOptions{.frames = frames}));
    last_.resize(tiles.size());
  }

  /// The next piece of all; none at the end, or where none of them can go on.
  std::optional<Together> next() {
    Together takes(runs_.size());
    std::size_t asked = 0, had = 0, frames = 0;
    Conduct<std::size_t, std::optional<FilmSegment>> pieces;
    pieces.produce = [&] {
      return asked < runs_.size() && !interrupted() ? std::optional(asked++) : std::nullopt;
    };
    pieces.hire = [&] { return [&](std::size_t i) { return runs_[i]->next(); }; };
    pieces.consume = [&](std::optional<FilmSegment> take) {
      if (take && !take->moments.empty()) last_[had] = take->moments.back();
      if (take) takes[had] = std::move(*take);
      frames = std::max(frames, takes[had++].moments.size());
      return true;
    };
    conduct(pieces, std::min(workers_, int(runs_.size())));
    if (interrupted()) return {};
    if (frames == 0) return {};
    // a run that cannot go on is shown where it last was
    for (std::size_t i = 0; i < runs_.size(); ++i)
      if (last_[i]) takes[i].moments.resize(frames, *last_[i]);
    return takes;
  }
  std::size_t in_trouble() const {
    return std::size_t(
        std::count_if(runs_.begin(), runs_.end(), [](const auto& run) { return run->trouble(); }));
  }

 private:
  int workers_;
  std::vector<std::unique_ptr<Simulation>> runs_;
  std::vector<std::optional<sim::Snapshot>> last_;
};

int crew(const MosaicOptions& options) {
  return options.workers > 0 ? options.workers : std::max(1, int(std::thread::hardware_concurrency()));
}

int ended(const std::string& out, std::size_t runs, std::size_t trouble, const std::string& summary,
          Progress& progress, std::int64_t done) {
  progress.finish(done, fmt::format("{}: {}", out, summary), true);
  if (trouble == 0) return kDone;
  say(stderr, "obscura: {}: {} of {} runs diverged, and stand still\n", out, trouble, runs);
  return kDiverged;
}

}  // namespace

Mosaic::Mosaic(int n, int picture_width, int whole_height, int strip) : head(strip) {
  const int picture_height = whole_height - strip;
  gap = std::max(4, whole_height / 135), words = std::max(14, whole_height / 40);
  const double aspect = double(picture_width) / picture_height;
  double best = 0;
  for (int c = 1; c <= n; ++c) {
    const int r = (n + c - 1) / c;
    const int w = (picture_width - gap * (c + 1)) / c, h = (picture_height - gap * (r + 1)) / r - words;
    const double size = std::min(w / aspect, double(h));
    if (w < kLeastWidth || h < kLeastHeight || size <= best) continue;
    best = size, columns = c, rows = r, width = w, height = h;
  }
  if (columns == 0)
    throw UsageError(fmt::format("{} runs have no room in {}x{} pixels: vary less, or --set film.size", n,
                                 picture_width, whole_height));
}

int mosaic_head(const scene::Scene& scene) {
  return int(std::lround(Head(scene).height * scene.film.height / 1080));
}

int mosaic_still(std::vector<Tile> tiles, sim::Rational at, const std::string& out,
                 const MosaicOptions& options) {
  const scene::Film film = tiles.front().scene.film;
  const Head head(tiles.front().scene);
  const Mosaic mosaic(int(tiles.size()), film.width, film.height, mosaic_head(tiles.front().scene));
  suit(mosaic, tiles);
  media::make_folder_of(out);
  Progress progress(options.progress, out, 1, 0, "pictures");
  Runs runs(tiles, Shots::still(at, film.fps, {}), 1, crew(options));
  const std::optional<Together> takes = runs.next();
  if (interrupted()) return kInterrupted;
  Wall wall(tiles, head, mosaic, film.width, film.height, options.context);
  media::write_png(out, wall.frame(takes.value_or(Together(tiles.size())), 0),
                   {.tags = {{"Software", "obscura " OBSCURA_VERSION}}});
  return ended(
      out, tiles.size(), runs.in_trouble(),
      fmt::format("{} runs at t = {:g} s, {}x{}", tiles.size(), sim::value(at), film.width, film.height),
      progress, 1);
}

int mosaic_movie(std::vector<Tile> tiles, const std::string& out, const MosaicOptions& options) {
  const scene::Scene& first = tiles.front().scene;
  media::MovieSpec spec = movie_spec(first);
  media::check(out, spec);
  spec.tags = {{"Software", "obscura " OBSCURA_VERSION}, {"Title", draw::in_letters(first.look.title)}};
  media::make_folder_of(out);
  const Shots shots = Shots::film(first.duration, first.film.fps, first.film.speed);
  const Head head(first);
  const Mosaic mosaic(int(tiles.size()), spec.width, spec.height, mosaic_head(first));
  suit(mosaic, tiles);

  Runs runs(tiles, shots, media::segment_frames(spec), crew(options));
  media::MovieWriter movie(out, spec);
  Progress progress(options.progress, out, shots.size(), double(spec.fps_den) / double(spec.fps_num));
  std::int64_t done = 0;
  Conduct<Together, media::Segment> parts;
  parts.produce = [&] { return runs.next(); };
  parts.hire = [&] {
    auto wall = std::make_shared<Wall>(tiles, head, mosaic, spec.width, spec.height, options.context);
    return [&, wall](const Together& takes) {
      media::SegmentEncoder encoder(out, spec);
      std::size_t frames = 0;
      for (const FilmSegment& take : takes) frames = std::max(frames, take.moments.size());
      for (std::size_t n = 0; n < frames && !interrupted(); ++n) encoder.add(wall->frame(takes, n));
      return encoder.finish();
    };
  };
  parts.consume = [&](const media::Segment& segment) {
    if (interrupted()) return false;
    movie.add(segment);
    done += segment.frames;
    return true;
  };
  parts.wait = [&] { progress.at(done); };
  gl::ready(options.context);
  conduct(parts, crew(options));

  if (interrupted()) {
    const std::string partial = Output{Output::Form::movie, out}.partial();
    if (done > 0) movie.close(partial);
    progress.finish(done,
                    done > 0
                        ? fmt::format("interrupted: {} of {} frames are in {}", done, shots.size(), partial)
                        : "interrupted: nothing was written",
                    false);
    return kInterrupted;
  }
  movie.close();
  return ended(out, tiles.size(), runs.in_trouble(),
               fmt::format("{} runs beside each other, {} frames, {}x{}, made in {:.1f} s", tiles.size(),
                           done, spec.width, spec.height, progress.seconds()),
               progress, done);
}

}  // namespace obscura::app
