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
constexpr double kStandsStill = 0.05, kFewest = 4, kMost = 64, kMostBytes = 2 << 20;

constexpr double kTrailMargin = 0.1;  // s

sim::Rational microseconds(double seconds) { return sim::rational(std::llround(seconds * 1e6), 1'000'000); }

// whether each of its bodies has a point at or before t
bool reaches_back_to(double t, const sim::Track& track) {
  return std::all_of(track.points.begin(), track.points.end(),
                     [&](const auto& way) { return !way.empty() && way.front().time <= t; });
}

}  // namespace

draw::Illustrator depictor(const scene::Scene& scene, const Ahead& ahead) {
  const auto run = scene.run();
  const double aspect = double(scene.film.width) / scene.film.height;
  const draw::Titles titles = draw::laid_out(scene.film.titles, aspect, scene.look.type_scale);
  std::vector<draw::Camera> cameras = scene.cameras;
  for (draw::Camera& camera : cameras)
    if (camera.fits_run) camera.reached = ahead.reached;
  draw::Illustrator artist(run->scene_info(), scene.look, cameras, scene.extent, aspect,
                           ahead.charts.empty() ? draw::Charts(titles.foot) : ahead.charts);
  artist.annotate(ahead.annotations);
  artist.entitle(titles);
  return artist;
}

std::vector<draw::Illustrator> depictors(const scene::Scene& scene, const Ahead& ahead) {
  if (!ahead.runs) return {depictor(scene, ahead)};
  std::vector<draw::Illustrator> all;
  for (const Ahead::Run& run : *ahead.runs) {
    // runs over each other share the page, charts and all; a panel has neither
    all.push_back(depictor(run.scene, {.charts = scene.film.over ? ahead.charts : draw::Charts(),
                                       .annotations = run.annotations}));
  }
  return all;
}

std::string hash_of_states(const std::vector<std::string>& hashes) {
  if (hashes.size() == 1) return hashes.front();
  std::string all;
  for (const std::string& each : hashes) all += each;
  return hash(all);
}

draw::Fate fate(const sim::Run& run) {
  const auto divergence = run.divergence();
  return !divergence ? draw::Fate::well : divergence->ended ? draw::Fate::ended : draw::Fate::diverges;
}

sim::Snapshot FilmSegment::all_bodies(std::size_t frame) const {
  sim::Snapshot all;
  all.time = moments[frame].time;
  for (std::size_t i = 0; i <= others.size(); ++i) {
    const std::vector<sim::Snapshot::Body>& its = run(i).moments[frame].bodies;
    all.bodies.insert(all.bodies.end(), its.begin(), its.end());
  }
  return all;
}

sim::Snapshot moment(sim::Run& run, sim::Rational t, const scene::Scene& scene) {
  doing("simulating", sim::value(t), sim::value(scene.duration), "s");
  auto found = run.at(t);
  if (const auto* trouble = std::get_if<sim::Trouble>(&found)) throw TroubleError(scene.file, *trouble, "");
  if (std::holds_alternative<sim::Stopped>(found)) throw Interrupted();
  return std::get<sim::Snapshot>(std::move(found));
}

// One run of a film.
class Simulation::Followed {
 public:
  Followed(const scene::Scene& scene, const Shots& shots, draw::Illustrator artist,
           const SimulationOptions& options, std::size_t number)
      : shots_(shots), artist_(std::move(artist)), film_(scene.film), options_(options), number_(number) {
    for (const draw::BodyLook& look : scene.look.bodies) contacts_ = contacts_ || look.contact;
    show_divergence_ = scene.show_divergence;
    trail_ = artist_.longest_trail();
    due_ = options_.every;
    begin(scene.run());
  }

  const std::optional<sim::Trouble>& trouble() const { return trouble_; }
  const sim::Run& run() const { return *run_; }

  std::int64_t step_before(sim::Rational t) const {
    // a trail needs a point before its end, of every body: they come at equal steps
    const double margin = std::max(kTrailMargin, 2 / sim::value(run_->rate()));
    if (trail_ > 0) t = t - microseconds(std::min(trail_, 1e9) + margin);
    return sim::floor(t * run_->rate());
  }

