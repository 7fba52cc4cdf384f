#pragma once

#include <vector>

namespace obscura::sim::sweep {

// Pairs that touch, four side by side. A pair has up to two touches; its normal forces are found together
// (a flat landing must not turn a box), its friction one by one. Groups of one colour share no body, so that
// four pairs at once and one after another give the same bits.

inline constexpr int kLanes = 4;

/// Velocity (m/s, rad/s) or displacement (m, rad) of a body.
struct alignas(32) Motion {
  double x = 0, y = 0, w = 0, unused = 0;
};

/// v_n = n . (v_a - v_b) + r_a x n w_a - r_b x n w_b, v_t likewise with t = (-n_y, n_x).
struct alignas(64) Group {
  struct Side {
    double nx[kLanes], ny[kLanes];
    double na[kLanes], nb[kLanes];  // r_a x n, r_b x n, m
    double ta[kLanes], tb[kLanes];  // r_a x t, r_b x t, m
    double mt[kLanes];              // 1 / K_t, kg
    double target[kLanes];          // least v_n, m/s
    double ln[kLanes], lt[kLanes];  // impulses, N s
  };
  int a[kLanes], b[kLanes];  // where in the motions; what does not move has a place that stays zero
  double ima[kLanes], iia[kLanes], imb[kLanes], iib[kLanes];  // 1/kg, 1/(kg m^2)
  double mu[kLanes];
  Side side[2];
  double k12[kLanes], k11[kLanes], k22[kLanes];  // of v_n under normal impulses, 1/kg
  double i11[kLanes], i12[kLanes], i22[kLanes];  // its inverse; not a number where it has none
  double r11[kLanes], r22[kLanes];               // 1 / k11, 1 / k22
};

/// What projects positions along the rows of a group: least n . d (m), and the push so far (kg m).
struct alignas(64) Projection {
  double target[2][kLanes], push[2][kLanes];
};

/// Applies all impulses to the velocities.
void start(const Group* groups, int count, Motion* v);
/// One sweep: every pair once, in order.
void sweep(Group* groups, int count, Motion* v);
/// One sweep over positions.
void project(const Group* groups, Projection* projections, int count, Motion* d);

}  // namespace obscura::sim::sweep
