#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>

#include "app/console/interrupt.h"
#include "app/run/origin.h"
#include "obscura/inside.h"
#include "scene/complaints.h"

namespace obscura {

namespace {

// s, after which a point of a trail is let go; a margin for the frame at hand
constexpr double kTrailMargin = 0.2;

Columns view(const sim::Columns& of) { return {of.first, of.rows, of.columns}; }

void copy(const sim::Vec3& from, double (&to)[3]) { std::copy_n(from.data(), 3, to); }

}  // namespace

World::Inside::Inside(const Scene& of, int threads) : scene(of) {
  const scene::Scene& its = of.inside().scene;
  if (threads < 0)
    throw UsageError(fmt::format("{} threads: expected 1 or more, or 0 for one a core", threads));
  if (threads == 1) {
    run = its.shown_run();
  } else {
    scene::Scene shared = its;
    shared.share_steps(threads);
    run = shared.shown_run();
  }
  std::vector<int> trailed;
  for (std::size_t i = 0; i < its.look.bodies.size(); ++i) {
    if (its.look.bodies[i].trail > 0) trailed.push_back(int(i));
    trail = std::max(trail, its.look.bodies[i].trail);
  }
  if (trail > 0) run->track(std::move(trailed));
  run->heed(app::interrupted);
  run->keep_whole_steps();
  columns = app::columns(run->scene_info(), its.axes);
}

sim::Snapshot World::Inside::now() const {
  const Work here = work();
  auto found = run->at(run->now());
  if (const auto* trouble = std::get_if<sim::Trouble>(&found))
    throw run_error(scene.inside().scene.file, *trouble);
  if (std::holds_alternative<sim::Stopped>(found)) throw Interrupted("interrupted");
  return std::get<sim::Snapshot>(std::move(found));
}

void World::Inside::go(std::int64_t step) {
  const Work here = work();
  const auto end = run->go(step);
  keep_ways();
  if (const auto* trouble = std::get_if<sim::Trouble>(&end))
    throw run_error(scene.inside().scene.file, *trouble);
  if (std::holds_alternative<sim::Stopped>(end)) throw Interrupted("interrupted");
}

// points of trails, in pieces of about a second: the oldest is let go when the longest trail has left it
void World::Inside::keep_ways() {
  if (trail <= 0) return;
  auto last = run->take_track();
  const auto end = [](const sim::Track& track) {
    double t = -1;
    for (const auto& way : track.points)
      if (!way.empty()) t = std::max(t, way.back().time);
    return t;
  };
  const auto begin = [](const sim::Track& track) {
    double t = 1e300;
    for (const auto& way : track.points)
      if (!way.empty()) t = std::min(t, way.front().time);
    return t;
  };
  if (end(last) < 0) return;
  if (!ways.empty() && end(last) - begin(*ways.back()) < 1) {
    auto longer = std::make_shared<sim::Track>(*ways.back());
    for (std::size_t i = 0; i < last.points.size(); ++i)
      longer->points[i].insert(longer->points[i].end(), last.points[i].begin(), last.points[i].end());
    ways.back() = std::move(longer);
  } else {
    ways.push_back(std::make_shared<const sim::Track>(std::move(last)));
  }
  const double oldest = sim::value(run->now()) - trail - kTrailMargin;
  while (ways.size() > 1 && end(*ways.front()) < oldest) ways.erase(ways.begin());
}

std::vector<Pair> World::Inside::touching() const {
  std::vector<Pair> all;
  for (const sim::Snapshot::Contact& each : now().contacts) {
    if (each.other >= 0)
      all.push_back({std::min(each.body, each.other), std::max(each.body, each.other), -1});
    else
      all.push_back({each.body, -1, each.wall});
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

World::World(const Scene& scene, int threads)
    : inside_(guarded([&] { return std::make_unique<Inside>(scene, threads); })) {}
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;
World::~World() = default;
World::Inside& World::inside() const { return held(inside_, "this World"); }

namespace {

sim::Rational now(const World::Inside& inside) {
  const Work here = inside.work();
  return inside.run->now();
}

}  // namespace

const Scene& World::scene() const { return inside().scene; }
double World::time() const { return sim::value(now(inside())); }
std::int64_t World::steps() const { return sim::floor(now(inside()) * inside().run->rate()); }
double World::step_length() const { return 1 / sim::value(inside().run->rate()); }

void World::step(std::int64_t count) {
  if (count < 0) throw UsageError(fmt::format("step({}): a world goes on; restore() goes back", count));
  const std::int64_t most = std::numeric_limits<std::int64_t>::max() - steps();
  guarded([&] { inside().go(steps() + std::min(count, most)); });
}

void World::step_to(double t) {
  if (!std::isfinite(t)) throw UsageError("step_to: the time is not finite");
  const auto step = std::int64_t(std::llround(std::clamp(t / step_length(), -9e15, 9e15)));
  if (step > steps()) guarded([&] { inside().go(step); });
}

int World::body(std::string_view name) const {
  const std::vector<Body>& all = scene().bodies();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Body& body) { return body.name == name; });
  if (found != all.end()) return int(found - all.begin());
  std::vector<std::string_view> names;
  for (const Body& body : all) names.push_back(body.name);
  throw UsageError(
      fmt::format("no body is called {}{}", scene::in_quotes(name), scene::did_you_mean(name, names)));
}

namespace {

sim::BodyColumns columns(const World::Inside& inside) {
  const Work here = inside.work();
  return inside.run->columns();
}

}  // namespace

Columns World::positions() const { return view(columns(inside()).x); }
Columns World::velocities() const { return view(columns(inside()).v); }
Columns World::turns() const { return view(columns(inside()).turn); }
Columns World::spins() const { return view(columns(inside()).spin); }
int World::first_turning() const { return int(scene().bodies().size() - turns().rows); }

namespace {

void set(World::Inside& inside, const sim::NewBodyColumns& columns) {
  const Work here = inside.work();
  if (const std::string why = inside.run->set(columns); !why.empty()) throw UsageError(why);
}

// an empty column of a world without such rows is all of it
std::span<const double> all_of(std::span<const double> given, const Columns& there, const char* what) {
  if (given.size() != there.size())
    throw UsageError(fmt::format("{}: {} numbers, expected {} ({} x {})", what, given.size(), there.size(),
                                 there.rows, there.columns));
  return given;
}

}  // namespace

void World::set_positions(std::span<const double> all) {
  set(inside(), {.x = all_of(all, positions(), "positions")});
}
void World::set_velocities(std::span<const double> all) {
  set(inside(), {.v = all_of(all, velocities(), "velocities")});
}
void World::set_turns(std::span<const double> all) { set(inside(), {.turn = all_of(all, turns(), "turns")}); }
void World::set_spins(std::span<const double> all) { set(inside(), {.spin = all_of(all, spins(), "spins")}); }

double World::read(std::string_view quantity) const {
  const auto& all = inside().columns;
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const app::Column& column) { return column.name == quantity; });
  if (found != all.end()) return guarded([&] { return found->read(inside().now()); });
  std::vector<std::string_view> names;
  for (const app::Column& column : all) names.push_back(column.name);
  throw UsageError(
      fmt::format("no quantity {}{}", scene::in_quotes(quantity), scene::did_you_mean(quantity, names)));
}

