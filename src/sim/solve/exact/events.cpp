// Where smooth motion ends before its time: something closes, or what slides stops.
//
// Between its ends a stretch is followed on the cubic through both poses and velocities: a closing found
// there is exact to the fourth order, and exact where it is found again from nearer by.

#include <algorithm>
#include <cmath>

#include "sim/math/lie_step.h"
#include "sim/solve/exact/exact.h"

namespace obscura::sim {

namespace {

constexpr int kFiner = 3;  // steps for one, where there are joints of rows, but few
constexpr int kFewJoints = 8;
constexpr double kNever = 2;        // a part of the stretch
constexpr double kAtOnce = 1e-9;    // a part too short to go
constexpr double kFine = 0.25;      // of the thinner body: how far two may move between two looks
constexpr int kMostLooks = 200000;  // of a couple in a stretch
constexpr double kSteepest = 2.5;   // of its way: how fast one goes in its stretch, at most (Hermite's cubic)
constexpr int kMostRoots = 100;
constexpr double kStraight = 0.8;  // how far a straight line is right about when a force has gone, at least
constexpr double kSlight = 1e-6;   // of the largest force: what may pull before it lets go

}  // namespace

// every gap below the margin, if they are near at all
template <int D>
template <class Found>
void ExactSolver<D>::near(const std::vector<BodyMotion<D>>& at, Couple couple, double margin, Found&& found) {
  const auto [a, b] = couple;
  some_.clear();
  if (b < 0) {
    const Wall<D>& wall = model_.walls[-1 - b];
    if ((at[a].x - wall.point).dot(wall.normal) > bounding_radius_[a] + margin) return;
    collide(a, model_.bodies[a].shape, at[a], -1 - b, wall, margin, some_);
  } else {
    const double far = bounding_radius_[a] + bounding_radius_[b] + margin;
    if ((at[a].x - at[b].x).squaredNorm() > far * far) return;
    collide(a, model_.bodies[a].shape, at[a], b, model_.bodies[b].shape, at[b], margin, some_);
  }
  for (const ContactCandidate<D>& gap : some_) found(gap);
}

template <int D>
void ExactSolver<D>::find(const State<D>& state, double margin) {
  stand(state);
  gaps_.clear();
  for (const Couple& couple : active_.couples) {
    if (!response_.moves(couple.a) && !response_.moves(couple.b)) continue;
    near(stances_, couple, margin, [&](const ContactCandidate<D>& gap) { gaps_.push_back(gap); });
  }
  std::sort(gaps_.begin(), gaps_.end(),
            [](const ContactCandidate<D>& p, const ContactCandidate<D>& q) { return p.key < q.key; });
}

// a gap at the stances at hand, m; `otherwise` where its features no longer face each other
template <int D>
double ExactSolver<D>::gap_of(const ContactKey& key, double otherwise) {
  double value = otherwise;
  near(stances_, {key.a, key.b}, model_.scale, [&](const ContactCandidate<D>& gap) {
    if (gap.key == key) value = gap.value;
  });
  return value;
}

// the pose of a body a part of the way from begun_ to `state`
template <int D>
BodyMotion<D> ExactSolver<D>::between(const State<D>& state, int body, double h, double part) const {
  const double s = part, r = 1 - s;
  const double p0 = r * r * (1 + 2 * s), p1 = s * s * (3 - 2 * s), m0 = h * s * r * r, m1 = -h * s * s * r;
  BodyMotion<D> at;
  at.x = p0 * begun_.x[body] + p1 * state.x[body] + m0 * begun_.v[body] + m1 * state.v[body];
  if (const int k = turning(state, body); k >= 0) {
    at.room_from_body =
        rotation<D>(sim::between<D>(begun_.turn[k], begun_.spin[k], state.turn[k], state.spin[k], h, s));
  }
  return at;
}

// how far a body went at most, m
template <int D>
double ExactSolver<D>::way(const State<D>& state, int body, double h) const {
  if (!response_.moves(body)) return 0;
  double sum = std::sqrt((state.x[body] - begun_.x[body]).squaredNorm());
  sum = std::max(sum, h * std::sqrt(std::max(begun_.v[body].squaredNorm(), state.v[body].squaredNorm())));
  if (const int k = turning(state, body); k >= 0) {
    const double fast = std::sqrt(std::max(begun_.spin[k].squaredNorm(), state.spin[k].squaredNorm()));
    sum += bounding_radius_[body] * std::min(2.0, h * fast);
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
    return (stances_[a].x - wall.point).dot(wall.normal) <= bounding_radius_[a] + way(state, a, h) + closed_;
  }
  const double far =
      bounding_radius_[a] + bounding_radius_[b] + way(state, a, h) + way(state, b, h) + closed_;
  return (stances_[a].x - stances_[b].x).squaredNorm() <= far * far;
}

// the part of the stretch at which a couple closes, beyond what is held; kNever where it does not. Moves
// their stances.
template <int D>
double ExactSolver<D>::closing(const State<D>& state, double h, Couple couple) {
  const int a = couple.a, b = couple.b;  // no binding: lambdas of clang 14 cannot hold one
  const double ways = way(state, a, h) + way(state, b, h);
  const auto held = [&](const ContactKey& key) {
    for (const Held& one : held_) {
      if (one.kind == Held::Kind::contact && gaps_[one.of].key == key) return acts(one);
    }
    return false;
  };
  // the least gap at a part of the way
  const auto least = [&](double part) {
    if (response_.moves(a)) stances_[a] = between(state, a, h, part);
    if (response_.moves(b)) stances_[b] = between(state, b, h, part);
    double value = 1e300;
    near(stances_, couple, ways + closed_, [&](const ContactCandidate<D>& gap) {
      if (!held(gap.key)) value = std::min(value, gap.value);
    });
    return value;
  };

  // walls are never left behind: the end tells. Bodies may pass through each other between
  double high = kNever, before = 0;
  const double thin = b < 0 ? 0
                            : std::min(half_thickness_[a] > 0 ? half_thickness_[a] : half_thickness_[b],
                                       half_thickness_[b] > 0 ? half_thickness_[b] : half_thickness_[a]);
  const double pieces = thin > 0 && std::isfinite(ways) ? ways / (kFine * thin) : 0;
  const int looks = int(std::min<double>(pieces, kMostLooks - 1)) + 1;
  for (int i = 1; i <= looks; ++i) {
    const double part = double(i) / looks;
    looks_ += i > 1;
    if (least(part) < -closed_) {
      high = part;
      break;
    }
    // no look is needed before what is between them can be used up
    const double apart = b < 0 ? 0
                               : std::sqrt((stances_[a].x - stances_[b].x).squaredNorm()) -
                                     bounding_radius_[a] - bounding_radius_[b];
    const double spare = apart / (kSteepest * ways) * looks - 1;
    if (spare >= 1) i += int(std::min(spare, double(looks - i)));
    before = double(i) / looks;
  }
  if (high == kNever) return kNever;

  // a part at which they are apart
  double low = before, at_low = least(low);
  for (int i = 0; i < 30 && at_low <= 0; ++i) {
    low = low == 0 && i == 0 ? 0.5 * high : 0.25 * low;
    at_low = least(low);
  }
  const auto force = [&] {
    forced_again_ =
        forced_again_ || std::find(forced_.begin(), forced_.end(), std::pair(a, b)) != forced_.end();
    forced_.push_back({a, b});
    return 0.0;
  };
  if (at_low <= 0) return force();
  const bool touching = least(0) <= closed_;

  // regula falsi, Illinois
  double at_high = least(high), fine = 0.1 * closed_;
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

// the part of the stretch at which the first of what slides has stopped, by a straight line; and whose slide
template <int D>
double ExactSolver<D>::stopping(Couple& which) const {
  double first = kNever;
  for (const Held& held : held_) {
    double begun = 0, now = 0;
    if (held.kind == Held::Kind::contact) {
      const ConeBlock<D>& block = blocks_[held.block];
      if (!block.sliding || modes_[held.block].hold != Hold::slide) continue;
      const Tangent<D>& way = D > 2 ? holding_[held.block].along : block.direction;
      for (int i = 0; i < D - 1; ++i) {
        begun += way[i] * slips_[held.first + 1 + i];
        now += way[i] * moves(held.first + 1 + i);
      }
      if (D > 2 && begun <= 0) continue;
    } else if (held.kind == Held::Kind::motor || held.kind == Held::Kind::friction) {
      const ConeBlock<D>& block = blocks_[held.block];
      if (block.lower != block.upper) continue;
      const double aim = held.kind == Held::Kind::motor ? model_.joints[held.of].motor->speed : 0;
      const double sign = slips_[held.first] > aim ? 1 : -1;
      begun = sign * (slips_[held.first] - aim), now = sign * (moves(held.first) - aim);
    } else {
      continue;
    }
    if (!(now < -still_ && begun / (begun - now) < first)) continue;
    first = begun / (begun - now);
    which = {rows_[held.first].a, rows_[held.first].b};
  }
  return first;
}

// how much force is left, of these, until a contact lets go; in event mode, until it slips
template <int D>
double ExactSolver<D>::grasp(const Held& held, const Eigen::VectorXd& f) const {
  const double pressed = f[held.first];
  if (model_.collision != Collision::event || holding_[held.block].hold != Hold::stick) return pressed;
  return blocks_[held.block].mu * pressed - std::sqrt(f.segment(held.first + 1, D - 1).squaredNorm());
}

// the part of the stretch at which the first contact lets go or slips, by a straight line: where its force
// has gone beyond by a little, so that it does indeed. Beyond, what pulls would hold on, and friction would
// drive the slip
template <int D>
double ExactSolver<D>::letting_go(const Held*& which) {
  double most = 0, first = kNever;
  for (const Held& held : held_) {
    if (held.kind == Held::Kind::contact) most = std::max(most, pressed_[held.first]);
  }
  slight_ = kSlight * most;
  for (const Held& held : held_) {
    if (held.kind != Held::Kind::contact || !acts(held)) continue;
    if (std::find(vague_.begin(), vague_.end(), gaps_[held.of].key) != vague_.end()) continue;
    const double begun = grasp(held, pressed_), now = grasp(held, f_);
    if (begun <= slight_ || now >= -slight_) continue;
    const double part = (begun + 0.5 * slight_) / (begun - now);
    if (part < first) first = part, which = &held;
  }
  return first;
}

// the part of the stretch from begun_ to `state` of the first event, and the pair concerned; kNever:
// nothing does
template <int D>
double ExactSolver<D>::crossing(const State<D>& state, double h, Couple& which) {
  // what slides, by its rows at the end
  stand(state);
  rows_.clear();
  for (Held& held : held_) {
    lay_rows(held, held.kind == Held::Kind::contact ? AngularVec<D>::Zero().eval()
                                                    : turn_between(state, model_.joints[held.of]));
  }
  double first = stopping(which);

  // ropes and limits that are not held, and so have no row, by theirs
  Couple joint{-1, -1};
  if (const double part = tightening(state, h, joint); part < first) first = part, which = joint;
  for (const Couple& couple : active_.couples) {
    if (!may_close(state, h, couple)) continue;
    if (const double part = closing(state, h, couple); part < first) first = part, which = couple;
    stances_[couple.a] = body_motion(state, couple.a);
    if (couple.b >= 0) stances_[couple.b] = body_motion(state, couple.b);
  }
  return first;
}

// the turn between the sides of a joint a part of the way
template <int D>
AngularVec<D> ExactSolver<D>::turn_part(const State<D>& state, const Joint<D>& joint, double h,
                                        double part) const {
  const auto at = [&](int body) -> AngularVec<D> {
    const int k = body < 0 ? -1 : turning(state, body);
    if (k < 0) return AngularVec<D>::Zero();
    return rounds<D>(sim::between<D>(begun_.turn[k], begun_.spin[k], state.turn[k], state.spin[k], h, part));
  };
  return at(joint.a.body) - at(joint.b.body);
}

// ropes that become tight and limits that are met
template <int D>
double ExactSolver<D>::tightening(const State<D>& state, double h, Couple& which) {
  using Kind = typename Held::Kind;
  double first = kNever;
  const auto look = [&](Kind kind, int joint) {
    for (const Held& held : held_) {
      if (held.kind == kind && held.of == joint && acts(held)) return;
    }
    Held held{};
    held.kind = kind, held.of = joint;
    const std::size_t rows = rows_.size();
    const auto left = [&](double part) {
      for (const int body : {model_.joints[joint].a.body, model_.joints[joint].b.body}) {
        if (response_.moves(body)) stances_[body] = between(state, body, h, part);
      }
      lay_rows(held, turn_part(state, model_.joints[joint], h, part));
      rows_.resize(rows);
      return held.off;
    };
    double high = 1, at_high = left(1);
    const double before = first;
    if (at_high < -closed_) {
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
    for (const int body : {model_.joints[joint].a.body, model_.joints[joint].b.body}) {
      if (response_.moves(body)) stances_[body] = body_motion(state, body);
    }
  };
  for (const int i : active_.joints) {
    const Joint<D>& joint = model_.joints[i];
    if (state.broken[i] || (!response_.moves(joint.a.body) && !response_.moves(joint.b.body))) continue;
    if (one_sided(joint)) look(Kind::rope, i);
    if (!has_free_row(joint)) continue;
    if (joint.lower > -1e299) look(Kind::lower, i);
    if (joint.upper < 1e299) look(Kind::upper, i);
  }
  return first;
}

// smooth motion up to the first event, at most h; answers how long it was. `cut`: an event ended it
template <int D>
double ExactSolver<D>::stretch(State<D>& state, double t, double h, bool& cut) {
  keep(state, begun_);
  slips_.resize(Eigen::Index(rows_.size()));
  for (int i = 0; i < int(rows_.size()); ++i) slips_[i] = moves(i);
  double length = h;
  cut = false, charged_ = {-1, -1};
  pressed_ = f_;
  for (int tries = 0; tries < 20; ++tries) {
    smooth(state, t, length);
    // a force may grow without bound within a stretch
    if (!sound(state)) {
      restore(begun_, state);
      stand(state);
      cut = true;
      return 0;
    }
    const Held* which = nullptr;
    double opens = openings_ > 0 ? letting_go(which) : kNever;
    // a force that comes down as far in a shorter time is one of many that may bear the same load
    if (let_go_ && opens < kStraight) vague_.push_back(gaps_[which->of].key), opens = kNever;
    Couple meets{-1, -1};
    const double part = std::min(opens, crossing(state, length, meets));
    if (part > 1) return length;
    cut = true;
    let_go_.reset();
    if (part == opens) {
      let_go_ = gaps_[which->of].key, grasp_at_let_go_ = grasp(*which, pressed_);
      meets = {let_go_->a, let_go_->b};
    }
    charged_ = meets;
    restore(begun_, state);
    stand(state);
    if (part * length < 1e-14 * h) return 0;
    length *= part;
  }
  smooth(state, t, length);
  return length;
}

// in finer steps where there are joints: what they hold swings faster than what flies
template <int D>
void ExactSolver<D>::smooth(State<D>& state, double t, double h) {
  const int pieces = row_joints_ == 0 || row_joints_ > kFewJoints ? 1 : kFiner;
  for (int i = 0; i < pieces; ++i)
    free_.step(integrate_, state, t + i * (h / pieces), h / pieces, stages_, this);
}

template double ExactSolver<2>::stretch(State<2>&, double, double, bool&);
template void ExactSolver<2>::find(const State<2>&, double);
template double ExactSolver<2>::grasp(const Held&, const Eigen::VectorXd&) const;
template double ExactSolver<3>::stretch(State<3>&, double, double, bool&);
template void ExactSolver<3>::find(const State<3>&, double);
template double ExactSolver<3>::grasp(const Held&, const Eigen::VectorXd&) const;
template double ExactSolver<2>::gap_of(const ContactKey&, double);
template double ExactSolver<3>::gap_of(const ContactKey&, double);

}  // namespace obscura::sim
