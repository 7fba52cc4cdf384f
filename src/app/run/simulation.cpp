#include "app/run/simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "app/console/interrupt.h"
#include "app/console/waiting.h"
#include "app/run/origin.h"
#include "app/run/trouble.h"

namespace obscura::app {

namespace {

// motion blur: the longest way, px, that counts as no motion; the fewest and most moments of a frame in which
// things move, one for each pixel of the longest way; and the memory that they may take, 2 MiB a frame
constexpr double kStill = 0.05, kFewest = 4, kMost = 64, kMostBytes = 2 << 20;

constexpr double kTrailMargin = 0.1;  // s

sim::Rational microseconds(double seconds) { return sim::rational(std::llround(seconds * 1e6), 1'000'000); }

double last_time(const sim::Track& track) {
  double t = 0;
  for (const auto& way : track.points) {
    if (!way.empty()) t = std::max(t, way.back().time);
  }
  return t;
}

}  // namespace

draw::Illustrator depictor(const scene::Scene& scene, const Ahead& ahead) {
  const auto run = scene.run();
  const double aspect = double(scene.film.width) / scene.film.height;
  const draw::Titles titles = draw::laid_out(scene.film.titles, aspect, scene.look.type_scale);
  draw::Illustrator artist(run->scene_info(), scene.look, scene.cameras, scene.extent, aspect,
                           ahead.charts.empty() ? draw::Charts(titles.foot) : ahead.charts);
  artist.annotate(ahead.annotations);
  artist.entitle(titles);
  return artist;
}

sim::Snapshot moment(sim::Run& run, sim::Rational t, const scene::Scene& scene) {
  doing("simulating", sim::value(t), sim::value(scene.duration), "s");
  auto found = run.at(t);
  if (const auto* trouble = std::get_if<sim::Trouble>(&found)) throw TroubleError(scene.file, *trouble, "");
  if (std::holds_alternative<sim::Stopped>(found)) throw Interrupted();
  return std::get<sim::Snapshot>(std::move(found));
}

Simulation::Simulation(const scene::Scene& scene, const Shots& shots, const draw::Illustrator& artist,
                       const SimulationOptions& options)
    : shots_(shots), artist_(artist), film_(scene.film), options_(options), take_(options.first) {
  for (const draw::BodyLook& look : scene.look.bodies) contacts_ = contacts_ || look.contact;
  trail_ = artist.longest_trail();
  due_ = options_.every;
  begin(scene.run());
}

void Simulation::begin(std::unique_ptr<sim::Run> run) {
  run_ = std::move(run);
  run_->track(artist_.trailed());
  run_->heed(interrupted);
  at_ = run_->now();
  ways_.clear();
  while (options_.every.num > 0 && due_ <= at_) due_ = due_ + options_.every;
}

std::int64_t Simulation::step_before(sim::Rational t) const {
  // a trail needs a point before its end
  if (trail_ > 0) t = t - microseconds(std::min(trail_, 1e9) + kTrailMargin);
  return sim::floor(t * run_->rate());
}

// the result of Run::at, with at_every on the way
std::variant<sim::Snapshot, sim::Trouble, sim::Stopped> Simulation::at(sim::Rational t) {
  while (options_.every.num > 0 && due_ <= t) {
    auto moment = run_->at(due_);
    if (!std::holds_alternative<sim::Snapshot>(moment)) return moment;
    options_.at_every(*run_, due_);
    due_ = due_ + options_.every;
  }
  return run_->at(t);
}

std::optional<FilmSegment> Simulation::next() {
  if (trouble_ || interrupted()) return {};
  const auto begins = [&] { return take_ * options_.frames; };
  while (take_ < options_.last && begins() < shots_.size() && options_.skip(take_)) ++take_;
  if (take_ >= options_.last || begins() >= shots_.size()) return {};
  next_ = begins();
  approach(shots_[next_].time);
  if (!trouble_ && !interrupted()) options_.begin_take(*run_);
  FilmSegment take;
  take.number = take_++;
  while (int(take.shots.size()) < options_.frames && next_ < shots_.size() && !trouble_ && !interrupted()) {
    const Shot shot = shots_[next_];
    auto moment = at(shot.time);
    if (auto* trouble = std::get_if<sim::Trouble>(&moment)) {
      trouble_ = *trouble;
      break;
    }
    if (std::holds_alternative<sim::Stopped>(moment)) break;
    take.shots.push_back(shot);
    take.moments.push_back(std::move(std::get<sim::Snapshot>(moment)));
    if (options_.hash_each || take.states.empty()) take.states.push_back(state_hash(run_->words()));
    take.open.push_back(open(take.moments.back()));
    ++next_;
  }
  keep_ways();
  take.ways.assign(ways_.begin(), ways_.end());
  if (take.shots.empty()) return {};
  return take;
}

// The instants that are seen while the shutter is open from a frame's own on, in the middle of as many equal
// parts; none where nothing moves. How many is known by how things move when it opens.
std::vector<sim::Snapshot> Simulation::open(const sim::Snapshot& moment) {
  if (film_.shutter <= 0) return {};
  const sim::Rational from = shots_[next_].time;
  const double seconds = film_.shutter / 360 / sim::value(film_.fps);  // of the film
  const double begins = sim::value(from),
               until =
                   sim::value(film_.speed.world(microseconds(sim::value(film_.speed.film(from)) + seconds)));
  const double way = artist_.travel(moment, until - begins) * film_.height / 1080;
  if (!(way >= kStill)) return {};

  const double bytes = double(moment.bodies.size() * sizeof(sim::Snapshot::Body) +
                              moment.springs.size() * sizeof(sim::Snapshot::Spring) +
                              moment.joints.size() * sizeof(sim::Snapshot::Joint) +
                              (contacts_ ? moment.contacts.size() * sizeof(sim::Snapshot::Contact) : 0));
  const double most = std::clamp(kMostBytes / std::max(bytes, 1.0), kFewest, kMost);
  const int count = int(std::clamp(std::ceil(way), kFewest, most));
  std::vector<sim::Snapshot> seen;
  for (int k = 0; k < count; ++k) {
    sim::Rational t = microseconds(begins + (until - begins) * (2 * k + 1) / (2 * count));
    if (t < from) t = from;
    if (next_ + 1 < shots_.size() && shots_[next_ + 1].time < t) t = shots_[next_ + 1].time;
    auto found = at(t);
    if (auto* trouble = std::get_if<sim::Trouble>(&found)) trouble_ = *trouble;
    if (!std::holds_alternative<sim::Snapshot>(found)) break;
    seen.push_back(std::move(std::get<sim::Snapshot>(found)));
    if (!contacts_) seen.back().contacts = {};
  }
  return seen;
}

// goes on to just before t in strides, so that the ways of a long beginning are not all kept
void Simulation::approach(sim::Rational t) {
  const std::int64_t here = sim::floor(run_->now() * run_->rate());
  if (auto nearer = options_.nearer(here, step_before(t))) begin(std::move(nearer));
  const sim::Rational stride{1, 1};
  while (at_ + stride < t && !trouble_ && !interrupted()) {
    at_ = at_ + stride;
    auto moment = at(at_);
    if (auto* trouble = std::get_if<sim::Trouble>(&moment)) trouble_ = *trouble;
    keep_ways();
  }
  at_ = t;
}

void Simulation::keep_ways() {
  if (trail_ <= 0) return;
  ways_.push_back(std::make_shared<const sim::Track>(run_->take_track()));
  // a way is let go when its last point is older than the longest trail before the next frame
  const double now = next_ > 0 ? sim::value(shots_[next_ - 1].time) : sim::value(at_);
  while (ways_.size() > 1 && last_time(*ways_.front()) < std::min(now, sim::value(at_)) - trail_)
    ways_.pop_front();
}

}  // namespace obscura::app
