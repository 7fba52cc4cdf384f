#include "sim/solve/iterate/plane_near_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/math/orientation.h"
#include "sim/math/workers.h"
#include "sim/solve/iterate/pieces.h"

namespace obscura::sim::plane {

namespace {

constexpr double kCalm = 0.02;    // of the least thickness: how far a calm body may come
constexpr double kSpare = 0.025;  // of the thickness of both: what they may come nearer by impacts
constexpr double kThrown = 1.25;  // times as fast as they are now, likewise

}  // namespace

NearPairs::NearPairs(const Model<2>& model, const CoreShapes& cores)
    : model_(model), cores_(cores), may_touch_(model), halves_(halves(cores)) {
  double thin = 1e300;
  for (const double half : cores.half_thickness) thin = std::min(thin, std::max(half, 1e-3 * model.scale));
  calm_ = kCalm * thin;
  const std::size_t n = model.bodies.size();
  movers_.resize(n), still_.resize(n), exposed_.resize(n);
  bounds_.resize(cores.all.size()), still_cores_.resize(cores.all.size());
  for (const CoreShape& core : cores.all) points_.push_back(core.count == 1 && core.radius <= 0);
  for (std::size_t i = 0; i < n; ++i) {
    movers_[i].bounding_radius = cores.bounding_radius[i];
    movers_[i].half_thickness = std::max(cores.half_thickness[i], 1e-3 * model.scale);
    const Body<2>& body = model.bodies[i];
    fixed_.push_back(body.fixed && !body.driven), handout_.push_back(body.handout);
    if (body.driven) farther_.resize(n);
    elasticity_ = std::max(elasticity_, model.bodies[i].elasticity);
  }
  for (const Wall<2>& wall : model.walls) elasticity_ = std::max(elasticity_, wall.elasticity.value_or(0));
}

double NearPairs::spare(int body, double speed, double span) const {
  const double thick = movers_[body].half_thickness;
  return 0.05 * thick + std::min(0.2 * thick, speed * span);
}

// velocities of the moving bodies, and how far each may get within the span
void NearPairs::compute_margins(const State<2>& state, const std::vector<Pose>& poses, double span,
                                int patience) {
  const int n = int(movers_.size()), points = n - int(state.turn.size());
  const double falls = span * std::sqrt(model_.gravity.squaredNorm());
  for (int body = 0; body < n; ++body) {
    Mover& m = movers_[body];
    m.x = poses[body].x, m.y = poses[body].y;
    m.vx = state.v[body][0], m.vy = state.v[body][1];
    m.swing = body >= points ? std::fabs(state.spin[body - points][0]) * m.bounding_radius : 0;
    m.speed = std::sqrt(m.vx * m.vx + m.vy * m.vy) + m.swing;
    const bool rests = fixed_[body] || state.frozen[body];
    still_[body] = rests || (patience > 0 && patience * span * m.speed < calm_);
    m.margin = rests ? 0 : span * (m.speed + falls) + spare(body, m.speed, span);
  }
  if (farther_.empty()) return;
  for (int body = 0; body < n; ++body) {
    if (!model_.bodies[body].driven) continue;
    still_[body] = 0, movers_[body].margin += farther_[body];
  }
}

// cores and their margins
void NearPairs::compute_bounds(const std::vector<Pose>& poses) {
  constexpr double kNever = std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < int(bounds_.size()); ++i) {
    const CoreShape& core = cores_.all[i];
    const Pose& at = poses[core.body];
    const double out = core.radius + movers_[core.body].margin;
    Bounds<2>& b = bounds_[i];
    still_cores_[i] = still_[core.body];
    if (handout_[core.body]) {
      b.lower = b.upper = Vec<2>::Constant(kNever);
      continue;
    }
    if (core.wide > 0) {
      const double c = std::fabs(at.c), s = std::fabs(at.s);
      const double wide = c * core.wide + s * core.high + out, high = s * core.wide + c * core.high + out;
      b.lower = {at.x - wide, at.y - high}, b.upper = {at.x + wide, at.y + high};
      continue;
    }
    b.lower.setConstant(1e300), b.upper.setConstant(-1e300);
    for (int k = core.first; k < core.first + core.count; ++k) {
      const Vec<2> p(at.x + (at.c * cores_.x[k] - at.s * cores_.y[k]),
                     at.y + (at.s * cores_.x[k] + at.c * cores_.y[k]));
      b.lower = b.lower.cwiseMin(p), b.upper = b.upper.cwiseMax(p);
    }
    b.lower.array() -= out, b.upper.array() += out;
  }
}

