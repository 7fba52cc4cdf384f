// The frame of an observer at x, that moves at v and turns at w, R the turn from how it is to how it was at
// the start, when it was at x0:
//   p' = x0 + R (p - x)     u' = R (u - v - w x (p - x))     w' = R (w_body - w)     f' = R f

#include "sim/step/observer.h"

#include <algorithm>
#include <utility>

#include "sim/math/exponential.h"
#include "sim/math/lie_step.h"

namespace obscura::sim {

namespace {

struct Frame {
  Vec3 home = Vec3::Zero();  // x0
  Vec3 x = Vec3::Zero(), v = Vec3::Zero(), w = Vec3::Zero();
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  // R
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  double angle = 0;  // in the plane, rad

  void place(Vec3& p) const { p = home + R * (p - x); }
  void vector(Vec3& f) const { f = R * f; }
  void velocity(Vec3& u, const Vec3& at) const { u = R * (u - v - w.cross(at - x)); }
  void spin(Vec3& own) const { own = R * (own - w); }
  void orientation(Eigen::Quaterniond& own) const { own = (turn * own).normalized(); }
};

class SeenFrom final : public Run {
 public:
  SeenFrom(std::unique_ptr<Run> run, int body, const Vec3& place, const Eigen::Quaterniond& orientation,
           double angle)
      : run_(std::move(run)), body_(body), home_(place), orientation_(orientation), angle_(angle) {}

  const SceneInfo& scene_info() const override { return run_->scene_info(); }
  Rational rate() const override { return run_->rate(); }
  std::variant<std::monostate, Trouble, Stopped> go(std::int64_t step) override { return run_->go(step); }
  void heed(std::function<bool()> stop) override { run_->heed(std::move(stop)); }
  void keep_whole_steps() override { run_->keep_whole_steps(); }
  void show_divergence() override { run_->show_divergence(); }
  std::optional<Divergence> divergence() const override { return run_->divergence(); }
  std::vector<std::uint64_t> saved() const override { return run_->saved(); }
  Rational now() const override { return run_->now(); }
  bool restore(std::span<const std::uint64_t> saved) override { return run_->restore(saved); }
  BodyColumns columns() const override { return run_->columns(); }
  std::string set(const NewBodyColumns& columns) override { return run_->set(columns); }
  std::vector<RunEvent> events() const override { return run_->events(); }
  LimitsMet limits_met() const override { return run_->limits_met(); }
  std::vector<std::uint64_t> words() const override { return run_->words(); }

  std::variant<Snapshot, Trouble, Stopped> at(Rational t) override {
    auto answer = run_->at(t);
    if (Snapshot* now = std::get_if<Snapshot>(&answer)) {
      const Snapshot::Body& it = now->bodies[std::size_t(body_)];
      see(*now, frame(it.position, it.velocity, it.spin, it.orientation, it.angle));
    }
    return answer;
  }

  void track(std::vector<int> bodies) override {
    asked_ = bodies.size();
    bodies.push_back(body_);
    run_->track(std::move(bodies));
  }

  Track take_track() override {
    Track track = run_->take_track();
    std::vector<Track::Point> own = std::move(track.points.back());
    track.bodies.resize(asked_), track.points.resize(asked_);
    if (last_) own.insert(own.begin(), *last_);
    if (own.empty()) return track;
    for (auto& way : track.points) {
      for (Track::Point& point : way) {
        const Frame frame = after(own, point.time);
        frame.velocity(point.velocity, point.place), frame.place(point.place);
        frame.spin(point.spin), frame.orientation(point.orientation);
      }
    }
    last_ = own.back();
    return track;
  }

 private:
  Frame frame(const Vec3& x, const Vec3& v, const Vec3& w, const Eigen::Quaterniond& orientation,
              double angle) const {
    Frame frame;
    frame.home = home_, frame.x = x, frame.v = v, frame.w = w;
    frame.turn = (orientation_ * orientation.conjugate()).normalized();
    frame.R = frame.turn.toRotationMatrix();
    frame.angle = angle - angle_;
    return frame;
  }

  // its frame just after the last point of its way: what comes later does not count, for it depends on when
  // the ways are taken
  Frame after(const std::vector<Track::Point>& own, double t) const {
    const auto next = std::upper_bound(own.begin(), own.end(), t,
                                       [](double time, const Track::Point& p) { return time < p.time; });
    const Track::Point& from = next == own.begin() ? own.front() : *(next - 1);
    const double dt = t - from.time;
    if (!(dt > 0)) return frame(from.place, from.velocity, from.spin, from.orientation, 0);
    const Orientation<3> turn = turned<3>(from.orientation.coeffs(), AngularVec<3>(from.spin * dt));
    return frame(from.place + from.velocity * dt, from.velocity, from.spin, Eigen::Quaterniond(turn), 0);
  }

  static void see(Snapshot& now, const Frame& frame) {
    for (Snapshot::Body& it : now.bodies) {
      frame.velocity(it.velocity, it.position), frame.place(it.position);
      frame.spin(it.spin), frame.orientation(it.orientation);
      it.angle -= frame.angle;
      for (Vec3* f : {&it.blast, &it.drag, &it.field, &it.held, &it.torque}) frame.vector(*f);
    }
    if (now.gravity) frame.vector(*now.gravity);
    for (Snapshot::Spring& it : now.springs) frame.place(it.a), frame.place(it.b), frame.vector(it.force);
    for (Snapshot::Joint& it : now.joints) {
      frame.place(it.a), frame.place(it.b), frame.vector(it.force), frame.vector(it.torque);
      for (Snapshot::Joint::Hold& hold : it.holds) {
        frame.place(hold.place), frame.place(hold.at);
        frame.vector(hold.force), frame.vector(hold.torque);
      }
    }
    for (Snapshot::Mouse& it : now.mice)
      frame.place(it.pointer), frame.place(it.held), frame.vector(it.force);
    for (Snapshot::Contact& it : now.contacts) {
      frame.place(it.point), frame.vector(it.normal);
      frame.vector(it.impulse), frame.vector(it.force);
    }
  }

  std::unique_ptr<Run> run_;
  int body_ = -1;
  Vec3 home_;
  Eigen::Quaterniond orientation_;
  double angle_ = 0;
  std::size_t asked_ = 0;                  // bodies whose ways are kept
  std::optional<Track::Point> last_ = {};  // of its own way, that was taken
};

}  // namespace

std::unique_ptr<Run> seen_from(std::unique_ptr<Run> run, int body, const Vec3& place,
                               const Eigen::Quaterniond& orientation, double angle) {
  return std::make_unique<SeenFrom>(std::move(run), body, place, orientation, angle);
}

}  // namespace obscura::sim