  // goes on to just before t in strides, so that the ways of a long beginning are not all kept
  void approach(sim::Rational t) {
    const std::int64_t here = sim::floor(run_->now() * run_->rate());
    if (auto nearer = options_.nearer(number_, here, step_before(t))) begin(std::move(nearer));
    const sim::Rational stride{1, 1};
    if (at_ < run_->now()) at_ = run_->now();
    while (at_ + stride < t && !trouble_ && !interrupted()) {
      at_ = at_ + stride;
      auto moment = at(at_);
      if (auto* trouble = std::get_if<sim::Trouble>(&moment)) trouble_ = *trouble;
      keep_ways(at_);
    }
    at_ = t;
  }

  // the moment of a shot, and how many more its exposure takes; none where the run cannot go on
  std::optional<sim::Snapshot> moment(std::int64_t shot, int& exposures) {
    auto found = at(shots_[shot].time);
    if (auto* trouble = std::get_if<sim::Trouble>(&found)) trouble_ = *trouble;
    if (!std::holds_alternative<sim::Snapshot>(found)) return {};
    auto& now = std::get<sim::Snapshot>(found);
    exposures = exposures_of(shot, now);
    return std::move(now);
  }

  std::vector<sim::Snapshot> open(std::int64_t shot, int count);

  Ways ways(sim::Rational now) {
    keep_ways(now);
    return {ways_.begin(), ways_.end()};
  }

 private:
  void begin(std::unique_ptr<sim::Run> run) {
    run_ = std::move(run);
    if (show_divergence_) run_->show_divergence();
    run_->track(artist_.trailed());
    run_->heed(interrupted);
    at_ = run_->now();
    ways_.clear();
    while (options_.every.num > 0 && due_ <= at_) due_ = due_ + options_.every;
  }

  // the result of Run::at, with at_every on the way
  std::variant<sim::Snapshot, sim::Trouble, sim::Stopped> at(sim::Rational t) {
    while (options_.every.num > 0 && due_ <= t) {
      auto moment = run_->at(due_);
      if (!std::holds_alternative<sim::Snapshot>(moment)) return moment;
      options_.at_every(*run_, due_);
      due_ = due_ + options_.every;
    }
    return run_->at(t);
  }

  // from when to when the shutter is open for a frame, s of the run
  std::pair<double, double> interval(std::int64_t shot) const {
    const sim::Rational from = shots_[shot].time;
    const double seconds = film_.shutter / 360 / sim::value(film_.fps);  // of the film
    return {sim::value(from),
            sim::value(film_.speed.world(microseconds(sim::value(film_.speed.film(from)) + seconds)))};
  }

  int exposures_of(std::int64_t shot, const sim::Snapshot& moment) const;

  void keep_ways(sim::Rational now) {
    if (trail_ <= 0) return;
    ways_.push_back(std::make_shared<const sim::Track>(run_->take_track()));
    // ways are let go that are before one with a point of each body before the end of the longest trail
    const double oldest = std::min(sim::value(now), sim::value(at_)) - trail_;
    const auto first = std::find_if(ways_.rbegin(), ways_.rend(),
                                    [&](const auto& track) { return reaches_back_to(oldest, *track); });
    if (first != ways_.rend()) ways_.erase(ways_.begin(), first.base() - 1);
  }

  const Shots& shots_;
  draw::Illustrator artist_;
  scene::Film film_;
  const SimulationOptions& options_;
  std::size_t number_;
  bool contacts_ = false, show_divergence_ = false;  // contacts_: are drawn
  std::unique_ptr<sim::Run> run_;
  double trail_ = 0;  // s, the longest
  std::deque<std::shared_ptr<const sim::Track>> ways_;
  sim::Rational at_, due_;  // due_: when at_every is next told
  std::optional<sim::Trouble> trouble_;
};

// How many instants are seen while the shutter is open: by how things move when it opens; none where nothing
// does.
int Simulation::Followed::exposures_of(std::int64_t shot, const sim::Snapshot& moment) const {
  if (film_.shutter <= 0) return 0;
  const auto [begins, until] = interval(shot);
  const double way = artist_.travel(moment, until - begins) * film_.height / 1080;
  if (!(way >= kStandsStill)) return 0;
  const double bytes = double(moment.bodies.size() * sizeof(sim::Snapshot::Body) +
                              moment.springs.size() * sizeof(sim::Snapshot::Spring) +
                              moment.joints.size() * sizeof(sim::Snapshot::Joint) +
                              (contacts_ ? moment.contacts.size() * sizeof(sim::Snapshot::Contact) : 0));
  const double most = std::clamp(kMostBytes / std::max(bytes, 1.0), kFewest, kMost);
  return int(std::clamp(std::ceil(way), kFewest, most));
}

