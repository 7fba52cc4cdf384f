// An impact, handout §3.5, of both touches of a pair, normals and friction together
// (sim/solve/iterate/pair_impact.h):
//   v_n' = -e v_n,  l >= 0,  |lt| <= mu l
// at the time tau at which the first of them closes, and where the bodies stand then
// (sim/solve/iterate/plane_impact_times.cpp); after it a body flies with the velocity it got. An elastic ball
// keeps its energy to rounding.

#include "sim/solve/iterate/plane_impacts.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>

#include "sim/solve/iterate/pair_impact.h"

namespace obscura::sim::plane {

namespace {

constexpr std::size_t kPairsAhead = 4;  // pairs
constexpr double kLocked = 1e-9;        // of what a push moves without joints

}  // namespace

Impacts::Impacts(const CoreShapes& cores, const Pairs& pairs)
    : pairs_(pairs), bounding_radius_(cores.bounding_radius) {
  const int bodies = int(bounding_radius_.size());
  bounding_radius_.push_back(0);
  around_start_.resize(bodies + 2);
  when_.assign(bodies + 1, -1);
  before_.resize(bodies + 1), now_.resize(bodies + 1);
}

void Impacts::list_pairs(const std::vector<Pair>& pairs, const std::vector<Motion>& v) {
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
  waiting_.assign(pairs.size(), 0), impact_of_.assign(pairs.size(), -1);
}

// as the step begins
const Rows& Impacts::rows(int group, const std::vector<ContactBatch>& batches,
                          const std::vector<Pose>& poses) {
  if (known_[group] < 0) {
    known_[group] = int(groups_.size());
    groups_.push_back(group);
    rows_.emplace_back();
    expand(batches[group], poses.data(), rows_.back());
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

// whether one of a pair hangs on joints: what hangs there with it meets the impact too
bool Impacts::reach_component(const Pair& pair, double when, const std::vector<Motion>& dv,
                              const StepConstants& pace, const JointSolver<2>& joints) {
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
void Impacts::compute_responses(const Pair& pair, const Push (&pushes)[2][2], const bool (&closes)[2],
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
bool Impacts::resolve_pair(int i, const std::vector<Pair>& pairs, std::vector<ContactBatch>& batches,
                           const std::vector<Pose>& poses, const std::vector<Motion>& dv,
                           const StepConstants& pace, JointSolver<2>& joints) {
  const Pair& pair = pairs[i];
  const int a = pair.a, b = pair.b >= 0 ? pair.b : int(now_.size()) - 1;
  // too slow for an impact however they meet: most are, and their lanes are far away in memory
  if (std::fabs(now_[a].x - now_[b].x) + std::fabs(now_[a].y - now_[b].y) +
          std::fabs(now_[a].w) * bounding_radius_[a] + std::fabs(now_[b].w) * bounding_radius_[b] <
      pair.impact_speed)
    return false;
  const int group = pair.slot / kLanes, lane = pair.slot % kLanes;
  const ContactBatch& g = batches[group];

  // when, and which touches
  bool closes[2] = {false, false};
  if (impact_of_[i] < 0) {
    Impact impact;
    if (!may_meet(pair, g, poses, dv, pace)) return false;
    if (!find_impact(pair, impact, g, poses, dv, pace)) {
      passing_.push_back(i);
      return false;
    }
    impact.pair = i, impact_of_[i] = int(impacts_.size());
    impacts_.push_back(impact);
    reach(a, impact.when, dv, pace), reach(b, impact.when, dv, pace);
    closes[0] = impact.met[0], closes[1] = impact.met[1];
  } else {
    // again, after others: what has met and does not part, and what comes together now
    const Impact& impact = impacts_[impact_of_[i]];
    bool any = false;
    for (int k = 0; k < pair.touches; ++k) {
      const double vn = speed(impact.pushes[0][k], a, b);
      const bool fast =
          vn < g.impact_speed[lane] && (impact.met[k] || impact.gap[k] + (pace.h - impact.when) * vn < 0);
      closes[k] = fast || (impact.met[k] && vn < -g.impact_speed[lane]), any = any || fast;
    }
    if (!any) return false;
  }
  Impact& impact = impacts_[impact_of_[i]];
  const auto& pushes = impact.pushes;
  const bool tied = !joints.empty() && reach_component(pair, impact.when, dv, pace, joints);
  const double ima = now_[a].im, imb = now_[b].im, iia = g.iia[lane], iib = g.iib[lane];
  if (tied) {
    compute_responses(pair, pushes, closes, joints);
    // joints may leave it nothing to move
    for (int k = 0; k < 2; ++k)
      closes[k] =
          closes[k] && joints.response_between(responses_[0][k], responses_[0][k]) > kLocked * (ima + imb);
  }

  PairImpact system;
  system.mu = pair.material.friction;
  for (int r = 0; r < 4; ++r) {
    if (!closes[r / 2]) continue;
    system.closed[r / 2] = true;
    const Push& p = pushes[r % 2][r / 2];
    system.v[r] = speed(p, a, b);
    if (r % 2 == 0) system.e[r / 2] = system.v[r] < g.impact_speed[lane] ? pair.material.elasticity : 0;
    for (int c = 0; c <= r; ++c) {
      if (!closes[c / 2]) continue;
      const Push& q = pushes[c % 2][c / 2];
      system.K[r][c] = system.K[c][r] =
          tied ? joints.response_between(responses_[r % 2][r / 2], responses_[c % 2][c / 2])
               : (ima + imb) * (p.x * q.x + p.y * q.y) + (iia * (p.a * q.a) + iib * (p.b * q.b));
    }
  }
  double impulses[4];
  solve(system, impulses);
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
    impact.met[k] = true, impact.n[k] += n, impact.t[k] += t;
    push(0, k, n), push(1, k, t);
  }
  return true;
}

// What is left to the iterations of pairs that met, in their rows, of the step's start: of what met that it
// does not come nearer than the impact left it; of the other touch that it does not close in what is left of
// the step. Where it met by other features than the rows have, these may part fast while those hardly do: to
// keep up such a speed would take energy from nowhere.
void Impacts::leave_to_iterations(const std::vector<Pair>& pairs, std::vector<ContactBatch>& batches,
                                  const std::vector<Pose>& poses, const std::vector<Motion>& dv,
                                  const StepConstants& pace) {
  if (least_.size() < batches.size()) least_.resize(batches.size());
  const int room = int(now_.size()) - 1;
  for (const int i : passing_) {
    const Pair& pair = pairs[i];
    const int group = pair.slot / kLanes, lane = pair.slot % kLanes, b = pair.b >= 0 ? pair.b : room;
    ContactBatch& g = batches[group];
    const Rows& r = rows(group, batches, poses);
    // what overlapped when the step began may have parted before another impact turned it back
    const double from = std::max({0.0, when_[pair.a], when_[b]});
    const PlacedPair at = placed_at(pair, from, g, poses, dv, pace);
    for (int k = 0; k < pair.touches; ++k) {
      if (!(normal_speed(r, k, lane, now_[pair.a], now_[b]) < g.impact_speed[lane])) continue;
      if (at.rows[k].gap <= 0) continue;
      g.struck[k] = static_cast<unsigned char>(g.struck[k] | 1 << lane);
      least_[group].n[k][lane] = -1e9;
    }
  }
  for (const Impact& impact : impacts_) {
    const Pair& pair = pairs[impact.pair];
    const int group = pair.slot / kLanes, lane = pair.slot % kLanes, b = pair.b >= 0 ? pair.b : room;
    ContactBatch& g = batches[group];
    const Rows& r = rows(group, batches, poses);
    const double left = pace.h - impact.when;
    for (int k = 0; k < pair.touches; ++k) {
      double& least = least_[group].n[k][lane];
      g.struck[k] = static_cast<unsigned char>(g.struck[k] | 1 << lane);
      least = normal_speed(r, k, lane, now_[pair.a], now_[b]) - speed(impact.pushes[0][k], pair.a, b);
      if (impact.renewed) least = std::min(least, 0.0);
      if (impact.met[k] || impact.gap[k] <= 0) continue;
      least = left > kInTime * pace.h ? least - impact.gap[k] / left : -1e9;
    }
  }
}

void Impacts::run(const Found& found, const std::vector<Pair>& pairs, std::vector<ContactBatch>& batches,
                  const std::vector<Pose>& poses, const std::vector<Motion>& old,
                  const std::vector<Motion>& dv, std::vector<Motion>& v, const StepConstants& pace,
                  JointSolver<2>& joints) {
  for (const int body : bodies_) when_[body] = -1;
  for (const Impact& impact : impacts_) {
    if (impact.pair < int(impact_of_.size())) impact_of_[impact.pair] = -1;
  }
  bodies_.clear(), impacts_.clear(), queue_.clear(), passing_.clear(), rows_.clear(), groups_.clear();
  if (found.empty()) return;
  std::copy(old.begin(), old.end(), now_.begin());

  known_.assign(batches.size(), -1);

  // in the order of time, then of pairs
  first_.clear();
  for (const int seat : found) {
    const ContactBatch& g = batches[seat / kLanes];
    const int i = g.pair[seat % kLanes];
    const Pair& pair = pairs[i];
    const PlacedPair at = placed_at(pair, 0, g, poses, dv, pace);
    double when = 1e300;
    for (int k = 0; k < pair.touches; ++k) when = std::min(when, closing_guess(pair, k, g, at, dv, pace));
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
    if (!resolve_pair(i, pairs, batches, poses, dv, pace, joints)) continue;
    const auto enqueue = [&](int body) {
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
        enqueue(body);
      } else {
        for (const int member : joints.members(part)) enqueue(member);
      }
    }
  }
  for (; at < queue_.size(); ++at) waiting_[queue_[at]] = 0;

  for (const int body : bodies_) {
    const Motion &p = before_[body], &q = now_[body];
    v[body].x += q.x - p.x, v[body].y += q.y - p.y, v[body].w += q.w - p.w;
  }
  leave_to_iterations(pairs, batches, poses, dv, pace);
}

void Impacts::note(const std::vector<Pair>& pairs, const std::vector<Contact<2>>& contacts,
                   [[maybe_unused]] const std::vector<ContactBatch>& batches) {
  for (const Impact& impact : impacts_) {
    const Pair& pair = pairs[impact.pair];
    assert(batches[pair.slot / kLanes].pair[pair.slot % kLanes] == impact.pair);
    for (int k = 0; k < pair.touches; ++k) {
      if (!impact.met[k]) continue;
      const double nx = impact.pushes[0][k].x, ny = impact.pushes[0][k].y;
      struck_.push_back({contacts[pair.first + k].key,
                         {impact.n[k] * nx - impact.t[k] * ny, impact.n[k] * ny + impact.t[k] * nx},
                         impact.n[k] > 0});
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
