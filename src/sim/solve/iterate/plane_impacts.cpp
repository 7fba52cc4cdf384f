// An impact, handout §3.5, of both touches of a pair, normals and friction together
// (sim/solve/iterate/plane_pair_impact.h):
//   v_n' = -e v_n,  l >= 0,  |lt| <= mu l
// at the time tau at which the first of them closes, and where the bodies stand then
// (sim/solve/iterate/plane_impact_times.cpp); after it a body flies with the velocity it got. An elastic ball
// keeps its energy to rounding.

#include "sim/solve/iterate/plane_impacts.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>

#include "sim/solve/iterate/closing_time.h"
#include "sim/solve/iterate/endless_impacts.h"
#include "sim/solve/iterate/plane_pair_impact.h"

namespace obscura::sim::plane {

namespace {

constexpr std::size_t kPairsAhead = 4;      // pairs that are asked for, as they are far apart in memory
constexpr std::size_t kMostAtOnce = 30000;  // impacts of an instant, of what bounces less than wholly

// of a body's fastest point, at most, m/s
double swiftness(const Motion& v, double radius) {
  return std::fabs(v.x) + std::fabs(v.y) + radius * std::fabs(v.w);
}

}  // namespace

Impacts::Impacts(const CoreShapes& cores, const Pairs& pairs, bool together)
    : pairs_(pairs), bounding_radius_(cores.bounding_radius), together_(together) {
  const int bodies = int(bounding_radius_.size());
  bounding_radius_.push_back(0);
  around_.build(bodies, 0, [](int, const auto&) {});
  first_.assign(bodies + 1, -1), when_.assign(bodies + 1, -1), rounds_.assign(bodies + 1, 0);
  crowded_.assign(bodies + 1, 0);
  meetings_.reserve(InstantImpact<2>::kMost + 1), closed_.reserve(InstantImpact<2>::kMost + 2);
  pose_.resize(bodies + 1), way_.resize(bodies + 1), now_.resize(bodies + 1), dv_impacts_.resize(bodies + 1);
}

void Impacts::list_pairs(const std::vector<Pair>& pairs, const std::vector<Motion>& v) {
  around_.build(int(bounding_radius_.size()) - 1, int(pairs.size()), [&](int i, const auto& act) {
    if (pairs[i].slot < 0) return;
    for (const int body : {pairs[i].a, pairs[i].b}) {
      if (body >= 0 && v[body].im > 0) act(body);
    }
  });
  waiting_.assign(pairs.size(), 0), impacts_of_.assign(pairs.size(), 0);
  queue_.reserve(pairs.size()), passing_.reserve(pairs.size());
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

// brings a body to an impact
void Impacts::reach(int body, double when, const Step& step) {
  Motion& v = now_[body];
  if (v.im == 0 || when_[body] == when) return;
  Motion ignored;
  move(body, when, step, pose_[body], ignored);
  if (when_[body] < 0) {
    bodies_.push_back(body);
    first_[body] = when, way_[body] = dv_impacts_[body] = {};
  }
  const double time = when - std::max(0.0, when_[body]), share = time / step.pace.h, half = 0.5 * share;
  const Motion& gain = step.dv[body];
  Motion& way = way_[body];
  way.x += time * (v.x + half * gain.x), way.y += time * (v.y + half * gain.y);
  way.w += time * (v.w + half * gain.w);
  v.x += share * gain.x, v.y += share * gain.y, v.w += share * gain.w;
  when_[body] = when;
}

// whether one of a pair hangs on joints: what hangs there with it meets the impact too
bool Impacts::reach_component(const Pair& pair, double when, const Step& step) {
  bool tied = false;
  for (const int body : {pair.a, pair.b}) {
    const int component = body < 0 ? -1 : step.joints.component(body);
    if (component < 0) continue;
    tied = true;
    for (const int member : step.joints.members(component)) reach(member, when, step);
  }
  return tied;
}

// where an impact finds the joints of its bodies
void Impacts::place_joints(const Pair& pair, double when, const Step& step) {
  for (const int side : {pair.a, pair.b}) {
    const int component = side < 0 ? -1 : step.joints.component(side);
    if (component < 0) continue;
    step.struck_joints.compute_rows_at(when, step.joints, component,
                                       [&](int body, BodyMotion<2>& at, Orientation<2>& turn) {
                                         Pose pose;
                                         Motion ignored;
                                         move(body, when, step, pose, ignored);
                                         at.x = {pose.x, pose.y};
                                         at.room_from_body << pose.c, -pose.s, pose.s, pose.c;
                                         turn[0] += way_at(body, when, step).w;
                                       });
  }
}

// whether joints leave a touch of an impact nothing to move
bool Impacts::locked(const Impact& impact, int k, const std::vector<ContactBatch>& batches,
                     const Step& step) {
  const Pair& pair = step.pairs[impact.pair];
  const ContactBatch& g = batches[pair.slot / kLanes];
  int words[2];
  if (impact.renewed) {
    features_at(pair, impact.when, step, words);
    copy_lane(g, pair.slot % kLanes, fresh_, pair.slot % kLanes);
  }
  const PlacedPair begun =
      impact.renewed ? placed_renewed(pair, words, 0, step) : placed_at(pair, 0, g, step);
  const TouchRow& r = begun.rows[k];
  Row<2>& row = responses_[0][k].row;
  row.a = pair.a, row.b = pair.b, row.along = {r.nx, r.ny};
  row.angular_a[0] = r.na, row.angular_b[0] = r.nb;
  return step.joints.locks(responses_[0][k]);
}

// what joints answer to pushes of those touches that close
void Impacts::compute_responses(const Pair& pair, const Push (&pushes)[2][2], const bool (&closes)[2],
                                const Step& step) {
  for (int across = 0; across < 2; ++across) {
    for (int k = 0; k < 2; ++k) {
      if (!closes[k]) continue;
      const Push& push = pushes[across][k];
      Row<2>& row = responses_[across][k].row;
      row.a = pair.a, row.b = pair.b;
      row.along = {push.x, push.y}, row.angular_a[0] = push.a, row.angular_b[0] = push.b;
      step.struck_joints.compute_response(responses_[across][k]);
    }
  }
}

void Impacts::look_at(int pair) {
  if (waiting_[pair]) return;
  waiting_[pair] = 1, queue_.push_back(pair);
}

// a pair's next impact, as its bodies move now; false where it has none
bool Impacts::predict(int i, Impact& impact, const std::vector<ContactBatch>& batches, const Step& step) {
  waiting_[i] = 0;
  const Pair& pair = step.pairs[i];
  const int a = pair.a, b = pair.b >= 0 ? pair.b : int(now_.size()) - 1;
  // too slow for an impact however they meet: most are, and their lanes are far away in memory
  const auto most = [&](const Motion& p, const Motion& q) {
    return std::fabs(p.x - q.x) + std::fabs(p.y - q.y) + std::fabs(p.w) * bounding_radius_[a] +
           std::fabs(q.w) * bounding_radius_[b];
  };
  const double passes = most(now_[a], now_[b]), changes = most(step.dv[a], step.dv[b]);
  if (passes + changes < pair.impact_speed) return false;
  const ContactBatch& g = batches[pair.slot / kLanes];
  if (!may_meet(pair, g, step)) {
    // what ends faster than it goes on the way: its row sees the end alone; and rows that turn see a way that
    // is not gone
    const double turns = pair.material.elasticity > kBounces
                             ? step.pace.h * (std::fabs(now_[a].w) + std::fabs(now_[b].w)) * passes
                             : 0;
    if (changes + turns >= pair.impact_speed) passing_.push_back(i);
    return false;
  }
  if (!find_impact(pair, impact, g, step)) {
    passing_.push_back(i);
    return false;
  }
  // once it has met in this step, one that would hardly bounce again touches: in a pile there is no end of
  // them
  if (impacts_of_[i] != 0 && pair.material.elasticity * impact.speed < pair.impact_speed) return false;
  impact.pair = i;
  return true;
}

// one pair, both touches together; false where joints leave it nothing to move
bool Impacts::resolve(Impact& impact, const std::vector<ContactBatch>& batches, const Step& step) {
  const Pair& pair = step.pairs[impact.pair];
  const int a = pair.a, b = pair.b >= 0 ? pair.b : int(now_.size()) - 1;
  const int group = pair.slot / kLanes, lane = pair.slot % kLanes;
  const ContactBatch& g = batches[group];
  reach(a, impact.when, step), reach(b, impact.when, step);
  bool closes[2] = {impact.met[0], impact.met[1]};
  const auto& pushes = impact.pushes;
  JointSolver<2>& joints = step.struck_joints;
  const bool tied = !joints.empty() && reach_component(pair, impact.when, step);
  const double ima = now_[a].im, imb = now_[b].im, iia = g.iia[lane], iib = g.iib[lane];
  if (tied) {
    for (int k = 0; k < 2; ++k) closes[k] = closes[k] && !locked(impact, k, batches, step);
    if (!closes[0] && !closes[1]) return false;
    place_joints(pair, impact.when, step);
    compute_responses(pair, pushes, closes, step);
  }

  const Motion va = motion_at(a, impact.when, step), vb = motion_at(b, impact.when, step);
  PairImpact system;
  system.mu = pair.material.friction;
  for (int r = 0; r < 4; ++r) {
    if (!closes[r / 2]) continue;
    system.closed[r / 2] = true;
    const Push& p = pushes[r % 2][r / 2];
    system.v[r] = speed(p, va, vb) + (r % 2 != 0 && g.belts ? g.belt[lane] : 0);
    if (r % 2 == 0) {
      const double slow = strike_speed(pair, g.impact_speed[lane], speed(p, step.dv[a], step.dv[b]), step);
      system.e[r / 2] = system.v[r] < slow ? pair.material.elasticity : 0;
    }
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
        give(body, v[0], v[1], w[0]);
      });
      return;
    }
    const Push& p = pushes[across][k];
    give(a, p.x * (ima * l), p.y * (ima * l), iia * (p.a * l));
    give(b, -(p.x * (imb * l)), -(p.y * (imb * l)), -(iib * (p.b * l)));
  };
  for (int k = 0; k < 2; ++k) {
    if (!closes[k]) continue;
    const double n = impulses[2 * k], t = impulses[2 * k + 1];
    impact.n[k] += n, impact.t[k] += t;
    push(0, k, n), push(1, k, t);
    // the work of a kinematic body: impulse times its speed
    const Motion none{}, &ua = ima > 0 ? none : va, &ub = imb > 0 ? none : vb;
    drive_work_ -= n * speed(pushes[0][k], ua, ub) + t * (speed(pushes[1][k], ua, ub) + g.belt[lane]);
    if (tied) drive_work_ += n * joints.given(responses_[0][k]) + t * joints.given(responses_[1][k]);
  }
  return true;
}