// The instants that are seen while the shutter is open from a frame's own on, in the middle of as many equal
// parts.
std::vector<sim::Snapshot> Simulation::Followed::open(std::int64_t shot, int count) {
  const sim::Rational from = shots_[shot].time;
  const auto [begins, until] = interval(shot);
  std::vector<sim::Snapshot> seen;
  for (int k = 0; k < count; ++k) {
    sim::Rational t = microseconds(begins + (until - begins) * (2 * k + 1) / (2 * count));
    if (t < from) t = from;
    if (shot + 1 < shots_.size() && shots_[shot + 1].time < t) t = shots_[shot + 1].time;
    auto found = at(t);
    if (auto* trouble = std::get_if<sim::Trouble>(&found)) trouble_ = *trouble;
    if (!std::holds_alternative<sim::Snapshot>(found)) break;
    seen.push_back(std::move(std::get<sim::Snapshot>(found)));
    if (!contacts_) seen.back().contacts = {};
  }
  return seen;
}

Simulation::Simulation(const scene::Scene& scene, const Shots& shots, const Ahead& ahead,
                       const SimulationOptions& options)
    : shots_(shots), options_(options), take_(options.first) {
  const std::vector<draw::Illustrator> artists = depictors(scene, ahead);
  for (std::size_t i = 0; i < artists.size(); ++i)
    followed_.push_back(std::make_unique<Followed>(ahead.runs ? (*ahead.runs)[i].scene : scene, shots_,
                                                   artists[i], options_, i));
}

Simulation::~Simulation() = default;

const std::optional<sim::Trouble>& Simulation::trouble() const {
  for (const auto& each : followed_)
    if (each->trouble()) return each->trouble();
  return followed_.front()->trouble();
}

const sim::Run& Simulation::run(std::size_t number) const { return followed_[number]->run(); }

std::int64_t Simulation::step_before(sim::Rational t, std::size_t run) const {
  return followed_[run]->step_before(t);
}

std::optional<FilmSegment> Simulation::next() {
  if (trouble() || interrupted()) return {};
  const auto begins = [&] { return take_ * options_.frames; };
  while (take_ < options_.last && begins() < shots_.size() && options_.skip(take_)) ++take_;
  if (take_ >= options_.last || begins() >= shots_.size()) return {};
  std::int64_t next = begins();
  std::vector<const sim::Run*> standing;
  for (const auto& each : followed_) {
    each->approach(shots_[next].time);
    standing.push_back(&each->run());
  }
  if (!trouble() && !interrupted()) options_.begin_take(standing);
  FilmSegment take;
  take.number = take_++;
  take.others.resize(followed_.size() - 1);
  const auto part = [&](std::size_t i) -> RunSegment& { return i == 0 ? take : take.others[i - 1]; };
  while (int(take.shots.size()) < options_.frames && next < shots_.size() && !trouble() && !interrupted()) {
    std::vector<sim::Snapshot> moments;
    std::vector<draw::Fate> fates;
    std::vector<std::string> hashes;
    int exposures = 0;
    const bool hashed = options_.hash_each || take.states.empty();
    for (const auto& each : followed_) {
      int own = 0;
      auto moment = each->moment(next, own);
      if (!moment) break;
      exposures = std::max(exposures, own);
      moments.push_back(std::move(*moment));
      fates.push_back(fate(each->run()));
      if (hashed) hashes.push_back(state_hash(each->run().words()));
    }
    if (moments.size() < followed_.size()) break;
    take.shots.push_back(shots_[next]);
    if (hashed) take.states.push_back(hash_of_states(hashes));
    for (std::size_t i = 0; i < followed_.size(); ++i) {
      part(i).moments.push_back(std::move(moments[i]));
      part(i).fates.push_back(fates[i]);
      part(i).open.push_back(followed_[i]->open(next, exposures));
    }
    ++next;
  }
  for (std::size_t i = 0; i < followed_.size(); ++i)
    part(i).ways = followed_[i]->ways(next > 0 ? shots_[next - 1].time : sim::Rational{0, 1});
  if (take.shots.empty()) return {};
  return take;
}

}  // namespace obscura::app
