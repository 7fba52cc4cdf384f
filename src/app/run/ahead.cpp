#include "app/run/ahead.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "app/console/interrupt.h"
#include "app/console/say.h"
#include "app/run/compared.h"
#include "app/run/outside.h"
#include "app/run/plot_points.h"
#include "draw/compose/annotations.h"
#include "draw/page/measure.h"
#include "draw/plane/stage.h"
#include "draw/space/outmost_places.h"
#include "sim/step/run.h"

namespace obscura::app {

namespace {

constexpr std::int64_t kPixels = 1920;      // of a line in a film
constexpr double kSample = 1.0 / 15;        // s of the film: how often labels look where they stand
constexpr double kMostSampled = 128 << 20;  // bytes of instants kept for labels
constexpr double kBetween = 1.0 / 60;       // s of the film: how often arrows and passing words are looked at
constexpr double kMostBetween = 32 << 20;   // bytes of instants kept for them

// the instants of a run from which a chart is made: ends of steps, which cost nothing extra; for another
// program's run its rows
std::vector<sim::Rational> beats(const scene::Scene& scene, sim::Rational rate, std::int64_t most = kPixels) {
  std::vector<sim::Rational> times;
  if (scene.trajectory) {
    const std::vector<double>& rows = scene.trajectory->times;
    const std::size_t stride = rows.size() / std::size_t(most) + 1;
    for (std::size_t i = 0; i < rows.size(); i += stride)
      if (const auto exact = sim::from_double(rows[i]); exact && *exact <= scene.duration)
        times.push_back(*exact);
    return times;
  }
  const std::int64_t steps = sim::floor(scene.duration * rate), stride = steps / most + 1;
  for (std::int64_t k = 0; k <= steps; k += stride) times.push_back(sim::rational(k) / rate);
  if (times.back() < scene.duration) times.push_back(scene.duration);
  return times;
}

// whether a camera of it shows all that the run reaches
bool fits_run(const scene::Scene& scene) {
  return std::any_of(scene.cameras.begin(), scene.cameras.end(),
                     [](const draw::Camera& camera) { return camera.fits_run; });
}

double bytes(const sim::Snapshot& now) {
  return double(now.bodies.size() * sizeof(sim::Snapshot::Body) +
                now.springs.size() * sizeof(sim::Snapshot::Spring) +
                now.joints.size() * sizeof(sim::Snapshot::Joint) +
                now.contacts.size() * sizeof(sim::Snapshot::Contact));
}

// What a run shows from its start to its end: the lines of the film's charts, and what its marks need.
struct Watched {
  std::vector<draw::Plot> plots;
  draw::RunAhead marks;
  sim::SceneInfo cast;
  bool any = false;           // an instant
  draw::OutmostPlaces reach;  // of its bodies
};

/// `under_words`: the words of another run are over it.
Watched watch(const scene::Scene& scene, const std::vector<draw::Chart>& wanted,
              const std::vector<sim::Rational>& times, const std::vector<sim::Rational>& looks,
              const draw::Palette& colours, bool under_words = false) {
  const draw::Marks& marks = scene.film.marks;
  const bool instants_kept = !marks.empty() || under_words;
  const auto run = scene.shown_run();
  Watched watched;
  watched.cast = run->scene_info();
  std::vector<std::vector<draw::Measured::Line>> lines;
  std::vector<draw::Plot> looked;
  if (!wanted.empty()) {
    const draw::Illustrator artist = depictor(scene, {});
    for (const draw::Chart& each : wanted) {
      watched.plots.push_back(draw::empty_plot(
          each, colours, artist.scene_info(), [&](int body) { return artist.line_color(body); },
          [&](int body) { return artist.called(body); },
          [&](int body) { return is_quiet(artist.look(), body); }));
      lines.push_back(each.lines());
    }
    looked = watched.plots;
  }
  run->heed(interrupted);
  std::vector<int> traced;
  for (const draw::Marks::Path& path : marks.paths) traced.push_back(path.at.body);
  std::sort(traced.begin(), traced.end());
  traced.erase(std::unique(traced.begin(), traced.end()), traced.end());
  run->track(traced);

  // the instants of ghosts among the others, and those at which the film stands still; of another program's
  // run the nearest row
  constexpr int kAxis = -1, kStill = -2, kLook = -3;
  std::vector<std::pair<sim::Rational, int>> instants;
  for (const sim::Rational t : times) instants.emplace_back(t, kAxis);
  for (const sim::Rational t : looks)
    if (!std::binary_search(times.begin(), times.end(), t)) instants.emplace_back(t, kLook);
  const auto more = [&](sim::Rational t, int what) {
    const auto next = std::lower_bound(times.begin(), times.end(), t);
    if (scene.trajectory) t = next == times.end() ? times.back() : *next;
    instants.emplace_back(t, what);
  };
  for (std::size_t i = 0; i < marks.ghosts.size(); ++i) more(marks.ghosts[i].time, int(i));
  for (const draw::Pace::Frozen& each : scene.film.speed.frozen()) more(each.world, kStill);
  std::stable_sort(instants.begin(), instants.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });

  draw::RunAhead& found = watched.marks;
  found.ghosts.resize(marks.ghosts.size());
  double next = 0, stride = kSample, kept = 0;
  // arrows are measured, and words pass over each other
  const bool pass = marks.points.size() + marks.labels.size() + marks.names.size() > 1;
  double next_between = marks.vectors.empty() && !pass ? 1e300 : 0, between = 0;
  const auto keep = [&](sim::Snapshot now, double film) {
    found.moments.push_back(std::move(now)), found.films.push_back(film);
  };
  bool diverges = false;
  const bool all = !wanted.empty() || fits_run(scene);  // instants are looked at, not only those of labels
  for (const auto& [t, ghost] : instants) {
    const double film = sim::value(scene.film.speed.film(t));
    if (!all && ghost == kAxis && film < std::min(next, next_between) - 1e-9 && t < times.back()) continue;
    auto outcome = run->at(t);
    if (std::holds_alternative<sim::Stopped>(outcome)) throw Interrupted();
    if (std::holds_alternative<sim::Trouble>(outcome)) break;
    auto& now = std::get<sim::Snapshot>(outcome);
    if (ghost >= 0) {
      found.ghosts[std::size_t(ghost)] = std::move(now);
      continue;
    }
    if (ghost == kLook) {
      for (std::size_t i = 0; i < wanted.size() && !diverges && !run->divergence(); ++i)
        add_values(watched.cast, now, wanted[i], lines[i], looked[i]);
      continue;
    }
    // axes and arrows are made for what a run does before it diverges
    diverges = diverges || run->divergence();
    if (diverges) continue;
    if (ghost == kStill) {
      // labels may come and go meanwhile
      if (!instants_kept) continue;
      for (const draw::Pace::Frozen& each : scene.film.speed.frozen()) {
        if (!(each.world == t)) continue;
        for (const double part : {0.0, 0.1, 0.3, 0.5, 0.7, 0.9})
          keep(now, sim::value(each.film) + part * sim::value(each.seconds));
      }
      next = found.films.back();
      continue;
    }
    watched.any = true;
    if (fits_run(scene)) {
      watched.reach.add(watched.cast, now);
      if (scene.look.drop_lines) watched.reach.add_feet(watched.cast, now);
    }
    for (std::size_t i = 0; i < wanted.size(); ++i)
      add_values(watched.cast, now, wanted[i], lines[i], watched.plots[i]);
    if (!instants_kept) continue;
    if (film < next - 1e-9) {
      if (film < next_between - 1e-9) continue;
      between += bytes(now), next_between = between < kMostBetween ? film + kBetween : 1e300;
      found.between.push_back(std::move(now)), found.between_films.push_back(film);
      continue;
    }
    kept += bytes(now);
    keep(std::move(now), film);
    // of a large scene fewer
    if (kept > kMostSampled) {
      const std::size_t half = (found.moments.size() + 1) / 2;
      for (std::size_t k = 1; k < half; ++k)
        found.moments[k] = std::move(found.moments[2 * k]), found.films[k] = found.films[2 * k];
      found.moments.resize(half), found.films.resize(half);
      stride *= 2, kept /= 2;
    }
    next = found.films.back() + stride;
  }
  for (std::size_t i = 0; i < wanted.size() && !looks.empty(); ++i) refine(looked[i], watched.plots[i]);
  if (!traced.empty()) found.track = std::make_shared<const sim::Track>(run->take_track());
  return watched;
}

// plain words as a part of mathematics
std::string in_quotes(const std::string& words) {
  std::string all = "\"";
  for (const char c : words) all += c == '$' ? "\\$" : std::string(1, c);
  return all + "\"";
}

// the lines of several runs in one plot, named and coloured by their runs
void join_plots(const std::vector<Ahead::Run>& runs, std::vector<Watched>& watched) {
  std::vector<draw::Plot>& all = watched.front().plots;
  for (std::size_t p = 0; p < all.size(); ++p) {
    const std::size_t own = all[p].lines.size();
    for (std::size_t i = 0; i < runs.size(); ++i) {
      draw::Plot& plot = watched[i].plots[p];
      for (std::size_t k = 0; k < own; ++k) {
        draw::Series& line = plot.lines[k];
        const std::string &run = runs[i].look.name, words = in_quotes(draw::in_letters(run));
        line.label = own > 1 ? line.label + "\", \"" + words : draw::contains_mathematics(run) ? run : words;
        line.color = runs[i].look.color;
        if (i > 0) all[p].lines.push_back(line);
      }
      if (plot.times.size() > all[p].times.size()) all[p].times = plot.times;
    }
    draw::tell_apart(all[p]);
  }
}

// Large words and several plots may leave a film's room hardly any height.
void tell_crowded(const scene::Scene& scene, const Ahead& page) {
  constexpr double kLeast = 0.15;
  if (scene.dimension() == 3 || page.runs) return;
  const double part = std::max(0.0, depictor(scene, page).layout().room_height / 1080);
  if (part >= kLeast) return;
  say(stderr,
      "{}: note: title, captions and plots leave {:.0f} % of the picture's height to the room; fewer plots, "
      "shorter words or a smaller look.type_scale leave more\n",
      scene.file, 100 * part);
}

// Words that come and go with an arrow are never read where that is never long enough, in all of these runs.
void tell_never_seen(const scene::Scene& scene,
                     const std::vector<std::shared_ptr<const draw::Annotations>>& runs) {
  std::map<int, std::pair<std::size_t, double>> never;  // in how many, and the largest value
  for (const auto& run : runs)
    for (const auto& [index, largest] : run->never_seen()) {
      auto& [count, most] = never[index];
      ++count, most = std::max(most, largest);
    }
  for (const auto& [index, known] : never) {
    const draw::Marks::Vector& vector = scene.film.marks.vectors[std::size_t(index)];
    if (vector.label.empty() || known.first < runs.size()) continue;
    const std::string_view unit = draw::unit(vector.quantity);
    const std::string_view longer = unit == "N"     ? "; a larger look.force_scale makes it longer"
                                    : unit == "m/s" ? "; a larger look.velocity_scale makes it longer"
                                                    : "";
    say(stderr,
        "{}: note: the arrow '{}' is never long enough for its words to be read (at most {:.3g} {}){}\n",
        scene.file, vector.label, known.second, unit, longer);
  }
}

// Words at places that no camera comes to. Where nothing is known of the run, as it begins.
void tell_never_shown(const scene::Scene& scene, const Ahead& page,
                      const std::vector<sim::Snapshot>& moments) {
  const std::vector<std::string> all =
      moments.empty() ? never_shown(scene) : never_shown(scene, depictor(scene, page), moments);
  for (const std::string& each : all) say(stderr, "{}: note: {}\n", scene.file, each);
}

std::shared_ptr<const draw::Annotations> annotations(const scene::Scene& scene, const Ahead& page,
                                                     draw::RunAhead found, const draw::Scales& given) {
  return std::make_shared<const draw::Annotations>(scene.film.marks, depictor(scene, page), std::move(found),
                                                   given, sim::value(scene.film.fps),
                                                   scene.film.rows ? scene.film.height : 0);
}

// the marks of several runs, with one scale for each kind of arrow: that of the longest
void annotate(const Ahead& page, std::vector<Watched>& watched, std::vector<Ahead::Run>& runs) {
  constexpr double draw::Scales::*kAll[] = {&draw::Scales::velocity, &draw::Scales::force,
                                            &draw::Scales::impulse, &draw::Scales::momentum,
                                            &draw::Scales::acceleration};
  draw::Scales common;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const scene::Scene& scene = runs[i].scene;
    if (scene.film.marks.empty()) continue;
    const draw::Scales own = draw::run_scales(scene.film.marks, depictor(scene, page), watched[i].marks,
                                              given_scales(scene, watched[i].cast));
    for (const auto member : kAll)
      if (own.*member > 0 && (common.*member == 0 || own.*member < common.*member))
        common.*member = own.*member;
  }
  std::vector<std::shared_ptr<const draw::Annotations>> made;
  if (!runs.empty()) tell_never_shown(runs.front().scene, page, watched.front().marks.moments);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].scene.film.marks.empty()) continue;
    runs[i].annotations = annotations(runs[i].scene, page, std::move(watched[i].marks), common);
    made.push_back(runs[i].annotations);
  }
  // a run with other marks says nothing of these
  if (made.size() == runs.size()) tell_never_seen(runs.front().scene, made);
}

}  // namespace

