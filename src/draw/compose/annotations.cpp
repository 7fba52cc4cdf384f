// The marks of a film: what is found from the run ahead, and what of it a frame shows.

#include "draw/compose/annotations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "draw/compose/arrow_scales.h"
#include "draw/compose/depict.h"
#include "draw/compose/label_courses.h"
#include "draw/compose/passing.h"
#include "draw/picture/way.h"

namespace obscura::draw {
namespace {

constexpr double kSpeed = 1.7;       // page units a frame that a label of the usual size moves by itself
constexpr double kPathError = 0.2;   // page units
constexpr double kCurveError = 0.3;  // of a path's error: of the points among which the needed ones are found
constexpr double kFaintest = 0.22;   // of a path's oldest end
constexpr double kSteadyArrow = 1;   // points: of an arrow from sample to sample
constexpr double kArrowSeen = 0.002;  // page units: of less an arrow is of nothing, but for rounding

// points of a curve that are needed for it to be no farther than `tolerance` from the line through them, by
// Douglas and Peucker
std::vector<sim::Track::Point> thinned(const std::vector<sim::Track::Point>& all, double tolerance) {
  if (all.size() < 3) return all;
  std::vector<char> kept(all.size(), 0);
  kept.front() = kept.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, all.size() - 1}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    const sim::Vec3 from = all[a].place, way = all[b].place - from;
    const double length = way.squaredNorm();
    double worst = tolerance;
    std::size_t at = 0;
    for (std::size_t k = a + 1; k < b; ++k) {
      const sim::Vec3 d = all[k].place - from;
      const double s = length > 0 ? std::clamp(d.dot(way) / length, 0.0, 1.0) : 0;
      const double far = (d - s * way).norm();
      if (far > worst) worst = far, at = k;
    }
    if (at == 0) continue;
    kept[at] = 1;
    open.push_back({a, at}), open.push_back({at, b});
  }
  std::vector<sim::Track::Point> needed;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (kept[k]) needed.push_back(all[k]);
  return needed;
}

// the ways behind bodies at a sample: their trails, through the samples before it, and paths
std::vector<std::vector<sim::Vec3>> ways_behind(const Look& look, const std::vector<sim::Snapshot>& moments,
                                                std::size_t k, const std::vector<WorldLine>& paths) {
  std::vector<std::vector<sim::Vec3>> ways;
  for (std::size_t i = 0; i < look.bodies.size() && i < moments[k].bodies.size(); ++i) {
    if (!(look.bodies[i].trail > 0)) continue;
    std::vector<sim::Vec3>& way = ways.emplace_back();
    for (std::size_t j = k + 1; j-- > 0 && moments[j].time >= moments[k].time - look.bodies[i].trail;)
      way.push_back(moments[j].bodies[i].position);
  }
  for (const WorldLine& path : paths) {
    std::vector<sim::Vec3>& way = ways.emplace_back();
    for (const WorldLine::Node& node : path.nodes) way.push_back(node.at);
  }
  return ways;
}

// of each run over this one the instant nearest to a time
std::vector<SpaceGhost> others_at(const RunAhead& ahead, double time) {
  static const std::vector<int> kAllThatMove;
  std::vector<SpaceGhost> all;
  for (const std::vector<sim::Snapshot>& run : ahead.others) {
    if (run.empty()) continue;
    auto next = std::lower_bound(run.begin(), run.end(), time,
                                 [](const sim::Snapshot& now, double t) { return now.time < t; });
    if (next == run.end() || (next != run.begin() && time - (next - 1)->time < next->time - time)) --next;
    all.push_back({&*next, &kAllThatMove});
  }
  return all;
}

}  // namespace

std::vector<std::vector<sim::Track::Point>> paths_of(
    const Marks& marks, std::span<const std::shared_ptr<const sim::Track>> tracks, double tolerance,
    const sim::Snapshot* now) {
  std::vector<std::vector<sim::Track::Point>> all;
  for (const Marks::Path& path : marks.paths) {
    std::vector<sim::Track::Point> way;
    for (const auto& track : tracks) {
      const auto at = std::find(track->bodies.begin(), track->bodies.end(), path.at.body);
      if (at == track->bodies.end()) continue;
      for (const sim::Track::Point& point : track->points[std::size_t(at - track->bodies.begin())])
        if (way.empty() || point.time > way.back().time) way.push_back(point);
    }
    if (now && !way.empty() && way.back().time < now->time) way.push_back(end_of_way(path.at.body, *now));
    all.push_back(thinned(refined(way, path.at.local, kCurveError * tolerance), tolerance));
  }
  return all;
}