// Marks bodies that may be struck within the span: those that may reach another body or a wall with their
// present velocities, those that they may be thrown against, and so on. Drops pairs of which neither body may
// be struck: two bodies that fly side by side do not touch. If one of two bodies is struck, they may approach
// with the full speed of the other, and faster if the first bounces; the margin of a pair covers that.
void NearPairs::mark_possible_impacts(double span) {
  const int n = int(movers_.size());
  groups_.reset(n);
  for (int a = 0; a < n; ++a) {
    exposed_[a] = 0;
    if (still_[a]) continue;
    const Mover& m = movers_[a];
    for (const Wall<2>& w : model_.walls) {
      const double high = w.normal[0] * (m.x - w.point[0]) + w.normal[1] * (m.y - w.point[1]);
      if (high <= m.bounding_radius + m.margin) exposed_[a] = 1;
    }
  }
  const double falls = 2 * span * span * std::sqrt(model_.gravity.squaredNorm());
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const int a = cores_.all[candidates_[i].a].body, b = cores_.all[candidates_[i].b].body;
    const Mover &p = movers_[a], &q = movers_[b];
    const double vx = p.vx - q.vx, vy = p.vy - q.vy;
    const double passes = std::sqrt(vx * vx + vy * vy) + p.swing + q.swing;
    const double both = p.margin + q.margin, thick = p.half_thickness + q.half_thickness;
    const double farther = farther_.empty() ? 0 : farther_[a] + farther_[b];
    const double margin = std::min(both, span * passes + falls + 0.1 * thick + farther);
    const double far = p.bounding_radius + q.bounding_radius + margin, dx = p.x - q.x, dy = p.y - q.y;
    const double thrown = std::max(p.speed, q.speed) + elasticity_ * std::min(p.speed, q.speed);
    candidates_[i].margin =
        std::min(both, span * kThrown * std::max(passes, thrown) + falls + kSpare * thick + farther);
    if (dx * dx + dy * dy <= far * far) exposed_[a] = exposed_[b] = 1;
    if (!still_[a] && !still_[b]) groups_.join(a, b);
  }
  for (int a = 0; a < n; ++a) {
    if (exposed_[a]) exposed_[groups_.root(a)] = 1;
  }
  const auto struck = [&](int core) { return exposed_[groups_.root(cores_.all[core].body)] != 0; };
  std::erase_if(candidates_, [&](const Candidate& c) { return !struck(c.a) && !struck(c.b); });
}

bool NearPairs::find(const State<2>& state, const std::vector<Pose>& poses, double span, int patience) {
  compute_margins(state, poses, span, patience);
  candidates_.clear();
  if (patience > 0 && std::find(still_.begin(), still_.end(), 0) == still_.end()) return false;
  compute_bounds(poses);
  for (const auto& [i, j] : broad_.find(bounds_, still_cores_, {}, points_)) {
    const CoreShape &p = cores_.all[i], &q = cores_.all[j];
    if (p.body == q.body) continue;
    if (may_touch_(p.body, q.body)) candidates_.push_back({i, j, -1, 0});
  }
  mark_possible_impacts(span);

  collide_box_pairs(poses);
  return true;
}

// boxes, four pairs at once
void NearPairs::collide_box_pairs(const std::vector<Pose>& poses) {
  int count = 0;
  for (Candidate& c : candidates_) {
    const int a = cores_.all[c.a].body, b = cores_.all[c.b].body;
    if (!boxes(a, b)) continue;
    c.meeting = count++;
    if (c.meeting / kLanes == int(manifolds_.size())) manifolds_.emplace_back();
    BoxManifold& m = manifolds_[c.meeting / kLanes];
    // fill unused lanes with the dummy body
    if (c.meeting % kLanes == 0) {
      for (int lane = 0; lane < kLanes; ++lane) m.a[lane] = m.b[lane] = int(movers_.size());
    }
    m.a[c.meeting % kLanes] = a, m.b[c.meeting % kLanes] = b;
  }
  sim::each(model_.workers.get(), (count + kLanes - 1) / kLanes, kPlaneBatchPiece, [&](int begin, int end) {
    plane::collide_boxes(manifolds_.data() + begin, end - begin, poses.data(), halves_.data(),
                         cores_.passing);
  });
}

void NearPairs::find_outdated(const std::vector<ContactBatch>& batches, const std::vector<Motion>& v,
                              const std::vector<Pose>& poses, double share, std::vector<ChangedPair>& boxes,
                              LaneList& others) {
  const int count = int(batches.size()), piece = model_.workers ? kActiveBatchPiece : std::max(1, count);
  const std::size_t pieces = std::size_t(count + piece - 1) / std::size_t(piece);
  if (outdated_.size() < pieces) outdated_.resize(pieces);
  for (Outdated& found : outdated_) found.boxes.clear(), found.others.clear();
  sim::each(model_.workers.get(), count, piece, [&](int begin, int end) {
    Outdated& found = outdated_[std::size_t(begin / piece)];
    plane::find_outdated(batches.data() + begin, end - begin, v.data(), poses.data(), halves_.data(),
                         cores_.passing, share, found.boxes, found.others);
    for (int& lane : found.others) lane += kLanes * begin;
  });
  boxes.clear(), others.clear();
  for (const Outdated& found : outdated_) {
    boxes.insert(boxes.end(), found.boxes.begin(), found.boxes.end());
    others.insert(others.end(), found.others.begin(), found.others.end());
  }
}

}  // namespace obscura::sim::plane
