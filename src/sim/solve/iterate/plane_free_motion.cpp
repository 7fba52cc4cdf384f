// Free motion in the plane: that which the integrator gives for the whole step, shared out among the
// substeps; of bodies on joints it is that of each substep. Forces that depend on the motion see that under
// the forces that contacts had last. These are taken out of the velocities again, so that the iterations find
// them anew.

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/motion/free_motion.h"
#include "sim/solve/iterate/plane.h"

namespace obscura::sim {

using plane::ContactBatch;
using plane::kLanes;
using plane::Pair;

namespace {

void add(plane::Motion& to, const Twist<2>& change, double times) {
  to.x += times * change.v[0], to.y += times * change.v[1], to.w += times * change.w[0];
}

// touch k of a lane, as a function of the poses
ContactCandidate<2> candidate(const ContactBatch& g, int lane, int k) {
  using Kind = ContactCandidate<2>::Kind;
  ContactCandidate<2> gap;
  const Vec<2> corner(g.cx[k][lane], g.cy[k][lane]), face(g.fx[k][lane], g.fy[k][lane]);
  const double d = g.d[k][lane];
  gap.radius_a = g.radius[lane];
  if (g.corners[k] >> lane & 1) {
    gap.kind = Kind::corners, gap.on_a = corner, gap.on_b = face;
    gap.radius_a -= d, gap.radius_b = d;
  } else if (g.of_b[k] >> lane & 1) {
    gap.kind = Kind::corner_of_b, gap.on_b = corner, gap.on_a = d * face, gap.normal = face;
    std::swap(gap.radius_a, gap.radius_b);
  } else {
    gap.kind = Kind::corner_of_a, gap.on_a = corner, gap.on_b = d * face, gap.normal = face;
  }
  return gap;
}

}  // namespace

void PlaneIterative::move_unconstrained(StepPart<D> part) {
  // contacts that bear turn from substep to substep
  const bool turns = !joints_.empty() || (smooth() && dynamics_.ever());
  if (varies_ && (part.substep == 0 || apart_ || !joints_.empty()))
    find_bearing(part.state, turns ? part.h : substeps_ * part.h);
  if (part.substep == 0) apart_ = turns && joints_.empty() && !bearing_.empty();
  if (apart_)
    integrate_unconstrained(part.state, part.t, part.h);
  else if (part.substep == 0)
    integrate_unconstrained(part.state, part.t, substeps_ * part.h);
  share_free_motion(part);
  move_driven(part);
  find_middle(part.h);
  if (!joints_.empty()) integrate_jointed(part);
}

// the contacts that bore in the last substep
void PlaneIterative::find_bearing(const State<D>& state, double h) {
  begin_bearing(state);
  const int none = int(turns_.size());
  for (const Pair& pair : pairs_.all()) {
    if (pair.slot < 0 || !bears(pair.a, pair.b)) continue;
    const ContactBatch& g = batches_[pair.slot / kLanes];
    const int lane = pair.slot % kLanes;
    for (int k = 0; k < pair.touches; ++k) {
      const Vec<D> force(g.p[k][lane], g.q[k][lane]);
      if (force.isZero(0)) continue;
      const plane::TouchRow at = plane::row(g, lane, k, poses_[pair.a], poses_[pair.b < 0 ? none : pair.b]);
      PersistentContact<D>& contact = bearing_.emplace_back();
      contact.a = pair.a, contact.b = std::max(pair.b, -1);
      contact.gap = candidate(g, lane, k);
      contact.normal = {at.nx, at.ny}, contact.point = {at.x, at.y}, contact.force = force;
      contact.begin(begun(pair.a));
    }
  }
  find_borne(state, h);
}

// gain_ and bend_: how each body would move in the step without contacts and joints, by the scene's
// integrator
void PlaneIterative::integrate_unconstrained(State<D>& state, double t, double h) {
  const int n = int(turns_.size()), still = n - int(state.turn.size());
  const double gx = model_.gravity[0], gy = model_.gravity[1];
  for (int i = 0; i < n; ++i) {
    // of what sleeps too: it may wake within the step
    if (fixed_[i]) {
      gain_[i] = bend_[i] = {};
      continue;
    }
    const FreeStep by = free_step(model_.integrator, drag_ ? -h * model_.bodies[i].drag * light_[i].im : 0);
    gain_[i] = {moving_[i].x * by.p + h * by.q * gx, moving_[i].y * by.p + h * by.q * gy, 0, 0};
    const double u = by.u - 1 - 0.5 * by.p, r = by.r - 0.5 * by.q;
    bend_[i] = {h * (moving_[i].x * u + h * r * gx), h * (moving_[i].y * u + h * r * gy), 0, 0};
    if (borne_.empty() || !(drag_ || !smooth())) continue;
    // drag and the scheme see what contacts give
    const Vec<D>& its = borne_[i].v;
    gain_[i].x += h * (by.q - 1) * its[0], gain_[i].y += h * (by.q - 1) * its[1];
    bend_[i].x += h * h * r * its[0], bend_[i].y += h * h * r * its[1];
  }

  // springs and hands; with joints in each substep
  if (!dynamics_.ever() || !joints_.empty()) return;
  const std::vector<int>& bodies = dynamics_.bodies();
  stages_.reserve(std::size_t(dynamics_.size()));
  dynamics_.bear(state, bearing_);
  dynamics_.step(integrate(model_.integrator), state, t, h, stages_);
  if (!state.work.empty()) state.work[0] += dynamics_.work();
  for (const int i : bodies) {
    const Motion& v = moving_[i];
    if (v.im > 0) {
      Motion &gain = gain_[i], &bend = bend_[i];
      gain.x = state.v[i][0] - v.x, gain.y = state.v[i][1] - v.y;
      bend.x = state.x[i][0] - poses_[i].x - h * (v.x + 0.5 * gain.x);
      bend.y = state.x[i][1] - poses_[i].y - h * (v.y + 0.5 * gain.y);
      if (i >= still) {
        gain.w = state.spin[i - still][0] - v.w;
        bend.w = state.turn[i - still][0] - turns_[i] - h * (v.w + 0.5 * gain.w);
      }
      if (!borne_.empty()) add(gain, borne_[i], -h);
    }
    state.x[i] = {poses_[i].x, poses_[i].y}, state.v[i] = {v.x, v.y};
    if (i >= still) state.turn[i - still][0] = turns_[i], state.spin[i - still][0] = v.w;
  }
}

// dv_ and dx_ of bodies on joints, and of those that springs, hands and forces act on, in a substep
void PlaneIterative::integrate_jointed(StepPart<D> part) {
  State<D>& state = part.state;
  const int still = int(turns_.size() - state.turn.size());
  dynamics_.gather(state, false, joints_.bodies());
  stages_.reserve(std::size_t(dynamics_.size()));
  dynamics_.bear(state, bearing_);
  poses_to_joints();
  const double work = joints_.step(dynamics_, integrate(model_.integrator), state, part.t, part.h, stages_);
  if (!state.work.empty()) state.work[0] += work;
  for (const int i : dynamics_.bodies()) {
    const Motion o = old_[i];
    if (Motion& v = moving_[i]; v.im > 0) {
      v.x = state.v[i][0], v.y = state.v[i][1];
      Motion &dv = dv_[i], &dx = dx_[i];
      dx.x = state.x[i][0] - poses_[i].x, dx.y = state.x[i][1] - poses_[i].y;
      if (i >= still) v.w = state.spin[i - still][0], dx.w = state.turn[i - still][0] - turns_[i];
      dv = {v.x - o.x, v.y - o.y, v.w - o.w, 0};
      if (!borne_.empty() && !joints_.has(i)) {
        add(v, borne_[i], -part.h), add(dv, borne_[i], -part.h);
        add(dx, borne_[i], -0.5 * part.h * part.h);
      }
    }
    state.x[i] = {poses_[i].x, poses_[i].y}, state.v[i] = {o.x, o.y};
    if (i >= still) state.turn[i - still][0] = turns_[i], state.spin[i - still][0] = o.w;
  }
}

// Poses of the middle of the substep. A turn by w h / 2 is that of the tangent of its quarter: to the third
// order, with a cosine and sine that are those of an angle.
void PlaneIterative::find_middle(double h) {
  middle_.resize(poses_.size());
  const auto place = [&](int i, double x, double y, double turn) {
    const plane::Pose& at = poses_[std::size_t(i)];
    const double t = std::fabs(turn) <= 0.5 * kMostTurn ? 0.5 * turn : 0, over = 1 / (1 + t * t);
    const double c = (1 - t * t) * over, s = 2 * t * over;
    middle_[std::size_t(i)] = {at.x + x, at.y + y, at.c * c - at.s * s, at.s * c + at.c * s};
  };
  const double half = 0.5 * h, eighth = 0.125 * h;
  each(workers(), int(turns_.size()), kBodyPiece, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const Motion& v = old_[std::size_t(i)];
      place(i, half * v.x, half * v.y, half * v.w);
    }
  });
  middle_.back() = poses_.back();
  for (int i = 0; i < drives_.size(); ++i) {
    const auto body = std::size_t(drives_.body(i));
    const Motion &o = old_[body], &v = moving_[body];
    place(int(body), eighth * (3 * o.x + v.x), eighth * (3 * o.y + v.y), eighth * (3 * o.w + v.w));
  }
}

