#pragma once

// Pulley: a rope without mass runs from a over points, of bodies or the room, to b, and is no longer than L.
//   C    = L - sum l_i - q_a (phi_a - theta_a) + q_b (phi_b - theta_b) >= 0,  f >= 0,  f C = 0
//                                l_i  the free pieces, straight from one to the next, of direction d_i
//   J v  = - sum d_i . (v_i+1 - v_i) + q_a w_a - q_b w_b
//   J' v = - sum (|u|^2 - (d . u)^2) / l + d . (w x (w x r))_i+1 - d . (w x (w x r))_i,   u = v_i+1 - v_i
// A wheel at an end (in the plane) takes the rope up without slipping: q is its radius, negative where the
// rope runs around it clockwise, phi the angle of the rope there, all rounds counted from the start, theta
// that of the wheel. The poses tell phi but for its rounds: it is the angle nearest to State::wound. The
// piece between two ends p_a and p_b, centres of wheels or points, is tangent to both:
//   p_b - p_a = l d - q perp(d),   q = q_a - q_b
// With friction (mu > 0) its rope slides over all that is between its ends, points and wheels, which are
// wheels in the plane alone; several of them stand still. Arcs are q (phi_out - phi_in) of it, and beside the
// tension f there is a drag, the tension at a less that at b:
//   J_d v = (J_first - J_last) v / 2            of the free pieces at a and b: half the slip, in m/s
//   |drag| <= mu_e f,   mu_e = 2 tanh(mu wrap / 2)      so that the greater tension is at most e^(mu wrap)
//                                                       times the lesser; against the slip where it slips
// Where its wrap around a wheel falls to zero the rope leaves that, and goes straight on until it comes back:
//   wrap = s (phi_out - phi_in),   s = 1 to the left, -1 to the right
// There both ways are one line, so C and J go on; follow_ropes.cpp follows it. Pieces of a rope with a wheel
// between them are then one, whose C is the sum of theirs, in which the wheel's turn does not count.
// free: all, until it is tight. Its force is the tension, shown as that on a. Breaks by it.
// Source: Featherstone, Rigid Body Dynamics Algorithms (2008), §8, as a sum of distance constraints; the
// friction is Euler's and Eytelwein's of a belt.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "sim/constraint/joints/joint.h"
#include "sim/math/elementary.h"

namespace obscura::sim {

/// A straight piece of rope: from one end to the next, how long, and which way.
template <int D>
struct RopePiece {
  Vec<D> direction = Vec<D>::Zero();
  double length = 0;  // m
};

/// The piece between two places whose wheels offset it by q in all.
template <int D>
RopePiece<D> rope_piece(const Vec<D>& from, const Vec<D>& to, double q) {
  const Vec<D> u = to - from;
  const double far2 = u.squaredNorm();
  RopePiece<D> piece;
  piece.length = std::sqrt(std::max(0.0, far2 - q * q));
  if (!(far2 > 0)) return piece;
  piece.direction = piece.length / far2 * u;
  if constexpr (D == 2) piece.direction += q / far2 * Vec<D>(-u[1], u[0]);
  return piece;
}

/// The angle from one direction of the plane to another, rad, within pi.
inline double angle_between(const Vec<2>& from, const Vec<2>& to) {
  return elementary::atan2(from[0] * to[1] - from[1] * to[0], from.dot(to));
}

/// That angle, whole rounds added, that is nearest to another.
inline double angle_between(const Vec<2>& from, const Vec<2>& to, double near) {
  constexpr double kRound = 2 * std::numbers::pi;
  const double angle = angle_between(from, to);
  return angle + kRound * std::round((near - angle) / kRound);
}

/// Whether a piece between two places, `u` apart and offset by q, will have next to no length left within a
/// time h: on the straight way from here, least of
///   l^2 = (u + u' s)^2 - q^2        0 <= s <= h
/// is below the square of a part of that way. Its end turns it about then, faster than a step follows.
template <int D>
bool runs_out(const Vec<D>& u, const Vec<D>& rate, double q, double h) {
  constexpr double kPart = 0.1;
  const double along = u.dot(rate), speed2 = rate.squaredNorm();
  if (!(along < 0)) return false;
  const double s = std::min(h, -along / speed2),
               least2 = u.squaredNorm() - q * q + s * (2 * along + s * speed2);
  return least2 <= kPart * kPart * h * h * speed2;
}

/// How far a rope that comes to a wheel by one direction and leaves it by another is wrapped around it, rad,
/// less than a round; none where it is straight but for rounding. `offset`: Winding::offset.
inline double wrap_between(const Vec<2>& before, const Vec<2>& after, double offset) {
  const double turn = (offset > 0 ? 1 : -1) * angle_between(before, after);
  constexpr double kRounding = 1e-12;
  return turn < -kRounding ? turn + 2 * std::numbers::pi : std::max(0.0, turn);
}

/// The last of the pieces of a rope that are one with a joint of a model, itself where there are no others.
template <int D>
const Joint<D>& last_piece(const JointPose<D>& at) {
  return (&at.joint)[std::max(0, at.wound.with)];
}

/// The places of a rope in their order, from a to b, with what it runs over between them, but for wheels that
/// it has left.
template <int D>
class RopePlaces {
 public:
  explicit RopePlaces(const JointPose<D>& at)
      : at_(at), last_(&last_piece(at)), size_(2 - at.wound.off_a - at.wound.off_b) {
    for (const Joint<D>* piece = &at.joint; piece <= last_; ++piece) size_ += int(piece->over.size());
  }

