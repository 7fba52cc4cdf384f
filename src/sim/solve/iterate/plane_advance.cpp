// How far each body goes in a step, and what of that is to be swept: by the mean of old and new velocity;
// struck at tau, by that up to tau and after it; by the new one where a slow touch closed.

#include <algorithm>
#include <cmath>

#include "sim/solve/iterate/plane.h"
#include "sim/solve/iterate/wide_sin_cos.h"

namespace obscura::sim {

using plane::Feature;
using plane::kLanes;
using plane::Pair;

void PlaneIterative::place_bodies(StepPart<D> part) {
  State<D>& state = part.state;
  const double h = part.h;
  const int n = int(turns_.size()), still = n - int(state.turn.size());
  const bool correct = first(part) && deep_;
  if (correct) push_out(state);

  begun_ = poses_;
  // bodies with slow contacts that closed
  std::fill(closing_.begin(), closing_.end(), 0);
  for (const int i : slow_)
    closing_[batches_[i / kLanes].a[i % kLanes]] = closing_[batches_[i / kLanes].b[i % kLanes]] = 1;
  if (joints_.stopped())
    for (const int i : joints_.bodies()) closing_[i] = 0;

  const auto move = [&](int i, Motion d) {
    const Motion& v = moving_[i];
    if (correct) d.x += push_[i].x, d.y += push_[i].y, d.w += push_[i].w;
    state.x[i][0] = poses_[i].x += d.x, state.x[i][1] = poses_[i].y += d.y;
    state.v[i][0] = v.x, state.v[i][1] = v.y;
    if (i >= still) {
      state.spin[i - still][0] = v.w;
      state.turn[i - still][0] = turns_[i] += d.w;
    }
  };
  // what is struck or fast looks at the ways of those around it, and may lose its velocity: one by one
  const auto alone = [&](int i) {
    const Motion& o = old_[i];
    const double far = 0.5 * kSight * cores_.half_thickness[i];
    return impacts_.last(i) >= 0 || h * h * (o.x * o.x + o.y * o.y) > far * far;
  };
  for (int i = 0; i < n; ++i)
    if (moving_[i].im != 0 && alone(i)) move(i, way_to_first_hit(i, h));
  each(workers(), n, kBodyPiece, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const Motion& v = moving_[i];
      if (v.im != 0 && !alone(i))
        move(i, closing_[i] ? Motion{h * v.x, h * v.y, h * v.w, 0} : mean_way(i, h));
    }
  });
  place_driven(state);
  each(workers(), n - still, kBodyPiece, [&](int begin, int end) {
    plane::turn_all(turns_.data() + still + begin, poses_.data() + still + begin, end - begin);
  });
}

// by the mean of old and new velocity
plane::Motion PlaneIterative::mean_way(int i, double h) const {
  const Motion &v = moving_[i], &o = old_[i], &dv = dv_[i], &dx = dx_[i];
  const double half = 0.5 * h;
  return {dx.x + half * (v.x - (o.x + dv.x)), dx.y + half * (v.y - (o.y + dv.y)),
          dx.w + half * (v.w - (o.w + dv.w)), 0};
}

// The way of a body in the substep. One that is fast goes up to its first hit (conservative advancement), and
// has the velocity it had before.
plane::Motion PlaneIterative::way_to_first_hit(int i, double h) {
  const Motion &v = moving_[i], &o = old_[i], &dv = dv_[i];
  const double when = impacts_.first(i);
  Motion d;
  if (when >= 0) {
    const double two = 0.5 * (h - impacts_.last(i));
    const Motion &there = impacts_.way(i), &a = impacts_.after(i);
    Motion back{two * (a.x + v.x), two * (a.y + v.y), two * (a.w + v.w), 0};
    if (fast(i, back)) {
      plane::Pose from = poses_[i];
      from.x += there.x, from.y += there.y;
      const double part = safe_fraction(i, from, back, impacts_.last(i), h, true);
      back.x *= part, back.y *= part, back.w *= part;
    }
    d = {there.x + back.x, there.y + back.y, there.w + back.w, 0};
    // what holds it since then has held it from then on
    if (sinks(i, d, h)) {
      const double left = h - impacts_.last(i);
      d = {there.x + left * v.x, there.y + left * v.y, there.w + left * v.w, 0};
    }
  } else if (closing_[i]) {
    d = {h * v.x, h * v.y, h * v.w, 0};
  } else {
    d = mean_way(i, h);
  }
  // continuous collision: a fast body stops at its first hit and collides in the next step
  const Motion way{h * o.x, h * o.y, h * o.w, 0};
  if (!fast(i, way)) return d;
  const double part = safe_fraction(i, poses_[i], way, 0, h, false);
  if (part >= 1) return d;
  // the impact it met is what was seen, within half of its thickness
  const double over = when - part * h;
  if (when >= 0 && (over <= 0 || !fast(i, {over * o.x, over * o.y, 0, 0}))) return d;
  // what another was given against it stays given
  const double gone = std::fabs(v.x - (o.x + dv.x)) + std::fabs(v.y - (o.y + dv.y)) +
                      std::fabs(v.w - (o.w + dv.w)) * cores_.bounding_radius[i];
  if (when < 0 && gone <= 1e-9 * (std::fabs(o.x) + std::fabs(o.y))) {
    const double im = moving_[i].im;
    moving_[i] = o, moving_[i].im = im;
  }
  return {part * way.x, part * way.y, part * way.w, 0};
}