std::vector<WorldLine> path_lines(const Marks& marks,
                                  const std::vector<std::vector<sim::Track::Point>>& paths,
                                  const sim::Snapshot& now, double film) {
  std::vector<WorldLine> lines;
  for (std::size_t i = 0; i < marks.paths.size(); ++i) {
    const Marks::Path& path = marks.paths[i];
    // its start is where it begins, its end when it goes
    const double start = path.shown.start ? path.shown.start->time : 0;
    if (now.time < start || !Interval{{}, path.shown.end}.has(now.time, film)) continue;
    const double from = path.lasting > 0 ? std::max(now.time - path.lasting, start) : start;
    WorldLine line{{}, path.at.body, path.color, path.front, int(i), path.lasting};
    const auto add = [&](double time, const sim::Vec3& at) {
      const double age = path.lasting > 0 ? (now.time - time) / path.lasting : 0;
      line.nodes.push_back({at, kFaintest + (1 - kFaintest) * std::clamp(1 - age, 0.0, 1.0), time});
    };
    const std::vector<sim::Track::Point>& way = paths[i];
    auto first = std::lower_bound(way.begin(), way.end(), from,
                                  [](const sim::Track::Point& p, double t) { return p.time < t; });
    if (first != way.begin() && first != way.end() && first->time > from) {
      const auto before = first - 1;
      const double part = (from - before->time) / (first->time - before->time);
      add(from, before->place + part * (first->place - before->place));
    }
    for (; first != way.end() && first->time < now.time; ++first) add(first->time, first->place);
    add(now.time, place(path.at, now));
    lines.push_back(std::move(line));
  }
  return lines;
}

Scales run_scales(const Marks& marks, const Illustrator& artist, const RunAhead& ahead, const Scales& given) {
  Scales all = given;
  const bool known = std::none_of(marks.vectors.begin(), marks.vectors.end(), [&](const Marks::Vector& each) {
    const double* scale = scale_of(each.quantity, all);
    return scale && *scale == 0;
  });
  if (known || ahead.moments.empty()) return all;
  const sim::SceneInfo& cast = artist.scene_info();
  const sim::Snapshot& start = ahead.moments.front();
  Scales chosen =
      draw::scales(marks, cast, ahead.moments, artist.projection(0, start).window(), artist.scale(start));
  std::vector<SeenInstant> seen;
  for (const auto* instants : {&ahead.moments, &ahead.between})
    for (const sim::Snapshot& now : *instants)
      for (int panel = 0; panel < artist.panels(); ++panel)
        seen.push_back({&now, artist.projection(panel, now)});
  const Lettering lettering = film_lettering(artist.weight(), artist.look().type_scale);
  chosen = kept_whole(marks, cast, seen, lettering.arrow, chosen);
  for (const auto member :
       {&Scales::velocity, &Scales::force, &Scales::impulse, &Scales::momentum, &Scales::acceleration})
    if (all.*member == 0) all.*member = chosen.*member;
  return all;
}

