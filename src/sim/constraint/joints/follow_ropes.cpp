// Ropes at their wheels, from step to step. Poses tell the angle by which a rope is wrapped around a wheel
// but for its rounds; those are kept, in State::wound, and for wheels that it has left in State::wheels_left.
//   wrap = s (phi_out - phi_in),   wrap' = s (phi_out' - phi_in')     phi' = perp(d) . u' / l   of each piece
// where the pieces are those from the places next to the wheel. A rope is on it while wrap > 0. Steps are cut
// where it will be zero, see wheel_time(), so that a rope changes over where both ways are one line. From
// what it has left it may come around to the other side, where
//   wrap_other = sum of angles between the tangents of both sides - wrap - 2 pi > 0
// which is not followed where it is tight.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/constraint/joints/joint.h"
#include "sim/constraint/joints/pulley.h"
#include "sim/model/script.h"

namespace obscura::sim {

namespace {

constexpr double kNoWrap = 1e-9;        // rad: a smaller wrap is none
constexpr double kStraightSoon = 1e-3;  // of a step: a rope that will be straight within that is

// a straight piece of rope between two places
struct Straight {
  RopePiece<2> piece;
  double rate = 0;  // rad/s: how fast it turns
};

// a wheel that a rope is on or has left, where that could change
struct WheelOfRope {
  std::size_t joint = 0, wheel = 0;  // as of WheelLeft
  bool left = false;
  double offset = 0;           // as Winding::offset, m
  double wrap = 0;             // rad, below zero if it has left it
  double rate = 0;             // rad/s
  Straight in = {}, out = {};  // to it and from it
  double other_wrap = 0;       // rad: above zero it lies on the wheel's other side
  double detour = 0;           // m: how much longer the way there is than the straight one
};

// the wheels of all ropes as they stand in a state
class RopeWheels {
 public:
  RopeWheels(const Model<2>& model, const State<2>& state) : model_(model), state_(state) {
    all_.resize(model.bodies.size());
    for (const Joint<2>& joint : model.joints) {
      if (joint.kind != JointKind::pulley) continue;
      joint.each_body([&](int body) {
        if (body >= 0) all_[std::size_t(body)] = body_motion(state, body);
      });
    }
  }

  bool broken(std::size_t i) const { return i < state_.broken.size() && state_.broken[i]; }

  // a joint with its bodies
  template <class Act>
  auto with_pose(std::size_t i, Act&& act) const {
    const Joint<2>& joint = model_.joints[i];
    const AngularVec<2> turn = turn_between(joint, i, state_);
    return act(JointPose<2>{joint, body(joint.a.body), body(joint.b.body), turn, all_, wound(state_, i)});
  }

  // act(wheel) for each wheel of ropes that these may leave or come back to
  template <class Act>
  void each_wheel(Act&& act) const {
    for (std::size_t i = 0; i < model_.joints.size(); ++i) {
      const Joint<2>& joint = model_.joints[i];
      if (joint.kind != JointKind::pulley || broken(i)) continue;
      for (std::size_t k = 0; k < joint.around.size(); ++k)
        if (joint.around[k] != 0)
          if (const auto it = slid_over(i, k)) act(*it);
      if (const auto it = at_end_of(i)) act(*it);
    }
  }

  // m: what a joint has left of its rope
  double slack(std::size_t i) const {
    return with_pose(i, [](const JointPose<2>& at) {
      Row<2> row;
      double left = 0;
      hold_rope(at, &row, &left);
      return left;
    });
  }
  std::size_t head(std::size_t i) const { return i + std::size_t(std::min(0, wound(state_, i).with)); }

 private:
  const BodyMotion<2>& body(int number) const {
    static const BodyMotion<2> room;
    return number < 0 ? room : all_[std::size_t(number)];
  }

  const WheelLeft* find(std::size_t joint, std::size_t wheel) const {
    for (const WheelLeft& it : state_.wheels_left)
      if (std::size_t(it.joint) == joint && std::size_t(it.wheel) == wheel) return &it;
    return nullptr;
  }

  Straight straight_between(const End<2>& a, double on_a, const End<2>& b, double on_b) const {
    const BodyMotion<2>&p = body(a.body), &q = body(b.body);
    const Vec<2> arm_p = p.arm(a.local), arm_q = q.arm(b.local), u = q.velocity(arm_q) - p.velocity(arm_p);
    Straight it{rope_piece<2>(p.x + arm_p, q.x + arm_q, on_a - on_b)};
    const Vec<2>& d = it.piece.direction;
    if (it.piece.length > 0) it.rate = (d[0] * u[1] - d[1] * u[0]) / it.piece.length;
    return it;
  }