draw::Scales given_scales(const scene::Scene& scene, const sim::SceneInfo& cast) {
  draw::Scales scales;
  bool velocity = scene.look.velocity_scale_given, force = scene.look.force_scale_given;
  for (const draw::BodyLook& body : scene.look.bodies)
    velocity = velocity || body.velocity, force = force || body.contact;
  if (velocity) scales.velocity = scene.look.velocity_scale;
  if (force) scales.force = scene.look.force_scale > 0 ? scene.look.force_scale : draw::newton(cast);
  return scales;
}

Ahead ahead(const scene::Scene& scene) {
  const std::vector<draw::Chart>& wanted = scene.film.charts;
  std::vector<Ahead::Run> runs = compared(scene);
  const bool fitted = fits_run(scene);
  if (runs.empty() && wanted.empty() && scene.film.marks.empty() && !fitted) {
    if (scene.look.type_scale > 1 || !scene.film.titles.captions.empty()) tell_crowded(scene, {});
    return {};
  }
  draw::Palette colours = draw::palette(scene.look.theme);
  if (scene.dimension() == 3) colours.ground = colours.room;  // as the page in space
  const sim::Rational rate = std::visit([](const auto& world) { return world.model.rate; }, scene.world);
  const std::vector<sim::Rational> times = beats(scene, rate);
  // several runs share the instants of their plots
  std::vector<sim::Rational> looks;
  if (!wanted.empty() && runs.empty() && !scene.trajectory) looks = beats(scene, rate, kLooks);
  std::vector<Watched> watched;
  // words that stand still need no run
  const bool still = scene.film.marks.empty() || (runs.empty() && scene.film.marks.fixed());
  const bool needed = !wanted.empty() || !still || fitted;
  if (runs.empty() && needed) watched.push_back(watch(scene, wanted, times, looks, colours));
  for (const Ahead::Run& run : runs)
    if (needed) watched.push_back(watch(run.scene, wanted, times, {}, colours, scene.film.over && !still));
  if (!runs.empty() && needed) join_plots(runs, watched);
  for (std::size_t i = 1; i < watched.size() && scene.film.over; ++i)
    watched.front().marks.others.push_back(std::move(watched[i].marks.moments));

  Ahead all;
  draw::OutmostPlaces reach;
  for (const Watched& each : watched) reach.add(each.reach);
  all.reached = reach.places();
  const double aspect = double(scene.film.width) / scene.film.height;
  if (!wanted.empty() && std::any_of(watched.begin(), watched.end(), [](const auto& w) { return w.any; })) {
    std::vector<sim::SceneInfo> casts;
    for (const Watched& each : watched) casts.push_back(each.cast);
    all.charts = {wanted,
                  watched.front().plots,
                  colours,
                  aspect,
                  sim::value(scene.duration),
                  casts,
                  draw::laid_out(scene.film.titles, aspect, scene.look.type_scale).foot,
                  scene.look.type_scale};
  }
  if (!runs.empty()) {
    if (!scene.film.marks.empty())
      annotate({.charts = scene.film.over ? all.charts : draw::Charts()}, watched, runs);
    all.runs = std::make_shared<const std::vector<Ahead::Run>>(std::move(runs));
  } else if (!scene.film.marks.empty()) {
    if (watched.empty()) watched.emplace_back();
    const draw::Scales given = given_scales(scene, watched.front().cast);
    tell_never_shown(scene, all, watched.front().marks.moments);
    all.annotations = annotations(scene, all, std::move(watched.front().marks), given);
    tell_never_seen(scene, {all.annotations});
  }
  tell_crowded(scene, all);
  return all;
}

}  // namespace obscura::app
