#pragma once

#include <vector>

#include "sim/collide/narrow_phase.h"

namespace obscura::sim {

// Rows of the Jacobian: the relative motions that a contact or joint constrains,
//   J v = along . (v_a - v_b) + turn_a . w_a - turn_b . w_b
//   d(J v)/dt = J v' + J' v               J' v  the velocity-product term
// A contact has a row for its normal and one for each of D-1 tangents; a joint one for each motion that it
// forbids.

/// What a row has of a body beside its two sides: J v gets along . v + angular . w.
template <int D>
struct RowSide {
  int body = -1;
  Vec<D> along = Vec<D>::Zero();
  AngularVec<D> angular = AngularVec<D>::Zero();
};

/// One row of J, at given stances.
template <int D>
struct Row {
  int a = -1, b = -1;                               // bodies; below zero: the room
  Vec<D> along = Vec<D>::Zero();                    // a unit vector, or zero of a row of turning
  AngularVec<D> angular_a = AngularVec<D>::Zero();  // arm x along, m; of a row of turning the axis
  AngularVec<D> angular_b = AngularVec<D>::Zero();
  double velocity_product = 0;  // m/s^2 or rad/s^2
  double drift = 0;             // m/s: what a belt on either side adds to J v
  bool of_wheels = false;       // a gear's, of angles, though teeth push along
  // All sides of a mechanism, which may be those of many bodies; its a and b are the room, and `along` is how
  // a unit of its force is shown.
  std::vector<RowSide<D>> more;

  /// The row of the opposite direction.
  void reverse() {
    along *= -1, angular_a *= -1, angular_b *= -1, velocity_product *= -1, drift *= -1;
    for (RowSide<D>& side : more) side.along *= -1, side.angular *= -1;
  }
};

/// Whether a row is one of turning, with J v in rad/s, not in m/s.
template <int D>
bool of_turning(const Row<D>& row) {
  if (row.of_wheels) return true;
  for (const RowSide<D>& side : row.more)
    if (!side.along.isZero(0)) return false;
  return row.along.isZero(0);
}

/// What a unit of J v, or of a row's error, counts as in metres where rows are compared: a radian as much as
/// the size of the scene, `scale` (m). So a room of other lengths is the same run.
template <int D>
double in_metres(const Row<D>& row, double scale) {
  return of_turning(row) ? scale : 1;
}

/// act(body, along, angular) for each side of a row that is a body, with its sign.
template <int D, class Act>
void each_side(const Row<D>& row, Act&& act) {
  if (row.a >= 0) act(row.a, row.along, row.angular_a);
  if (row.b >= 0) act(row.b, Vec<D>(-row.along), AngularVec<D>(-row.angular_b));
  for (const RowSide<D>& side : row.more) act(side.body, side.along, side.angular);
}

/// A body of a row of which its(body) is true; below zero: none.
template <int D, class Its>
int side_that(const Row<D>& row, Its&& its) {
  if (its(row.a)) return row.a;
  if (its(row.b)) return row.b;
  for (const RowSide<D>& side : row.more)
    if (its(side.body)) return side.body;
  return -1;
}

/// The i-th of D-1 unit vectors across n, which with it are a right-handed frame.
template <int D>
Vec<D> tangent(const Vec<D>& n, int i) {
  const Vec<D> t = perpendicular<D>(n);
  if constexpr (D == 3) {
    if (i == 1) return n.cross(t);
  }
  return t;
}

/// J v. The room stands still.
template <int D>
double speed(const Row<D>& row, const std::vector<BodyMotion<D>>& bodies);

/// The rows of a gap: the first is d(gap)/dt, then D-1 tangents. `a` and `b`: how its sides stand and move.
template <int D>
EvaluatedContact<D> rows(const ContactCandidate<D>& gap, const BodyMotion<D>& a, const BodyMotion<D>& b,
                         Row<D>* out);

/// Velocity of the surface of a body against its matter where `outward` is the normal out of it, room's
/// frame, m/s: in the plane a belt runs around it clockwise, in space along a direction of its own.
template <int D>
Vec<D> belt_velocity(const Body<D>& body, const Rotation<D>& room_from_body, const Vec<D>& outward);

/// Adds the belts of both sides to the tangents' rows of a contact.
template <int D>
void add_belts(const Model<D>& model, const ContactKey& key, const std::vector<BodyMotion<D>>& bodies,
               Row<D>* out);

}  // namespace obscura::sim