  // what there is to know of a wheel between two places; `near`: its wrap but for whole rounds
  void find_wrap(const End<2>& before, double on_before, const End<2>& center, const End<2>& after,
                 double on_after, double near, WheelOfRope& it) const {
    constexpr double kRound = 2 * std::numbers::pi;
    const double sign = it.offset > 0 ? 1 : -1;
    it.in = straight_between(before, on_before, center, it.offset),
    it.out = straight_between(center, it.offset, after, on_after);
    it.wrap = sign * angle_between(it.in.piece.direction, it.out.piece.direction, sign * near);
    it.rate = sign * (it.out.rate - it.in.rate);
    if (!it.left) return;
    const Straight in = straight_between(before, on_before, center, -it.offset),
                   out = straight_between(center, -it.offset, after, on_after);
    it.other_wrap = std::fabs(angle_between(it.in.piece.direction, in.piece.direction)) +
                    std::fabs(angle_between(it.out.piece.direction, out.piece.direction)) - it.wrap - kRound;
    it.detour = in.piece.length + out.piece.length + std::fabs(it.offset) * it.other_wrap -
                straight_between(before, on_before, after, on_after).piece.length;
  }

  // wheel k that a rope with friction slides over; none, where only what stands still is next to it
  std::optional<WheelOfRope> slid_over(std::size_t i, std::size_t k) const {
    const Joint<2>& joint = model_.joints[i];
    const Wound now = wound(state_, i);
    const std::size_t n = joint.around.size(), first = std::size_t(now.off_a),
                      end = n - std::size_t(now.off_b);
    const bool on = k >= first && k < end, none = first == end;
    if (on && k != first && k + 1 != end) return {};
    WheelOfRope it{i, k, !on, joint.around[k]};
    // the places next to it that it is on, from 0 for a to n + 1 for b
    const std::size_t before = k < first || none ? 0
                               : on              ? (k == first ? 0 : k)
                                                 : end,
                      after = k >= end || none ? n + 1
                              : on             ? (k + 1 == end ? n + 1 : k + 2)
                                               : first + 1;
    const auto place = [&](std::size_t at) -> const End<2>& {
      return at == 0 ? joint.a : at == n + 1 ? joint.b : joint.over[at - 1];
    };
    const auto offset = [&](std::size_t at) { return at == 0 || at == n + 1 ? 0 : joint.around[at - 1]; };
    const WheelLeft* known = find(i, k);
    const double near = on ? wrap_at(joint, now, k) : known ? known->wrap : 0;
    find_wrap(place(before), offset(before), joint.over[k], place(after), offset(after), near, it);
    return it;
  }

  // the wheel at the b of a piece, where another piece begins
  std::optional<WheelOfRope> at_end_of(std::size_t i) const {
    if (i + 1 >= model_.joints.size()) return {};
    const Joint<2>&joint = model_.joints[i], &next = model_.joints[i + 1];
    if (next.rope != joint.rope || joint.b.body != next.a.body || joint.on_b.offset == 0 ||
        next.on_a.offset == 0 || broken(i + 1))
      return {};
    const bool left = wound(state_, i + 1).with < 0;
    WheelOfRope it{i, 0, left, joint.on_b.offset};
    const std::size_t h = head(i);
    with_pose(h, [&](const JointPose<2>& before) {
      const RopePlaces<2> places(before);
      if (left) {
        int at = 0;  // the place before it, of those that the rope is on
        for (std::size_t k = h; k <= i; ++k) at += int(model_.joints[k].over.size());
        const WheelLeft* known = find(i, 0);
        find_wrap(places.end(at), places.offset(at), joint.b, places.end(at + 1), places.offset(at + 1),
                  known ? known->wrap : 0, it);
        return;
      }
      with_pose(i + 1, [&](const JointPose<2>& after) {
        const RopePlaces<2> others(after);
        const int at = places.size() - 2;
        find_wrap(places.end(at), places.offset(at), joint.b, others.end(1), others.offset(1),
                  wrap_between(before, after), it);
      });
    });
    return it;
  }

  const Model<2>& model_;
  const State<2>& state_;
  std::vector<BodyMotion<2>> all_;  // of ropes
};

// lets ropes of a state leave wheels and come back to them
class WheelChanges {
 public:
  WheelChanges(const Model<2>& model, State<2>& state)
      : model_(model), state_(state), wheels_(model, state) {}

  const RopeWheels& wheels() const { return wheels_; }

  // changes over to what the wheel says; whether it did
  bool change(const WheelOfRope& it) {
    const double soon = it.wrap + kStraightSoon * step_length(model_.rate) * it.rate;
    if (it.left ? soon <= kNoWrap : soon >= -kNoWrap) return false;
    const bool slides = !model_.joints[it.joint].around.empty();
    if (it.left) {
      slides ? come_back_over(it) : part(it);
    } else {
      slides ? leave_over(it) : join(it);
    }
    wake(model_.joints[it.joint].rope);
    return true;
  }
  void note(const WheelOfRope& it) {
    for (WheelLeft& known : state_.wheels_left)
      if (std::size_t(known.joint) == it.joint && std::size_t(known.wheel) == it.wheel) known.wrap = it.wrap;
  }