// a pair at a time, by the features that are nearest then
Impacts::PlacedPair Impacts::placed_by_nearest(const Pair& pair, double when, const ContactBatch& g,
                                               const Step& step) {
  const int lane = pair.slot % kLanes;
  int words[2];
  features_at(pair, when, step, words);
  copy_lane(g, lane, fresh_, lane);
  return placed_renewed(pair, words, when, step);
}

// whether a pair parts at a time, or does not come together again in what is left of the step
bool Impacts::parts_at(const Pair& pair, double when, const ContactBatch& g, const Step& step) {
  const PlacedPair at = placed_by_nearest(pair, when, g, step);
  for (int k = 0; k < pair.touches; ++k) {
    const double vn = normal_speed(at.rows[k], at.a, at.b);
    if (!(vn > 0) && !(at.rows[k].gap + (step.pace.h - when) * vn > 0)) return false;
  }
  return true;
}

// whether it is apart
bool Impacts::apart_at(const Pair& pair, double when, const ContactBatch& g, const Step& step) {
  const PlacedPair at = placed_by_nearest(pair, when, g, step);
  for (int k = 0; k < pair.touches; ++k)
    if (!(at.rows[k].gap > 0)) return false;
  return true;
}

// Sets the targets of the iterations for the pairs of bodies that had impacts. Their rows are those of the
// middle of the substep. A pair that touches must not approach; a pair that is apart must not close in the
// rest of the substep. If a pair struck by other features than its rows have, the rows may separate fast
// while these features hardly do: to keep up such a speed would take energy from nowhere, so the target is at
// most zero.
void Impacts::leave_to_iterations(std::vector<ContactBatch>& batches, const Step& step) {
  if (least_.size() < batches.size()) least_.resize(batches.size());
  for (const Impact& impact : impacts_) waiting_[impact.pair] = impact.renewed ? 2 : 1;
  const int room = int(now_.size()) - 1;
  const auto leave = [&](int i) {
    const Pair& pair = step.pairs[i];
    const int group = pair.slot / kLanes, lane = pair.slot % kLanes, b = pair.b >= 0 ? pair.b : room;
    ContactBatch& g = batches[group];
    const Rows& r = rows(group, batches, step.poses);
    const char met = waiting_[i];
    double v[2], slow[2];
    bool any = met != 0;
    const double last = std::max({0.0, when_[pair.a], when_[b]});
    const Motion va = motion_at(pair.a, last, step), vb = motion_at(b, last, step);
    for (int k = 0; k < pair.touches; ++k) {
      v[k] = normal_speed(r, k, lane, va, vb);
      const double dvn = normal_speed(r, k, lane, step.dv[pair.a], step.dv[b]),
                   ends = v[k] + gains(dvn, pair);
      slow[k] = strike_speed(pair, g.impact_speed[lane], dvn, step);
      any = any || (v[k] < 0 && r.gap[k][lane] + step.pace.h * v[k] < 0) ||
            (ends < slow[k] && r.gap[k][lane] + step.pace.h * ends < 0);
    }
    const double fast = swiftness(va, bounding_radius_[pair.a]) + swiftness(vb, bounding_radius_[b]);
    const bool struck = strikes(pair.a, b, va, vb, step);
    const auto in_middle = [&](int k) {
      return normal_speed(middle_row(g, lane, k, step.middle[pair.a], step.middle[b]), va, vb);
    };
    // what bounces and has been found not to meet is not held by rows that turn into each other on the way
    const auto would_push = [&](int k) {
      return r.gap[k][lane] + step.pace.h * std::min(v[k], in_middle(k)) < 0;
    };
    if (met == 0 && pair.material.elasticity > kBounces &&
        (would_push(0) || (pair.touches > 1 && would_push(1))) && apart_at(pair, step.pace.h, g, step)) {
      for (int k = 0; k < pair.touches; ++k) {
        g.struck[k] = static_cast<unsigned char>(g.struck[k] | 1 << lane);
        least_[group].n[k][lane] = kNoAim;
      }
      return;
    }
    if (!any && !struck) return;
    if (struck) {
      for (int k = 0; k < 2; ++k) g.surface[k][lane] = g.belt[lane];
    }
    if (!any) {
      // as it stands where the substep begins: a way that was not gone says nothing
      for (int k = 0; k < pair.touches; ++k) g.turns[k][lane] = v[k] - in_middle(k);
      return;
    }
    // what bounces, and parts by the features that are nearest then is not held by those that it had: where
    // corners pass each other they say nothing
    const bool parts = met == 2 && pair.material.elasticity > kBounces && parts_at(pair, last, g, step);
    const PlacedPair at = placed_at(pair, last, g, step);
    const double left = step.pace.h - at.when;
    for (int k = 0; k < pair.touches; ++k) {
      const double gap = at.rows[k].gap, vn = normal_speed(at.rows[k], at.a, at.b);
      double& least = least_[group].n[k][lane];
      g.struck[k] = static_cast<unsigned char>(g.struck[k] | 1 << lane);
      if (parts) {
        least = kNoAim;
        continue;
      }
      const double middle = in_middle(k);
      // Of what goes on bearing and has hardly changed, how its rows turn until the end. Else what rows have
      // in excess, but no more than those where the substep begins: of the middle there is only a way not
      // gone.
      const bool goes_on = !struck && std::fabs(vn) <= kLasting * fast;
      least = !goes_on ? std::min(middle - vn, std::max(v[k] - vn, 0.0)) : v[k] - middle;
      if (goes_on && !(g.p[k][lane] > 0)) least = std::min(least, 0.0);
      // nor may rows that are others push apart what only they part
      if (met == 2 || vn < 0) least = std::min(least, 0.0);
      least = target_after_impacts(least, {gap, vn}, kTogether * g.far[lane], slow[k], left, step.pace.h);
    }
  };
  for (const int i : passing_) leave(i);
  for (const int body : bodies_) {
    for (const int i : around(body)) leave(i);
  }
  for (const Impact& impact : impacts_) waiting_[impact.pair] = 0;
}