  int size() const { return size_; }
  const End<D>& end(int i) const {
    if (i == 0) return at_.joint.a;
    if (i + 1 == size_) return last_->b;
    std::size_t k = std::size_t(i - 1 + at_.wound.off_a);
    const Joint<D>* piece = &at_.joint;
    for (; k >= piece->over.size(); ++piece) k -= piece->over.size();
    return piece->over[k];
  }
  /// As Winding::offset, m.
  double offset(int i) const {
    if (i == 0) return at_.joint.on_a.offset;
    if (i + 1 == size_) return last_->on_b.offset;
    return at_.joint.around.empty() ? 0 : at_.joint.around[std::size_t(i - 1 + at_.wound.off_a)];
  }
  /// The straight piece from place i to the next.
  RopePiece<D> piece(int i) const {
    const BodyMotion<D>&p = at_.side(end(i).body), &q = at_.side(end(i + 1).body);
    return rope_piece<D>(Vec<D>(p.x + p.arm(end(i).local)), Vec<D>(q.x + q.arm(end(i + 1).local)),
                         offset(i) - offset(i + 1));
  }
  /// Whether place i and the next are points, and no rope will be left between them within a time h, s.
  bool meet(int i, double h) const {
    if (offset(i) != 0 || offset(i + 1) != 0) return false;
    const BodyMotion<D>&p = at_.side(end(i).body), &q = at_.side(end(i + 1).body);
    const Vec<D> arm_p = p.arm(end(i).local), arm_q = q.arm(end(i + 1).local);
    return runs_out<D>(q.x + arm_q - p.x - arm_p, q.velocity(arm_q) - p.velocity(arm_p), 0, h);
  }
  /// Adds a piece to a row of the rope, `share` times: its ends, less the turn of wheels there, and J' v.
  void add(int i, const RopePiece<D>& piece, double share, Row<D>& row) const {
    const BodyMotion<D>&p = at_.side(end(i).body), &q = at_.side(end(i + 1).body);
    const Vec<D> arm_p = p.arm(end(i).local), arm_q = q.arm(end(i + 1).local);
    const Vec<D>& d = piece.direction;
    const auto side = [&](int place, const Vec<D>& arm, double sign) {
      const int body = end(place).body;
      if (body < 0) return;
      RowSide<D> it{body, Vec<D>(sign * d), moment<D>(arm, Vec<D>(sign * d))};
      if constexpr (D == 2) it.angular[0] += sign * offset(place);
      row.more.push_back(it);
    };
    side(i, arm_p, share), side(i + 1, arm_q, -share);
    const Vec<D> u = q.velocity(arm_q) - p.velocity(arm_p);
    const double along = d.dot(u);
    if (piece.length > 0) row.velocity_product -= share * ((u.squaredNorm() - along * along) / piece.length);
    row.velocity_product -= share * d.dot(cross_velocity<D>(q.w, cross_velocity<D>(q.w, arm_q)) -
                                          cross_velocity<D>(p.w, cross_velocity<D>(p.w, arm_p)));
    if (i == 0) row.along = share * d;
  }

