#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sim/collide/core_shapes.h"
#include "sim/math/islands.h"
#include "sim/solve/iterate/exact_island.h"
#include "sim/solve/iterate/iterative.h"
#include "sim/solve/iterate/pieces.h"
#include "sim/solve/iterate/plane_contact_rows.h"
#include "sim/solve/iterate/plane_impacts.h"
#include "sim/solve/iterate/plane_pair_cache.h"
#include "sim/solve/iterate/struck_speeds.h"

namespace obscura::sim {

/// The iterative solver of the plane, for thousands of bodies. Pairs are found 60 times a second, forces by a
/// few warm-started iterations a step. All that is carried from step to step is in the state: its contacts,
/// those of pairs that may touch soon among them, hold forces and feature numbers. Members are scratch and
/// follow from the state, so a run cut in two is the run in one. Scratch is reused if step, poses and
/// velocities of the state are bit for bit those that the last step left.
class PlaneIterative final : public Iterative<2> {
  static constexpr int kMostQuietPairs = 4000;  // of more, quiet or not, iterations end as soon
  static constexpr int D = 2;

 public:
  /// Both are kept by reference.
  explicit PlaneIterative(const Model<D>& model, const std::vector<Path<D>>& paths);

  void begin_anew() override { anew_ = true; }
  void warm_start(StepPart<D> part) override;
  void resolve_impacts(StepPart<D> part) override;
  void report(StepPart<D> step) override;

 private:
  bool find_contacts(StepPart<D> step) override;
  bool wake_struck(State<D>& state, double h);
  void update_sleep(StepPart<D> step) override;
  ClosingRates closing_rates(double h) const override;
  bool mostly_quiet() const;
  void renew_contacts(StepPart<D> part) override;
  void move_unconstrained(StepPart<D> part) override;
  BodyMotion<D> begun(int body) const override;
  Orientation<D> begun_turn(int body) const override;
  int iterations(StepPart<D> part) const override;
  void iterate_contacts(int i) override;
  void settle_contacts(double h) override;
  void solve_exhausted() override;
  void end_round(StepPart<D> part) override;
  void list_touches(std::vector<TouchEnds>& touches) const override;
  TouchRows read_touch(int number) const override;
  void write_touch(int number, const TouchRows& its) override;
  std::array<Row<D>, D> begun_rows(int number) const override;
  bool open_touch(int number) override;
  void bear_touch(StepPart<D> part, int number, double force) override;
  double contact_work(StepPart<D> part) const override;
  void place_bodies(StepPart<D> part) override;
  void moved_by_joints(const State<D>& state, int body) override;
  void finish_substep(StepPart<D> part) override;
  void list_touching(StepPart<D> part, std::vector<std::pair<int, int>>& pairs) const override;
  int begin_rest(const Sleep<D>::Island& island, const State<D>& state, double h) override;
  void iterate_rest(int i) override;
  void finish_rest(const Sleep<D>::Island& island, State<D>& state, double h) override;
  void stop_sleeping(const State<D>& state) override;

  using Motion = plane::Motion;

  // Of the thickness of the thinner body: contacts with wider gaps are ignored in a substep. A body fast
  // enough to cross such a gap is swept instead.
  static constexpr double kSight = 0.5;
  // m; a point, which has no thickness, is seen from a little way off
  double sight(const plane::CoreShape& a, const plane::CoreShape& b) const {
    const double thin = std::max(std::min(a.half_thickness, b.half_thickness), 0.5 * (a.radius + b.radius));
    const double thick = std::max(a.half_thickness, b.half_thickness);
    return kSight * (thin > 0 ? thin : std::min(thick, kPointWidth * model_.scale));
  }

  static plane::ContactBatch empty_batch(int none);
  bool gather(const State<D>& state);
  bool first(StepPart<D> part) const { return part.substep == 0 && part.state.step % every_ == 0; }
  double share(StepPart<D> part) const;
  bool strained(const State<D>& state) const;
  void report_pair(const plane::Pair& pair, State<D>& state) const;
  void build_batches(const State<D>& state, bool known);
  void moderate_warm_start();
  void find_whipped();
  void keep_forces(State<D>& state, bool last);
  void place_contacts(State<D>& state, bool all) const;
  bool update_batches(const State<D>& state);
  int colour(const plane::Pair& pair);
  void clear_lane(int slot);
  void fill_lane(int pair, const State<D>& state);
  void write_lane(const plane::Pair& pair, const State<D>& state);
  void first_guess(State<D>& state);
  template <class Act>
  void by_colour(const Act& act, int piece = kPlaneBatchPiece);
  template <class Act>
  void by_colour(std::span<const int> batches, const Act& act);
  plane::SubstepConstants constants_from(int batch) const;
  void reserve_seen();
  void apply_warm_start();
  void iterate_all();
  int iterate_active();
  void iterate_last(Contact<D>* contacts);
  void project_all(double share, AllowedOverlap allowed);
  int fewest_iterations() const;
  void settle_all();
  void settle_few();
  void find_few();
  double squared_change() const;
  static bool may_bear(const plane::ContactBatch& batch, int lane, int k);
  double least_speed(const plane::ContactBatch& batch, int slot, int k, double gap) const;
  std::array<Row<D>, D> rows_of(const plane::ContactBatch& batch, int lane, const plane::TouchRow& row) const;
  void solve_together(std::span<const std::pair<int, int>> lanes);
  void find_bearing(const State<D>& state, double h);
  void integrate_unconstrained(State<D>& state, double t, double h);
  void share_free_motion(StepPart<D> part);
  void integrate_jointed(StepPart<D> part);
  void move_driven(StepPart<D> part);
  void find_middle(double h);
  void place_driven(State<D>& state);
  void foresee_driven(double t);
  double belt_of(int body) const { return body < 0 ? 0 : model_.bodies[std::size_t(body)].belt[0]; }
  void push_out(const State<D>& state);
  void update_pairs(State<D>& state, bool known);
  bool outran(double h, double left) const;
  double safe_fraction(int body, const plane::Pose& from, const Motion& way, double begun, double h,
                       bool walls) const;
  Motion mean_way(int body, double h) const;
  Motion way_to_first_hit(int body, double h);
  bool sinks(int body, const Motion& way, double h) const;
  bool fast(int body, const Motion& way) const;

