// A blow, handout §3.5, of both touches of a pair:
//   v_n' = -e v_n,  l >= 0               l = -K^-1 (1 + e) v_n,  or one touch alone
//   lt = clamp(-v_t / K_t, -mu l, mu l)
// at the time tau at which the first of them closes: until then the body flies with the velocity it had,
//   g + v_n tau + a_n tau^2 / 2 = 0
// after it with the one it got. An elastic ball keeps its energy to rounding.

#include "sim/iterative_blows.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sim/trig.h"

namespace obscura::sim::sweep {

namespace {

constexpr std::size_t kAhead = 4;  // pairs
constexpr double kLocked = 1e-9;   // of what a push moves without joints

// v_n of touch k
double along(const Rows& r, int k, int lane, const Motion& a, const Motion& b) {
  return r.nx[k][lane] * (a.x - b.x) + r.ny[k][lane] * (a.y - b.y) +
         (r.na[k][lane] * a.w - r.nb[k][lane] * b.w);
}

}  // namespace

Blows::Blows(const Cores& cores) : reach_(cores.reach) {
  const int bodies = int(reach_.size());
  reach_.push_back(0);
  around_start_.resize(bodies + 2);
  when_.assign(bodies + 1, -1);
  before_.resize(bodies + 1), now_.resize(bodies + 1);
}

void Blows::join(const std::vector<Pair>& pairs, const std::vector<Motion>& v) {
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

const Rows& Blows::rows(int group, const std::vector<Seats>& seats, const std::vector<Pose>& poses) {
  if (known_[group] < 0) {
    known_[group] = int(groups_.size());
    groups_.push_back(group);
    rows_.emplace_back();
    expand(seats[group], poses.data(), rows_.back());
  }
  return rows_[known_[group]];
}

// a body meets its first blow of the step
void Blows::reach(int body, double when, const std::vector<Motion>& dv, const Pace& pace) {
  if (now_[body].im == 0 || when_[body] >= 0) return;
  when_[body] = when;
  bodies_.push_back(body);
  const double part = when / pace.h;
  now_[body].x += part * dv[body].x, now_[body].y += part * dv[body].y, now_[body].w += part * dv[body].w;
  before_[body] = now_[body];
}

// when the first touch of a pair closes with a blow, s; the step's length where none does
double Blows::closing(int i, const std::vector<Pair>& pairs, const std::vector<Seats>& seats,
                      const std::vector<Pose>& poses, const std::vector<Motion>& dv, const Pace& pace) {
  const Pair& pair = pairs[i];
  const int group = pair.slot / kLanes, lane = pair.slot % kLanes;
  const Seats& g = seats[group];
  const Rows& r = rows(group, seats, poses);
  double when = pace.h;
  for (int k = 0; k < pair.touches; ++k) {
    const double vn = along(r, k, lane, now_[g.a[lane]], now_[g.b[lane]]), gap = r.gap[k][lane];
    const double dvn = along(r, k, lane, dv[g.a[lane]], dv[g.b[lane]]);
    if (gap > g.sight[lane] || !(vn < g.blow[lane])) continue;
    const double left = std::max(0.0, gap);
    // two corners: |l n + v t| = radius, if they do not pass
    if (g.corners[k] >> lane & 1) {
      const Motion &a = now_[g.a[lane]], &b = now_[g.b[lane]];
      const double vt = r.nx[k][lane] * (a.y - b.y) - r.ny[k][lane] * (a.x - b.x) +
                        (r.ta[k][lane] * a.w - r.tb[k][lane] * b.w);
      const double p = (left + g.radius[lane]) * vn, q = left * (left + 2 * g.radius[lane]);
      const double under = p * p - (vn * vn + vt * vt) * q;
      if (under > 0) {
        when = std::min(when, q / (std::sqrt(under) - p));
        continue;
      }
    }
    when = std::min(when, left / -std::min(vn, vn - 0.5 * dvn * left / (pace.h * vn)));
  }
  return when;
}

// whether one of a pair hangs on joints: what hangs there with it meets the blow too
bool Blows::tie(const Pair& pair, double when, const std::vector<Motion>& dv, const Pace& pace,
                const Linkage<2>& linkage) {
  bool tied = false;
  for (const int body : {pair.a, pair.b}) {
    const int part = body < 0 ? -1 : linkage.part(body);
    if (part < 0) continue;
    tied = true;
    for (const int member : linkage.members(part)) reach(member, when, dv, pace);
  }
  return tied;
}

// The pushes of a pair that meets. Where two corners do, as balls, they stand otherwise by then.
void Blows::aim(const Pair& pair, const Seats& g, const Rows& r, const std::vector<Pose>& poses, double when,
                const std::vector<Motion>& dv, const Pace& pace, Push (&pushes)[2][2]) {
  int lane = pair.slot % kLanes;
  const Rows* at = &r;
  Rows then;
  if ((g.corners[0] | g.corners[1]) >> lane & 1) {
    Pose moved[3];
    const int bodies[] = {g.a[lane], g.b[lane]};
    for (int side = 0; side < 2; ++side) {
      const int body = bodies[side];
      const Motion& v = now_[body];
      Pose& pose = moved[side] = poses[body];
      if (v.im == 0) continue;
      // it has the velocity of then
      const double half = 0.5 * when / pace.h;
      pose.x += when * (v.x - half * dv[body].x), pose.y += when * (v.y - half * dv[body].y);
      const SinCos turn = sin_cos(when * (v.w - half * dv[body].w));
      const double c = pose.c;
      pose.c = c * turn.cos - pose.s * turn.sin, pose.s = pose.s * turn.cos + c * turn.sin;
    }
    for (int k = 0; k < kLanes; ++k) one_.a[k] = one_.b[k] = 2;
    copy_seat(g, lane, one_, 0);
    one_.a[0] = 0, one_.b[0] = 1;
    expand(one_, moved, then);
    at = &then, lane = 0;
  }
  for (int k = 0; k < 2; ++k) {
    const double nx = at->nx[k][lane], ny = at->ny[k][lane];
    // each is rubbed where it is touched: by then they have come together
    const double apart = 0.5 * std::max(0.0, at->gap[k][lane]);
    pushes[0][k] = {nx, ny, at->na[k][lane], at->nb[k][lane]};
    pushes[1][k] = {-ny, nx, at->ta[k][lane] + apart, at->tb[k][lane] - apart};
  }
}

// what joints answer to pushes of those touches that close
void Blows::hear(const Pair& pair, const Push (&pushes)[2][2], const bool (&closes)[2], Linkage<2>& linkage) {
  for (int across = 0; across < 2; ++across) {
    for (int k = 0; k < 2; ++k) {
      if (!closes[k]) continue;
      const Push& push = pushes[across][k];
      Row<2>& row = echoes_[across][k].row;
      row.a = pair.a, row.b = pair.b;
      row.along = {push.x, push.y}, row.turn_a[0] = push.a, row.turn_b[0] = push.b;
      linkage.hear(echoes_[across][k]);
    }
  }
}

// one pair, both touches together; false where it does not approach
bool Blows::hit(int i, const std::vector<Pair>& pairs, std::vector<Seats>& seats,
                const std::vector<Pose>& poses, const std::vector<Motion>& dv, const Pace& pace,
                Linkage<2>& linkage) {
  const Pair& pair = pairs[i];
  const int a = pair.a, b = pair.b >= 0 ? pair.b : int(now_.size()) - 1;
  // too slow for a blow however they meet: most are, and their seats are far away in memory
  if (std::fabs(now_[a].x - now_[b].x) + std::fabs(now_[a].y - now_[b].y) + std::fabs(now_[a].w) * reach_[a] +
          std::fabs(now_[b].w) * reach_[b] <
      pair.blow)
    return false;
  const int group = pair.slot / kLanes, lane = pair.slot % kLanes;
  Seats& g = seats[group];
  const Rows& r = rows(group, seats, poses);

  // which touches close, and when
  bool closes[2] = {false, false}, fast[2] = {false, false};
  const Blow* known = blow_[i] >= 0 ? &blows_[blow_[i]] : nullptr;
  for (int k = 0; k < pair.touches; ++k) {
    const double vn = along(r, k, lane, now_[a], now_[b]), dvn = along(r, k, lane, dv[a], dv[b]),
                 gap = r.gap[k][lane];
    if (gap > g.sight[lane]) continue;
    closes[k] = gap + pace.h * (vn + 0.5 * dvn) < 0 || (known && known->met[k]);
    fast[k] = closes[k] && vn < g.blow[lane];
  }
  if (!fast[0] && !fast[1]) return false;
  const double when = closing(i, pairs, seats, poses, dv, pace);
  reach(a, when, dv, pace), reach(b, when, dv, pace);

  if (!known) {
    blow_[i] = int(blows_.size());
    blows_.emplace_back();
    blows_.back().pair = i;
    aim(pair, g, r, poses, when, dv, pace, blows_.back().pushes);
  }
  Blow& blow = blows_[blow_[i]];
  const auto& pushes = blow.pushes;
  const bool tied = !linkage.empty() && tie(pair, when, dv, pace, linkage);
  const double ima = now_[a].im, imb = now_[b].im, iia = g.iia[lane], iib = g.iib[lane];
  if (tied) {
    hear(pair, pushes, closes, linkage);
    // joints may leave it nothing to move
    for (int k = 0; k < 2; ++k)
      closes[k] = closes[k] && linkage.couple(echoes_[0][k], echoes_[0][k]) > kLocked * (ima + imb);
  }
  const auto push = [&](int across, int k, double l) {
    if (tied) {
      linkage.each_push(echoes_[across][k], l, [&](int body, const Vec<2>& v, const Spin<2>& w) {
        now_[body].x += v[0], now_[body].y += v[1], now_[body].w += w[0];
      });
      return;
    }
    const Push& p = pushes[across][k];
    now_[a].x += p.x * (ima * l), now_[a].y += p.y * (ima * l), now_[a].w += iia * (p.a * l);
    now_[b].x -= p.x * (imb * l), now_[b].y -= p.y * (imb * l), now_[b].w -= iib * (p.b * l);
  };
  const auto speed = [&](const Push& p) {
    return p.x * (now_[a].x - now_[b].x) + p.y * (now_[a].y - now_[b].y) +
           (p.a * now_[a].w - p.b * now_[b].w);
  };
  double e[2] = {1e300, 1e300};
  for (int k = 0; k < 2; ++k) {
    if (closes[k]) e[k] = (1 + pair.elasticity) * speed(pushes[0][k]);
  }

  // impulses l >= 0 with e + K l >= 0
  const auto yields = [&](int i0, int i1) {
    if (tied) return closes[i0] && closes[i1] ? linkage.couple(echoes_[0][i0], echoes_[0][i1]) : 0.0;
    const Push &p = pushes[0][i0], &q = pushes[0][i1];
    return (ima + imb) * (p.x * q.x + p.y * q.y) + (iia * (p.a * q.a) + iib * (p.b * q.b));
  };
  const double k11 = yields(0, 0), k22 = yields(1, 1), k12 = yields(0, 1), det = k11 * k22 - k12 * k12;
  double l[2] = {0, 0};
  if (closes[0] && closes[1] && det > 1e-8 * k11 * k22) {
    l[0] = -(k22 * e[0] - k12 * e[1]) / det, l[1] = -(k11 * e[1] - k12 * e[0]) / det;
  }
  if (!(closes[0] && closes[1] && det > 1e-8 * k11 * k22 && l[0] >= 0 && l[1] >= 0)) {
    const double only0 = closes[0] ? std::max(0.0, -e[0] / k11) : 0;
    const double only1 = closes[1] ? std::max(0.0, -e[1] / k22) : 0;
    const bool first = e[1] + k12 * only0 >= e[0] + k12 * only1;
    l[0] = first ? only0 : 0, l[1] = first ? 0 : only1;
  }
  for (int k = 0; k < 2; ++k) {
    if (!closes[k]) continue;
    g.struck[k] = static_cast<unsigned char>(g.struck[k] | 1 << lane);
    blow.met[k] = true, blow.n[k] += l[k];
    push(0, k, l[k]);
  }

  // friction
  for (int k = 0; k < 2; ++k) {
    if (!closes[k]) continue;
    const Push& p = pushes[1][k];
    const double vt = speed(p);
    const double yield =
        tied ? linkage.couple(echoes_[1][k], echoes_[1][k]) : ima + imb + (iia * p.a * p.a + iib * p.b * p.b);
    const double most = pair.friction * blow.n[k];
    const double next = std::clamp(yield > 0 ? blow.t[k] - vt / yield : 0.0, -most, most);
    push(1, k, next - blow.t[k]);
    blow.t[k] = next;
  }
  return true;
}

void Blows::run(const Found& found, const std::vector<Pair>& pairs, std::vector<Seats>& seats,
                const std::vector<Pose>& poses, const std::vector<Motion>& old, const std::vector<Motion>& dv,
                std::vector<Motion>& v, const Pace& pace, Linkage<2>& linkage) {
  for (const int body : bodies_) when_[body] = -1;
  for (const Blow& blow : blows_) {
    if (blow.pair < int(blow_.size())) blow_[blow.pair] = -1;
  }
  bodies_.clear(), blows_.clear(), queue_.clear(), rows_.clear(), groups_.clear();
  if (found.empty()) return;
  known_.assign(seats.size(), -1);
  std::copy(old.begin(), old.end(), now_.begin());

  // in the order of time, then of pairs
  first_.clear();
  for (const int seat : found) {
    const int i = seats[seat / kLanes].pair[seat % kLanes];
    first_.emplace_back(closing(i, pairs, seats, poses, dv, pace), i);
  }
  std::sort(first_.begin(), first_.end());
  for (const auto& [when, i] : first_) queue_.push_back(i);
  for (const int i : queue_) waiting_[i] = 1;
  const std::size_t most = 40 * queue_.size() + 100;
  std::size_t at = 0;
  for (; at < queue_.size() && at < most; ++at) {
    // pairs and their seats are far apart in memory: ask for those of later ones
    if (at + 2 * kAhead < queue_.size()) __builtin_prefetch(&pairs[queue_[at + 2 * kAhead]]);
    if (at + kAhead < queue_.size()) {
      const Pair& later = pairs[queue_[at + kAhead]];
      __builtin_prefetch(&now_[later.a]);
      if (later.b >= 0) __builtin_prefetch(&now_[later.b]);
    }
    const int i = queue_[at];
    waiting_[i] = 0;
    if (!hit(i, pairs, seats, poses, dv, pace, linkage)) continue;
    const auto ask = [&](int body) {
      for (const int next : around(body)) {
        if (waiting_[next]) continue;
        waiting_[next] = 1;
        queue_.push_back(next);
      }
    };
    for (const int body : {pairs[i].a, pairs[i].b}) {
      if (body < 0 || now_[body].im == 0) continue;
      const int part = linkage.empty() ? -1 : linkage.part(body);
      if (part < 0) {
        ask(body);
      } else {
        for (const int member : linkage.members(part)) ask(member);
      }
    }
  }
  for (; at < queue_.size(); ++at) waiting_[queue_[at]] = 0;

  for (const int body : bodies_) {
    const Motion &p = before_[body], &q = now_[body];
    v[body].x += q.x - p.x, v[body].y += q.y - p.y, v[body].w += q.w - p.w;
  }
}

void Blows::note(const std::vector<Pair>& pairs, const std::vector<Contact<2>>& contacts,
                 [[maybe_unused]] const std::vector<Seats>& seats) {
  for (const Blow& blow : blows_) {
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

void Blows::keep(std::vector<Contact<2>>& contacts) const {
  for (const Struck& struck : struck_) {
    const auto at = std::lower_bound(contacts.begin(), contacts.end(), struck.key,
                                     [](const Contact<2>& c, const ContactKey& key) { return c.key < key; });
    if (at == contacts.end() || at->key != struck.key) continue;
    at->impulse += struck.impulse;
    if (at->touching == Touching::open && struck.pushed) at->touching = Touching::slide;
  }
}

}  // namespace obscura::sim::sweep
