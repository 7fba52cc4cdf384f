// Events: the first time at which smooth motion ends within an interval, because a gap closes, a rope
// tightens or a slide stops.
//
// Within the interval the motion is approximated by the cubic through both poses and velocities: an event
// found on it is exact to the fourth order, and exact once it is found again from nearer by.

#include <algorithm>
#include <cmath>

#include "sim/math/false_position.h"
#include "sim/math/lie_step.h"
#include "sim/solve/exact/exact.h"

namespace obscura::sim {

namespace {

constexpr int kFiner = 3;  // steps for one, where there are joints of rows, but few
constexpr int kFewJoints = 8;
constexpr double kAtOnce = 1e-9;    // a part too short to go
constexpr double kFine = 0.25;      // of the thinner body: how far two may move between two looks
constexpr int kMostLooks = 200000;  // of a couple in an interval
constexpr double kSteepest = 2.5;  // of its way: how fast one goes in its interval, at most (Hermite's cubic)
constexpr double kNotKnown = -1e300;
constexpr double kSlope = 1e-4;  // of the time between two looks
constexpr double kGolden = 0.6180339887498949;
constexpr int kClipLooks = 16;
constexpr int kMostRoots = 100;
constexpr double kStraight = 0.8;  // of an interval cut at a release: earlier releases in it are ignored
constexpr double kBeyond = 1e-12;  // of what a joint bears
constexpr double kBeyondAim = 2;   // of the time to it: how far one goes at once
constexpr double kShortestSlip = 1.0 / 64;  // of a step
constexpr double kShorter = 1.0 / 8;        // of an interval that is too long by far
constexpr int kMostShorter = 9;             // times one after another, where numbers are not finite

}  // namespace

template <int D>
void ExactSolver<D>::find_contacts(const State<D>& state, double margin) {
  update_poses(state);
  candidates_.clear();
  for (const Couple& couple : active_.couples) {
    if (!response_.moves(couple.a) && !response_.moves(couple.b)) continue;
    near_contacts(poses_, couple, margin,
                  [&](const ContactCandidate<D>& gap) { candidates_.push_back(gap); });
    scratch_.on_rails.clear();
    near_rails(poses_, couple, margin);
    candidates_.insert(candidates_.end(), scratch_.on_rails.begin(), scratch_.on_rails.end());
  }
  if (!limits_.rails.empty()) choose_rail_contacts();
  if (limits_.wires) follow_wires(state);
  std::sort(candidates_.begin(), candidates_.end(),
            [](const ContactCandidate<D>& p, const ContactCandidate<D>& q) { return p.key < q.key; });
}

// a gap at the stances at hand, m; `otherwise` where its features no longer face each other
template <int D>
double ExactSolver<D>::gap_of(const ContactKey& key, double otherwise) {
  double value = otherwise;
  near_contacts(poses_, {key.a, key.b}, model_.scale, [&](const ContactCandidate<D>& gap) {
    if (gap.key == key) value = gap.value;
  });
  scratch_.on_rails.clear();
  near_rails(poses_, {key.a, key.b}, model_.scale);
  for (const ContactCandidate<D>& gap : scratch_.on_rails)
    if (gap.key == key) value = gap.value;
  return value;
}

// the pose of a body a part of the way from interval_.begun to `state`
template <int D>
BodyMotion<D> ExactSolver<D>::pose_at(const State<D>& state, int body, double h, double part) {
  if (const int drive = drives_.number(body); drive >= 0) return drives_.at(drive, interval_.t + part * h).at;
  const double s = part, r = 1 - s;
  const double p0 = r * r * (1 + 2 * s), p1 = s * s * (3 - 2 * s), m0 = h * s * r * r, m1 = -h * s * s * r;
  BodyMotion<D> at;
  at.x =
      p0 * interval_.begun.x[body] + p1 * state.x[body] + m0 * interval_.begun.v[body] + m1 * state.v[body];
  if (const int k = turning(state, body); k >= 0) {
    at.room_from_body = rotation<D>(sim::between<D>(interval_.begun.turn[k], interval_.begun.spin[k],
                                                    state.turn[k], state.spin[k], h, s));
  }
  return at;
}

// how far a body went at most, m
template <int D>
double ExactSolver<D>::travel(const State<D>& state, int body, double h) const {
  if (const int drive = drives_.number(body); drive >= 0) {
    const auto& [fast, turns] = interval_.paces[std::size_t(drive)];
    return h * fast + limits_.bounding_radius[body] * std::min(2.0, h * turns);
  }
  if (!response_.moves(body)) return 0;
  double sum = std::sqrt((state.x[body] - interval_.begun.x[body]).squaredNorm());
  sum = std::max(sum,
                 h * std::sqrt(std::max(interval_.begun.v[body].squaredNorm(), state.v[body].squaredNorm())));
  if (const int k = turning(state, body); k >= 0) {
    const double fast =
        std::sqrt(std::max(interval_.begun.spin[k].squaredNorm(), state.spin[k].squaredNorm()));
    sum += limits_.bounding_radius[body] * std::min(2.0, h * fast);
  }
  return sum;
}

// whether two are near enough for it
template <int D>
bool ExactSolver<D>::may_close(const State<D>& state, double h, Couple couple) const {
  const auto [a, b] = couple;
  if (!response_.moves(a) && !response_.moves(b)) return false;
  if (b < 0) {
    const Wall<D>& wall = model_.walls[-1 - b];
    return (poses_[a].x - wall.point).dot(wall.normal) <=
           limits_.bounding_radius[a] + travel(state, a, h) + limits_.touching_gap;
  }
  const double far = limits_.bounding_radius[a] + limits_.bounding_radius[b] + travel(state, a, h) +
                     travel(state, b, h) + limits_.touching_gap;
  return (poses_[a].x - poses_[b].x).squaredNorm() <= far * far;
}

// A part between two looks at which a couple lies in each other: where its gap falls from the first and rises
// to the second, by golden section. kNever: it does not.
template <int D>
template <class Gap>
double ExactSolver<D>::clipping_time(Gap&& gap, double from, double to, double at_from, double at_to) {
  const double little = kSlope * (to - from);
  if (!(gap(from + little) < at_from) || !(gap(to - little) < at_to)) return kNever;
  double low = from, high = to, one = high - kGolden * (high - low), other = low + kGolden * (high - low),
         at_one = gap(one), at_other = gap(other);
  for (int i = 0; i < kClipLooks; ++i) {
    if (at_one < -limits_.touching_gap) return one;
    if (at_other < -limits_.touching_gap) return other;
    if (at_one < at_other) {
      high = other, other = one, at_other = at_one;
      one = high - kGolden * (high - low), at_one = gap(one);
    } else {
      low = one, one = other, at_one = at_other;
      other = low + kGolden * (high - low), at_other = gap(other);
    }
  }
  return kNever;
}

// the part of the interval at which a couple closes, beyond what is held; kNever where it does not. Moves
// their stances.
template <int D>
double ExactSolver<D>::closing_time(const State<D>& state, double h, Couple couple) {
  const int a = couple.a, b = couple.b;  // no binding: lambdas of clang 14 cannot hold one
  const double ways = travel(state, a, h) + travel(state, b, h);
  const auto is_held = [&](const ContactKey& key) {
    for (const Constraint& one : constraints_) {
      if (one.kind == Constraint::Kind::contact && candidates_[one.of].key == key) return active(one);
    }
    return false;
  };
  // the least gap at a part of the way
  const auto least = [&](double part) {
    if (shifts(a)) poses_[a] = pose_at(state, a, h, part);
    if (shifts(b)) poses_[b] = pose_at(state, b, h, part);
    double value = 1e300;
    near_contacts(poses_, couple, ways + limits_.touching_gap, [&](const ContactCandidate<D>& gap) {
      if (!is_held(gap.key)) value = std::min(value, gap.value);
    });
    return value;
  };

  // walls are never left behind: the end tells. Bodies may pass through each other between
  double high = kNever, before = 0, gap_before = kNotKnown;
  const double thin =
      b < 0 ? 0
            : std::min(limits_.half_thickness[a] > 0 ? limits_.half_thickness[a] : limits_.half_thickness[b],
                       limits_.half_thickness[b] > 0 ? limits_.half_thickness[b] : limits_.half_thickness[a]);
  const double pieces = thin > 0 && std::isfinite(ways) ? ways / (kFine * thin) : 0;
  const int looks = int(std::min<double>(pieces, kMostLooks - 1)) + 1;
  for (int i = 1; i <= looks; ++i) {
    const double part = double(i) / looks;
    progress_.searches += i > 1;
    const double gap = least(part);
    if (gap < -limits_.touching_gap) {
      high = part;
      break;
    }
    // corners may clip each other between two looks
    if (gap < ways * (part - before)) {
      if (gap_before == kNotKnown) gap_before = least(before);
      if (gap_before > limits_.touching_gap && gap_before + gap < ways * (part - before))
        high = clipping_time(least, before, part, gap_before, gap);
      if (high != kNever) break;
      least(part);
    }
    gap_before = gap;
    // no look is needed before what is between them can be used up
    const double apart = b < 0 ? 0
                               : std::sqrt((poses_[a].x - poses_[b].x).squaredNorm()) -
                                     limits_.bounding_radius[a] - limits_.bounding_radius[b];
    const double spare = apart / (kSteepest * ways) * looks - 1;
    if (spare >= 1) i += int(std::min(spare, double(looks - i))), gap_before = kNotKnown;
    before = double(i) / looks;
  }
  if (high == kNever) return kNever;

  // a part at which they are apart
  double low = before, at_low = least(low);
  for (int i = 0; i < 30 && at_low <= 0; ++i) {
    low = low == 0 && i == 0 ? 0.5 * high : 0.25 * low;
    at_low = least(low);
  }
  const auto force = [&] { return force_couple(couple); };
  if (at_low <= 0) return force();
  const bool touching = least(0) <= limits_.touching_gap;

  // False position, after each try with half the weight of the other end. Its bits are those of all states:
  // FalsePosition, which halves less, is no faster here.
  double at_high = least(high), fine = 0.1 * limits_.touching_gap;
  for (int i = 0; i < kMostRoots && high - low > 1e-15; ++i) {
    double part = (low * at_high - high * at_low) / (at_high - at_low);
    if (!(part > low && part < high)) part = 0.5 * (low + high);
    const double value = least(part);
    if (std::abs(value) <= fine) return touching && part < kAtOnce ? force() : part;
    if (value > 0) {
      if (i > 0) at_high *= 0.5;
      low = part, at_low = value;
    } else {
      if (i > 0) at_low *= 0.5;
      high = part, at_high = value;
    }
  }
  return touching && high < kAtOnce ? force() : 0.5 * (low + high);
}

// two that come through each other at once: from here on they are held
template <int D>
double ExactSolver<D>::force_couple(Couple couple) {
  const std::pair<int, int> pair(couple.a, couple.b);
  progress_.forced_again =
      progress_.forced_again ||
      std::find(progress_.forced.begin(), progress_.forced.end(), pair) != progress_.forced.end();
  progress_.forced.push_back(pair);
  return 0;
}

// How much of `h` may be gone at once: not far beyond where what slips comes to its aim, by the accelerations
// of the instant. A strong motor is there at once, and would throw what it holds about until the interval
// ends.
template <int D>
double ExactSolver<D>::time_to_aims(State<D>& state, double t, double h) {
  const auto slip = [&](const Constraint& constraint) {
    if (!is_bounded(constraint)) return 0.0;
    const ConeBlock<D>& block = blocks_[std::size_t(constraint.block)];
    return block.lower != block.upper
               ? 0.0
               : in_metres(constraint.first, row_velocity(constraint.first) - aim(constraint).speed);
  };
  if (std::none_of(constraints_.begin(), constraints_.end(),
                   [&](const Constraint& constraint) { return std::abs(slip(constraint)) > still_speed_; }))
    return h;
  const auto rate = dynamics_.accelerations(state, t);
  std::vector<double> ends(rate.begin(), rate.end());
  for (int i = 0; i < int(rows_.size()); ++i) add_accelerations(i, f_[i], ends);
  const double shortest = kShortestSlip / value(model_.rate);
  for (const Constraint& constraint : constraints_) {
    const double fast = slip(constraint);
    if (std::abs(fast) <= still_speed_) continue;
    const int row = constraint.first;
    const double gains =
        in_metres(row, row_acceleration(row, ends) + rows_[row].velocity_product - aim(constraint).rate);
    if (fast * gains < 0) h = std::min(h, std::max(kBeyondAim * std::abs(fast / gains), shortest));
  }
  return h;
}

// how far a motor, or the friction of a joint, still is from its aim, at the rows at hand, m/s; below 0 where
// it is past it
template <int D>
double ExactSolver<D>::slip_left(const Constraint& constraint) {
  const double started = interval_.aims[std::size_t(&constraint - constraints_.data())];
  const double sign = interval_.velocities[constraint.first] > started ? 1 : -1;
  return sign * in_metres(constraint.first, row_velocity(constraint.first) - aim(constraint).speed);
}

// the part of the interval at which the first of what slides has stopped, by a straight line; and what slides
template <int D>
double ExactSolver<D>::stopping_time(const Constraint*& which) {
  double first = kNever;
  for (const Constraint& constraint : constraints_) {
    double begun = 0, now = 0;
    if (constraint.kind == Constraint::Kind::contact) {
      const ConeBlock<D>& block = blocks_[constraint.block];
      if (!block.sliding || modes_[constraint.block].kind != ModeKind::slide) continue;
      const Tangent<D>& way = D > 2 ? interval_.modes[constraint.block].along : block.direction;
      for (int i = 0; i < D - 1; ++i) {
        begun += way[i] * interval_.velocities[constraint.first + 1 + i];
        now += way[i] * row_velocity(constraint.first + 1 + i);
      }
      if (D > 2 && begun <= 0) continue;
    } else if (is_bounded(constraint)) {
      const ConeBlock<D>& block = blocks_[constraint.block];
      if (block.lower != block.upper) continue;
      begun = in_metres(constraint.first,
                        std::abs(interval_.velocities[constraint.first] -
                                 interval_.aims[std::size_t(&constraint - constraints_.data())]));
      now = slip_left(constraint);
    } else {
      continue;
    }
    if (!(now < -still_speed_ && begun / (begun - now) < first)) continue;
    first = begun / (begun - now);
    which = &constraint;
  }
  return first;
}

// The length of the interval after which a motor, or the friction of a joint, has come to its aim: it has not
// yet after `low`, and is past it after `high`. Its aim moves, and what it holds swings, so its slip is no
// straight line: false position. Leaves the state, and its rows, at the end of that length.
template <int D>
double ExactSolver<D>::stopping_length(State<D>& state, double t, const Constraint& which, double low,
                                       double high) {
  const auto left_after = [&](double length) {
    begin_again(state, t);
    if (!integrates(state, t, length)) return -1e300;
    build_rows(state, t + length);
    return slip_left(which);
  };
  const double at_high = left_after(high);
  FalsePosition root(low, left_after(low), high, at_high);
  double length = low;
  for (int i = 0; i < kMostRoots && root.high() - root.low() > 1e-15 * root.high(); ++i) {
    length = root.next();
    const double value = left_after(length);
    if (std::abs(value) <= 0.5 * still_speed_) break;
    root.put(length, value);
  }
  return length;
}

// The fraction of the interval at which the first joint is loaded beyond its strength, by linear
// interpolation of the loads; a little later, so that it is found to be so. And what it holds.
template <int D>
double ExactSolver<D>::breaking_time(const State<D>& state, Couple& which) const {
  if (model_.collision != Collision::event) return kNever;
  double first = kNever;
  for (const int i : active_.joints) {
    const Joint<D>& joint = model_.joints[i];
    if (!(joint.breaks < 1e299 || joint.breaks_torque < 1e299) || !holds_any(state, i)) continue;
    const Wrench<D>& at_begin = outcome_.joint_loads[i];
    Wrench<D> at_end = load_of_coil(state, i);
    for (const Constraint& constraint : constraints_) {
      if (constraint.kind != Constraint::Kind::contact && constraint.of == i) at_end += load(constraint);
    }
    const auto passes = [&](double begun, double now, double bears) {
      const double most = bears * (1 + kBeyond);
      if (begun >= most || now <= most) return;
      const double part = (most - begun) / (now - begun);
      if (part < first) first = part, which = {joint.a.body, joint.b.body};
    };
    passes(std::sqrt(at_begin.f.squaredNorm()), std::sqrt(at_end.f.squaredNorm()), joint.breaks);
    passes(std::sqrt(at_begin.n.squaredNorm()), std::sqrt(at_end.n.squaredNorm()), joint.breaks_torque);
  }
  return first;
}

// the rows of what is at hand, at time t
template <int D>
void ExactSolver<D>::build_rows(const State<D>& state, double t) {
  update_poses(state), pose_driven(t);
  rows_.clear();
  for (Constraint& constraint : constraints_) build_jacobian(constraint, turn_of(state, constraint));
}

// the part of the interval from interval_.begun to `state` at which the first thing happens, and to what;
// kNever: nothing does
template <int D>
double ExactSolver<D>::first_event(const State<D>& state, double h, Couple& which, bool& passes,
                                   const Constraint*& stops) {
  // what is moved may go there and back
  interval_.paces.clear();
  for (int i = 0; i < drives_.size(); ++i) interval_.paces.push_back(drives_.fastest(i, interval_.t, h));
  // what slides, by its rows at the end
  build_rows(state, interval_.t + h);
  double first = stopping_time(stops);
  const double stopped = first;
  if (stops) which = {rows_[stops->first].a, rows_[stops->first].b};

  // ropes and limits that are not held, and so have no row, by theirs
  Couple joint{-1, -1};
  if (const double part = tightening_time(state, h, joint); part < first) first = part, which = joint;
  for (const Couple& couple : active_.couples) {
    if (!may_close(state, h, couple)) continue;
    if (const double part = closing_time(state, h, couple); part < first) first = part, which = couple;
    if (has_rails(couple.a) || has_rails(couple.b)) {
      if (const double part = rail_closing_time(state, h, couple); part < first) first = part, which = couple;
    }
    poses_[couple.a] = end_pose(state, couple.a);
    if (couple.b >= 0) poses_[couple.b] = end_pose(state, couple.b);
  }
  passes = false;
  if (const double part = passing_time(state, h); part < first) first = part, passes = true, which = {-1, -1};
  if (const double part = feature_time(state, h); part < first) first = part, passes = true, which = {-1, -1};
  if (first < stopped) stops = nullptr;
  return first;
}

// the turn between the sides of a joint a part of the way
template <int D>
JointTurn<D> ExactSolver<D>::turn_between_at(const State<D>& state, const Joint<D>& joint, double h,
                                             double part) {
  const auto at = [&](int body) -> AngularVec<D> {
    const int k = body < 0 ? -1 : turning(state, body);
    if (k < 0) return AngularVec<D>::Zero();
    if (const int drive = drives_.number(body); drive >= 0)
      return rounds<D>(drives_.at(drive, interval_.t + part * h).turn);
    // of what stands still no beginning is kept
    if (!response_.moves(body)) return rounds<D>(state.turn[k]);
    return rounds<D>(sim::between<D>(interval_.begun.turn[k], interval_.begun.spin[k], state.turn[k],
                                     state.spin[k], h, part));
  };
  const Wound rope = wound(state, std::size_t(&joint - model_.joints.data()));
  return {sim::turn_between(joint, rope, at), rope};
}

// ropes that become tight and limits that are met
template <int D>
double ExactSolver<D>::tightening_time(const State<D>& state, double h, Couple& which) {
  using Kind = typename Constraint::Kind;
  double first = kNever;
  const auto look = [&](Kind kind, int joint) {
    for (const Constraint& constraint : constraints_) {
      if (constraint.kind == kind && constraint.of == joint && active(constraint)) return;
    }
    Constraint constraint{};
    constraint.kind = kind, constraint.of = joint;
    const std::size_t rows = rows_.size();
    const auto left = [&](double part) {
      each_body_held(model_, state, std::size_t(joint), [&](int body) {
        if (shifts(body)) poses_[body] = pose_at(state, body, h, part);
      });
      build_jacobian(constraint, turn_between_at(state, model_.joints[joint], h, part));
      const double off = in_metres(constraint.first, constraint.off);
      rows_.resize(rows);
      return off;
    };
    double high = 1, at_high = left(1);
    const double before = first;
    if (at_high < -limits_.touching_gap) {
      double low = 0, at_low = left(0);
      for (int i = 0; i < 60 && at_low <= 0; ++i) {
        low = i == 0 ? 0.5 : 0.5 * low;
        at_low = left(low);
      }
      if (at_low <= 0) {
        first = 0;
      } else {
        for (int i = 0; i < kMostRoots && high - low > 1e-15; ++i) {
          const double part = 0.5 * (low + high), value = left(part);
          (value > 0 ? low : high) = part;
        }
        first = std::min(first, high);
      }
    }
    if (first < before) which = {model_.joints[joint].a.body, model_.joints[joint].b.body};
    each_body_held(model_, state, std::size_t(joint), [&](int body) {
      if (shifts(body)) poses_[body] = end_pose(state, body);
    });
  };
  for (const int i : active_.joints) {
    const Joint<D>& joint = model_.joints[i];
    if (!holds_any(state, i)) continue;
    if (one_sided(joint)) look(Kind::rope, i);
    if (!has_free_row(joint)) continue;
    if (joint.lower > -1e299) look(Kind::lower, i);
    if (joint.upper < 1e299) look(Kind::upper, i);
  }
  return first;
}

// back to where the interval began
template <int D>
void ExactSolver<D>::begin_again(State<D>& state, double t) {
  restore(interval_.begun, state);
  state.limits_met.rough = interval_.rough, state.limits_met.wildest = interval_.wildest;
  update_poses(state), pose_driven(t);
}

// smooth motion up to the first event, at most h; answers how long it was. `cut`: an event ended it
template <int D>
double ExactSolver<D>::advance_to_event(State<D>& state, double t, double h, bool& cut) {
  save(state, interval_.begun);
  interval_.rough = state.limits_met.rough, interval_.wildest = state.limits_met.wildest;
  interval_.t = t;
  interval_.velocities.resize(Eigen::Index(rows_.size()));
  for (int i = 0; i < int(rows_.size()); ++i) interval_.velocities[i] = row_velocity(i);
  interval_.aims.clear();
  for (const Constraint& constraint : constraints_) interval_.aims.push_back(aim(constraint).speed);
  double length = h, longer = h;
  cut = false, progress_.cut_by = {-1, -1}, progress_.leaving.reset();
  interval_.forces = f_;
  const Constraint* stops = nullptr;  // what the interval is to end with, coming to its aim
  for (int tries = 0; tries < 20; ++tries) {
    if (const bool finite = integrates(state, t, length); !finite || pulls_wildly()) {
      begin_again(state, t);
      cut = true, longer = length, length *= kShorter;
      progress_.released.reset(), stops = nullptr;
      // a force may grow without bound within any interval
      if (!finite && tries >= kMostShorter) return 0;
      continue;
    }
    if (const Constraint* one = progress_.released ? bears_alone(*progress_.released) : nullptr;
        one && force_reserve(*one, f_) > interval_.slight) {
      length = release_length(state, t, *one, length, longer);
      begin_again(state, t);
      integrate(state, t, length);
    }
    if (stops && is_bounded(*stops)) {
      build_rows(state, t + length);
      if (slip_left(*stops) > still_speed_) length = stopping_length(state, t, *stops, length, longer);
    }
    stops = nullptr;
    const Constraint* which = nullptr;
    double opens = progress_.openings > 0 ? release_time(which) : kNever;
    // a force that comes down as far in a shorter time is one of many that may bear the same load
    if (progress_.released && opens < kStraight)
      progress_.unclear.push_back(candidates_[which->of].key), opens = kNever;
    Couple held{-1, -1}, meets{-1, -1};
    const double breaks = breaking_time(state, held);
    bool passes = false;
    double part = std::min(opens, first_event(state, length, meets, passes, stops));
    if (breaks < part) part = breaks, passes = false, meets = held, stops = nullptr;
    // what was to be past the end of a face is not there yet
    if (part > 1 && part == progress_.late && part < kNever && part * length < h) {
      begin_again(state, t);
      cut = progress_.passes = true, progress_.cut_by = {-1, -1};
      progress_.released.reset();
      length *= part;
      break;
    }
    if (part > 1) {
      if (model_.collision != Collision::event) return length;
      const double lawful = lawful_length(state, t, length);
      if (lawful == length) return length;
      cut = true, progress_.passes = false, progress_.cut_by = {-1, -1};
      progress_.released.reset();
      return lawful;
    }
    cut = true;
    progress_.passes = passes && part < opens;
    progress_.released.reset();
    if (part == opens) {
      stops = nullptr;
      progress_.released = candidates_[which->of].key,
      progress_.reserve_at_release = force_reserve(*which, interval_.forces);
      meets = {progress_.released->a, progress_.released->b};
    }
    progress_.cut_by = meets;
    begin_again(state, t);
    if (part * length < 1e-14 * h) return 0;
    longer = length, length *= part;
  }
  integrate(state, t, length);
  return length;
}

// Whether that leads anywhere: where rows are all but dependent, a stage may go beyond all numbers.
template <int D>
bool ExactSolver<D>::integrates(State<D>& state, double t, double h) {
  try {
    integrate(state, t, h);
  } catch (const NotFinite&) {
    return false;
  }
  return all_finite(state);
}

// takes finer steps if there are joints: what they hold swings faster than free bodies fly
template <int D>
void ExactSolver<D>::integrate(State<D>& state, double t, double h) {
  const int pieces = limits_.row_joints == 0 || limits_.row_joints > kFewJoints ? 1 : kFiner;
  interval_.given = 0, interval_.piece = h / pieces;
  for (int i = 0; i < pieces; ++i) {
    dynamics_.step(integrate_, state, t + i * (h / pieces), h / pieces, stages_, this);
    interval_.given += dynamics_.work();
  }
}

template double ExactSolver<2>::advance_to_event(State<2>&, double, double, bool&);
template void ExactSolver<2>::find_contacts(const State<2>&, double);
template double ExactSolver<3>::advance_to_event(State<3>&, double, double, bool&);
template void ExactSolver<3>::find_contacts(const State<3>&, double);
template double ExactSolver<2>::time_to_aims(State<2>&, double, double);
template double ExactSolver<3>::time_to_aims(State<3>&, double, double);
template double ExactSolver<2>::gap_of(const ContactKey&, double);
template BodyMotion<2> ExactSolver<2>::pose_at(const State<2>&, int, double, double);
template BodyMotion<3> ExactSolver<3>::pose_at(const State<3>&, int, double, double);
template double ExactSolver<3>::gap_of(const ContactKey&, double);

}  // namespace obscura::sim