// whether impacts have changed by much how fast two pass each other
bool Impacts::strikes(int a, int b, const Motion& va, const Motion& vb, const Step& step) const {
  const Motion &oa = step.old[a], &ob = step.old[b];
  const double ra = bounding_radius_[a], rb = bounding_radius_[b];
  const double changed = std::fabs((va.x - vb.x) - (oa.x - ob.x)) + std::fabs((va.y - vb.y) - (oa.y - ob.y)) +
                         ra * std::fabs(va.w - oa.w) + rb * std::fabs(vb.w - ob.w);
  return changed > kStrikes * (swiftness(oa, ra) + swiftness(ob, rb));
}

// notes it, and looks anew at all that it moves
void Impacts::had_impact(const Impact& impact, const Step& step) {
  const Pair& pair = step.pairs[impact.pair];
  impacts_.push_back(impact);
  // what only passes a blow on may still have one of its own
  if (impact.speed > pair.impact_speed) impacts_of_[impact.pair] = 1;
  for (const int side : {pair.a, pair.b}) {
    if (side < 0 || now_[side].im == 0) continue;
    step.joints.each_tied(side, [&](int body) {
      ++rounds_[body];
      for (const int next : around(body)) look_at(next);
    });
  }
}

int Impacts::run(const LaneList& found, const std::vector<Pair>& pairs, std::vector<ContactBatch>& batches,
                 const std::vector<Pose>& poses, const std::vector<Pose>& middle,
                 const std::vector<Motion>& old, const std::vector<Motion>& dv, std::vector<Motion>& v,
                 const StepConstants& pace, JointSolver<2>& joints, JointSolver<2>& struck_joints) {
  for (const int body : bodies_) when_[body] = first_[body] = -1, rounds_[body] = 0;
  for (const int body : crowd_) crowded_[body] = 0;
  crowd_.clear(), instants_ = 0, spent_ = 0;
  for (const Impact& impact : impacts_) {
    if (impact.pair < int(impacts_of_.size())) impacts_of_[impact.pair] = 0;
  }
  jammed_.assign(now_.size(), 0);
  bodies_.clear(), impacts_.clear(), due_.clear(), predicted_.clear(), passing_.clear();
  rows_.clear(), groups_.clear(), queue_.clear(), drive_work_ = 0;
  if (found.empty()) return -1;
  std::copy(old.begin(), old.end(), now_.begin());
  known_.assign(batches.size(), -1);

  const Step step{pairs, poses, middle, old, dv, pace, joints, struck_joints};
  for (const int lane : found) look_at(batches[lane / kLanes].pair[lane % kLanes]);
  // which lane a pair has hangs on the steps before; the order of pairs does not
  std::sort(queue_.begin(), queue_.end());
  double now = 0;
  std::size_t before = 0;  // impacts before this instant
  for (std::size_t at = 0;;) {
    Impact impact;
    if (at < queue_.size()) {
      // all that may have changed in this instant
      const int i = queue_[at++];
      if (at + kPairsAhead < queue_.size()) __builtin_prefetch(&pairs[queue_[at + kPairsAhead]]);
      if (!predict(i, impact, batches, step)) continue;
      if (impact.when > now) {
        due_.push(impact.when, int(predicted_.size()), rounds(pairs[i]));
        predicted_.push_back(impact);
        continue;
      }
    } else if (!due_.empty()) {
      const ImpactQueue::Due due = due_.pop();
      impact = predicted_[due.number];
      if (due.rounds != rounds(pairs[impact.pair])) continue;
      if (due.when > now) before = impacts_.size();
      now = due.when;
    } else {
      break;
    }
    const Pair& pair = pairs[impact.pair];
    // what loses at each of them ends, but where friction of something that moves feeds it, as of a belt that
    // wedges a box: then nothing bounces there
    if (impacts_.size() - before > kMostAtOnce && pair.material.elasticity < 1) jam(pair);
    if (jams(pair)) continue;
    if (impacts_.size() >= kMostImpacts) {
      for (const int i : queue_) waiting_[i] = 0;
      return pair.a;
    }
    if (at == queue_.size()) queue_.clear(), at = 0;
    if (resolve_instant(impact, batches, step)) {
      for (const Meeting& meeting : meetings_) {
        if (meeting.moved) had_impact(meeting.impact, step);
      }
      continue;
    }
    if (jams(pair)) continue;
    if (resolve(impact, batches, step)) had_impact(impact, step);
  }

  for (const int body : bodies_) {
    const Motion& given = dv_impacts_[body];
    v[body].x += given.x, v[body].y += given.y, v[body].w += given.w;
  }
  leave_to_iterations(batches, step);
  return -1;
}

void Impacts::record(const std::vector<Pair>& pairs, const std::vector<Contact<2>>& contacts,
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
void Impacts::store_impulses(std::vector<Contact<2>>& contacts) const {
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