 private:
  Wound& rope(std::size_t i) { return state_.wound[i]; }

  // what rests on a rope may hang on another end of it from now on
  void wake(int rope) {
    for (const Joint<2>& joint : model_.joints) {
      if (joint.rope != rope) continue;
      joint.each_body([&](int body) {
        if (body < 0) return;
        if (std::size_t(body) < state_.frozen.size()) state_.frozen[std::size_t(body)] = 0;
        if (std::size_t(body) < state_.quiet.size()) state_.quiet[std::size_t(body)] = 0;
      });
    }
  }

  // the angles at its ends, of a rope that goes another way from now on: near to where they were
  void turn_ends(std::size_t i) {
    const Wound now = wheels_.with_pose(i, [](const JointPose<2>& at) { return turned_ends(at); });
    rope(i).a = now.a, rope(i).b = now.b;
  }

  void leave_over(const WheelOfRope& it) {
    Wound& now = rope(it.joint);
    std::size_t(now.off_a) == it.wheel ? ++now.off_a : ++now.off_b;
    state_.wheels_left.push_back({int(it.joint), int(it.wheel), it.wrap});
    turn_ends(it.joint);
  }

  // Of several that it has left from one end it lies on all up to that which it comes back to: those stand
  // still, and it leaves them from that end on.
  void come_back_over(const WheelOfRope& it) {
    const Joint<2>& joint = model_.joints[it.joint];
    Wound& now = rope(it.joint);
    const int n = int(joint.around.size()), k = int(it.wheel);
    const bool none = now.off_a + now.off_b == n, from_a = k < now.off_a;
    if (from_a || none) now.off_a = k;
    if (!from_a || none) now.off_b = n - 1 - k;
    std::erase_if(state_.wheels_left, [&](const WheelLeft& left) {
      return std::size_t(left.joint) == it.joint && left.wheel >= now.off_a && left.wheel < n - now.off_b;
    });
    // its angles are those that its wrap is of
    const double sign = it.offset > 0 ? 1 : -1;
    if (from_a || none) now.a = angle_between(joint.on_a.start, it.in.piece.direction, now.a);
    double& angle = from_a && !none ? now.a : now.b;
    angle = 0;
    angle = (from_a && !none ? -sign : sign) * (it.wrap - wrap_at(joint, now, it.wheel));
    turn_ends(it.joint);
  }

  // the pieces before and after the wheel are one
  void join(const WheelOfRope& it) {
    const std::size_t h = wheels_.head(it.joint), next = it.joint + 1;
    const std::size_t last = next + std::size_t(rope(next).with);
    rope(h).with = int(last - h), rope(h).b = rope(next).b, rope(h).given += rope(next).given;
    for (std::size_t k = next; k <= last; ++k) rope(k).with = -int(k - h), rope(k).given = 0;
    state_.wheels_left.push_back({int(it.joint), 0, it.wrap});
    turn_ends(h);
  }

  // and two again: what is loose is shared, as the rope slips on the wheel while nothing presses it there
  void part(const WheelOfRope& it) {
    const std::size_t h = wheels_.head(it.joint), next = it.joint + 1, last = h + std::size_t(rope(h).with);
    const Joint<2>&before = model_.joints[it.joint], &after = model_.joints[next];
    const double sign = it.offset > 0 ? 1 : -1, b = rope(h).b;
    rope(h).with = int(it.joint - h), rope(next).with = int(last - next), rope(next).b = b;
    for (std::size_t k = next + 1; k <= last; ++k) rope(k).with = -int(k - next);
    std::erase_if(state_.wheels_left,
                  [&](const WheelLeft& left) { return std::size_t(left.joint) == it.joint; });
    rope(h).b = angle_between(before.on_b.start, it.in.piece.direction, 0);
    rope(next).a =
        rope(h).b + sign * (it.wrap - wrap_between(before.on_b.start, after.on_a.start, it.offset));
    turn_ends(h), turn_ends(next);
    rope(next).given = 0;
    const double more = 0.5 * (wheels_.slack(next) - wheels_.slack(h));
    rope(h).given += more, rope(next).given -= more;
  }