  plane::CoreShapes cores_;
  plane::Pairs pairs_;
  plane::Impacts impacts_;
  std::vector<DrivenMotion<D>> driven_;  // kinematic bodies at the end of the substep
  double driven_gain_ = 0;               // m/s: the most that a substep adds to a point of a kinematic body
  double span_ = 0;                      // s between two pair searches
  bool anew_ = false;                    // the next step searches for pairs, even if no search is due
  bool outran_ = false;                  // a body has left the margin of the last pair search
  bool drag_ = false;

  // One entry a body, and one more that never moves, for walls
  std::vector<plane::Pose> poses_, begun_;  // now, and at the start of the substep
  std::vector<plane::Pose> middle_;         // in the middle of the substep, as bodies go where it begins
  std::vector<double> turns_;               // the angles of poses_, rad
  std::vector<double> ii_;                  // 1/(kg m^2); 0: asleep or fixed
  std::vector<Motion> old_;                 // moving_ at the start of the substep
  bool apart_ = false;                      // each substep of this step is integrated by itself
  // Of the whole step, or of the substep, without contacts: the change of velocity, and of the displacement
  // what exceeds h times the mean velocity
  std::vector<Motion> gain_, bend_;
  std::vector<Motion> dv_, dx_;  // of the substep without contacts: changes of velocity and of pose
  std::vector<Motion> push_;     // displacements by push_out()
  std::vector<char> closing_;    // a contact of the body closed slowly in this substep
  std::vector<char> frozen_;     // State::frozen when lanes were assigned
  std::vector<char> fixed_;
  struct Light {
    double im, ii;  // 1/kg, 1/(kg m^2)
  };
  std::vector<Light> light_;
  std::vector<char> movers_;  // one a body: springs, hands or forces act on it

  std::vector<std::uint64_t> colours_;     // one a body: a bit for each colour in use
  std::vector<int> count_, begin_, ends_;  // one a colour: its next free lane, its first lane and its end
  std::vector<plane::ContactBatch> batches_;
  std::vector<plane::Projection> projections_;
  plane::LaneList slow_, fast_;
  // what a piece of apply_warm_start() has found
  struct Seen {
    bool deep = false;
    plane::LaneList slow, fast;
  };
  std::vector<Seen> seen_;
  std::vector<plane::LaneImpulses> forces_before_;  // by group, N: before a piece of a step
  std::vector<int> iterated_;                       // pieces of an iteration: how many pairs
  // of an island at rest: its pairs, by lane, and batches of its own
  std::vector<int> rest_;
  std::vector<plane::ContactBatch> rest_batches_;
  plane::SubstepConstants constants_;  // of the substep
  plane::ActiveBodies active_bodies_;
  std::vector<int> few_bodies_, few_groups_;              // of islands of few pairs
  StruckSpeeds struck_speeds_;                            // in the step
  std::vector<int> struck_;                               // bodies that sleep
  bool few_stale_ = true;                                 // pairs have come or gone since
  std::vector<plane::LaneImpulses> before_, directions_;  // by group, while iterations are accelerated
  // islands that iterations have not settled
  struct Exhausted {
    struct Touch {
      int number;
      TouchRows at;
    };
    Islands sets;
    std::vector<int> contacts;               // at roots
    std::vector<std::pair<int, int>> lanes;  // root and lane
    std::vector<Touch> touches;
    ExactIsland<2> island;
  } exhausted_;
  bool deep_ = false;                    // some overlap exceeds the allowed one
  std::vector<int> slots_, next_slots_;  // the pair in each lane
  std::vector<int> moved_;               // pairs that change lanes
  std::int64_t next_step_ = -1;          // State::step of the state that the last step left
  long version_ = -1;
  int awake_pairs_ = 0;
  double calmest_ = 0;  // m/s: while all points are slower than half of it, no features change
};

}  // namespace obscura::sim
