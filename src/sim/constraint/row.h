#pragma once

#include <vector>

#include "sim/collide/narrow_phase.h"

namespace obscura::sim {

// What two bodies may not do against each other, row by row,
//   J v = along . (v_a - v_b) + turn_a . w_a - turn_b . w_b
//   d(J v)/dt = J v' + drift,  drift = J' v
// A contact has its normal and D-1 tangents as rows; a joint has those of what it holds.

/// One row of J, at given stances.
template <int D>
struct Row {
  int a = -1, b = -1;                               // bodies; below zero: the room
  Vec<D> along = Vec<D>::Zero();                    // a unit vector, or zero of a row of turning
  AngularVec<D> angular_a = AngularVec<D>::Zero();  // arm x along, m; of a row of turning the axis
  AngularVec<D> angular_b = AngularVec<D>::Zero();
  double velocity_product = 0;  // m/s^2 or rad/s^2
};

/// J v. The room stands still.
template <int D>
double speed(const Row<D>& row, const std::vector<BodyMotion<D>>& bodies);

/// The candidate as evaluate() has it, by the same terms as the rows below.
template <int D>
EvaluatedContact<D> width(const ContactCandidate<D>& gap, const BodyMotion<D>& a, const BodyMotion<D>& b);

/// The rows of a gap: the first is d(gap)/dt, then D-1 tangents. `a` and `b`: how its sides stand and move.
template <int D>
EvaluatedContact<D> rows(const ContactCandidate<D>& gap, const BodyMotion<D>& a, const BodyMotion<D>& b,
                         Row<D>* out);

/// The most rows that a joint holds.
template <int D>
inline constexpr int kMostHeld = D + kAngular<D>;

/// The rows that a joint holds as equalities, and by how much each is off (m or rad). Returns how many. A
/// rope has one, what it has left; it is no equality. `turn`: of a against b (rad), for what keeps one; in
/// space the stances tell it.
template <int D>
int rows(const Joint<D>& joint, const BodyMotion<D>& a, const BodyMotion<D>& b, const AngularVec<D>& turn,
         Row<D>* out, double* off);

/// Whether a joint leaves one thing free that it can tell: the turn of a hinge (in the plane also called a
/// pin), the way of a slider.
template <int D>
bool has_free_row(JointKind kind) {
  return kind == JointKind::hinge || kind == JointKind::slider || (D == 2 && kind == JointKind::pin);
}

/// The row of that, for motors, limits and friction; and how far it is (rad or m). False where there is none.
template <int D>
bool free_row(const Joint<D>& joint, const BodyMotion<D>& a, const BodyMotion<D>& b,
              const AngularVec<D>& turn, Row<D>& out, double& way);

}  // namespace obscura::sim
