#include "app/film/film_page.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/console/memory.h"
#include "app/film/frame_painter.h"
#include "app/film/output.h"
#include "app/film/space_page.h"
#include "app/film/subtitles.h"
#include "app/run/ahead.h"
#include "app/run/description.h"
#include "app/run/origin.h"
#include "app/run/simulation.h"
#include "app/run/telling.h"
#include "app/run/trouble.h"
#include "draw/picture/prose.h"
#include "gl/renderer.h"
#include "media/error.h"
#include "media/file.h"
#include "media/png.h"
#include "page/html.h"
#include "page/page.h"
#include "scene/complaints.h"

namespace obscura::app {

namespace {

using Json = nlohmann::ordered_json;

// a number is told to a digit of this part of the largest, or less, and is known to this part of that digit;
// of very many bodies to one less
constexpr double kLastDigit = 1 / 2000.0, kKnown = 1 / 20.0;
constexpr std::size_t kVeryMany = 200;
constexpr double kSlow = 0.01;                  // of the room a second: so fast is counted as the largest
constexpr double kSlowSpin = 0.1;               // rad/s, alike
constexpr double kAngleDigit = 0.1;             // degrees
constexpr double kTimeBound = 2e-6;             // s
constexpr double kNoFrame = 1e-6;               // of a frame
constexpr double kDegrees = 57.29577951308232;  // a radian
constexpr double kStill = 720;                  // pt: the width of the first picture,
constexpr int kStillPixels = 720;               // and of its surfaces

std::string css(draw::Color c) { return fmt::format("rgb({},{},{})", c.r, c.g, c.b); }

// the last digit that is told of so many numbers up to the largest: a power of ten
double last_digit(double largest, std::size_t count = 1) {
  return std::pow(10, std::floor(std::log10(kLastDigit * largest)) + (count > kVeryMany ? 1 : 0));
}

const char* kind_of(sim::ShapeKind kind) {
  switch (kind) {
    case sim::ShapeKind::point:
      return "particle";
    case sim::ShapeKind::ball:
      return "ball";
    case sim::ShapeKind::box:
      return "box";
    case sim::ShapeKind::capsule:
      return "capsule";
    default:
      return "body";
  }
}

// What a page says of a run besides its pictures, frame by frame.
class PageNumbers {
 public:
  PageNumbers(const std::vector<draw::Illustrator>& artists, double duration, const Ahead& ahead,
              page::Reel& reel);
  void add(const FilmSegment& take, std::size_t frame);
  /// The bodies, whose numbers are written as exactly as they are told: by the largest of the frames so far.
  Json bodies();
  Json charts() const { return charts_; }
  int time() const { return time_; }

 private:
  struct Body {
    std::size_t run, index;
    int first;  // of its numbers
    bool angle, turns;
    double speed = 0, spin = 0;  // the largest
  };
  struct Line {
    std::size_t run;
    draw::Measured::Line line;
    int number;
  };