  const Model<2>& model_;
  State<2>& state_;
  RopeWheels wheels_;
};

// leaves wheels and comes back to them; returns the first joint whose rope is on the other side of one
std::optional<EndOfRope> change_wheels(const Model<2>& model, State<2>& state) {
  constexpr double kTight = 1e-6;  // of its length
  WheelChanges ropes(model, state);
  const RopeWheels& wheels = ropes.wheels();
  // what has changed may change what is next to it
  bool any = true;
  for (std::size_t rounds = 0; any && rounds <= 2 * model.joints.size() + 64; ++rounds) {
    any = false;
    wheels.each_wheel([&](const WheelOfRope& it) {
      ropes.note(it);
      any = ropes.change(it) || any;
    });
  }
  std::optional<EndOfRope> ended;
  wheels.each_wheel([&](const WheelOfRope& it) {
    if (ended || !it.left || it.other_wrap <= kNoWrap) return;
    const std::size_t h = wheels.head(it.joint);
    const double length = length_held(model.joints[h], wound(state, h));
    if (wheels.slack(h) - it.detour <= kTight * length) ended = EndOfRope{int(h), true};
  });
  // pieces that are one have one force
  for (std::size_t i = 0; i < state.wound.size() && i < state.joint_forces.size(); ++i)
    if (state.wound[i].with < 0) state.joint_forces[i] = state.joint_forces[wheels.head(i)];
  return ended;
}

// a rope that has broken is on no wheels
template <int D>
void forget_wheels(State<D>& state, std::size_t joint) {
  Wound& rope = state.wound[joint];
  rope.off_a = rope.off_b = rope.with = 0;
  std::erase_if(state.wheels_left, [&](const WheelLeft& it) { return std::size_t(it.joint) == joint; });
}

}  // namespace

template <int D>
std::optional<EndOfRope> follow_ropes(const Model<D>& model, State<D>& state,
                                      std::type_identity_t<std::span<const BodyMotion<D>>> begun,
                                      double done) {
  static const BodyMotion<D> room;
  const double h = step_length(model.rate);
  std::optional<EndOfRope> ended;
  std::vector<BodyMotion<D>> all(model.bodies.size());
  const bool wind = has_wound_ropes(model);
  if (wind) state.wound.resize(model.joints.size());
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const Joint<D>& joint = model.joints[i];
    if (joint.kind != JointKind::pulley) continue;
    if (i < state.broken.size() && state.broken[i]) {
      if (wind) forget_wheels(state, i);
      continue;
    }
    if (one_with_another(state, i)) continue;
    each_body_held(model, state, i, [&](int body) {
      if (body >= 0) all[std::size_t(body)] = body_motion(state, body);
    });
    const AngularVec<D> turn = turn_between(joint, i, state);
    const auto pose = [&](std::span<const BodyMotion<D>> of) {
      const auto side = [&](int body) -> const BodyMotion<D>& {
        return body < 0 ? room : of[std::size_t(body)];
      };
      return JointPose<D>{joint, side(joint.a.body), side(joint.b.body), turn, of, wound(state, i)};
    };
    const JointPose<D> at = pose(all);
    bool ends = comes_to_its_end(at, h);
    if constexpr (D == 2) {
      if (winds(joint)) {
        const auto now = on_wheels(at, h);
        ends = ends || !now || (!begun.empty() && met_rims(pose(begun), at, done));
        if (now) state.wound[i] = *now;
      }
    }
    if (ends && !ended) ended = EndOfRope{int(i)};
  }
  if constexpr (D == 2) {
    if (wind && !ended) ended = change_wheels(model, state);
  }
  return ended;
}

template <int D>
void leave_wheels(const Model<D>& model, State<D>& state) {
  if (!has_wound_ropes(model)) return;
  state.wound.resize(model.joints.size());
  if constexpr (D == 2) change_wheels(model, state);
}

template <int D>
std::optional<double> wheel_time(const Model<D>& model, const State<D>& state, double most) {
  std::optional<double> first;
  if constexpr (D == 2) {
    const double least = kStraightSoon * step_length(model.rate);
    RopeWheels(model, state).each_wheel([&](const WheelOfRope& it) {
      const double t = (it.left == (it.rate > 0)) ? -it.wrap / it.rate : -1;
      if (it.rate != 0 && t > least && t < most - least && (!first || t < *first)) first = t;
    });
  }
  return first;
}

template std::optional<EndOfRope> follow_ropes<2>(const Model<2>&, State<2>&, std::span<const BodyMotion<2>>,
                                                  double);
template std::optional<EndOfRope> follow_ropes<3>(const Model<3>&, State<3>&, std::span<const BodyMotion<3>>,
                                                  double);
template void leave_wheels<2>(const Model<2>&, State<2>&);
template void leave_wheels<3>(const Model<3>&, State<3>&);
template std::optional<double> wheel_time<2>(const Model<2>&, const State<2>&, double);
template std::optional<double> wheel_time<3>(const Model<3>&, const State<3>&, double);

}  // namespace obscura::sim
