// A impact, handout §3.5, of both touches of a pair, normals and friction together
// (sim/solve/iterate/pair_impact.h):
//   v_n' = -e v_n,  l >= 0,  |lt| <= mu l
// at the time tau at which the first of them closes, and where the bodies stand then: until then a body flies
// with the velocity it had,
//   g(x + v tau + a tau^2 / 2) = 0
// after it with the one it got. An elastic ball keeps its energy to rounding.

#include "sim/solve/iterate/plane_impacts.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>

#include "sim/math/trig.h"
#include "sim/solve/iterate/pair_impact.h"

namespace obscura::sim::plane {

namespace {

constexpr std::size_t kPairsAhead = 4;  // pairs
constexpr double kLocked = 1e-9;        // of what a push moves without joints
constexpr double kTogether =
    1e-6;                  // of the larger bounding radius: no wider open, a touch meets with the other
constexpr int kTimes = 8;  // Newton steps for the time of an impact
constexpr double kInTime = 1e-9;   // of the step: the next would be by its square
constexpr double kForward = 0.01;  // of the step: by so much at least features are looked for on the way
constexpr double kLatest = 1.5;    // steps: so late a touch may close that its tangent would close in one

// v_n of a touch
double along(const Rows& r, int k, int lane, const Motion& a, const Motion& b) {
  return r.nx[k][lane] * (a.x - b.x) + r.ny[k][lane] * (a.y - b.y) +
         (r.na[k][lane] * a.w - r.nb[k][lane] * b.w);
}
double along(const TouchRow& r, const Motion& a, const Motion& b) {
  return r.nx * (a.x - b.x) + r.ny * (a.y - b.y) + (r.na * a.w - r.nb * b.w);
}

// two corners of polygons: others may come nearer, however these move
bool other_corners(const ContactBatch& g, int k, int lane) {
  return (g.corners[k] >> lane & 1) != 0 && g.radius[lane] == 0;
}

}  // namespace

Impacts::Impacts(const CoreShapes& cores, const Pairs& pairs)
    : pairs_(pairs), bounding_radius_(cores.bounding_radius) {
  const int bodies = int(bounding_radius_.size());
  bounding_radius_.push_back(0);
  around_start_.resize(bodies + 2);
  when_.assign(bodies + 1, -1);
  before_.resize(bodies + 1), now_.resize(bodies + 1);
}

void Impacts::join(const std::vector<Pair>& pairs, const std::vector<Motion>& v) {
  std::fill(around_start_.begin(), around_start_.end(), 0);
  const int n = int(around_start_.size()) - 2;
  const auto each = [&](const auto& act) {
    for (int i = 0; i < int(pairs.size()); ++i) {
      if (pairs[i].slot < 0) continue;
      for (const int body : {pairs[i].a, pairs[i].b}) {
        if (body >= 0 && v[body].im > 0) act(i, body);
      }
    }
  };
  each([&](int, int body) { ++around_start_[body + 2]; });
  for (int i = 2; i < n + 2; ++i) around_start_[i] += around_start_[i - 1];
  around_.resize(around_start_[n + 1]);
  each([&](int i, int body) { around_[around_start_[body + 1]++] = i; });
  waiting_.assign(pairs.size(), 0), blow_.assign(pairs.size(), -1);
}

// as the step begins
const Rows& Impacts::rows(int group, const std::vector<ContactBatch>& seats, const std::vector<Pose>& poses) {
  if (known_[group] < 0) {
    known_[group] = int(groups_.size());
    groups_.push_back(group);
    rows_.emplace_back();
    expand(seats[group], poses.data(), rows_.back());
  }
  return rows_[known_[group]];
}

// a body meets its first impact of the step
void Impacts::reach(int body, double when, const std::vector<Motion>& dv, const StepConstants& pace) {
  if (now_[body].im == 0 || when_[body] >= 0) return;
  when_[body] = when;
  bodies_.push_back(body);
  const double part = when / pace.h;
  now_[body].x += part * dv[body].x, now_[body].y += part * dv[body].y, now_[body].w += part * dv[body].w;
  before_[body] = now_[body];
}

// where a body is at a time after its last impact, and how it moves there
void Impacts::move(int body, double when, const std::vector<Pose>& poses, const std::vector<Motion>& dv,
                   const StepConstants& pace, Pose& pose, Motion& v) const {
  pose = poses[body], v = now_[body];
  if (v.im == 0) return;
  const Motion& gain = dv[body];
  double x = 0, y = 0, w = 0;
  const auto fly = [&](const Motion& from, double time) {
    const double half = 0.5 * time / pace.h;
    x += time * (from.x + half * gain.x), y += time * (from.y + half * gain.y);
    w += time * (from.w + half * gain.w);
  };
  if (when_[body] < 0) {
    fly(v, when);
    const double part = when / pace.h;
    v.x += part * gain.x, v.y += part * gain.y, v.w += part * gain.w;
  } else {
    const double part = when_[body] / pace.h;
    const Motion& to = before_[body];
    fly({to.x - part * gain.x, to.y - part * gain.y, to.w - part * gain.w, 0}, when_[body]);
    fly(v, when - when_[body]);
  }
  pose.x += x, pose.y += y;
  if (w == 0) return;
  const SinCos turn = sin_cos(w);
  const double c = pose.c;
  pose.c = c * turn.cos - pose.s * turn.sin, pose.s = pose.s * turn.cos + c * turn.sin;
}

// a pair at a time
Impacts::Standing Impacts::clear_sleeping(const Pair& pair, double when, const ContactBatch& g,
                                          const std::vector<Pose>& poses, const std::vector<Motion>& dv,
                                          const StepConstants& pace) const {
  const int lane = pair.slot % kLanes, a = g.a[lane], b = g.b[lane];
  Standing at;
  at.when = when;
  Pose pose_a, pose_b;
  const bool start = when == 0;
  if (start)
    at.a = now_[a], at.b = now_[b];
  else
    move(a, when, poses, dv, pace, pose_a, at.a), move(b, when, poses, dv, pace, pose_b, at.b);
  for (int k = 0; k < pair.touches; ++k)
    at.rows[k] = row(g, lane, k, start ? poses[a] : pose_a, start ? poses[b] : pose_b);
  return at;
}

// when a touch closes with an impact, by its course from where it stands, s; never: 1e300
double Impacts::closing(const Pair& pair, int k, const ContactBatch& g, const Standing& at,
                        const std::vector<Motion>& dv, const StepConstants& pace) const {
  const int lane = pair.slot % kLanes;
  const Motion &a = at.a, &b = at.b, &gain_a = dv[g.a[lane]], &gain_b = dv[g.b[lane]];
  const TouchRow& r = at.rows[k];
  const double vn = along(r, a, b), gap = r.gap;
  if (gap > g.sight[lane] || !(vn < g.blow[lane])) return 1e300;
  const double dvn = along(r, gain_a, gain_b), left = std::max(0.0, gap);
  // two corners: |l n + v t| = radius, if they do not pass
  if (g.corners[k] >> lane & 1) {
    const double vt = r.nx * (a.y - b.y) - r.ny * (a.x - b.x) + (r.ta * a.w - r.tb * b.w);
    const double p = (left + g.radius[lane]) * vn, q = left * (left + 2 * g.radius[lane]);
    const double under = p * p - (vn * vn + vt * vt) * q;
    if (under > 0) return at.when + q / (std::sqrt(under) - p);
  }
  return at.when + left / -std::min(vn, vn - 0.5 * dvn * left / (pace.h * vn));
}

// The same where its bodies stand by then: Newton's method along the course; where the bodies turn so far
// that this misleads, by halving.
double Impacts::manifold(const Pair& pair, int k, const ContactBatch& g, const Standing& start,
                         const std::vector<Pose>& poses, const std::vector<Motion>& dv,
                         const StepConstants& pace) const {
  const int lane = pair.slot % kLanes, a = g.a[lane], b = g.b[lane];
  const TouchRow& r = start.rows[k];
  const double from = start.when;
  double when = closing(pair, k, g, start, dv, pace);
  if (when == 1e300 || r.gap <= 0) return when;
  const double vn = along(r, start.a, start.b), dvn = along(r, dv[a], dv[b]);
  const bool closes = r.gap + (pace.h - from) * (vn + 0.5 * dvn) < 0;
  double low = from, high = -1;
  for (int i = 0; i < kTimes && when <= from + kLatest * pace.h; ++i) {
    const Standing at = clear_sleeping(pair, when, g, poses, dv, pace);
    const double gap = at.rows[k].gap, speed = along(at.rows[k], at.a, at.b);
    if (gap > 0 && !(speed < 0)) {
      // it has come nearest before: was it closed then?
      for (double parts = when; parts - low > kInTime * pace.h && high < 0;) {
        const double mid = 0.5 * (low + parts);
        const Standing then = clear_sleeping(pair, mid, g, poses, dv, pace);
        if (then.rows[k].gap <= 0)
          high = mid;
        else
          (along(then.rows[k], then.a, then.b) < 0 ? low : parts) = mid;
      }
      if (high < 0) return 1e300;
      break;
    }
    if (!(speed < g.blow[lane])) break;
    const double next = when - gap / speed;
    if (std::fabs(next - when) <= kInTime * pace.h) return closes || when <= pace.h ? when : 1e300;
    when = std::clamp(next, from, from + kLatest * pace.h);
  }
  if (high < 0) {
    if (from >= pace.h || clear_sleeping(pair, pace.h, g, poses, dv, pace).rows[k].gap > 0) return 1e300;
    high = pace.h;
  }
  while (high - low > kInTime * pace.h) {
    when = 0.5 * (low + high);
    (clear_sleeping(pair, when, g, poses, dv, pace).rows[k].gap > 0 ? low : high) = when;
  }
  const Standing at = clear_sleeping(pair, low, g, poses, dv, pace);
  return along(at.rows[k], at.a, at.b) < g.blow[lane] ? low : 1e300;
}

// Whether a pair may meet with an impact in the step, as its rows were when it began: most do not.
bool Impacts::may_meet(const Pair& pair, const ContactBatch& g, const std::vector<Pose>& poses,
                       const std::vector<Motion>& dv, const StepConstants& pace) const {
  const int lane = pair.slot % kLanes, a = pair.a, b = pair.b >= 0 ? pair.b : int(now_.size()) - 1;
  const Motion &va = now_[a], &vb = now_[b];
  double spare = -1;  // what it may come nearer than by these rows and velocities, m
  const auto fastest = [&] {
    return std::fabs(va.x - vb.x) + std::fabs(va.y - vb.y) +
           g.far[lane] * (std::fabs(va.w) + std::fabs(vb.w));
  };
  for (int k = 0; k < pair.touches; ++k) {
    const TouchRow r = row(g, lane, k, poses[a], poses[b]);
    const double vn = along(r, va, vb);
    if (other_corners(g, k, lane) && r.gap < pace.h * (fastest() + pace.gravity_dv)) return true;
    if (vn > -pair.blow) continue;
    const double left = r.gap + pace.h * (vn + 0.5 * along(r, dv[a], dv[b]));
    if (left >= 0 && spare < 0) {
      const double far = std::max(bounding_radius_[a], bounding_radius_[b]),
                   w = std::fabs(va.w) + std::fabs(vb.w);
      spare = 0.5 * pace.h * pace.h *
              (far * (va.w * va.w + vb.w * vb.w) +
               2 * w * (std::fabs(va.x - vb.x) + std::fabs(va.y - vb.y) + far * w));
      for (const int body : {a, b}) {
        if (!(when_[body] > 0)) continue;
        const Motion &p = before_[body], &q = now_[body];
        spare += when_[body] * (std::fabs(q.x - p.x) + std::fabs(q.y - p.y) +
                                std::fabs(q.w - p.w) * bounding_radius_[body]);
      }
    }
    if (left >= 0 && left >= spare) continue;
    if (r.gap <= g.sight[lane] && vn < g.blow[lane]) return true;
  }
  return false;
}

// when the first of a pair's touches closes with an impact, and which
double Impacts::first_closing(const Pair& pair, const ContactBatch& g, const Standing& start,
                              const std::vector<Pose>& poses, const std::vector<Motion>& dv,
                              const StepConstants& pace, int& which) const {
  double first = 1e300;
  which = 0;
  for (int k = 0; k < pair.touches; ++k) {
    const double when = manifold(pair, k, g, start, poses, dv, pace);
    if (when < first) first = when, which = k;
  }
  return first;
}

// Moves `at`, how a pair stands, to where it meets with an impact; false where it does not. By the features
// of its lane or, where others are nearest by then, by those: then it goes as far as it surely does not meet,
// again and again, until the features that are nearest there are so when they close.
bool Impacts::find_meeting(const Pair& pair, const ContactBatch& g, Standing& at,
                           const std::vector<Pose>& poses, const std::vector<Motion>& dv,
                           const StepConstants& pace) {
  const int lane = pair.slot % kLanes, a = g.a[lane], b = g.b[lane];
  int which, words[2];
  double when = first_closing(pair, g, at, poses, dv, pace, which);
  const auto find_features = [&](double time) {
    Pose pose_a, pose_b;
    Motion v_a, v_b;
    move(a, time, poses, dv, pace, pose_a, v_a), move(b, time, poses, dv, pace, pose_b, v_b);
    pairs_.features(pair, pose_a, pose_b, words);
  };
  const auto knows = [&](const ContactBatch& by, int k) {
    return by.words[k][lane] == words[0] || (pair.touches > 1 && by.words[k][lane] == words[1]);
  };
  const auto stand_anew = [&](double time) {
    pairs_.put(pair, words, fresh_);
    at = clear_sleeping(pair, time, fresh_, poses, dv, pace);
    at.renewed = true;
  };
  // whether that is all there is to find
  const auto found = [&](const ContactBatch& by) {
    // round things have no other features
    if (g.calm[lane] < 1e300) {
      find_features(std::min(when, pace.h));
      if (!knows(by, 0) || (pair.touches > 1 && !knows(by, 1))) {
        if (&by != &fresh_) copy_lane(by, lane, fresh_, lane);
        if (when == 1e300 || !knows(by, which)) return false;
        stand_anew(when);
        return true;
      }
    }
    if (when < 1e300 && when != at.when) {
      at = clear_sleeping(pair, when, by, poses, dv, pace);
      at.renewed = &by != &g;
    }
    return true;
  };
  if (found(g)) return when < 1e300;

  const double from = at.when;
  const Motion &p = at.a, &q = at.b;
  const double fastest = std::fabs(p.x - q.x) + std::fabs(p.y - q.y) + std::fabs(dv[a].x - dv[b].x) +
                         std::fabs(dv[a].y - dv[b].y) +
                         (std::fabs(p.w) + std::fabs(dv[a].w)) * bounding_radius_[a] +
                         (std::fabs(q.w) + std::fabs(dv[b].w)) * bounding_radius_[b];
  const auto gap = [&] {
    return pair.touches > 1 ? std::min(at.rows[0].gap, at.rows[1].gap) : at.rows[0].gap;
  };
  double apart = -1;  // s: when it was last
  for (double time = from; time <= pace.h;) {
    find_features(time), stand_anew(time);
    if (gap() <= 0 && apart >= 0) {
      // on the way
      for (double low = apart; time - low > kInTime * pace.h;) {
        const double mid = 0.5 * (low + time);
        find_features(mid), stand_anew(mid);
        (gap() > 0 ? low : time) = mid;
      }
      find_features(time), stand_anew(time);
    }
    when = first_closing(pair, fresh_, at, poses, dv, pace, which);
    if (when == time) return true;
    if (found(fresh_)) return when < 1e300;
    apart = gap() > 0 ? time : -1;
    time += std::max(kForward * pace.h, gap() / fastest);
  }
  return false;
}

// When and where a pair meets with an impact in the step, into `impact`; false where it does not.
bool Impacts::meet(const Pair& pair, Impact& blow, const ContactBatch& g, const std::vector<Pose>& poses,
                   const std::vector<Motion>& dv, const StepConstants& pace) {
  const int lane = pair.slot % kLanes, a = g.a[lane], b = g.b[lane];
  const double from = std::max({0.0, when_[a], when_[b]});
  Standing at = clear_sleeping(pair, from, g, poses, dv, pace);
  if (!find_meeting(pair, g, at, poses, dv, pace)) return false;
  const double when = at.when;
  blow.when = when, blow.renewed = at.renewed;
  bool any = false;
  for (int k = 0; k < pair.touches; ++k) {
    const TouchRow& r = at.rows[k];
    blow.gap[k] = r.gap, blow.met[k] = r.gap <= kTogether * g.far[lane];
    // what meets is pushed in one point, so that angular momentum stays; what is to come together yet is
    // rubbed where it is touched
    const double apart = blow.met[k] ? 0 : 0.5 * r.gap;
    blow.pushes[0][k] = {r.nx, r.ny, r.na, r.nb};
    blow.pushes[1][k] = {-r.ny, r.nx, r.ta + apart, r.tb - apart};
    any = any || (blow.met[k] && along(r, at.a, at.b) < g.blow[lane]);
  }
  return any;
}

// whether one of a pair hangs on joints: what hangs there with it meets the impact too
bool Impacts::tie(const Pair& pair, double when, const std::vector<Motion>& dv, const StepConstants& pace,
                  const JointSolver<2>& joints) {
  bool tied = false;
  for (const int body : {pair.a, pair.b}) {
    const int part = body < 0 ? -1 : joints.part(body);
    if (part < 0) continue;
    tied = true;
    for (const int member : joints.members(part)) reach(member, when, dv, pace);
  }
  return tied;
}

// what joints answer to pushes of those touches that close
void Impacts::hear(const Pair& pair, const Push (&pushes)[2][2], const bool (&closes)[2],
                   JointSolver<2>& joints) {
  for (int across = 0; across < 2; ++across) {
    for (int k = 0; k < 2; ++k) {
      if (!closes[k]) continue;
      const Push& push = pushes[across][k];
      Row<2>& row = responses_[across][k].row;
      row.a = pair.a, row.b = pair.b;
      row.along = {push.x, push.y}, row.angular_a[0] = push.a, row.angular_b[0] = push.b;
      joints.compute_response(responses_[across][k]);
    }
  }
}

// one pair, both touches together; false where it does not approach
bool Impacts::hit(int i, const std::vector<Pair>& pairs, std::vector<ContactBatch>& seats,
                  const std::vector<Pose>& poses, const std::vector<Motion>& dv, const StepConstants& pace,
                  JointSolver<2>& joints) {
  const Pair& pair = pairs[i];
  const int a = pair.a, b = pair.b >= 0 ? pair.b : int(now_.size()) - 1;
  // too slow for an impact however they meet: most are, and their lanes are far away in memory
  if (std::fabs(now_[a].x - now_[b].x) + std::fabs(now_[a].y - now_[b].y) +
          std::fabs(now_[a].w) * bounding_radius_[a] + std::fabs(now_[b].w) * bounding_radius_[b] <
      pair.blow)
    return false;
  const int group = pair.slot / kLanes, lane = pair.slot % kLanes;
  const ContactBatch& g = seats[group];

  // when, and which touches
  bool closes[2] = {false, false};
  if (blow_[i] < 0) {
    Impact blow;
    if (!may_meet(pair, g, poses, dv, pace)) return false;
    if (!meet(pair, blow, g, poses, dv, pace)) {
      passing_.push_back(i);
      return false;
    }
    blow.pair = i, blow_[i] = int(impacts_.size());
    impacts_.push_back(blow);
    reach(a, blow.when, dv, pace), reach(b, blow.when, dv, pace);
    closes[0] = blow.met[0], closes[1] = blow.met[1];
  } else {
    // again, after others: what has met and does not part, and what comes together now
    const Impact& blow = impacts_[blow_[i]];
    bool any = false;
    for (int k = 0; k < pair.touches; ++k) {
      const double vn = speed(blow.pushes[0][k], a, b);
      const bool fast = vn < g.blow[lane] && (blow.met[k] || blow.gap[k] + (pace.h - blow.when) * vn < 0);
      closes[k] = fast || (blow.met[k] && vn < -g.blow[lane]), any = any || fast;
    }
    if (!any) return false;
  }
  Impact& blow = impacts_[blow_[i]];
  const auto& pushes = blow.pushes;
  const bool tied = !joints.empty() && tie(pair, blow.when, dv, pace, joints);
  const double ima = now_[a].im, imb = now_[b].im, iia = g.iia[lane], iib = g.iib[lane];
  if (tied) {
    hear(pair, pushes, closes, joints);
    // joints may leave it nothing to move
    for (int k = 0; k < 2; ++k)
      closes[k] =
          closes[k] && joints.response_between(responses_[0][k], responses_[0][k]) > kLocked * (ima + imb);
  }

  PairImpact impact;
  impact.mu = pair.material.friction;
  for (int r = 0; r < 4; ++r) {
    if (!closes[r / 2]) continue;
    impact.closed[r / 2] = true;
    const Push& p = pushes[r % 2][r / 2];
    impact.v[r] = speed(p, a, b);
    if (r % 2 == 0) impact.e[r / 2] = impact.v[r] < g.blow[lane] ? pair.material.elasticity : 0;
    for (int c = 0; c <= r; ++c) {
      if (!closes[c / 2]) continue;
      const Push& q = pushes[c % 2][c / 2];
      impact.K[r][c] = impact.K[c][r] =
          tied ? joints.response_between(responses_[r % 2][r / 2], responses_[c % 2][c / 2])
               : (ima + imb) * (p.x * q.x + p.y * q.y) + (iia * (p.a * q.a) + iib * (p.b * q.b));
    }
  }
  double impulses[4];
  solve(impact, impulses);
  const auto push = [&](int across, int k, double l) {
    if (tied) {
      joints.each_push(responses_[across][k], l, [&](int body, const Vec<2>& v, const AngularVec<2>& w) {
        now_[body].x += v[0], now_[body].y += v[1], now_[body].w += w[0];
      });
      return;
    }
    const Push& p = pushes[across][k];
    now_[a].x += p.x * (ima * l), now_[a].y += p.y * (ima * l), now_[a].w += iia * (p.a * l);
    now_[b].x -= p.x * (imb * l), now_[b].y -= p.y * (imb * l), now_[b].w -= iib * (p.b * l);
  };
  for (int k = 0; k < 2; ++k) {
    if (!closes[k]) continue;
    const double n = impulses[2 * k], t = impulses[2 * k + 1];
    blow.met[k] = true, blow.n[k] += n, blow.t[k] += t;
    push(0, k, n), push(1, k, t);
  }
  return true;
}

// What is left to the iterations of pairs that met, in their rows, of the step's start: of what met that it
// does not come nearer than the impact left it; of the other touch that it does not close in what is left of
// the step. Where it met by other features than the rows have, these may part fast while those hardly do: to
// keep up such a speed would take energy from nowhere.
void Impacts::leave(const std::vector<Pair>& pairs, std::vector<ContactBatch>& seats,
                    const std::vector<Pose>& poses, const StepConstants& pace) {
  if (least_.size() < seats.size()) least_.resize(seats.size());
  const int room = int(now_.size()) - 1;
  for (const int i : passing_) {
    const Pair& pair = pairs[i];
    const int group = pair.slot / kLanes, lane = pair.slot % kLanes, b = pair.b >= 0 ? pair.b : room;
    ContactBatch& g = seats[group];
    const Rows& r = rows(group, seats, poses);
    for (int k = 0; k < pair.touches; ++k) {
      if (!(along(r, k, lane, now_[pair.a], now_[b]) < g.blow[lane]) || r.gap[k][lane] <= 0) continue;
      g.struck[k] = static_cast<unsigned char>(g.struck[k] | 1 << lane);
      least_[group].n[k][lane] = -1e9;
    }
  }
  for (const Impact& blow : impacts_) {
    const Pair& pair = pairs[blow.pair];
    const int group = pair.slot / kLanes, lane = pair.slot % kLanes, b = pair.b >= 0 ? pair.b : room;
    ContactBatch& g = seats[group];
    const Rows& r = rows(group, seats, poses);
    const double left = pace.h - blow.when;
    for (int k = 0; k < pair.touches; ++k) {
      double& least = least_[group].n[k][lane];
      g.struck[k] = static_cast<unsigned char>(g.struck[k] | 1 << lane);
      least = along(r, k, lane, now_[pair.a], now_[b]) - speed(blow.pushes[0][k], pair.a, b);
      if (blow.renewed) least = std::min(least, 0.0);
      if (blow.met[k] || blow.gap[k] <= 0) continue;
      least = left > kInTime * pace.h ? least - blow.gap[k] / left : -1e9;
    }
  }
}

void Impacts::run(const Found& found, const std::vector<Pair>& pairs, std::vector<ContactBatch>& seats,
                  const std::vector<Pose>& poses, const std::vector<Motion>& old,
                  const std::vector<Motion>& dv, std::vector<Motion>& v, const StepConstants& pace,
                  JointSolver<2>& joints) {
  for (const int body : bodies_) when_[body] = -1;
  for (const Impact& blow : impacts_) {
    if (blow.pair < int(blow_.size())) blow_[blow.pair] = -1;
  }
  bodies_.clear(), impacts_.clear(), queue_.clear(), passing_.clear(), rows_.clear(), groups_.clear();
  if (found.empty()) return;
  std::copy(old.begin(), old.end(), now_.begin());

  known_.assign(seats.size(), -1);

  // in the order of time, then of pairs
  first_.clear();
  for (const int seat : found) {
    const ContactBatch& g = seats[seat / kLanes];
    const int i = g.pair[seat % kLanes];
    const Pair& pair = pairs[i];
    const Standing at = clear_sleeping(pair, 0, g, poses, dv, pace);
    double when = 1e300;
    for (int k = 0; k < pair.touches; ++k) when = std::min(when, closing(pair, k, g, at, dv, pace));
    first_.emplace_back(when, i);
  }
  std::sort(first_.begin(), first_.end());
  for (const auto& [when, i] : first_) queue_.push_back(i);
  for (const int i : queue_) waiting_[i] = 1;
  const std::size_t most = 40 * queue_.size() + 100;
  std::size_t at = 0;
  for (; at < queue_.size() && at < most; ++at) {
    // pairs and their lanes are far apart in memory: ask for those of later ones
    if (at + 2 * kPairsAhead < queue_.size()) __builtin_prefetch(&pairs[queue_[at + 2 * kPairsAhead]]);
    if (at + kPairsAhead < queue_.size()) {
      const Pair& later = pairs[queue_[at + kPairsAhead]];
      __builtin_prefetch(&now_[later.a]);
      if (later.b >= 0) __builtin_prefetch(&now_[later.b]);
    }
    const int i = queue_[at];
    waiting_[i] = 0;
    if (!hit(i, pairs, seats, poses, dv, pace, joints)) continue;
    const auto ask = [&](int body) {
      for (const int next : around(body)) {
        if (waiting_[next]) continue;
        waiting_[next] = 1;
        queue_.push_back(next);
      }
    };
    for (const int body : {pairs[i].a, pairs[i].b}) {
      if (body < 0 || now_[body].im == 0) continue;
      const int part = joints.empty() ? -1 : joints.part(body);
      if (part < 0) {
        ask(body);
      } else {
        for (const int member : joints.members(part)) ask(member);
      }
    }
  }
  for (; at < queue_.size(); ++at) waiting_[queue_[at]] = 0;

  for (const int body : bodies_) {
    const Motion &p = before_[body], &q = now_[body];
    v[body].x += q.x - p.x, v[body].y += q.y - p.y, v[body].w += q.w - p.w;
  }
  leave(pairs, seats, poses, pace);
}

void Impacts::note(const std::vector<Pair>& pairs, const std::vector<Contact<2>>& contacts,
                   [[maybe_unused]] const std::vector<ContactBatch>& seats) {
  for (const Impact& blow : impacts_) {
    const Pair& pair = pairs[blow.pair];
    assert(seats[pair.slot / kLanes].pair[pair.slot % kLanes] == blow.pair);
    for (int k = 0; k < pair.touches; ++k) {
      if (!blow.met[k]) continue;
      const double nx = blow.pushes[0][k].x, ny = blow.pushes[0][k].y;
      struck_.push_back({contacts[pair.first + k].key,
                         {blow.n[k] * nx - blow.t[k] * ny, blow.n[k] * ny + blow.t[k] * nx},
                         blow.n[k] > 0});
    }
  }
}

// Features may have changed since: then the touch of the same pair that is closest.
void Impacts::keep(std::vector<Contact<2>>& contacts) const {
  for (const Struck& struck : struck_) {
    const ContactKey& key = struck.key;
    const auto from = [&](const ContactKey& least) {
      return std::lower_bound(contacts.begin(), contacts.end(), least,
                              [](const Contact<2>& c, const ContactKey& it) { return c.key < it; });
    };
    auto at = from(key);
    if (at == contacts.end() || at->key != key) {
      const auto parts = [](const ContactKey& it) { return std::tuple(it.a, it.b, it.feature >> 16); };
      at = contacts.end();
      for (auto it = from({key.a, key.b, key.feature >> 16 << 16});
           it != contacts.end() && parts(it->key) == parts(key); ++it) {
        if (at == contacts.end() || it->gap < at->gap) at = it;
      }
    }
    if (at == contacts.end()) continue;
    at->impulse += struck.impulse;
    if (at->touching == ContactMode::open && struck.pushed) at->touching = ContactMode::slide;
  }
}

}  // namespace obscura::sim::plane