// dv_ and dx_: the part of gain_ and bend_ in a substep. `bend` comes of an acceleration that changes within
// the step. Schemes of second order and more see the acceleration as linear in time, so that `bend` is in the
// velocities of the substeps too, and contacts know of it. Of n substeps the k-th (from 0) has
//   dv = gain / n - 12 bend / (n h) ((k + 1/2) / n - 1/2),   dx = h v / n + h dv / 2n + bend / n^3
// with h of the whole step. Where they are integrated apart, it is all of the substep's.
void PlaneIterative::share_free_motion(StepPart<D> part) {
  const double h = part.h, fraction = apart_ ? 1 : 1 / double(substeps_), half = 0.5 * h;
  const double middle = apart_ ? 0.5 : (part.substep + 0.5) * fraction;
  const double late = smooth() ? -12 * fraction / h * fraction * (middle - 0.5) : 0;
  const double bends = smooth() ? fraction * fraction * fraction : fraction;
  each(workers(), int(turns_.size()), kBodyPiece, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      Motion &v = moving_[i], &dv = dv_[i];
      const Motion &gain = gain_[i], &bend = bend_[i];
      if (v.im == 0) {
        old_[i] = v = dv = dx_[i] = {};
        continue;
      }
      old_[i] = v;
      dv = {fraction * gain.x + late * bend.x, fraction * gain.y + late * bend.y,
            fraction * gain.w + late * bend.w, 0};
      dx_[i] = {h * v.x + (half * dv.x + bends * bend.x), h * v.y + (half * dv.y + bends * bend.y),
                h * v.w + (half * dv.w + bends * bend.w), 0};
      v.x += dv.x, v.y += dv.y, v.w += dv.w;
    }
  });
}

}  // namespace obscura::sim
