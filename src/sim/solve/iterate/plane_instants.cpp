// Impacts of several pairs in one instant, all together (sim/solve/iterate/instant_impact.h): those of bodies
// that hang together by closed gaps or joints, with the ends of joints that are reached there. What is more
// than few goes pair after pair.

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/solve/iterate/plane_impacts.h"
#include "sim/solve/iterate/plane_pair_cache.h"

namespace obscura::sim::plane {

namespace {

constexpr int kMostInstants = 2000;  // of a substep: what is squeezed has no end of them
constexpr double kAtOnce = 0.5;      // of an impact's speed: another that closes so fast is one at once
constexpr int kSpent = 16000;        // of a substep: the squares of the touches of large instants
constexpr int kSpentOfCrowds = 6000;
constexpr double kStill = 1e-9;  // of how fast an instant's touches close: what is left as it is

}  // namespace

// where a body's centre is at a time
std::pair<double, double> Impacts::place_at(int body, double when, const Step& step) const {
  if (when_[body] == when) return {pose_[body].x, pose_[body].y};
  const Motion way = way_at(body, when, step);
  return {step.poses[body].x + way.x, step.poses[body].y + way.y};
}

// what a pair meets in this substep is left to the iterations
void Impacts::jam(const Pair& pair) {
  for (const int side : {pair.a, pair.b})
    if (side >= 0 && now_[side].im > 0) jammed_[side] = 1;
}

// whether a body and the other of a pair of its are near enough to touch at a time
bool Impacts::near_at(const Pair& pair, int body, double when, const Step& step) const {
  if (pair.b < 0) return true;
  const int beside = pair.a == body ? pair.b : pair.a;
  const auto [x, y] = place_at(body, when, step);
  const auto [px, py] = place_at(beside, when, step);
  const double both = (1 + kTogether) * (bounding_radius_[body] + bounding_radius_[beside]);
  return (x - px) * (x - px) + (y - py) * (y - py) <= both * both;
}

bool Impacts::on_joints(int body, const Step& step) {
  return body >= 0 && !step.joints.empty() &&
         (step.joints.has(body) || step.struck_joints.component(body) >= 0);
}

bool Impacts::knows(int pair) const {
  return std::any_of(meetings_.begin(), meetings_.end(),
                     [&](const Meeting& known) { return known.impact.pair == pair; });
}

// Whether a pair touches at a time, by the features that are nearest then: how, into `meeting`.
bool Impacts::meets_at(const Pair& pair, double when, const ContactBatch& g, const Step& step,
                       Meeting& meeting) {
  const int lane = pair.slot % kLanes;
  PlacedPair at = placed_at(pair, when, g, step);
  if (g.calm[lane] < 1e300) {
    int words[2];
    features_at(pair, when, step, words);
    if (outdated(pair, words, g)) {
      copy_lane(g, lane, fresh_, lane);
      at = placed_renewed(pair, words, when, step);
    }
  }
  meeting.impact = {}, meeting.a = at.a, meeting.b = at.b;
  meeting.impact.when = when, meeting.impact.renewed = at.renewed;
  bool any = false;
  for (int k = 0; k < pair.touches; ++k) {
    if (!place_touch(at.rows[k], closed_gap(pair, at, g.far[lane]), k, meeting.impact)) continue;
    any = true;
    meeting.impact.speed = std::max(meeting.impact.speed, -normal_speed(at.rows[k], at.a, at.b));
  }
  return any;
}

bool Impacts::crowd() const { return int(now_.size()) - 1 > InstantImpact<2>::kCrowd; }

// how many touches are solved together at most
int Impacts::most_together() const {
  return crowd() ? InstantImpact<2>::kMostOfCrowds : InstantImpact<2>::kMost;
}

// What hangs together with an impact through touches that are closed then, into meetings_ and closed_. False
// where that is more than few.
bool Impacts::gather_instant(const Impact& first, const std::vector<ContactBatch>& batches,
                             const Step& step) {
  meetings_.assign(1, {first, {}, {}, false}), closed_.clear();
  bool few = true;
  const int most = spent_ > (crowd() ? kSpentOfCrowds : kSpent) ? InstantImpact<2>::kFew : most_together();
  const auto list = [&](int number) {
    for (int k = 0; k < 2; ++k)
      if (meetings_[number].impact.met[k]) closed_.emplace_back(number, k);
    few = int(closed_.size()) <= most;
  };
  list(0);
  for (int m = 0; few && m < int(meetings_.size()); ++m) {
    const Pair& pair = step.pairs[meetings_[m].impact.pair];
    for (const int side : {pair.a, pair.b}) {
      if (side < 0 || now_[side].im == 0) continue;
      step.joints.each_tied(side, [&](int body) {
        for (const int next : around(body)) {
          if (!few) return;
          const Pair& other = step.pairs[next];
          if (!near_at(other, body, first.when, step) || knows(next)) continue;
          Meeting meeting;
          if (!meets_at(other, first.when, batches[other.slot / kLanes], step, meeting)) continue;
          meeting.impact.pair = next;
          meetings_.push_back(meeting);
          list(int(meetings_.size()) - 1);
        }
      });
    }
  }
  // what falls flat strikes with several of its bodies at once; in heaps a blow is one of a pair, and what
  // else touches rests
  const auto strikes = [&](const Meeting& it) { return it.impact.speed > kAtOnce * first.speed; };
  const bool tied = std::any_of(meetings_.begin(), meetings_.end(), [&](const Meeting& it) {
    const Pair& pair = step.pairs[it.impact.pair];
    return on_joints(pair.a, step) || on_joints(pair.b, step);
  });
  return few && (int(closed_.size()) <= InstantImpact<2>::few(tied, int(now_.size()) - 1) ||
                 std::count_if(meetings_.begin(), meetings_.end(), strikes) > 1);
}

// an impact alone, into meetings_ and closed_
void Impacts::take_alone(const Impact& first) {
  meetings_.assign(1, {first, {}, {}, false}), closed_.clear();
  for (int k = 0; k < 2; ++k)
    if (first.met[k]) closed_.emplace_back(0, k);
}

// the ends of joints that are reached by what meets, into ends_
void Impacts::gather_ends(double when, const Step& step) {
  ends_.clear();
  if (step.joints.empty()) return;
  for (const Meeting& meeting : meetings_) {
    const Pair& pair = step.pairs[meeting.impact.pair];
    place_joints(pair, when, step);
    for (const int body : {pair.a, pair.b}) {
      if (body < 0) continue;
      const double left = 1 - when / step.constants.h;
      ends_.add(step.joints, step.struck_joints, body, left, [&](int member, Vec<2>& v, AngularVec<2>& w) {
        if (now_[member].im == 0) return false;
        Pose ignored;
        Motion its;
        move(member, when, step, ignored, its);
        v = {its.x, its.y}, w[0] = its.w;
        return true;
      });
    }
  }
  ends_.drop_if_too_many();
}

// the pair of a touch of an instant, and how its rows push
const Pair& Impacts::pair_of(int touch, const Step& step) const {
  return step.pairs[meetings_[closed_[touch].first].impact.pair];
}
const Impacts::Push& Impacts::push_of(int row) const {
  const auto& [number, k] = closed_[row / 2];
  return meetings_[number].impact.pushes[row % 2][k];
}

// what a row of an instant does to both of its bodies
std::array<Impacts::StruckSide, 2> Impacts::sides(int row, const std::vector<ContactBatch>& batches,
                                                  const Step& step) const {
  const Pair& pair = pair_of(row / 2, step);
  const ContactBatch& g = batches[pair.slot / kLanes];
  const int lane = pair.slot % kLanes, b = pair.b >= 0 ? pair.b : int(now_.size()) - 1;
  const Push& push = push_of(row);
  return {{{pair.a, push.x, push.y, push.a, now_[pair.a].im, g.iia[lane]},
           {b, -push.x, -push.y, -push.b, now_[b].im, g.iib[lane]}}};
}

// The system of the touches of an instant, into instant_; there is room for ends_. `tied`: joints hold some
// of its bodies.
void Impacts::couple_instant(const std::vector<ContactBatch>& batches, const Step& step, bool tied) {
  JointSolver<2>& joints = step.struck_joints;
  const int count = int(closed_.size()), rows = 2 * count, room = int(now_.size()) - 1;
  instant_.resize(count, ends_.count());
  auto& K = instant_.K;
  if (tied && instant_responses_.empty()) {
    instant_responses_.resize(InstantImpact<2>::kMostRows);
    for (JointSolver<2>::JointResponse& response : instant_responses_) joints.reserve(response);
  }
  for (int i = 0; i < rows; ++i) {
    const int k = i / 2;
    const Pair& pair = pair_of(k, step);
    const ContactBatch& g = batches[pair.slot / kLanes];
    const int lane = pair.slot % kLanes;
    const Meeting& meeting = meetings_[closed_[k].first];
    const Push& push = push_of(i);
    instant_.speeds[i] = speed(push, meeting.a, meeting.b) + (i % 2 != 0 && g.belts ? g.belt[lane] : 0);
    instant_.blocks[k].mu = pair.material.friction;
    const auto driven = [](double im, const Motion& u) {
      return !(im > 0) && (u.x != 0 || u.y != 0 || u.w != 0);
    };
    instant_.driven = instant_.driven || (g.belts && g.belt[lane] != 0) ||
                      driven(now_[pair.a].im, meeting.a) ||
                      (pair.b >= 0 && driven(now_[pair.b].im, meeting.b));
    const auto gained = [&] { return speed(push, step.dv[pair.a], step.dv[pair.b >= 0 ? pair.b : room]); };
    if (i % 2 == 0 && instant_.speeds[i] < strike_speed(pair, g.impact_speed[lane], gained(), step))
      instant_.strikes[k] = 1, instant_.elasticity[k] = pair.material.elasticity;
    const auto own = sides(i, batches, step);
    if (tied) {
      Row<2>& row = instant_responses_[i].row;
      row.a = pair.a, row.b = pair.b;
      row.along = {push.x, push.y}, row.angular_a[0] = push.a, row.angular_b[0] = push.b;
      joints.compute_response(instant_responses_[i]);
    }
    for (int j = 0; j <= i; ++j) {
      double sum = 0;
      if (tied) {
        sum = joints.response_between(instant_responses_[i], instant_responses_[j]);
      } else {
        const auto others = sides(j, batches, step);
        for (const StruckSide& p : own)
          for (const StruckSide& q : others)
            if (p.body == q.body) sum += p.im * (p.x * q.x + p.y * q.y) + p.ii * (p.turn * q.turn);
      }
      K(i, j) = K(j, i) = sum;
    }
  }
}

// What a blow makes close of all that hangs together with it, into meetings_ and closed_: what it leaves as
// it is has no part in it. False where that is more than few, hangs on joints, or no impulses are found.
bool Impacts::grow_instant(const Impact& first, const std::vector<ContactBatch>& batches, const Step& step) {
  take_alone(first);
  ends_.clear();
  const Pair& its = step.pairs[first.pair];
  if (!(its.material.elasticity > kBounces)) return false;
  const int room = int(now_.size()) - 1;
  const int most = most_together();
  Pose ignored;
  move(its.a, first.when, step, ignored, meetings_[0].a);
  move(its.b >= 0 ? its.b : room, first.when, step, ignored, meetings_[0].b);
  if (on_joints(its.a, step) || on_joints(its.b, step)) return false;
  for (std::size_t known = 0; known < meetings_.size();) {
    known = meetings_.size();
    couple_instant(batches, step, false);
    if (++instants_ > kMostInstants || !instant_.solve()) return false;
    changes_.clear();
    double fastest = 0;
    for (int i = 0; i < 2 * int(closed_.size()); ++i) {
      fastest = std::max(fastest, std::fabs(instant_.speeds[i]));
      const double l = instant_.p[i];
      for (const StruckSide& p : sides(i, batches, step)) {
        auto at = std::find_if(changes_.begin(), changes_.end(),
                               [&](const auto& it) { return it.first == p.body; });
        if (at == changes_.end()) at = changes_.insert(at, {p.body, Motion{}});
        at->second.x += p.x * (p.im * l), at->second.y += p.y * (p.im * l),
            at->second.w += p.ii * (p.turn * l);
      }
    }
    const auto change = [&](int body) {
      for (const auto& [of, by] : changes_)
        if (of == body) return by;
      return Motion{};
    };
    for (std::size_t m = 0; m < known; ++m) {
      const Pair pair = step.pairs[meetings_[m].impact.pair];
      for (const int side : {pair.a, pair.b}) {
        if (side < 0 || now_[side].im == 0) continue;
        for (const int next : around(side)) {
          const Pair& other = step.pairs[next];
          if (!near_at(other, side, first.when, step) || knows(next)) continue;
          Meeting meeting;
          if (!meets_at(other, first.when, batches[other.slot / kLanes], step, meeting)) continue;
          meeting.impact.pair = next;
          const Motion a = change(other.a), b = change(other.b >= 0 ? other.b : room);
          const auto closes = [&](int k) {
            const Push& push = meeting.impact.pushes[0][k];
            return meeting.impact.met[k] &&
                   speed(push, meeting.a, meeting.b) + speed(push, a, b) < -kStill * fastest;
          };
          if (!closes(0) && !closes(1)) continue;
          if (on_joints(other.a, step) || on_joints(other.b, step)) return false;
          meetings_.push_back(meeting);
          for (int k = 0; k < 2; ++k)
            if (meeting.impact.met[k]) closed_.emplace_back(int(meetings_.size()) - 1, k);
          if (int(closed_.size()) > most) return false;
        }
      }
    }
  }
  return true;
}

// all that meets together; false where it goes pair after pair
bool Impacts::resolve_instant(const Impact& first, const std::vector<ContactBatch>& batches,
                              const Step& step) {
  if (instants_ == kMostInstants || (!together_ && step.joints.empty())) return false;
  JointSolver<2>& joints = step.struck_joints;
  const Pair& its = step.pairs[first.pair];
  const auto moves = [&](int body) { return body >= 0 && now_[body].im > 0; };
  bool alone = !together_;
  for (const int body : {its.a, its.b}) alone = alone || (moves(body) && crowded_[body] != 0);
  bool solved = false;
  if (!alone && !gather_instant(first, batches, step) && !(solved = grow_instant(first, batches, step))) {
    // so many touch there that what meets them later goes pair after pair, too
    alone = true;
    for (const int body : {its.a, its.b})
      if (moves(body)) crowded_[body] = 1, crowd_.push_back(body);
  }
  if (alone) take_alone(first);
  const auto tied_to = [&](int body) { return body >= 0 && joints.component(body) >= 0; };
  const auto hangs = [&](const Meeting& meeting) {
    const Pair& pair = step.pairs[meeting.impact.pair];
    return tied_to(pair.a) || tied_to(pair.b);
  };
  const bool tied = !joints.empty() && std::any_of(meetings_.begin(), meetings_.end(), hangs);
  // what joints leave nothing to move meets nothing
  if (tied) {
    std::erase_if(closed_, [&](const auto& touch) {
      const Meeting& meeting = meetings_[touch.first];
      return hangs(meeting) && locked(meeting.impact, touch.second, batches, step);
    });
    if (closed_.empty()) return false;
  }
  gather_ends(first.when, step);
  if (meetings_.size() == 1 && ends_.count() == 0) return false;
  Pose ignored;
  move(its.a, first.when, step, ignored, meetings_[0].a);
  move(its.b >= 0 ? its.b : int(now_.size()) - 1, first.when, step, ignored, meetings_[0].b);
  const int count = int(closed_.size()), rows = 2 * count, room = int(now_.size()) - 1;
  if (!solved) {
    couple_instant(batches, step, tied);
    if (tied) ends_.couple(joints, std::span(instant_responses_).first(std::size_t(rows)), instant_);
    ++instants_;
    if (count > InstantImpact<2>::kFew) spent_ += count * count;
    if (!instant_.solve()) {
      // the iterations push it out as far as they come
      for (const Meeting& meeting : meetings_)
        if (instant_.jams()) jam(step.pairs[meeting.impact.pair]);
      return false;
    }
  }

  for (int k = 0; k < count; ++k) {
    const auto& [number, touch] = closed_[k];
    meetings_[number].impact.n[touch] += instant_.p[2 * k];
    meetings_[number].impact.t[touch] += instant_.p[2 * k + 1];
  }
  const bool ends_push = ends_.push(instant_);
  for (Meeting& meeting : meetings_) {
    const Pair& pair = step.pairs[meeting.impact.pair];
    meeting.moved = meeting.impact.any() || (ends_push && (tied_to(pair.a) || tied_to(pair.b)));
    if (!meeting.moved) continue;
    reach(pair.a, first.when, step), reach(pair.b >= 0 ? pair.b : room, first.when, step);
    if (tied) reach_component(pair, first.when, step);
  }
  for (int i = 0; i < rows; ++i) {
    const double l = instant_.p[i];
    if (l == 0) continue;
    const Pair& pair = pair_of(i / 2, step);
    const ContactBatch& g = batches[pair.slot / kLanes];
    const Meeting& meeting = meetings_[closed_[i / 2].first];
    const auto own = sides(i, batches, step);
    // the work of a kinematic body: impulse times its speed
    const Motion none{}, &ua = own[0].im > 0 ? none : meeting.a, &ub = own[1].im > 0 ? none : meeting.b;
    drive_work_ -= l * (speed(push_of(i), ua, ub) + (i % 2 != 0 ? g.belt[pair.slot % kLanes] : 0));
    if (tied) {
      drive_work_ += l * joints.given(instant_responses_[i]);
      joints.each_push(instant_responses_[i], l, [&](int body, const Vec<2>& v, const AngularVec<2>& w) {
        give(body, v[0], v[1], w[0]);
      });
      continue;
    }
    for (const StruckSide& p : own) give(p.body, p.x * (p.im * l), p.y * (p.im * l), p.ii * (p.turn * l));
  }
  drive_work_ += ends_.apply(joints, instant_, [&](int body, const Vec<2>& v, const AngularVec<2>& w) {
    give(body, v[0], v[1], w[0]);
  });
  return true;
}

}  // namespace obscura::sim::plane
