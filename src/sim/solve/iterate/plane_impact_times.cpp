// When a pair meets with an impact in a step, and how it stands then: with the velocity that each body has
// after its last impact, or when the step began,
//   g(x + v tau + a tau^2 / 2) = 0
// of the features that are nearest at tau.

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/math/trig.h"
#include "sim/solve/iterate/closing_time.h"
#include "sim/solve/iterate/plane_impacts.h"

namespace obscura::sim::plane {

namespace {

constexpr double kForward = 0.01;  // of the step: by so much at least features are looked for on the way

// two corners of polygons: others may come nearer, however these move
bool other_corners(const ContactBatch& g, int k, int lane) {
  return (g.corners[k] >> lane & 1) != 0 && g.radius[lane] == 0;
}

}  // namespace

// where a body is at a time after its last impact, and how it moves there
void Impacts::move(int body, double when, const Step& step, Pose& pose, Motion& v) const {
  const bool there = when_[body] == when;
  pose = there ? pose_[body] : step.poses[body], v = now_[body];
  if (there) return;
  const Motion way = way_at(body, when, step), &gain = step.dv[body];
  const double share = (when - std::max(0.0, when_[body])) / step.constants.h;
  v.x += share * gain.x, v.y += share * gain.y, v.w += share * gain.w;
  pose.x += way.x, pose.y += way.y;
  if (way.w == 0) return;
  const SinCos turn = sin_cos(way.w);
  const double c = pose.c;
  pose.c = c * turn.cos - pose.s * turn.sin, pose.s = pose.s * turn.cos + c * turn.sin;
}

// from where the step begins
Motion Impacts::way_at(int body, double when, const Step& step) const {
  const Motion &v = now_[body], &gain = step.dv[body];
  const double time = when - std::max(0.0, when_[body]), half = 0.5 * (time / step.constants.h);
  Motion way{time * (v.x + half * gain.x), time * (v.y + half * gain.y), time * (v.w + half * gain.w)};
  if (when_[body] >= 0) way.x += way_[body].x, way.y += way_[body].y, way.w += way_[body].w;
  return way;
}

// a pair at a time
Impacts::PlacedPair Impacts::placed_at(const Pair& pair, double when, const ContactBatch& g,
                                       const Step& step) const {
  const int lane = pair.slot % kLanes, a = g.a[lane], b = g.b[lane];
  PlacedPair at;
  at.when = when;
  Pose pose_a, pose_b;
  const bool start = when == 0;
  if (start)
    at.a = now_[a], at.b = now_[b];
  else
    move(a, when, step, pose_a, at.a), move(b, when, step, pose_b, at.b);
  for (int k = 0; k < pair.touches; ++k)
    at.rows[k] = row(g, lane, k, start ? step.poses[a] : pose_a, start ? step.poses[b] : pose_b);
  return at;
}

// when a touch closes with an impact, by its course from where it stands, s; never: kNeverCloses
double Impacts::closing_guess(const Pair& pair, int k, const ContactBatch& g, const PlacedPair& at,
                              const Step& step) const {
  const int lane = pair.slot % kLanes;
  const Motion &a = at.a, &b = at.b, &gain_a = step.dv[g.a[lane]], &gain_b = step.dv[g.b[lane]];
  const TouchRow& r = at.rows[k];
  const double vn = normal_speed(r, a, b), gap = r.gap;
  const double dvn = normal_speed(r, gain_a, gain_b), left = std::max(0.0, gap);
  const double slow = strike_speed(pair, g.impact_speed[lane], dvn, step);
  if (gap > g.sight[lane]) return kNeverCloses;
  if (!(vn < slow)) {
    // it may yet, by forces: gap + vn t + dvn t^2 / 2 h = 0
    const double gain = gains(dvn, pair) * (1 - at.when / step.constants.h);
    if (gap <= 0 || !(vn + gain < slow)) return kNeverCloses;
    return at.when +
           (vn + std::sqrt(vn * vn - 2 * dvn / step.constants.h * left)) / -(dvn / step.constants.h);
  }
  // two corners: |l n + v t| = radius, if they do not pass
  if (g.corners[k] >> lane & 1) {
    const double vt = r.nx * (a.y - b.y) - r.ny * (a.x - b.x) + (r.ta * a.w - r.tb * b.w);
    const double p = (left + g.radius[lane]) * vn, q = left * (left + 2 * g.radius[lane]);
    const double under = p * p - (vn * vn + vt * vt) * q;
    if (under > 0) return at.when + q / (std::sqrt(under) - p);
  }
  return at.when + left / -std::min(vn, vn - 0.5 * dvn * left / (step.constants.h * vn));
}

// the same where its bodies stand by then
double Impacts::closing_time(const Pair& pair, int k, const ContactBatch& g, const PlacedPair& start,
                             const Step& step) const {
  const double guess = closing_guess(pair, k, g, start, step);
  if (start.rows[k].gap <= 0) return guess;
  const int lane = pair.slot % kLanes;
  const double dvn = normal_speed(start.rows[k], step.dv[g.a[lane]], step.dv[g.b[lane]]);
  if (guess == kNeverCloses) {
    // what turns may begin to close on the way
    const double time = step.constants.h - start.when, vn = normal_speed(start.rows[k], start.a, start.b);
    const double nearer = 0.5 * time * time * most_bend(pair, start.a, start.b);
    if (start.rows[k].gap > g.sight[lane] ||
        start.rows[k].gap + time * (vn + 0.5 * time / step.constants.h * dvn) >= nearer)
      return kNeverCloses;
  }
  return sim::closing_time(start.when, guess, step.constants.h,
                           strike_speed(pair, g.impact_speed[lane], dvn, step), [&](double when) {
                             const PlacedPair at = placed_at(pair, when, g, step);
                             return GapInTime{at.rows[k].gap, normal_speed(at.rows[k], at.a, at.b)};
                           });
}

// by how much, at most, a gap's second derivative is below zero by how its bodies turn, m/s^2
double Impacts::most_bend(const Pair& pair, const Motion& va, const Motion& vb) const {
  const double far = std::max(bounding_radius_[pair.a], pair.b < 0 ? 0 : bounding_radius_[pair.b]),
               w = std::fabs(va.w) + std::fabs(vb.w);
  return far * (va.w * va.w + vb.w * vb.w) +
         2 * w * (std::fabs(va.x - vb.x) + std::fabs(va.y - vb.y) + far * w);
}

// Whether a pair may meet with an impact in what is left of the step, by its rows as it stands: most do not.
bool Impacts::may_meet(const Pair& pair, const ContactBatch& g, const Step& step) const {
  const int lane = pair.slot % kLanes, a = pair.a, b = pair.b >= 0 ? pair.b : int(now_.size()) - 1;
  const double from = std::max({0.0, when_[a], when_[b]}), time = step.constants.h - from;
  Pose pose_a = step.poses[a], pose_b = step.poses[b];
  Motion va = now_[a], vb = now_[b];
  if (from > 0) move(a, from, step, pose_a, va), move(b, from, step, pose_b, vb);
  const double bend = most_bend(pair, va, vb);
  const auto fastest = [&] {
    return std::fabs(va.x - vb.x) + std::fabs(va.y - vb.y) +
           g.far[lane] * (std::fabs(va.w) + std::fabs(vb.w));
  };
  for (int k = 0; k < pair.touches; ++k) {
    const TouchRow r = row(g, lane, k, pose_a, pose_b);
    const double vn = normal_speed(r, va, vb);
    if (other_corners(g, k, lane) && r.gap < time * (fastest() + step.constants.free_dv)) return true;
    const double dvn = normal_speed(r, step.dv[a], step.dv[b]);
    const double ends = vn + time / step.constants.h * gains(dvn, pair);
    const double slow = strike_speed(pair, g.impact_speed[lane], dvn, step);
    if (!(ends - time * bend < slow)) continue;
    // what it may come nearer than by these rows and velocities
    const double left = r.gap + time * (vn + 0.5 * time / step.constants.h * dvn);
    if (left >= 0 && left >= 0.5 * time * time * bend) continue;
    if (r.gap <= g.sight[lane]) return true;
  }
  return false;
}

// when the first of a pair's touches closes with an impact, and which
double Impacts::first_closing(const Pair& pair, const ContactBatch& g, const PlacedPair& start,
                              const Step& step, int& which) const {
  double first = kNeverCloses;
  which = 0;
  for (int k = 0; k < pair.touches; ++k) {
    const double when = closing_time(pair, k, g, start, step);
    if (when < first) first = when, which = k;
  }
  return first;
}

// the features of a pair that are nearest at a time
void Impacts::features_at(const Pair& pair, double when, const Step& step, int (&words)[2]) const {
  Pose a, b;
  Motion ignored;
  move(pair.a, when, step, a, ignored),
      move(pair.b >= 0 ? pair.b : int(now_.size()) - 1, when, step, b, ignored);
  pairs_.features(pair, a, b, words);
}

// whether the k-th feature of its lane is among them
bool Impacts::still_nearest(const Pair& pair, const int (&words)[2], const ContactBatch& by, int k) {
  const int known = by.words[k][pair.slot % kLanes];
  return known == words[0] || (pair.touches > 1 && known == words[1]);
}

// whether others are nearer than those of its lane
bool Impacts::outdated(const Pair& pair, const int (&words)[2], const ContactBatch& by) {
  return !still_nearest(pair, words, by, 0) || (pair.touches > 1 && !still_nearest(pair, words, by, 1));
}

// a pair at a time by these features, in the lane that fresh_ has of it
Impacts::PlacedPair Impacts::placed_renewed(const Pair& pair, const int (&words)[2], double when,
                                            const Step& step) {
  pairs_.put(pair, words, fresh_);
  PlacedPair at = placed_at(pair, when, fresh_, step);
  at.renewed = true;
  return at;
}

// Moves `at`, the placed pair, to the time of its impact; false if it has none. Takes the features of its
// lane. If other features are nearest by then, conservative advancement: goes on by a time in which the pair
// surely does not meet, takes the nearest features there, and again until these are still the nearest when
// they close.
bool Impacts::find_meeting(const Pair& pair, const ContactBatch& g, PlacedPair& at, const Step& step) {
  const int lane = pair.slot % kLanes, a = g.a[lane], b = g.b[lane];
  int which, words[2];
  double when = first_closing(pair, g, at, step, which);
  const auto find_features = [&](double time) { features_at(pair, time, step, words); };
  const auto place_renewed = [&](double time) { at = placed_renewed(pair, words, time, step); };
  // whether that is all there is to find
  const auto found = [&](const ContactBatch& by) {
    // round things have no other features
    if (g.calm[lane] < 1e300) {
      find_features(std::min(when, step.constants.h));
      if (outdated(pair, words, by)) {
        if (&by != &fresh_) copy_lane(by, lane, fresh_, lane);
        if (when == kNeverCloses || !still_nearest(pair, words, by, which)) return false;
        place_renewed(when);
        return true;
      }
    }
    if (when < kNeverCloses && when != at.when) {
      at = placed_at(pair, when, by, step);
      at.renewed = &by != &g;
    }
    return true;
  };
  if (found(g)) return when < kNeverCloses;

  const double from = at.when;
  const Motion &p = at.a, &q = at.b;
  const double fastest = std::fabs(p.x - q.x) + std::fabs(p.y - q.y) +
                         std::fabs(step.dv[a].x - step.dv[b].x) + std::fabs(step.dv[a].y - step.dv[b].y) +
                         (std::fabs(p.w) + std::fabs(step.dv[a].w)) * bounding_radius_[a] +
                         (std::fabs(q.w) + std::fabs(step.dv[b].w)) * bounding_radius_[b];
  // next to nothing where faces pass by: they have none
  const auto gap = [&] {
    const double least = pair.touches > 1 ? std::min(at.rows[0].gap, at.rows[1].gap) : at.rows[0].gap;
    return least < kNowhere / 2 ? least : std::numeric_limits<double>::min();
  };
  double apart = -1;  // s: when it was last
  for (double time = from; time <= step.constants.h;) {
    find_features(time), place_renewed(time);
    if (gap() <= 0 && apart >= 0) {
      // on the way
      for (double low = apart; time - low > kInTime * step.constants.h;) {
        const double mid = 0.5 * (low + time);
        find_features(mid), place_renewed(mid);
        (gap() > 0 ? low : time) = mid;
      }
      find_features(time), place_renewed(time);
    }
    when = first_closing(pair, fresh_, at, step, which);
    if (when == time) return true;
    if (found(fresh_)) return when < kNeverCloses;
    apart = gap() > 0 ? time : -1;
    time += std::max(kForward * step.constants.h, gap() / fastest);
  }
  return false;
}

// up to which gap the touches of a pair are closed, m
double Impacts::closed_gap(const Pair& pair, const PlacedPair& at, double far) {
  return closed_up_to(far, pair.touches > 1 ? std::min(at.rows[0].gap, at.rows[1].gap) : at.rows[0].gap);
}

// Touch k of an impact where its row stands; whether it is closed.
bool Impacts::place_touch(const TouchRow& r, double together, int k, Impact& impact) {
  impact.gap[k] = r.gap, impact.met[k] = r.gap <= together;
  // what meets is pushed in one point, so that angular momentum stays; what is to come together yet is
  // rubbed where it is touched
  const double apart = impact.met[k] ? 0 : 0.5 * r.gap;
  impact.pushes[0][k] = {r.nx, r.ny, r.na, r.nb};
  impact.pushes[1][k] = {-r.ny, r.nx, r.ta + apart, r.tb - apart};
  return impact.met[k];
}

// When and where a pair meets with an impact in the step, into `impact`; false where it does not.
bool Impacts::find_impact(const Pair& pair, Impact& impact, const ContactBatch& g, const Step& step) {
  const int lane = pair.slot % kLanes, a = g.a[lane], b = g.b[lane];
  const double from = std::max({0.0, when_[a], when_[b]});
  PlacedPair at = placed_at(pair, from, g, step);
  if (!find_meeting(pair, g, at, step)) return false;
  const double when = at.when;
  impact.when = when, impact.renewed = at.renewed;
  bool any = false;
  for (int k = 0; k < pair.touches; ++k) {
    const TouchRow& r = at.rows[k];
    place_touch(r, closed_gap(pair, at, g.far[lane]), k, impact);
    const double vn = normal_speed(r, at.a, at.b);
    if (impact.met[k]) impact.speed = std::max(impact.speed, -vn);
    const double dvn = normal_speed(r, step.dv[a], step.dv[b]);
    any = any || (impact.met[k] && vn < strike_speed(pair, g.impact_speed[lane], dvn, step));
  }
  return any;
}

}  // namespace obscura::sim::plane