// whether a body comes to lie in what presses against it, if it goes this way
bool PlaneIterative::sinks(int body, const Motion& way, double h) const {
  for (const int i : impacts_.around(body)) {
    const Pair& pair = pairs_.all()[i];
    const int other = body == pair.a ? pair.b : pair.a, none = int(turns_.size());
    const plane::ContactBatch& g = batches_[pair.slot / kLanes];
    const int lane = pair.slot % kLanes;
    Motion its{};
    if (other >= 0 && moving_[other].im > 0)
      its = closing_[other] ? Motion{h * moving_[other].x, h * moving_[other].y, h * moving_[other].w, 0}
                            : mean_way(other, h);
    if (drives_.number(other) >= 0) its = dx_[other];
    const double let = allowed_overlap_(g.far[lane], 1 / g.per_width[lane]);
    for (int k = 0; k < pair.touches; ++k) {
      const plane::TouchRow at = plane::row(g, lane, k, begun_[pair.a], begun_[pair.b < 0 ? none : pair.b]);
      if (g.p[k][lane] * at.nx + g.q[k][lane] * at.ny <= 0) continue;
      const double moves =
          body == pair.a ? plane::normal_speed(at, way, its) : plane::normal_speed(at, its, way);
      if (std::min(at.gap, 0.0) + moves < -let) return true;
    }
  }
  return false;
}

// whether it may pass through something in the step
bool PlaneIterative::fast(int body, const Motion& way) const {
  const double half = 0.5 * kSight * cores_.half_thickness[body];
  return way.x * way.x + way.y * way.y > half * half;
}

// The part of its way from `begun` s of the substep on that a body may go before it meets another, which
// flies on as it did, or a wall: by steps as long as the distance that is left.
double PlaneIterative::safe_fraction(int body, const plane::Pose& from, const Motion& way, double begun,
                                     double h, bool walls) const {
  double part = 1;
  Feature features[2];
  for (const int i : impacts_.around(body)) {
    const Pair& pair = pairs_.all()[i];
    const plane::CoreShape& a = cores_.all[pair.core_a];
    if (pair.b < 0) {
      const Wall<D>& wall = model_.walls[-1 - pair.b];
      const double nears = -(wall.normal[0] * way.x + wall.normal[1] * way.y);
      const double gap = find_features(cores_, a, from, wall, features) + 0.02 * a.half_thickness;
      if (walls && nears > gap) part = std::min(part, std::max(gap, 0.0) / nears);
      continue;
    }
    const plane::CoreShape& b = cores_.all[pair.core_b];
    const double thin = std::min(a.half_thickness, b.half_thickness);
    const double close = 0.02 * std::max(thin, 1e-6 * model_.scale);
    const int other = body == pair.a ? pair.b : pair.a;
    const Motion& o = old_[other];
    const double time = h - begun, x = way.x - time * o.x, y = way.y - time * o.y;
    const double length = std::sqrt(x * x + y * y);
    if (length == 0) continue;
    plane::Pose at = from, there = begun_[other];
    there.x += begun * o.x, there.y += begun * o.y;
    for (double gone = 0; gone < part;) {
      at.x = from.x + gone * x, at.y = from.y + gone * y;
      const double left = body == pair.a ? find_features(cores_, a, at, b, there, features)
                                         : find_features(cores_, a, there, b, at, features);
      // what is as near as this from the first, its rows keep apart
      if (gone == 0 && left <= sight(a, b)) break;
      if (left <= close) {
        part = gone;
        break;
      }
      gone += std::max(left - 0.5 * close, 0.5 * close) / length;
    }
  }
  return part;
}

// whether a body may come farther in `left` s until the next look than its pairs foresaw, by more than a part
// of its thickness
bool PlaneIterative::outran(double h, double left) const {
  const int n = int(turns_.size());
  const double falls = 3 * h * span_ * std::sqrt(model_.gravity.squaredNorm());
  for (int i = 0; i < n; ++i) {
    const Motion &v = moving_[i], &o = old_[i];
    const double radius = cores_.bounding_radius[i];
    const double gain = std::fabs(v.x - o.x) + std::fabs(v.y - o.y) + std::fabs(v.w - o.w) * radius;
    if (gain * left < 0.04 * cores_.half_thickness[i] + falls) continue;
    const auto speed = [&](const Motion& m) {
      return std::sqrt(m.x * m.x + m.y * m.y) + std::fabs(m.w) * radius;
    };
    if ((speed(v) - speed(o)) * left >
        0.25 * cores_.half_thickness[i] + pairs_.spare(i, speed(o), span_) + falls)
      return true;
  }
  return false;
}

}  // namespace obscura::sim