  const std::vector<draw::Illustrator>& artists_;
  page::Reel& reel_;
  int dimension_;
  int time_;
  double duration_;
  std::vector<double> farthest_;  // of each run, m
  std::vector<Body> tracked_;
  std::vector<Line> lines_;
  Json bodies_ = Json::array(), charts_ = Json::array();
};

PageNumbers::PageNumbers(const std::vector<draw::Illustrator>& artists, double duration, const Ahead& ahead,
                         page::Reel& reel)
    : artists_(artists),
      reel_(reel),
      dimension_(artists.front().scene_info().dimension),
      duration_(duration),
      farthest_(artists.size(), 0) {
  time_ = reel.number(kTimeBound * std::min(1.0, duration));
  for (std::size_t run = 0; run < artists.size(); ++run) {
    const sim::SceneInfo& cast = artists[run].scene_info();
    for (std::size_t i = 0; i < cast.bodies.size(); ++i) {
      const sim::SceneInfo::Body& body = cast.bodies[i];
      if (body.bare) continue;
      Json each{
          {"name", scene::one_line(body.name)}, {"part", run}, {"index", i}, {"kind", kind_of(body.kind)}};
      if (artists.size() > 1 && ahead.runs) each["run"] = scene::one_line((*ahead.runs)[run].look.name);
      Body its{run, i, -1, dimension_ == 2 && body.turns, body.turns};
      Json place = Json::array(), velocity = Json::array();
      // their bounds: bodies()
      for (int k = 0; k < dimension_; ++k) place.push_back(reel.number(0));
      for (int k = 0; k < dimension_; ++k) velocity.push_back(reel.number(0));
      its.first = place[0];
      each["place"] = place, each["velocity"] = velocity;
      if (its.angle) each["angle"] = reel.number(kKnown * kAngleDigit / kDegrees);
      if (its.turns) each["spin"] = reel.number(0);
      if (body.fixed)
        each["fixed"] = true;
      else
        each["mass"] = body.mass;
      tracked_.push_back(its);
      bodies_.push_back(std::move(each));
    }
  }
  for (const draw::Charts::Shown& shown : ahead.charts.shown()) {
    const draw::PlotArea& area = shown.area;
    const bool over_time = shown.chart.against.empty();
    Json each{{"left", area.left},     {"right", area.right}, {"top", area.top},
              {"bottom", area.bottom}, {"first", area.first}, {"last", area.last},
              {"low", area.low},       {"high", area.high},   {"time", over_time && !area.log}};
    Json lines = Json::array();
    const std::vector<draw::Measured::Line> measured = shown.chart.lines();
    for (std::size_t i = 0; i < shown.plot.lines.size(); ++i) {
      const std::size_t run = i / measured.size();
      const draw::Measured::Line& line = measured[i % measured.size()];
      const sim::SceneInfo& cast = artists[run].scene_info();
      std::string name(line.measure->name);
      if (line.body >= 0) name += " of " + scene::one_line(cast.bodies[std::size_t(line.body)].name);
      if (artists.size() > 1 && ahead.runs) name = (*ahead.runs)[run].look.name + ": " + name;
      const double digit = last_digit(area.high - area.low);
      const int number = reel.number(kKnown * digit);
      lines_.push_back({run, line, number});
      lines.push_back({{"name", name},
                       {"unit", line.measure->unit ? line.measure->unit : ""},
                       {"color", css(shown.plot.lines[i].color)},
                       {"number", number},
                       {"within", digit}});
    }
    each["lines"] = lines;
    charts_.push_back(std::move(each));
  }
}

void PageNumbers::add(const FilmSegment& take, std::size_t frame) {
  reel_.put(time_, sim::value(take.shots[frame].time));
  for (Body& each : tracked_) {
    const sim::Snapshot::Body& now = take.run(each.run).moments[frame].bodies[each.index];
    farthest_[each.run] = std::max(farthest_[each.run], now.position.cwiseAbs().maxCoeff());
    each.speed = std::max(each.speed, now.velocity.norm()), each.spin = std::max(each.spin, now.spin.norm());
    int number = each.first;
    for (int k = 0; k < dimension_; ++k) reel_.put(number++, now.position[k]);
    for (int k = 0; k < dimension_; ++k) reel_.put(number++, now.velocity[k]);
    if (each.angle) reel_.put(number++, now.angle);
    if (each.turns) reel_.put(number, dimension_ == 2 ? now.spin.z() : now.spin.norm());
  }
  for (const Line& each : lines_)
    reel_.put(each.number, each.line.at(artists_[each.run].scene_info(), take.run(each.run).moments[frame]));
}

Json PageNumbers::bodies() {
  for (std::size_t i = 0; i < tracked_.size(); ++i) {
    const Body& each = tracked_[i];
    const double scale = artists_[each.run].scene_info().scale;
    const double slow = kSlow * scale * std::max(1.0, 1 / duration_);
    const std::size_t count = tracked_.size();
    const double place = last_digit(std::max(farthest_[each.run], kSlow * scale), count),
                 speed = last_digit(std::max(each.speed, slow), count),
                 spin = last_digit(std::max(each.spin, kSlowSpin), count);
    for (int k = 0; k < dimension_; ++k) reel_.bound(each.first + k, kKnown * place);
    for (int k = 0; k < dimension_; ++k) reel_.bound(each.first + dimension_ + k, kKnown * speed);
    Json& its = bodies_[i];
    its["within"] = {place, speed, kAngleDigit, spin};
    if (each.turns) reel_.bound(its["spin"], kKnown * spin);
  }
  return bodies_;
}

// Where the shots show a frame of the whole film, counted in shots from the first; none where they do not.
std::optional<double> place_in(const Shots& shots, double frame) {
  std::int64_t low = 0, high = shots.size();  // the last shot that is not after it
  while (high - low > 1) {
    const std::int64_t middle = (low + high) / 2;
    (double(shots[middle].frame) <= frame + kNoFrame ? low : high) = middle;
  }
  const double off = frame - double(shots[low].frame);
  if (off < -kNoFrame || off > 1 + kNoFrame) return {};
  return double(low) + std::max(off, 0.0);
}

// those that the shots show
Json events_of(const scene::Scene& scene, const Shots& shots, const std::vector<Happening>& events) {
  Json all = Json::array();
  const double fps = sim::value(shots.fps());
  for (const Happening& each : events) {
    const double film =
        sim::value(scene.film.speed.film(sim::rational(std::llround(each.seen * 1e6), 1'000'000)));
    if (const auto place = place_in(shots, film * fps))
      all.push_back({{"time", each.time}, {"film", *place / fps}, {"text", each.text}});
  }
  return all;
}

// What happens in the run as far as the shots show it.
Story story_of(const scene::Scene& scene, const Shots& shots) {
  const std::int64_t first = shots[0].frame, last = shots[shots.size() - 1].frame;
  scene::Scene told = scene;
  const Shots film = Shots::film(scene.duration, scene.film.fps, scene.film.speed);
  if (last < film.last_frame())
    told.duration =
        std::min(scene.duration, scene.film.speed.world(sim::rational(last + 1) / scene.film.fps));
  Story all = story(told);
  const double duration = sim::value(scene.duration);
  if (first > 0 || told.duration < scene.duration)
    all.sentences.push_back(fmt::format("This page shows the run from {} to {}; it lasts {}.",
                                        telling::time(sim::value(shots[0].time), duration),
                                        telling::time(sim::value(told.duration), duration),
                                        telling::time(duration, duration)));
  return all;
}

}  // namespace

struct PageFilm::Making {
  Making(const scene::Scene& as_filmed, const Shots& wanted)
      : scene(as_shown(as_filmed)),
        blurred(as_filmed.film.shutter > 0),
        shots(wanted),
        ahead(app::ahead(scene)),
        simulation(scene, shots, ahead, {.frames = 1}),
        artist(scene, ahead),
        numbers(artist.artists(), sim::value(scene.duration), ahead, reel) {
    const std::vector<draw::Rect> panels = artist.panels();
    for (std::size_t i = 0; i < artist.artists().size(); ++i)
      if (const draw::SpaceStage* stage = artist.artists()[i].space())
        spaces.emplace_back(*stage, int(i), panels[i], reel);
    origin = origin_of(as_filmed);
    origin.shots = shots.text(), origin.shot = shots[0], origin.encoder = "html";
  }
  static scene::Scene as_shown(scene::Scene scene) {
    scene.film.shutter = 0;
    scene.film.rows = false;
    return scene;
  }

