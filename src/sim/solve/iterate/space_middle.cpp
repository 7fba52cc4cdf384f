// Where contacts' rows of space stand. Rows of what lies on or along something are those of the middle of the
// substep, as the bodies move where it begins: forces act there, on the mean. And speeds along them are to
// hold at its end: what rows that turn add to them until then is as much as from the beginning to the middle.
//   n . u' >= -c_n, slip u' + c_t      c = J(h/2) v - J(0) v
// Otherwise what slides on a thing that turns would push it where it was, and go by its old velocity: what
// rides on a turntable would go outwards by w^2 h / 2 of its radius a second.

#include <algorithm>
#include <cmath>

#include "sim/solve/iterate/pieces.h"
#include "sim/solve/iterate/space.h"
#include "sim/solve/iterate/substeps.h"

namespace obscura::sim {

namespace {

constexpr double kAllFriction = 0.999;  // of the square of what friction can: more is all of it
constexpr double kAnswers =
    8;  // of what a push moves a body by at its centre, how far it moves what is pushed
constexpr double kMostAskew = 0.5;  // the cosine by which a normal turns in half a substep, at most

}  // namespace

// whether a touch goes on bearing, that had this force
bool SpaceIterative::lasts(const ContactConstraint& touch, const Vec<D>& force) const {
  if (!(touch.n.dot(force) > 0)) return false;
  static const BodyMotion<D> room;
  const bool wall = touch.b == int(model_.bodies.size());
  const BodyMotion<D>&a = stances_[touch.a], &b = wall ? room : stances_[touch.b];
  const Vec<D> passes = a.velocity(touch.arm_a) - b.velocity(touch.arm_b);
  double speed = std::sqrt(passes.squaredNorm()) + bounding_radius_[touch.a] * std::sqrt(a.w.squaredNorm());
  if (!wall) speed += bounding_radius_[touch.b] * std::sqrt(b.w.squaredNorm());
  return -touch.n.dot(passes) <= kLasting * speed;
}

// whether a force has all the friction that it can: then a touch slides, or is about to
bool SpaceIterative::rubs_fully(const ContactConstraint& touch, const Vec<D>& force) const {
  const double pressed = touch.n.dot(force), most = touch.mu * pressed;
  return (force - pressed * touch.n).squaredNorm() > kAllFriction * most * most;
}

// Whether what bears and slides, and passes like that where the substep begins, slides to its end: friction
// is then against its way, which is that of the middle. What stages of the free motion have of friction is
// taken out of these as it is at the end.
bool SpaceIterative::slides_on(const ContactConstraint& touch, const Vec<D>& force, const Vec<D>& passes,
                               double h) const {
  if (touch.mu == 0 || (varies_ && bears(touch.a, touch.b))) return false;
  if (!rubs_fully(touch, force)) return false;
  const double most = touch.mu * touch.n.dot(force);
  const double stops = kAnswers * h * most * (moving_[touch.a].inverse_mass + moving_[touch.b].inverse_mass);
  const Vec<D> slips = passes + touch.belt;
  return (slips - touch.n * touch.n.dot(slips)).squaredNorm() > stops * stops;
}

// What the forces that contacts had last change of its slip across their friction, beside what free motion
// and the way rows turn do. What friction changes along itself turns nothing; and of what is on joints these
// forces are no guess, as joints answer them.
void SpaceIterative::foresee_slip(int number) {
  ContactConstraint& touch = touches_[std::size_t(number)];
  const double rubs = touch.tangent_impulse.squaredNorm();
  if (!touch.slides || !(rubs > 0)) return;
  const auto tied = [&](int body) { return body < int(model_.bodies.size()) && joints_.has(body); };
  if (tied(touch.a) || tied(touch.b)) return;
  // those of some touches of a pair, whose others are new, are none
  const auto beside = [&](int i) {
    return i >= 0 && i < int(touches_.size()) && touches_[std::size_t(i)].a == touch.a &&
           touches_[std::size_t(i)].b == touch.b;
  };
  for (int i = number - 1; beside(i); --i)
    if (!known_force_[std::size_t(i)]) return;
  for (int i = number + 1; beside(i); ++i)
    if (!known_force_[std::size_t(i)]) return;
  const Vec<D> changes = slip(touch) - free_slips_[std::size_t(number)];
  touch.half_change += 0.5 * (changes - touch.n * touch.n.dot(changes) -
                              touch.tangent_impulse * (touch.tangent_impulse.dot(changes) / rubs));
}

// Whether a blow, that is left to the iterations or has been, changes by much how fast a's matter passes b's:
// that was `passes`.
bool SpaceIterative::strikes(const ContactConstraint& touch, const Vec<D>& passes) const {
  if (!touch.after && !touch.blow) return false;
  const double much =
      kStrikes * (swiftness(touch.a) + (touch.b < int(model_.bodies.size()) ? swiftness(touch.b) : 0));
  if (touch.blow) return -touch.n.dot(passes) > much;
  return touch.least < 0.5 * kNoAim || (slip(touch) - touch.belt - passes).squaredNorm() > much * much;
}

// where bodies stand in the middle of the substep
void SpaceIterative::find_middles(const State<D>& state, double h) {
  middles_ = stances_;
  each(workers(), int(stances_.size()), kBodyPiece, [&](int begin, int end) {
    for (int body = begin; body < end; ++body) {
      BodyMotion<D>& at = middles_[std::size_t(body)];
      const AngularVec<D> spin = at.w;
      if (drives_.number(body) >= 0) {
        const BodyMotion<D> then = body_motion(state, body);
        at.v = 0.25 * (3 * at.v + then.v), at.w = 0.25 * (3 * at.w + then.w);
      } else if (inactive_[std::size_t(body)]) {
        continue;
      }
      if (h * h * at.w.squaredNorm() > kMostTurn * kMostTurn) at.w.setZero();
      at = ahead<D>(at, begun_turn(body), 0.5 * h);
      at.w = spin;
    }
  });
}

void SpaceIterative::center(int number, bool bears) {
  ContactConstraint& touch = touches_[std::size_t(number)];
  const int n = int(model_.bodies.size());
  const auto middle = [&](int body) {
    if (body == n) return BodyMotion<D>();
    BodyMotion<D> at = middles_[std::size_t(body)];
    // they turn as they move after it
    if (touch.after && !inactive_[std::size_t(body)]) at.v = moving_[body].v, at.w = moving_[body].w;
    return at;
  };
  const BodyMotion<D> a = middle(touch.a), b = middle(touch.b);
  const EvaluatedContact<D> there = evaluate(features_[std::size_t(number)], a, b);
  if (!(there.normal.dot(touch.n) > kMostAskew)) return;
  const Vec<D> before = a.velocity(touch.arm_a) - b.velocity(touch.arm_b);
  const Vec<D> apart = 0.5 * std::max(0.0, there.value) * there.normal;
  const Vec<D> arm_a = there.point + apart - a.x, arm_b = there.point - apart - b.x;
  const Vec<D> now = a.velocity(arm_a) - b.velocity(arm_b);
  touch.drift = now - before - there.normal * there.normal.dot(now - before);
  const double turns = there.normal.dot(now) - touch.n.dot(before);
  touch.least -= touch.apart + (bears ? turns : std::max(turns, 0.0));
  touch.n = there.normal, touch.arm_a = arm_a, touch.arm_b = arm_b;
}

}  // namespace obscura::sim
