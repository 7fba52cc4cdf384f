#pragma once

#include <vector>

#include "sim/collide/core_shapes.h"
#include "sim/model/contact.h"
#include "sim/solve/iterate/substeps.h"

namespace obscura::sim::plane {

// Contact constraints of four pairs at once. The lanes of one colour share no moving body, so four pairs at
// once give the same bits as one after another. A lane stores the features, not the rows: these are computed
// from the poses in every pass, as memory is slower than arithmetic.

inline constexpr int kLanes = 4;
inline constexpr double kNowhere = 1e30;  // m: the gap of an unused contact point
inline constexpr double kOpen = 1e30;     // m/s: of ContactBatch::turns, of a touch that is left out

/// Velocity (m/s, rad/s) or displacement (m, rad) of a body, and 1/kg: zero for what does not move.
struct alignas(32) Motion {
  double x = 0, y = 0, w = 0, im = 0;
};

/// Four pairs. Each has up to two contact points (touches): a corner c in the frame of its body, and the face
/// f, or the corner if two corners touch, of the other body in its frame; gap = n . (p - x) - d - radius.
struct alignas(64) ContactBatch {
  int a[kLanes], b[kLanes];         // bodies; walls and empty lanes have the one after the last
  int pair[kLanes], first[kLanes];  // the pair, and its first contact; -1: an unused lane
  unsigned char touches[kLanes];
  // flags, a bit a lane
  unsigned char of_b[2];            // the corner is b's
  unsigned char corners[2];         // two corners touch
  unsigned char struck[2];          // the pair has had an impact in this step
  unsigned char boxes;              // both are boxes
  unsigned char used;               // the lane is in use
  unsigned char belts;              // a body of the pair has a belt, or is moved
  unsigned short words[2][kLanes];  // Feature::word()
  alignas(32) double mu[kLanes], iia[kLanes], iib[kLanes];
  double calm[kLanes];          // m/s: at slower relative speeds features do not change until the next search
  double far[kLanes];           // m: the larger bounding radius of both
  double impact_speed[kLanes];  // -m/s: faster approaches are impacts
  double sight[kLanes];         // m: points with wider gaps are ignored
  double per_width[kLanes];     // 1/m: one over the width of the narrower body
  double radius[kLanes];        // sum of both radii, m
  double belt[kLanes];          // m/s: what the belts of both add to v_t
  // where the substep begins: gaps, m, and of sharp corners on each other the normal
  double gap[2][kLanes], ux[2][kLanes], uy[2][kLanes];
  // m/s: what rows that turn, and belts, add to speeds at its end, along the normal and the tangent
  double turns[2][kLanes], surface[2][kLanes];
  double cx[2][kLanes], cy[2][kLanes];
  double fx[2][kLanes], fy[2][kLanes];
  double d[2][kLanes];  // of two corners: b's radius
  // between substeps the force on a along x and y, N; from warm_start() to iterate_last() the impulse along
  // the normal and the tangent, N s
  double p[2][kLanes], q[2][kLanes];
};

/// The rows of four pairs.
///   v_n = n . (v_a - v_b) + r_a x n w_a - r_b x n w_b      v_t likewise, t = (-n_y, n_x), and belts in it
struct alignas(64) Rows {
  double nx[2][kLanes], ny[2][kLanes], x[2][kLanes], y[2][kLanes], gap[2][kLanes];
  double na[2][kLanes], nb[2][kLanes], ta[2][kLanes], tb[2][kLanes];  // r_a x n, ..., m
};

/// Accumulated pseudo-impulses of project(), along normals and tangents, kg m.
struct alignas(64) Projection {
  double push[2][kLanes], side[2][kLanes];
};

/// The lanes that a pass has found, as numbers: lane + kLanes * batch.
using LaneList = std::vector<int>;

/// Of a group: normal speeds that an iteration leaves, at least, m/s.
struct alignas(32) TargetSpeeds {
  double n[2][kLanes];
};

/// Constants of a step.
struct StepConstants {
  double h = 0;                         // s
  double min_closing_speed = 0;         // m/s: slower approaches are none
  double gravity_dv = 0;                // m/s that gravity may add in the step
  double rests = 0;                     // times what forces add to a closing speed in it: no faster is a blow
  AllowedOverlap allowed;               // what is deeper is pushed apart
  const TargetSpeeds* least = nullptr;  // by group, of lanes that are struck
};

/// One pair to another lane; the forces alone.
void copy_lane(const ContactBatch& from, int i, ContactBatch& to, int k);
void copy_lane_forces(const ContactBatch& from, int i, ContactBatch& to, int k);

/// Rows of one group.
void expand(const ContactBatch& batches, const Pose* poses, Rows& out);

/// The row of a touch, as one lane of Rows.
struct TouchRow {
  double nx, ny, x, y, gap, na, nb, ta, tb;
};
/// Touch k of one lane, whose bodies stand at these poses.
TouchRow row(const ContactBatch& batches, int lane, int k, const Pose& a, const Pose& b);
/// The same at poses of the middle of the substep, where sharp corners on each other keep their normal.
TouchRow middle_row(const ContactBatch& batches, int lane, int k, const Pose& a, const Pose& b);

/// Normal speed of a touch, m/s: a against b.
inline double normal_speed(const TouchRow& r, const Motion& a, const Motion& b) {
  return r.nx * (a.x - b.x) + r.ny * (a.y - b.y) + (r.na * a.w - r.nb * b.w);
}
/// Its speed across the normal, along (-n_y, n_x), without belts.
inline double tangent_speed(const TouchRow& r, const Motion& a, const Motion& b) {
  return r.nx * (a.y - b.y) - r.ny * (a.x - b.x) + (r.ta * a.w - r.tb * b.w);
}
inline double normal_speed(const Rows& r, int k, int lane, const Motion& a, const Motion& b) {
  return r.nx[k][lane] * (a.x - b.x) + r.ny[k][lane] * (a.y - b.y) +
         (r.na[k][lane] * a.w - r.nb[k][lane] * b.w);
}

/// Warm start: turns the stored forces into impulses and applies them to v. `poses`, `old`: where the substep
/// begins; `middle`: poses in its middle, as bodies go there. Appends the lanes that close slowly within it
/// to `closing`, and those that close with an impact to `impacts`. True if some overlap is deeper than
/// project() allows.
bool warm_start(ContactBatch* batches, int count, const Pose* poses, const Pose* middle, const Motion* old,
                Motion* v, const StepConstants& pace, LaneList& closing, LaneList& impacts);

/// The largest closing speed of pairs that touch or may within h s, in widths of the narrower body, 1/s. Of
/// polygons a part of the relative speed counts too, as other corners of theirs may come near.
double closing_rate(const ContactBatch* batches, int count, const Pose* poses, const Motion* v, double h);

/// One iteration: every pair once, in order. `poses`, here and below: those of the middle.
void iterate(ContactBatch* batches, int count, const Pose* poses, Motion* v, const StepConstants& pace);
/// Bodies whose pairs need more iterations: those of a pair whose last correction exceeded `settled` widths a
/// second. Bodies on joints are excluded by kNever.
struct ActiveBodies {
  static constexpr unsigned char kNow = 1, kNever = 2;
  double settled = 0;                 // 1/s
  std::vector<unsigned char> bodies;  // flags; one more for walls
  std::vector<unsigned char> next;    // of these, what an iteration notes; apart, for threads read the flags
  // where not empty: the groups that alone are looked at, and all bodies of theirs that may be active
  std::vector<int> groups, listed;
};

/// One iteration of the pairs of such bodies alone, in `count` groups, or in so many of the numbers `listed`.
/// Notes what the next is to look at; returns the number of pairs.
int iterate(ContactBatch* batches, const int* listed, int count, const Pose* poses, Motion* v,
            const StepConstants& pace, ActiveBodies& active);
/// After one over all: the bodies that it has noted are active.
void activate_next(ActiveBodies& active);
/// Impulses of four pairs, as ContactBatch has them.
struct alignas(64) LaneImpulses {
  double p[2][kLanes], q[2][kLanes];
};
/// Impulses of all pairs go on along the directions, one of each group, `share` times as far, within their
/// bounds; the next directions are that and what has changed since `before`, which then are the impulses. Of
/// pairs on bodies that are never active neither changes.
void follow(ContactBatch* batches, int count, const Pose* poses, Motion* v, LaneImpulses* before,
            LaneImpulses* directions, double share, const ActiveBodies& active);

/// The last iteration of a substep: stores forces in the lanes and, unless null, in `contacts`.
void iterate_last(ContactBatch* batches, int count, const Pose* poses, Motion* v, const StepConstants& pace,
                  Contact<2>* contacts);

/// One iteration over positions at `poses`, which takes away `share` of the overlap beyond the allowed one.
/// Friction holds here too; without it the correction would let piles slide apart.
void project(const ContactBatch* batches, Projection* projections, int count, const Pose* poses, Motion* d,
             double share, AllowedOverlap allowed);

}  // namespace obscura::sim::plane
