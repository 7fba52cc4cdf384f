// What the iterative solver does in the plane (its stages: sim/solve/iterate/iterative.h). Pairs and their
// features are kept from step to step and sought sixty times a second; free motion is that which the
// integrator gives for the whole step, shared out among the substeps.

#include "sim/solve/iterate/plane.h"

#include <algorithm>
#include <cmath>

#include "sim/solve/iterate/endless_impacts.h"
#include "sim/solve/iterate/substeps.h"

namespace obscura::sim {

using plane::ContactBatch;
using plane::Feature;
using plane::kLanes;
using plane::Pair;

namespace {

// iterations of a substep
constexpr int kPlaneIterations = 40;   // of few pairs
constexpr int kPairIterations = 2000;  // of more: pairs times iterations, but at least one iteration
constexpr int kJointIterations = 16;   // with joints, which are solved exactly in each
constexpr int kStrainIterations = 64;  // if joints press a body far into another
constexpr double kStrained = 0.02;     // how far that is, of its half thickness
constexpr double kPassingOverlaps =
    2;  // allowed overlaps: what lies so deep in one plank slides onto the next

// iterations of push_out()
constexpr int kProjections = 5;  // for each of a substep
constexpr int kFewestProjections = 8;

}  // namespace

PlaneIterative::PlaneIterative(const Model<D>& model, const std::vector<Path<D>>& paths)
    : Iterative(model, paths, 4 * sim::allowed_overlap(model).share + 2 * AllowedOverlap::kLeast),
      cores_(model, std::max(kAligned, kPassingOverlaps * allowed_overlap_.share)),
      pairs_(model, cores_),
      impacts_(cores_, pairs_, model.impacts == Impacts::simultaneous),
      driven_(std::size_t(drives_.size())) {
  const int n = int(model.bodies.size());
  span_ = double(every_) * (1 / value(model.rate));
  poses_.resize(n + 1), turns_.assign(n, 0), ii_.resize(n + 1);
  gain_.resize(n + 1), bend_.resize(n + 1);
  old_.resize(n + 1), dv_.resize(n + 1), dx_.resize(n + 1), push_.resize(n + 1);
  closing_.resize(n + 1), colours_.resize(n + 1), movers_.assign(n, 0);
  for (const Body<D>& body : model.bodies) {
    drag_ = drag_ || body.drag != 0;
    fixed_.push_back(body.fixed);
    light_.push_back({1 / body.mass, body.turns() ? 1 / body.inertia[0] : 0});
  }
}

bool PlaneIterative::find_contacts(StepPart<D> step) {
  State<D>& state = step.state;
  const int n = int(model_.bodies.size());
  outran_ = false;
  impacts_.clear();
  const bool due = state.step % every_ == 0 || anew_;

  // bodies that springs and mice hold
  if (dynamics_.ever()) {
    dynamics_.gather(state);
    for (int i = 0; i < n; ++i) movers_[i] = dynamics_.has(i);
  }
  bool held = wake_near_driven(step, std::max(step.h, span_)), asleep = true;
  for (int i = 0; i < n; ++i) {
    held = held || (movers_[i] && state.frozen[i]);
    asleep = asleep && (state.frozen[i] | fixed_[i]);
  }
  if (asleep && !held) {
    next_step_ = -1;
    return false;
  }
  const bool known = gather(state);
  if (!known) pairs_.adopt(state);
  if (Sleep<D>::any(state)) held = wake_struck(state, step.h) || held;
  if (due || held) foresee_driven(step.t);
  if (due || held) {
    update_pairs(state, known);
    // what has come near since the last search may strike what still sleeps
    if (Sleep<D>::any(state) && wake_struck(state, step.h)) update_pairs(state, true);
  } else if (!known) {
    build_batches(state, false);
  }
  // not by a part of a step, as of a frame between two
  anew_ = anew_ && step.h < (1 - 1e-9) * step_length(model_.rate);
  return true;
}

void PlaneIterative::update_sleep(StepPart<D> step) {
  if (step.state.step > 0) return;
  place_contacts(step.state, true);
  if (!sleep_.at_start(step.state, step.state.contacts)) return;
  stop_sleeping(step.state);
  // what begins at rest may be struck in the first step
  if (wake_struck(step.state, step.h)) update_pairs(step.state, true);
}

PlaneIterative::ClosingRates PlaneIterative::closing_rates(double h) const {
  double most = plane::closing_rate(batches_.data(), int(batches_.size()), poses_.data(), moving_.data(), h);
  const bool quiet = awake_pairs_ <= kMostQuietPairs && (most < kQuiet || mostly_quiet());
  if (std::all_of(quicker_.begin(), quicker_.end(), [](double speed) { return speed == 0; }))
    return {most, most, quiet};
  // of what is moved, as fast as it becomes within the step
  for (const Pair& pair : pairs_.all()) {
    const double quicker = pair.b < 0 ? 0 : quicker_[pair.a] + quicker_[pair.b];
    if (pair.slot < 0 || quicker == 0) continue;
    const ContactBatch& g = batches_[pair.slot / kLanes];
    const int lane = pair.slot % kLanes;
    for (int k = 0; k < pair.touches; ++k) {
      const plane::TouchRow r = plane::row(g, lane, k, poses_[pair.a], poses_[pair.b]);
      const double closes =
          quicker + std::max(0.0, -plane::normal_speed(r, moving_[pair.a], moving_[pair.b]));
      if ((r.gap - h * closes) * g.per_width[lane] < kNearly)
        most = std::max(most, closes * g.per_width[lane]);
    }
  }
  return {most, most, quiet};
}

// whether at most points that touch, or nearly do, bodies hardly close or part, however they slide
bool PlaneIterative::mostly_quiet() const {
  int all = 0, slow = 0;
  for (const Pair& pair : pairs_.all()) {
    if (pair.slot < 0) continue;
    const ContactBatch& g = batches_[pair.slot / kLanes];
    const int lane = pair.slot % kLanes;
    for (int k = 0; k < pair.touches; ++k) {
      const int a = g.a[lane], b = g.b[lane];  // a wall is the one after the last
      const plane::TouchRow r = plane::row(g, lane, k, poses_[a], poses_[b]);
      if (r.gap * g.per_width[lane] >= kNearly) continue;
      const double passes = std::fabs(plane::normal_speed(r, moving_[a], moving_[b]));
      ++all, slow += passes * g.per_width[lane] < kQuiet;
    }
  }
  return slow >= kMostlyQuiet * all;
}

void PlaneIterative::report(StepPart<D> step) {
  impacts_.store_impulses(step.state.contacts);
  // the next step looks anyway, unless this was a fraction of one
  const bool whole = step.h * value(model_.rate) > 1 - 1e-9;
  if (outran_ && !(whole && (step.state.step + 1) % every_ == 0)) {
    foresee_driven(step.t + step.h);
    update_pairs(step.state, true);
  }
  next_step_ = step.state.step + 1;
}

// computes points, normals and gaps at the present poses: of all contacts, or of those that have none yet
void PlaneIterative::place_contacts(State<D>& state, bool all) const {
  for (const Pair& pair : pairs_.all()) {
    for (int k = pair.first; k < pair.first + pair.touches; ++k) {
      Contact<D>& contact = state.contacts[k];
      if (!all && !contact.normal.isZero(0)) continue;
      const Feature feature = Feature::of(contact.key.feature);
      contact.gap = plane::kNowhere;
      if (feature.kind == Feature::none) continue;
      const plane::ContactPoint at = pairs_.place(pair, poses_, feature);
      contact.point = {at.x, at.y}, contact.normal = {at.nx, at.ny}, contact.gap = at.gap;
    }
  }
}

// zeroes the velocities of bodies that have just fallen asleep
void PlaneIterative::stop_sleeping(const State<D>& state) {
  for (std::size_t i = 0; i < turns_.size(); ++i) {
    if (state.frozen[i]) moving_[i] = {};
  }
  build_batches(state, true);
}

// the time of a substep since the last pair search, as a part of the time between two
double PlaneIterative::share(StepPart<D> part) const {
  return (double(part.state.step % every_) * substeps_ + part.substep) / double(every_ * substeps_);
}

// Renews the pairs whose features have changed since the last search; all pairs, if a body has left its
// margin.
void PlaneIterative::renew_contacts(StepPart<D> part) {
  State<D>& state = part.state;
  if (outran_) {
    for (const Pair& pair : pairs_.all()) report_pair(pair, state);
    foresee_driven(part.t);
    update_pairs(state, true);
    outran_ = false;
  }
  double fastest = 0;
  for (int i = 0; i < int(turns_.size()); ++i) {
    const Motion& m = moving_[i];
    fastest = std::max(fastest, std::fabs(m.x) + std::fabs(m.y) + std::fabs(m.w) * cores_.bounding_radius[i]);
  }
  const double gone = share(part);
  if (gone == 0 || 2 * gone * fastest <= calmest_) return;
  for (const plane::ChangedPair& old : pairs_.outdated(batches_, moving_, poses_, gone)) {
    const Pair& pair = pairs_.all()[old.pair];
    if (substeps_ > 1) report_pair(pair, state);
    pairs_.renew(old, state, poses_);
    write_lane(pair, state);
  }
}

BodyMotion<2> PlaneIterative::begun(int body) const {
  const plane::Pose& pose = poses_[body];
  BodyMotion<D> at;
  at.x = {pose.x, pose.y}, at.v = velocity(old_[body]), at.w = spin(old_[body]);
  at.room_from_body << pose.c, -pose.s, pose.s, pose.c;
  return at;
}

Orientation<2> PlaneIterative::begun_turn(int body) const { return Orientation<D>(turns_[body]); }

// The wide kernel that applies the forces of the last step also finds the contact points that close.
void PlaneIterative::warm_start(StepPart<D> part) {
  constants_ = {part.h, 0.05 * restitution_threshold_,
                part.h * std::sqrt(model_.gravity.squaredNorm()) + driven_gain_, smooth() ? kRestingGains : 0,
                allowed_overlap(part.state)};
  if (part.substep == 0) warm_start_.begin(moving_);
  if (newness() < 1) {
    forces_before_.resize(batches_.size());
    for (std::size_t i = 0; i < batches_.size(); ++i) {
      std::copy_n(&batches_[i].p[0][0], 2 * kLanes, &forces_before_[i].p[0][0]);
      std::copy_n(&batches_[i].q[0][0], 2 * kLanes, &forces_before_[i].q[0][0]);
    }
  }
  apply_warm_start();
  if (part.substep == 0) moderate_warm_start();
}

void PlaneIterative::moderate_warm_start() {
  if (!warm_start_.gave(moving_, bounding_radius_)) return;
  const int room = int(turns_.size());
  const auto each_pair = [&](auto&& act) {
    for (const Pair& pair : pairs_.all()) {
      if (pair.slot < 0) continue;
      const ContactBatch& g = batches_[pair.slot / kLanes];
      const int lane = pair.slot % kLanes;
      if (g.p[0][lane] > 0 || g.p[1][lane] > 0) act(pair.a, pair.b >= 0 ? pair.b : room);
    }
  };
  if (!warm_start_.moderate(
          moving_, each_pair, [&](int body) { return shares_forces(body); },
          [](int) { return Rotation<D>(Rotation<D>::Identity()); }))
    return;
  for (const Pair& pair : pairs_.all()) {
    if (pair.slot < 0) continue;
    const double share = warm_start_.share(moving_[pair.a].im > 0 ? pair.a : pair.b);
    if (share == 1) continue;
    ContactBatch& g = batches_[pair.slot / kLanes];
    const int lane = pair.slot % kLanes;
    for (int k = 0; k < 2; ++k) g.p[k][lane] *= share, g.q[k][lane] *= share;
  }
}

// What forces that are no gravity make so fast within the substep that it may strike what it does not close
// in on yet: the end of a whip, a shot of a spring.
void PlaneIterative::find_whipped() {
  for (int i = 0; i < int(model_.bodies.size()); ++i) {
    const Motion& gain = dv_[std::size_t(i)];
    if (!moves(i) ||
        std::fabs(gain.x) + std::fabs(gain.y) + bounding_radius_[std::size_t(i)] * std::fabs(gain.w) <
            restitution_threshold_)
      continue;
    for (const int number : impacts_.around(i)) {
      const Pair& pair = pairs_.all()[std::size_t(number)];
      const ContactBatch& g = batches_[std::size_t(pair.slot / kLanes)];
      const int lane = pair.slot % kLanes;
      // what bears goes on bearing
      if (!(g.p[0][lane] > 0 || g.p[1][lane] > 0)) fast_.push_back(pair.slot);
    }
  }
}

void PlaneIterative::resolve_impacts(StepPart<D> part) {
  begin_struck_joints(part.state);
  find_whipped();
  const int endless = impacts_.run(fast_, pairs_.all(), batches_, poses_, middle_, old_, dv_, moving_,
                                   constants_, joints_, struck_joints_);
  if (endless >= 0) throw_endless_impacts(model_.bodies[endless].name, part.t, part.h);
  end_struck_joints(part.h, [&](int body) {
    const Motion given = impacts_.given(body);
    return Twist<D>{spin(given), velocity(given)};
  });
  if (!part.state.work.empty()) part.state.work[0] += impacts_.drive_work();
  constants_.least = impacts_.least();
}

int PlaneIterative::fewest_iterations() const {
  return std::clamp(kPairIterations / std::max(1, awake_pairs_), 1, kPlaneIterations);
}

// all but the last, of end_round()
int PlaneIterative::iterations(StepPart<D> part) const {
  const int few = starts(part) ? kFirstIterations : fewest_iterations();
  if (joints_.empty()) return few - 1;
  if (batches_.empty() && joints_.plain()) return 0;
  const int most = strained(part.state) ? kStrainIterations : kJointIterations;
  return std::clamp(most / 4 * few, 4, most) - 1;
}

void PlaneIterative::iterate_contacts(int) { iterate_all(); }

// one more; forces stay in the lanes until the last substep
void PlaneIterative::end_round(StepPart<D> part) {
  const bool last = part.substep + 1 == substeps_;
  solve_joint_velocities();
  iterate_last(last ? part.state.contacts.data() : nullptr);
  if (newness() < 1) keep_forces(part.state, last);
  impacts_.record(pairs_.all(), part.state.contacts, batches_);
}

// of a piece of a step
void PlaneIterative::keep_forces(State<D>& state, bool last) {
  const double share = newness();
  for (std::size_t i = 0; i < batches_.size(); ++i) {
    ContactBatch& g = batches_[i];
    for (int lane = 0; lane < kLanes; ++lane) {
      if (g.pair[lane] < 0) continue;
      for (int k = 0; k < g.touches[lane]; ++k) {
        const plane::LaneImpulses& before = forces_before_[i];
        double &p = g.p[k][lane], &q = g.q[k][lane];
        p = before.p[k][lane] + share * (p - before.p[k][lane]);
        q = before.q[k][lane] + share * (q - before.q[k][lane]);
        if (!last) continue;
        Contact<D>& contact = state.contacts[std::size_t(g.first[lane] + k)];
        contact.force = {p, q};
        const double pressed = contact.normal.dot(contact.force);
        if (contact.touching != ContactMode::open || !(pressed > 0)) continue;
        const Vec<D> rubs = contact.force - pressed * contact.normal;
        const bool sticks = std::sqrt(rubs.squaredNorm()) < g.mu[lane] * pressed;
        contact.touching = sticks ? ContactMode::stick : ContactMode::slide;
      }
    }
  }
}

void PlaneIterative::list_touching(StepPart<D>, std::vector<std::pair<int, int>>& pairs) const {
  for (const Pair& pair : pairs_.all()) {
    if (pair.slot < 0) continue;
    const ContactBatch& g = batches_[pair.slot / kLanes];
    const int lane = pair.slot % kLanes;
    bool bears = false;
    for (int k = 0; k < pair.touches; ++k)
      bears = bears || (g.struck[k] >> lane & 1) || g.p[k][lane] != 0 || g.q[k][lane] != 0;
    if (bears) pairs.emplace_back(pair.a, pair.b);
  }
}

void PlaneIterative::finish_substep(StepPart<D> part) { outran_ = outran(part.h, (1 - share(part)) * span_); }

// Whether joints press an awake body far into another. Few iterations of contacts, each with the mass of its
// own body alone, would hardly move it out.
bool PlaneIterative::strained(const State<D>& state) const {
  const auto far = [&](int body) { return kStrained * cores_.half_thickness[body]; };
  return std::any_of(state.contacts.begin(), state.contacts.end(), [&](const Contact<D>& c) {
    const int a = c.key.a, b = c.key.b;
    const bool awake = moving_[a].im > 0 || (b >= 0 && moving_[b].im > 0);
    const bool tied = joints_.has(a) || (b >= 0 && joints_.has(b));
    return awake && tied && c.gap < -(b < 0 ? far(a) : std::min(far(a), far(b)));
  });
}

// a pair's forces, from its lane
void PlaneIterative::report_pair(const Pair& pair, State<D>& state) const {
  if (pair.slot < 0) return;
  const ContactBatch& g = batches_[pair.slot / kLanes];
  const int lane = pair.slot % kLanes;
  for (int k = 0; k < pair.touches; ++k) {
    Contact<D>& contact = state.contacts[pair.first + k];
    const Feature f = Feature::of(contact.key.feature);
    contact.force = {g.p[k][lane], g.q[k][lane]};
    if (f.kind == Feature::none) continue;
    const plane::ContactPoint at = pairs_.place(pair, poses_, f);
    contact.point = {at.x, at.y};
  }
}

// searches for pairs, wakes bodies that they reach, and assigns lanes
void PlaneIterative::update_pairs(State<D>& state, bool known) {
  const int patience = state.contacts.empty() || anew_ ? 0 : plane::NearPairs::patience(state.step / every_);
  bool changed = pairs_.find(state, poses_, span_, patience);
  if (Sleep<D>::any(state)) place_contacts(state, false);
  // gaps of contacts may be those of a step before
  const double step = span_ / double(every_);
  if (sleep_.wake(state, state.contacts, span_ + step, step / double(substeps_))) {
    pairs_.find(state, poses_, span_, 0);
    changed = true;
  }
  if (known && !changed && frozen_ == state.frozen) return;
  build_batches(state, known);
  const bool fresh =
      state.step == 0 && std::all_of(state.contacts.begin(), state.contacts.end(),
                                     [](const Contact<D>& c) { return c.force == Vec<D>::Zero(); });
  if (fresh) {
    first_guess(state);
    build_batches(state, false);
  }
}

// Wakes what a body may strike within the step, and what that may strike then, as each search for pairs does
// for the time until the next: something may have become faster since. True if any woke.
bool PlaneIterative::wake_struck(State<D>& state, double h) {
  const int n = int(turns_.size());
  const auto moves = [&](int body) { return !fixed_[body] && !state.frozen[body]; };
  const auto meets = [&](const Pair& pair) {
    int words[2];
    pairs_.features(pair, poses_[pair.a], poses_[pair.b], words);
    for (const int word : words) {
      const Feature feature = Feature::of(word);
      if (feature.kind != Feature::none &&
          pairs_.place(pair, poses_, feature).gap <
              Sleep<D>::kSooner * h * (struck_speeds_.speed(pair.a) + struck_speeds_.speed(pair.b)))
        return true;
    }
    return false;
  };
  bool any = false, begun = false;
  for (bool more = true; more;) {
    more = false, struck_.clear();
    const auto mixed = [&](const Pair& pair) {
      if (pair.b < 0 || fixed_[pair.a] || fixed_[pair.b]) return false;
      return state.frozen[pair.a] != state.frozen[pair.b];
    };
    const std::vector<Pair>& all = pairs_.all();
    if (std::none_of(all.begin(), all.end(), mixed)) break;
    if (!begun) {
      struck_speeds_.clear(n), begun = true;
      for (int i = 0; i < n; ++i) {
        // what is quiet gets no faster, and where it may come the last search has seen
        if (!moves(i) || state.quiet[i] > 0) continue;
        const Motion& m = moving_[i];
        struck_speeds_.begin(
            i, std::sqrt(m.x * m.x + m.y * m.y) + std::fabs(m.w) * cores_.bounding_radius[i] + h * g_);
      }
    }
    for (const Pair& pair : all) {
      if (pair.b < 0 || fixed_[pair.a] || fixed_[pair.b]) continue;
      if (state.frozen[pair.a] && state.frozen[pair.b]) continue;
      const int struck = struck_speeds_.struck(pair.a, pair.b);
      if (struck < 0 || !meets(pair)) continue;
      if (mixed(pair)) struck_.push_back(state.frozen[pair.a] ? pair.a : pair.b);
      struck_speeds_.strike(pair.a + pair.b - struck, struck), more = true;
    }
    if (struck_.empty()) continue;
    sleep_.wake(state, struck_), any = true;
    pairs_.find(state, poses_, span_, 0);
  }
  return any;
}

// false where the state is not the one that the last step left
bool PlaneIterative::gather(const State<D>& state) {
  const int n = int(turns_.size()), still = n - int(state.turn.size());
  std::size_t contacts = 0;
  if (!pairs_.all().empty()) contacts = pairs_.all().back().first + pairs_.all().back().touches;
  bool known = state.step == next_step_ && state.contacts.size() == contacts && state.frozen == frozen_;
  for (int i = 0; i < n; ++i) {
    const double x = state.x[i][0], y = state.x[i][1], vx = state.v[i][0], vy = state.v[i][1];
    const bool same = (poses_[i].x == x) & (poses_[i].y == y) & (moving_[i].x == vx) & (moving_[i].y == vy);
    known = known && (same || drives_.number(i) >= 0);
    poses_[i].x = x, poses_[i].y = y, moving_[i].x = vx, moving_[i].y = vy;
  }
  for (int i = still; i < n; ++i) {
    const double turn = state.turn[i - still][0], w = state.spin[i - still][0];
    const bool moved = drives_.number(i) >= 0;  // as its time says, to rounding
    known = known && (moving_[i].w == w || moved);
    moving_[i].w = w;
    if (turn == turns_[i]) continue;
    known = known && moved;
    const SinCos sc = sin_cos(turn);
    poses_[i].c = sc.cos, poses_[i].s = sc.sin, turns_[i] = turn;
  }
  return known;
}

void PlaneIterative::moved_by_joints(const State<D>& state, int body) {
  plane::Pose& pose = poses_[body];
  pose.x = state.x[body][0], pose.y = state.x[body][1];
  const int k = turning(state, body);
  if (k < 0) return;
  const SinCos sc = sin_cos(turns_[body] = state.turn[k][0]);
  pose.c = sc.cos, pose.s = sc.sin;
}

// pushes bodies out of overlaps, by a part of each
void PlaneIterative::push_out(const State<D>& state) {
  std::fill(projections_.begin(), projections_.end(), plane::Projection{});
  for (std::size_t i = 0; i < moving_.size(); ++i) push_[i] = {0, 0, 0, moving_[i].im};
  int iterations = std::max(kFewestProjections, kProjections * fewest_iterations());
  if (!joints_.empty() && strained(state)) iterations = kStrainIterations;
  for (int i = 0; i < iterations; ++i) {
    // joints go along
    for (const int k : joints_.bodies())
      joints_.body_motion(k).v = velocity(push_[k]), joints_.body_motion(k).w = spin(push_[k]);
    if (!joints_.empty()) joints_.solve_positions();
    for (const int k : joints_.bodies())
      set_velocity(push_[k], joints_.body_motion(k).v, joints_.body_motion(k).w);
    project_all(part_of_step_ * corrected_share(state, span_), allowed_overlap(state));
  }
  begin_corrections();
  for (std::size_t i = 0; i < corrections_.size(); ++i) corrections_[i] = {push_[i].x, push_[i].y};
}

}  // namespace obscura::sim
