#include "app/simulation.h"

#include <algorithm>

#include "app/interrupt.h"
#include "app/origin.h"

namespace obscura::app {

namespace {

double last_time(const sim::Track& track) {
  double t = 0;
  for (const auto& way : track.points) {
    if (!way.empty()) t = std::max(t, way.back().time);
  }
  return t;
}

}  // namespace

draw::Depictor depictor(const scene::Scene& scene) {
  const auto run = scene.run();
  const double aspect = double(scene.film.width) / scene.film.height;
  if (scene.dimension() == 2)
    return draw::Depictor(run->cast(), scene.look, scene.cameras.front(), scene.extent, aspect);
  return draw::Depictor(run->cast(), scene.look, scene.cameras, scene.extent, aspect);
}

Simulation::Simulation(const scene::Scene& scene, const Shots& shots, const SimulationOptions& options)
    : shots_(shots), options_(options), run_(scene.run()) {
  const draw::Depictor artist = depictor(scene);
  trail_ = artist.longest_trail();
  run_->track(artist.trailed());
  run_->heed(interrupted);
}

std::optional<Take> Simulation::next() {
  if (trouble_ || next_ >= shots_.size() || interrupted()) return {};
  approach(shots_[next_].time);
  Take take;
  while (int(take.shots.size()) < options_.frames && next_ < shots_.size() && !interrupted()) {
    const Shot shot = shots_[next_];
    auto moment = run_->at(shot.time);
    if (auto* trouble = std::get_if<sim::Trouble>(&moment)) {
      trouble_ = *trouble;
      break;
    }
    if (std::holds_alternative<sim::Stopped>(moment)) break;
    take.shots.push_back(shot);
    take.moments.push_back(std::move(std::get<sim::Snapshot>(moment)));
    if (options_.hash_each || take.states.empty()) take.states.push_back(state_hash(run_->words()));
    ++next_;
  }
  keep_ways();
  take.ways.assign(ways_.begin(), ways_.end());
  if (take.shots.empty()) return {};
  return take;
}

// goes on to just before t in strides, so that the ways of a long beginning are not all kept
void Simulation::approach(sim::Rational t) {
  const sim::Rational stride{1, 1};
  while (at_ + stride < t && !trouble_ && !interrupted()) {
    at_ = at_ + stride;
    auto moment = run_->at(at_);
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