std::vector<std::string> World::quantities() const {
  std::vector<std::string> names;
  for (const app::Column& column : inside().columns) names.push_back(column.name);
  return names;
}

Energies World::energies() const {
  const sim::Energies e = guarded([&] { return inside().now().energies; });
  return {e.kinetic, e.gravity, e.springs, e.fields, e.work, e.total()};
}

std::vector<Contact> World::contacts() const {
  std::vector<Contact> all;
  for (const sim::Snapshot::Contact& each : guarded([&] { return inside().now(); }).contacts) {
    Contact& it = all.emplace_back();
    it.body = each.body, it.other = each.other, it.wall = each.wall;
    copy(each.point, it.point), copy(each.normal, it.normal);
    copy(each.force, it.force), copy(each.impulse, it.impulse);
    it.gap = each.gap;
    it.mode = !each.holds    ? Contact::Mode::bouncing
              : each.sliding ? Contact::Mode::sliding
                             : Contact::Mode::sticking;
  }
  return all;
}

ContactChanges World::contact_changes() {
  std::vector<Pair> now = guarded([&] { return inside().touching(); });
  ContactChanges changes;
  const std::vector<Pair>& before = inside().touched;
  std::set_difference(now.begin(), now.end(), before.begin(), before.end(),
                      std::back_inserter(changes.began));
  std::set_difference(before.begin(), before.end(), now.begin(), now.end(),
                      std::back_inserter(changes.ended));
  inside().touched = std::move(now);
  return changes;
}

std::vector<Event> World::events() const {
  const Work here = inside().work();
  std::vector<Event> all;
  for (const sim::RunEvent& each : inside().run->events())
    all.push_back({sim::value(each.time), each.name, each.what, each.of, each.marks, each.stop});
  return all;
}

State World::save() const {
  const Work here = inside().work();
  State state{inside().run->saved()};
  const sim::Rational rate = inside().run->rate();
  // its time is a number of steps
  for (const std::int64_t each : {rate.num, rate.den}) state.words.push_back(std::uint64_t(each));
  return state;
}

void World::restore(const State& state) {
  const Work here = inside().work();
  const std::span<const std::uint64_t> words = state.words;
  if (words.size() < 2) throw UsageError("restore: this is no state of a world");
  const sim::Rational rate = inside().run->rate(),
                      saved{std::int64_t(words[words.size() - 2]), std::int64_t(words.back())};
  if (saved.num != rate.num || saved.den != rate.den)
    throw UsageError(fmt::format("restore: it was saved at physics.rate = {}, and this world has {}",
                                 sim::text(saved), sim::text(rate)));
  if (!inside().run->restore(words.first(words.size() - 2)))
    throw UsageError("restore: this is no state of a world of this scene");
  if (inside().trail > 0) (void)inside().run->take_track();
  inside().ways.clear();
}

std::string World::hash() const {
  const Work here = inside().work();
  return app::state_hash(inside().run->words());
}

}  // namespace obscura