Annotations::Annotations(const Marks& marks, const Illustrator& artist, RunAhead ahead, const Scales& given,
                         double fps, int rows)
    : marks_(marks),
      cast_(artist.scene_info()),
      look_(artist.look()),
      colours_(artist.colours()),
      scales_(run_scales(marks, artist, ahead, given)) {
  lettering_ = film_lettering(artist.weight(), look_.type_scale, rows);
  ghosts_ = std::move(ahead.ghosts);
  if (ahead.moments.empty()) {
    plans_.resize(std::size_t(artist.panels()));
    paths_.resize(marks_.paths.size());
    return;
  }

  const std::vector<sim::Snapshot>& moments = ahead.moments;
  const std::vector<double>& films = ahead.films;
  number_arrows(marks_, cast_, moments, films);
  if (ahead.track) {
    const std::shared_ptr<const sim::Track> tracks[] = {ahead.track};
    paths_ = paths_of(marks_, tracks, kPathError / artist.scale(moments.front()));
  }
  paths_.resize(marks_.paths.size());

  std::map<int, double> largest;  // of the vectors whose arrows are drawn
  std::set<int> legible;
  // first what values there are, then where their labels may stand
  for (int panel = 0; panel < artist.panels(); ++panel) {
    LabelPlan plan;
    std::vector<std::vector<Offered>> offered(moments.size());
    for (std::size_t k = 0; k < moments.size(); ++k) {
      List unused;
      Annotating how{.lettering = lettering_,
                     .film = films[k],
                     .survey = &offered[k],
                     .ranges = &plan.ranges,
                     .arrows = &plan.arrows,
                     .before = k > 0 ? films[k - 1] : -1,
                     .look = &look_};
      annotate(marks_, scales_, cast_, colours_, artist.projection(panel, moments[k]), moments[k], unused,
               how);
    }
    const double speed = kSpeed * fps * lettering_.point / film_lettering(1, 1).point;
    for (auto& [key, arrow] : plan.arrows) arrow.ease(speed, kSteadyArrow * lettering_.point);
    const LabelPlan ranges{plan.ranges, plan.arrows, {}};
    for (std::size_t k = 0; k < moments.size(); ++k) {
      List unused;
      offered[k].clear();
      const auto behind = ways_behind(look_, moments, k, path_lines(marks_, paths_, moments[k], films[k]));
      const auto others = others_at(ahead, moments[k].time);
      Annotating how{.lettering = lettering_,
                     .film = films[k],
                     .plan = &ranges,
                     .survey = &offered[k],
                     .look = &look_,
                     .behind = behind,
                     .ghosts = others};
      annotate(marks_, scales_, cast_, colours_, artist.projection(panel, moments[k]), moments[k], unused,
               how);
    }
    for (const auto& [key, range] : plan.ranges)
      if (key.kind == WordKey::vector && range.longest > kArrowSeen)
        largest[key.index] = std::max({largest[key.index], std::abs(range.low), std::abs(range.high)});
    for (const std::vector<Offered>& sample : offered)
      for (const Offered& each : sample)
        if (each.key.kind == WordKey::vector && each.legible) legible.insert(each.key.index);
    plan.courses = courses(offered, films, lettering_.point, speed);
    plan_passing(ahead, artist, panel, plan);
    // lines behind bodies are not among what is avoided
    if (!marks_.paths.empty() || !marks_.ghosts.empty() || artist.longest_trail() > 0)
      for (auto& [key, course] : plan.courses) course.covers = true;
    plans_.push_back(std::move(plan));
  }
  std::erase_if(largest, [&](const auto& each) { return legible.contains(each.first); });
  never_seen_.assign(largest.begin(), largest.end());
}

// where words pass over others, looked for at all instants that are known
void Annotations::plan_passing(const RunAhead& ahead, const Illustrator& artist, int panel,
                               LabelPlan& plan) const {
  if (plan.courses.size() < 2) return;
  std::vector<std::pair<double, const sim::Snapshot*>> instants;
  for (std::size_t k = 0; k < ahead.moments.size(); ++k)
    instants.emplace_back(ahead.films[k], &ahead.moments[k]);
  for (std::size_t k = 0; k < ahead.between_films.size(); ++k)
    instants.emplace_back(ahead.between_films[k], &ahead.between[k]);
  std::stable_sort(instants.begin(), instants.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::vector<Standing>> standing(instants.size());
  std::vector<double> films;
  for (std::size_t k = 0; k < instants.size(); ++k) {
    const auto& [film, now] = instants[k];
    List unused;
    annotate(marks_, scales_, cast_, colours_, artist.projection(panel, *now), *now, unused,
             {.lettering = lettering_, .film = film, .plan = &plan, .standing = &standing[k]});
    films.push_back(film);
  }
  draw::plan_passing(standing, films, plan);
}

std::vector<WorldLine> Annotations::lines(const sim::Snapshot& now, double film) const {
  return path_lines(marks_, paths_, now, film);
}

std::vector<std::pair<const sim::Snapshot*, const Marks::Ghost*>> Annotations::ghosts(
    const sim::Snapshot& now, double film) const {
  std::vector<std::pair<const sim::Snapshot*, const Marks::Ghost*>> all;
  for (std::size_t i = 0; i < ghosts_.size() && i < marks_.ghosts.size(); ++i)
    if (marks_.ghosts[i].shown.has(now.time, film)) all.emplace_back(&ghosts_[i], &marks_.ghosts[i]);
  return all;
}

void Annotations::draw(int panel, const Projection& projection, const sim::Snapshot& now, double film,
                       List& list) const {
  annotate(marks_, scales_, cast_, colours_, projection, now, list,
           {.lettering = lettering_, .film = film, .plan = &plans_[std::size_t(panel)]});
}

}  // namespace obscura::draw
