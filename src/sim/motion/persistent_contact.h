#pragma once

#include <cmath>

#include "sim/collide/narrow_phase.h"

namespace obscura::sim {

/// A contact that bears in a step, as forces that depend on the motion see it: the motion is that under the
/// force which the contact had last. It keeps its size and turns as its normal does, so that a pair that
/// turns keeps its angular momentum.
template <int D>
struct PersistentContact {
  int a = -1, b = -1;  // bodies; -1: the room
  ContactCandidate<D> gap;
  Vec<D> normal = Vec<D>::Zero(), point = Vec<D>::Zero();  // where the step begins, in the room
  Vec<D> force = Vec<D>::Zero();                           // N, on a there

  bool slides = false;           // its friction is against the slip, and turns with that
  Vec<D> belt = Vec<D>::Zero();  // m/s: what belts add to the slip of a

  // where sharp edges and corners meet, their features tell no normal: it goes along with a, in whose frame
  // these are
  bool sharp = false;
  Vec<D> point_on_a = Vec<D>::Zero(), normal_on_a = Vec<D>::Zero();

  /// To be called where the step begins.
  void begin(const BodyMotion<D>& a_at) {
    using Kind = typename ContactCandidate<D>::Kind;
    const bool round = gap.radius_a + gap.radius_b > 0;
    sharp = gap.kind == Kind::edges ||
            (!round && (gap.kind == Kind::corners || gap.kind == Kind::corner_at_edge_a ||
                        gap.kind == Kind::corner_at_edge_b));
    if (!sharp) return;
    point_on_a = a_at.room_from_body.transpose() * (point - a_at.x);
    normal_on_a = a_at.room_from_body.transpose() * normal;
  }

  struct Push {
    Vec<D> force, point;  // on a, N; where, in the room
  };
  /// As the bodies stand and move within the step.
  Push at(const BodyMotion<D>& a_at, const BodyMotion<D>& b_at) const {
    EvaluatedContact<D> now;
    if (sharp)
      now.normal = a_at.arm(normal_on_a), now.point = a_at.x + a_at.arm(point_on_a);
    else
      now = evaluate(gap, a_at, b_at);
    // by the least turn from the one normal to the other: f + u x f + u x (u x f) / (1 + n . n')
    const double cos = normal.dot(now.normal);
    if (!(cos > 0)) return {force, now.point};
    const AngularVec<D> u = moment<D>(normal, now.normal);
    const Vec<D> across = cross_velocity<D>(u, force);
    const Vec<D> turned = force + across + cross_velocity<D>(u, across) / (1 + cos);
    return {against_slip(turned, now.normal, now.point, a_at, b_at), now.point};
  }
  /// The force where the step begins, as the bodies move where it ends.
  Vec<D> ended(const BodyMotion<D>& a_at, const BodyMotion<D>& b_at) const {
    const Vec<D> p = sharp ? Vec<D>(a_at.x + a_at.arm(point_on_a)) : evaluate(gap, a_at, b_at).point;
    return against_slip(force, normal, p, a_at, b_at);
  }

 private:
  Vec<D> against_slip(const Vec<D>& f, const Vec<D>& n, const Vec<D>& p, const BodyMotion<D>& a_at,
                      const BodyMotion<D>& b_at) const {
    if (!slides) return f;
    const Vec<D> passes = a_at.velocity(Vec<D>(p - a_at.x)) - b_at.velocity(Vec<D>(p - b_at.x)) + belt;
    const Vec<D> slip = passes - n * n.dot(passes), pushes = n * n.dot(f), rubs = f - pushes;
    const double speed = std::sqrt(slip.squaredNorm());
    if (!(rubs.dot(slip) < 0)) return f;
    return pushes - slip * (std::sqrt(rubs.squaredNorm()) / speed);
  }
};

}  // namespace obscura::sim
