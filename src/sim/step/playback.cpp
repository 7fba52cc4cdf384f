#include "sim/step/playback.h"

#include <algorithm>
#include <cmath>

#include "sim/step/snapshots.h"

namespace obscura::sim {

namespace {

Sighting between(const Sighting& a, const Sighting& b, double s) {
  Sighting pose;
  pose.position = a.position + s * (b.position - a.position);
  pose.velocity = a.velocity + s * (b.velocity - a.velocity);
  pose.spin = a.spin + s * (b.spin - a.spin);
  pose.angle = a.angle + s * (b.angle - a.angle);
  // the shorter way round, along the chord: rows are near each other
  Eigen::Vector4d to = b.orientation.coeffs();
  if (a.orientation.coeffs().dot(to) < 0) to = -to;
  pose.orientation.coeffs() = (1 - s) * a.orientation.coeffs() + s * to;
  pose.orientation.normalize();
  return pose;
}

template <int D>
void place(const Sighting& pose, int body, State<D>& state) {
  state.x[body] = pose.position.template head<D>();
  state.v[body] = pose.velocity.template head<D>();
  const int k = turning(state, body);
  if (k < 0) return;
  if constexpr (D == 2) {
    state.turn[k][0] = pose.angle, state.spin[k][0] = pose.spin.z();
  } else {
    state.turn[k] = pose.orientation.coeffs(), state.spin[k] = pose.spin;
  }
}

template <int D>
class PlaybackOf final : public RunWithoutSteps {
 public:
  PlaybackOf(World<D> world, std::shared_ptr<const Trajectory> trajectory)
      : model_(std::move(world.model)),
        state_(std::move(world.state)),
        stepper_(model_),
        trajectory_(std::move(trajectory)) {
    stepper_.begin(state_);
    // the script's first actions are not part of this run
    for (Grip<D>& grip : state_.grips) grip = {};
    cast_ = sim::cast(model_, state_, stepper_.paths());
  }

  const SceneInfo& scene_info() const override { return cast_; }
  Rational rate() const override { return model_.rate; }
  void heed(std::function<bool()> stop) override { stop_ = std::move(stop); }

  std::variant<Snapshot, Trouble, Stopped> at(Rational t) override {
    if (stop_ && stop_()) return Stopped{};
    const double now = value(t);
    if (!trajectory_->has(now)) return Trouble{now, "trajectory", "time", "is in none of its rows", ""};
    keep_ways(now);
    const std::vector<Sighting> poses = trajectory_->at(now);
    for (std::size_t i = 0; i < poses.size(); ++i) place(poses[i], int(i), state_);
    const TimeStamp beat = sim::time_stamp(t, model_.rate);
    state_.step = beat.step;
    return snapshot(model_, state_, stepper_, beat, now);
  }

  std::variant<std::monostate, Trouble, Stopped> go(std::int64_t step) override {
    auto found = at(rational(step) / model_.rate);
    if (auto* trouble = std::get_if<Trouble>(&found)) return std::move(*trouble);
    if (std::holds_alternative<Stopped>(found)) return Stopped{};
    return std::monostate{};
  }

  std::string set(const NewBodyColumns&) override { return "another program's run is only shown"; }

  std::vector<std::uint64_t> words() const override { return sim::words(state_); }

  void track(std::vector<int> bodies) override {
    track_.bodies = std::move(bodies);
    track_.points.assign(track_.bodies.size(), {});
  }

  Track take_track() override {
    Track taken{track_.bodies, std::vector<std::vector<Track::Point>>(track_.bodies.size())};
    taken.points.swap(track_.points);
    return taken;
  }

 private:
  // a trail has the rows' own points
  void keep_ways(double now) {
    for (; next_ < trajectory_->times.size() && trajectory_->times[next_] <= now; ++next_) {
      for (std::size_t i = 0; i < track_.bodies.size(); ++i) {
        const Sighting& pose = trajectory_->poses[next_][std::size_t(track_.bodies[i])];
        track_.points[i].push_back(
            {trajectory_->times[next_], pose.position, pose.orientation, pose.velocity, pose.spin});
      }
    }
  }

  Model<D> model_;
  State<D> state_;
  Stepper<D> stepper_;
  std::shared_ptr<const Trajectory> trajectory_;
  SceneInfo cast_;
  std::function<bool()> stop_;
  Track track_;
  std::size_t next_ = 0;  // the row whose places are not kept yet
};

}  // namespace

bool Trajectory::has(double t) const {
  const auto next = std::lower_bound(times.begin(), times.end(), t);
  if (next != times.end() && *next - t <= same) return true;
  if (next != times.begin() && t - *(next - 1) <= same) return true;
  return interpolate && next != times.begin() && next != times.end();
}

std::vector<Sighting> Trajectory::at(double t) const {
  const auto next = std::lower_bound(times.begin(), times.end(), t);
  const std::size_t n = std::size_t(next - times.begin());
  if (next != times.end() && *next - t <= same) return poses[n];
  if (next == times.end() || t - times[n - 1] <= same) return poses[n - 1];
  const double s = (t - times[n - 1]) / (times[n] - times[n - 1]);
  std::vector<Sighting> all;
  for (std::size_t i = 0; i < poses[n].size(); ++i) all.push_back(between(poses[n - 1][i], poses[n][i], s));
  return all;
}

std::unique_ptr<Run> playback(World<2> world, std::shared_ptr<const Trajectory> trajectory) {
  return std::make_unique<PlaybackOf<2>>(std::move(world), std::move(trajectory));
}
std::unique_ptr<Run> playback(World<3> world, std::shared_ptr<const Trajectory> trajectory) {
  return std::make_unique<PlaybackOf<3>>(std::move(world), std::move(trajectory));
}

}  // namespace obscura::sim