 private:
  const JointPose<D>& at_;
  const Joint<D>* last_;
  int size_;
};

/// The first place of a rope, or the last, and the place next to it; how far their wheels offset the piece
/// between.
struct RopeEnd {
  Vec<2> from, to;
  double offset = 0;
  Vec<2> rate;  // of to - from, m/s
};
inline RopeEnd rope_end(const JointPose<2>& at, bool first) {
  const RopePlaces<2> places(at);
  const int i = first ? 0 : places.size() - 2;
  const End<2>&from = places.end(i), &to = places.end(i + 1);
  const BodyMotion<2>&p = at.side(from.body), &q = at.side(to.body);
  const Vec<2> arm_p = p.arm(from.local), arm_q = q.arm(to.local);
  return {p.x + arm_p, q.x + arm_q, places.offset(i) - places.offset(i + 1),
          q.velocity(arm_q) - p.velocity(arm_p)};
}

/// The same of an end on a wheel: or it turns by more than a radian in that time, as it is so short.
inline bool runs_out(const RopeEnd& end, const RopePiece<2>& piece, double h) {
  if (!(piece.length > 0) || runs_out<2>(end.to - end.from, end.rate, end.offset, h)) return true;
  const double across = piece.direction[0] * end.rate[1] - piece.direction[1] * end.rate[0];
  return h * std::fabs(across) > piece.length;
}

/// Whether the rope has a wheel at that end.
inline bool on_wheel(const JointPose<2>& at, bool first) {
  if (at.joint.around.empty()) return (first ? at.joint.on_a : last_piece(at).on_b).offset != 0;
  const RopePlaces<2> places(at);
  return places.offset(first ? 1 : places.size() - 2) != 0;
}

/// Whether an end was on the rim of its wheel on its way, of h s, between how it began and how it ended:
///   |u| < |q|    on the cubic that both places and speeds give
inline bool met_rim(const RopeEnd& begun, const RopeEnd& ended, double h) {
  constexpr int kLooks = 16;
  const Vec<2> u = begun.to - begun.from, w = ended.to - ended.from;
  for (int i = 1; i < kLooks; ++i) {
    const double s = double(i) / kLooks, left = 1 - s;
    const Vec<2> there = left * left * ((1 + 2 * s) * u + s * h * begun.rate) +
                         s * s * ((3 - 2 * s) * w - left * h * ended.rate);
    if (there.squaredNorm() < ended.offset * ended.offset) return true;
  }
  return false;
}

/// The same of either end of a rope.
inline bool met_rims(const JointPose<2>& begun, const JointPose<2>& ended, double h) {
  return (on_wheel(begun, true) && met_rim(rope_end(begun, true), rope_end(ended, true), h)) ||
         (on_wheel(begun, false) && met_rim(rope_end(begun, false), rope_end(ended, false), h));
}

/// How far a rope with friction turns to the left at wheel k of Joint::around at the start, all rounds
/// counted, rad.
inline double turn_at_start(const Joint<2>& joint, std::size_t k) {
  return (joint.around[k] > 0 ? 1 : -1) * joint.wraps[k];
}

/// How far a rope with friction is wrapped around wheel k of Joint::around, rad, all rounds counted, as its
/// ends are turned by `now`. Of a wheel that it is on, and that is the first or the last such: between others
/// nothing moves.
inline double wrap_at(const Joint<2>& joint, const Wound& now, std::size_t k) {
  const std::size_t first = std::size_t(now.off_a), last = joint.around.size() - 1 - std::size_t(now.off_b);
  const double sign = joint.around[k] > 0 ? 1 : -1;
  const auto turns = [&](std::size_t from, std::size_t to) {
    double sum = 0;
    for (std::size_t i = from; i <= to; ++i) sum += joint.around[i] == 0 ? 0 : turn_at_start(joint, i);
    return sum;
  };
  if (k == first && k == last) return sign * (turns(0, joint.around.size() - 1) + now.b - now.a);
  if (k == first) return sign * (turns(0, k) - now.a);
  if (k == last) return sign * (turns(k, joint.around.size() - 1) + now.b);
  return joint.wraps[k];
}

/// Wound with the angles of the rope's ends as they are now, near to those known.
inline Wound turned_ends(const JointPose<2>& at) {
  Wound now = at.wound;
  for (const bool first : {true, false}) {
    if (!on_wheel(at, first)) continue;
    const RopeEnd end = rope_end(at, first);
    double& angle = first ? now.a : now.b;
    angle = angle_between((first ? at.joint.on_a : last_piece(at).on_b).start,
                          rope_piece<2>(end.from, end.to, end.offset).direction, angle);
  }
  return now;
}

/// The same, where its wheels leave the pieces at them some length; none where one runs out within a time h,
/// s.
inline std::optional<Wound> on_wheels(const JointPose<2>& at, double h) {
  for (const bool first : {true, false}) {
    if (!on_wheel(at, first)) continue;
    const RopeEnd end = rope_end(at, first);
    if (runs_out(end, rope_piece<2>(end.from, end.to, end.offset), h)) return {};
  }
  return turned_ends(at);
}

/// How far a rope is wrapped around the wheel between two pieces of it that wind on it, rad. It ends where
/// the other begins.
inline double wrap_between(const JointPose<2>& before, const JointPose<2>& after) {
  const Winding<2>& wheel = last_piece(before).on_b;
  const double sign = wheel.offset > 0 ? 1 : -1;
  return wrap_between(wheel.start, after.joint.on_a.start, wheel.offset) +
         sign * (after.wound.a - before.wound.b);
}

/// hold_rope() of one that has left wheels:
///   C = L + sum r wrap_0 - sum l - sum r wrap       r wrap_0 of all wheels, r wrap of those that it is on
/// where of wheels at its ends, with which it does not slip, the arcs are counted from the start as there.
inline void hold_rope_off_wheels(const JointPose<2>& at, Row<2>* J, double* C) {
  J[0] = {}, C[0] = 0;
  if (at.wound.with < 0) return;
  const RopePlaces<2> places(at);
  const Joint<2>&joint = at.joint, &last = last_piece(at);
  double left = at.turn[0];
  for (const Joint<2>* piece = &joint; piece <= &last; ++piece) {
    left += piece->length - piece->turn[0];
    if (piece != &last)
      left += std::fabs(piece->on_b.offset) *
              wrap_between(piece->on_b.start, piece[1].on_a.start, piece->on_b.offset);
  }
  if (joint.turns.empty()) left -= at.turn[0] - joint.turn[0];
  const std::size_t n = joint.around.size();
  const Wound now = turned_ends(at);
  for (std::size_t k = 0; k < n; ++k) {
    if (joint.around[k] == 0) continue;
    const bool on = k >= std::size_t(at.wound.off_a) && k + std::size_t(at.wound.off_b) < n;
    left += std::fabs(joint.around[k]) * (joint.wraps[k] - (on ? wrap_at(joint, now, k) : 0));
  }
  for (int i = 0; i + 1 < places.size(); ++i) {
    const RopePiece<2> piece = places.piece(i);
    left -= piece.length;
    places.add(i, piece, 1, J[0]);
    if (i == 0 && joint.on_a.offset != 0)
      left -= joint.on_a.offset * angle_between(joint.on_a.start, piece.direction, at.wound.a);
    if (i + 2 == places.size() && last.on_b.offset != 0)
      left += last.on_b.offset * angle_between(last.on_b.start, piece.direction, at.wound.b);
  }
  C[0] = left + at.wound.given;
}

template <int D>
void hold_rope(const JointPose<D>& at, Row<D>* J, double* C) {
  if constexpr (D == 2) {
    if (at.wound.with != 0 || at.wound.off_a != 0 || at.wound.off_b != 0)
      return hold_rope_off_wheels(at, J, C);
  }
  const Joint<D>& joint = at.joint;
  Row<D> row;
  const RopePlaces<D> places(at);
  const int points = places.size();
  double free = 0;  // how long the pieces are, and what wheels have given out
  for (int i = 0; i + 1 < points; ++i) {
    const RopePiece<D> piece = places.piece(i);
    free += piece.length;
    places.add(i, piece, 1, row);
    if constexpr (D == 2) {
      const double first = joint.around.empty() ? joint.on_a.offset : -joint.around.front(),
                   last = joint.around.empty() ? joint.on_b.offset : -joint.around.back();
      if (i == 0 && first != 0) free += first * angle_between(joint.on_a.start, piece.direction, at.wound.a);
      if (i + 2 == points && last != 0)
        free -= last * angle_between(joint.on_b.start, piece.direction, at.wound.b);
    }
  }
  C[0] = joint.length + at.wound.given - free;
  if constexpr (D == 2) {
    if (!joint.turns.empty()) C[0] += (at.turn - joint.turn)[0];
  }
  J[0] = std::move(row);
}

/// Whether a rope has no slack.
template <int D>
bool is_tight(const JointPose<D>& at) {
  constexpr double kTight = 1e-6;  // of its length
  Row<D> row;
  double slack = 0;
  hold_rope(at, &row, &slack);
  return slack <= kTight * length_held(at.joint, at.wound);
}

/// Whether a rope that is tight comes to an end within a time h, s: a place of it to the next.
template <int D>
bool comes_to_its_end(const JointPose<D>& at, double h) {
  const RopePlaces<D> places(at);
  bool any = false;
  for (int i = 0; i + 1 < places.size(); ++i) any = any || places.meet(i, h);
  return any && is_tight(at);
}

/// Whether the rope of a joint slides over things with friction.
template <int D>
bool rubs(const Joint<D>& joint) {
  return joint.kind == JointKind::pulley && joint.friction > 0;
}
/// Whether it does as it is now: it may have left all of them.
template <int D>
bool rubs(const Joint<D>& joint, const Wound& now) {
  return rubs(joint) && std::size_t(now.off_a) + std::size_t(now.off_b) < joint.over.size();
}

/// How far a rope with friction is wrapped around all that it slides over, rad, at least 0.
template <int D>
double rope_wrap(const JointPose<D>& at) {
  const Joint<D>& joint = at.joint;
  const RopePlaces<D> places(at);
  const int points = places.size();
  const bool left = at.wound.off_a != 0 || at.wound.off_b != 0;
  double wrap = left ? 0 : joint.wrap;
  Vec<D> before = places.piece(0).direction;
  const Vec<D> first = before;
  for (int i = 1; i + 1 < points; ++i) {
    const Vec<D> after = places.piece(i).direction;
    const double turn = std::clamp(before.dot(after), -1.0, 1.0);
    if (places.offset(i) == 0) wrap += elementary::acos(turn);
    before = after;
  }
  if constexpr (D == 2) {
    const Wound now = left ? turned_ends(at) : at.wound;
    for (int i = 1; left && i + 1 < points; ++i)
      if (places.offset(i) != 0) wrap += wrap_at(joint, now, std::size_t(i - 1 + at.wound.off_a));
    if (left) return std::max(0.0, wrap);
    const auto sign = [](double q) { return q > 0 ? 1.0 : q < 0 ? -1.0 : 0.0; };
    wrap -= sign(joint.around.front()) * angle_between(joint.on_a.start, first, at.wound.a);
    wrap += sign(joint.around.back()) * angle_between(joint.on_b.start, before, at.wound.b);
  }
  return std::max(0.0, wrap);
}

/// The row of the drag of a rope with friction; its force is the tension at a less that at b, N. Returns
/// mu_e.
template <int D>
double hold_drag(const JointPose<D>& at, Row<D>& out) {
  const RopePlaces<D> places(at);
  const int last = places.size() - 2;
  Row<D> row;
  places.add(0, places.piece(0), 0.5, row);
  places.add(last, places.piece(last), -0.5, row);
  out = std::move(row);
  return 2 * elementary::tanh(at.joint.friction * rope_wrap(at) / 2);
}

template <int D>
inline constexpr JointEquations<D> kPulley = {.kind = JointKind::pulley,
                                              .rows = 1,
                                              .one_sided = true,
                                              .apart = true,
                                              .mechanism = true,
                                              .hold = hold_rope<D>};

}  // namespace obscura::sim