  scene::Scene scene;
  bool blurred;
  Shots shots;
  Ahead ahead;
  Simulation simulation;
  FramePainter artist;
  page::Reel reel;
  PageNumbers numbers;
  std::deque<SpacePage> spaces;  // one a run
  Origin origin;
  std::optional<Checksums> states;
  draw::Picture first;
  std::optional<Story> story;
};

PageFilm::PageFilm(const scene::Scene& scene, const Shots& shots) {
  making_ = std::make_unique<Making>(scene, shots);
}
PageFilm::~PageFilm() = default;

bool PageFilm::next() {
  Making& m = *making_;
  const auto take = m.simulation.next();
  if (!take) return false;
  const draw::Picture picture = m.artist.frame(*take, 0);
  if (!m.states) {
    m.first = picture;
    m.states.emplace(m.shots.size(), take->all_bodies(0).bodies.size());
    m.origin.state = take->states[0];
  }
  m.states->add(m.reel.frames(), take->states[0], take->all_bodies(0));
  m.reel.add(picture);
  m.numbers.add(*take, 0);
  for (std::size_t i = 0; i < m.spaces.size(); ++i) m.spaces[i].add(take->run(i).moments[0], picture);
  return true;
}

std::int64_t PageFilm::frames() const { return making_->reel.frames(); }

const std::optional<sim::Trouble>& PageFilm::trouble() const { return making_->simulation.trouble(); }

std::string PageFilm::watched() { return html(true, {}); }

std::string PageFilm::html(const gl::ContextOptions& context) {
  draw::Picture& first = making_->first;
  const page::Sheet sheet{.width = kStill, .title = draw::in_letters(making_->scene.look.title)};
  if (first.solids.empty()) return html(false, page::page(first, page::Form::svg, sheet));
  // surfaces are pixels, lines over them are not
  gl::Renderer renderer(kStillPixels, int(std::lround(kStillPixels / first.aspect)), context);
  draw::List lines;
  std::swap(lines, first.moving);
  const media::Image& image = renderer.draw(first);
  std::swap(lines, first.moving);
  const page::Raster raster{image.width, image.height, kStill / image.width, image.pixels.data(),
                            media::encode_png(image)};
  return html(false, page::page(first, page::Form::svg, sheet, raster));
}

std::string PageFilm::html(bool watched, const std::vector<std::uint8_t>& still) {
  Making& m = *making_;
  const scene::Scene& scene = m.scene;
  const bool whole = frames() == m.shots.size();
  m.origin.frames = frames();
  m.origin.states = m.states;
  if (whole) m.origin.states->close();
  page::FilmPage out;
  out.title = scene.look.title.empty() ? scene.name : draw::in_letters(scene.look.title);
  out.dark = scene.look.theme == draw::Theme::screen;
  out.watched = watched;
  out.still = still;
  out.generator = "obscura " OBSCURA_VERSION;
  out.origin = m.origin.tags(draw::in_letters(scene.look.title)).at("obscura");
  // what happens is told when all shots are there
  if (whole && !m.story) m.story = story_of(scene, m.shots);
  if (m.story) out.sentences = m.story->sentences;
  out.footer = fmt::format("Made by obscura {} from {}; obscura verify makes it again.", OBSCURA_VERSION,
                           m.origin.scene_file);
  Json& film = out.film;
  film["title"] = out.title;
  film["aspect"] = m.first.aspect;
  film["ground"] = {m.first.ground.r, m.first.ground.g, m.first.ground.b};
  film["theme"] = out.dark ? "screen" : "paper";
  film["fps"] = sim::value(m.shots.fps());
  film["dimension"] = scene.dimension();
  film["time"] = m.numbers.time();
  film["duration"] = sim::value(scene.duration);
  if (!whole) film["of"] = m.shots.size();
  film["windows"] = Json::array();
  for (const draw::Rect& w : m.artist.windows()) film["windows"].push_back({w.x, w.y, w.width, w.height});
  film["bodies"] = m.numbers.bodies();
  film["charts"] = m.numbers.charts();
  for (const SpacePage& space : m.spaces) film["spaces"].push_back(space.json());
  film["events"] = events_of(scene, m.shots, m.story ? m.story->events : std::vector<Happening>());
  film["captions"] = Json::array();
  for (const media::TextCue& cue : subtitles(scene, m.shots, frames()).captions)
    film["captions"].push_back({{"from", cue.begin}, {"to", cue.end}, {"text", cue.text}});
  film["exact"] = fmt::format(
      "In each of its {} frames, {:g} a second, what moves is drawn within {} px, of 1080, of where the run "
      "has it; "
      "between frames it is in between.{}{}",
      frames(), sim::value(m.shots.fps()), page::kReelBound,
      !m.spaces.empty()
          ? " Bodies in space are lit and hidden by WebGL: edges and shadows are softer or harder by "
            "some pixels "
            "than in the movie."
          : "",
      m.blurred ? " The movie has motion blur, which this page leaves out." : "");
  page::Reel so_far = m.reel;
  return page::html(out, so_far);
}

int film_page(const scene::Scene& scene, const Shots& shots, const std::string& path,
              const FilmOptions& options) {
  if (!options.overwrite) require_fresh(path);
  media::make_folder_of(path);
  PageFilm film(scene, shots);
  Progress progress(options.progress, path, shots.size(), 1 / sim::value(shots.fps()));
  while (film.next()) {
    if (interrupted()) return kInterrupted;
    progress.at(film.frames());
  }
  if (film.trouble()) throw TroubleError(scene.file, *film.trouble(), "");
  if (interrupted()) return kInterrupted;
  const std::string text = film.html(options.context);
  media::File file(path);
  file.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  file.place(false);
  progress.finish(film.frames(),
                  fmt::format("{}: {} frames at {:g} a second, {}", path, film.frames(),
                              sim::value(shots.fps()), bytes_text(double(text.size()))),
                  true);
  return kDone;
}

}  // namespace obscura::app
