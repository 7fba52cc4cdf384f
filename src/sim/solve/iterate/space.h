#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sim/collide/broad_phase.h"
#include "sim/collide/may_touch.h"
#include "sim/collide/narrow_phase.h"
#include "sim/constraint/material.h"
#include "sim/constraint/response.h"
#include "sim/energy/energy_guard.h"
#include "sim/math/islands.h"
#include "sim/solve/iterate/contact_constraint.h"
#include "sim/solve/iterate/exact_island.h"
#include "sim/solve/iterate/impact_queue.h"
#include "sim/solve/iterate/instant_impact.h"
#include "sim/solve/iterate/iterative.h"
#include "sim/solve/iterate/pair_levels.h"
#include "sim/solve/iterate/space_batches.h"
#include "sim/solve/iterate/struck_ends.h"
#include "sim/solve/iterate/struck_speeds.h"

namespace obscura::sim {

/// Contact for hundreds of bodies of space: all that may touch within a step is found anew in each, forces by
/// warm iterations over it, impacts of few exactly and at their time, joints exactly in each iteration. All
/// that is carried from step to step is in the state, so a run cut in two is the run in one.
class SpaceIterative final : public Iterative<3> {
  static constexpr int D = 3;

 public:
  /// Both are kept by reference.
  SpaceIterative(const Model<D>& model, const std::vector<Path<D>>& paths);

  void resolve_impacts(StepPart<D> part) override;
  void report(StepPart<D> step) override;

 private:
  bool find_contacts(StepPart<D> step) override;
  void update_sleep(StepPart<D> step) override;
  bool wake_struck(State<D>& state, double h);
  ClosingRates closing_rates(double h) const override { return rates_of_touches(h, true); }
  double approach_rate(double h) const override { return rates_of_touches(h, false).ruling; }
  ClosingRates rates_of_touches(double h, bool spins_along) const;
  void renew_contacts(StepPart<D> part) override;
  void move_unconstrained(StepPart<D> part) override;
  BodyMotion<D> begun(int body) const override { return stances_[std::size_t(body)]; }
  Orientation<D> begun_turn(int body) const override;
  void start_contacts(StepPart<D> part) override;
  int iterations(StepPart<D> part) const override;
  void iterate_contacts(int i) override { batches_.iterate(moving_, i % 2 != 0); }
  void settle_contacts(double h) override;
  void solve_exhausted() override;
  void end_round(StepPart<D> part) override;
  void list_touches(std::vector<TouchEnds>& touches) const override;
  TouchRows read_touch(int number) const override;
  void write_touch(int number, const TouchRows& its) override;
  std::array<Row<D>, D> begun_rows(int number) const override;
  bool open_touch(int number) override;
  void bear_touch(StepPart<D> part, int number, double force) override;
  void begin_jointed() override { batches_.store(touches_); }
  void end_jointed(bool changed) override {
    if (changed) batches_.load(touches_);
  }
  bool temper(StepPart<D> part, int round) override;
  double contact_work(StepPart<D> part) const override;
  void place_bodies(StepPart<D> part) override;
  void correct_overlaps(StepPart<D> part) override;
  void finish_substep(StepPart<D> part) override;
  void list_touching(StepPart<D> part, std::vector<std::pair<int, int>>& pairs) const override;
  int begin_rest(const Sleep<D>::Island& island, const State<D>& state, double h) override;
  void iterate_rest(int i) override;
  void finish_rest(const Sleep<D>::Island& island, State<D>& state, double h) override;

  using ContactConstraint = sim::ContactConstraint<D>;

  // a body at a time within the step
  struct Flown {
    BodyMotion<D> stance;
    Orientation<D> turn = no_rotation<D>();
  };
  // where it is at the two times that were asked for last, and where the step ends
  struct Course {
    Flown then[2], end;
    double asked[2] = {-1, -1};  // s
    int last = 0;
    bool ends = false;

    void forget() { asked[0] = asked[1] = -1, last = 0, ends = false; }
  };
  // a gap then; the bodies until they are asked for at two other times
  struct Instant {
    const BodyMotion<D>&a, &b;
    EvaluatedContact<D> now;
    double speed = 0;  // m/s
  };
  // From `when` on, until one of its bodies is struck, a gap is at least  gap - speed (t - when).
  struct Reach {
    double gap = -1e300, when = 0, speed = 0;  // m, s from the start of the step, m/s

    double least(double t) const { return gap - speed * (t - when); }
  };
  // how fast a body is at most in the step, since its last impact or, `ever`, since the step began
  struct Fastest {
    double spin = 0, ever = 0, gain = 0;  // rad/s, m/s, m/s: what the step adds without contacts
    double turns = 0;                     // rad/s, likewise
  };

  // a pair that collide() found apart, and how its bodies stood then
  struct Apart {
    Clearance clearance{-1e300, 1};
    Vec<D> between = Vec<D>::Zero();  // m, from b's centre to a's
    double turned = 0;                // rad, of both
  };

  // what features are looked for by
  struct Search {
    double h = 0;             // s
    std::int64_t number = 0;  // of the substep, since all were looked for
    bool same = false;        // those of the step's start are known
    std::span<const Contact<D>> contacts;
  };
  // the touches of a pair that may come to lie in each other; see may_turn_into()
  struct TurningPair {
    int first, end;
    bool may = false;
    double least = 0;
  };
  // of those that are pushed apart
  struct OverlappingTouch {
    int touch;
    double wanted;        // m
    double response = 0;  // 1/kg
    double parted = 0;    // kg m: of unit time
  };
  // the work of a contact on its bodies over the substep
  struct ContactWork {
    double work = 0;     // J
    int island = -1;     // whose budget is spent; -1: it does not count
    bool opens = false;  // its bodies part there, and have not bounced
  };
  // of a body, s: when the first blow meets it, of which pair, and when the first of another
  struct FirstBlow {
    double when = 1e300, other = 1e300;
    int pair = -1;

    double of_others(int which) const { return which == pair ? other : when; }
  };
  // a touch that closes fast, and when its bodies meet something else before
  struct LaterBlow {
    int touch;
    double after;  // s
  };
  // those of a pair, and the most that a round has changed, m
  struct OverlapPair {
    int level, first, end;
    double change = 0;
  };
  // the features of some bodies
  struct Found {
    std::vector<ContactCandidate<D>> all, of_pair;
    int first = 0;  // their place among all
  };

  void prepare(const State<D>& state, double t, double h);
  bool too_fast() const;
  void find(StepPart<D> step);
  void find_of(int begin, int end, const Search& search, Found& found);
  void begin_constraints();
  void find_near();
  bool stays_apart(const Apart& apart, int a, int b, double margin) const;
  void take_known(int a, int b, double margin, std::size_t& memo,
                  std::vector<ContactCandidate<D>>& gaps) const;
  bool keep_features(int a, int b, const Search& search, std::span<const Contact<D>>& old, std::size_t& memo,
                     std::vector<ContactCandidate<D>>& gaps) const;
  ContactConstraint constraint(const ContactCandidate<D>& gap, const Material& pair) const;
  const Flown& flown(int body, double t, double h, Flown* own = nullptr) const;
  Flown fly(int body, double t, double h) const;
  Instant instant(int touch, double t, double h, Flown* own = nullptr) const;
  Vec<D> free_gain(int body) const;
  double strike_speed(const ContactConstraint& touch) const;
  bool meets_later(const ContactConstraint& touch, double before, double h) const;
  double closing_time(int touch, double h);
  double meeting_time(int touch, double h, Flown* own = nullptr) const;
  bool may_turn_into(int first, int end, double h, Flown* own, double& least) const;
  double most_passing(const ContactConstraint& touch) const;
  void limit_speed(int body, double h);
  double approach_limit(int touch, double h) const;
  double bend_limit(int touch, const Instant& at, double h) const;
  bool stays_apart(int touch, double apart, double h);
  int rounds(int touch) const {
    return rounds_[touches_[touch].a] + rounds_[touches_[touch].b] + touches_[touch].renewals;
  }
  double margin(int body, double h) const;
  double thrown_way(int body, double h) const;
  void foresee_blows(double h);
  double passing_speed(int a, int b) const;
  double pair_margin(int a, int b, double h) const;
  double find_features(int a, int b, double t, double h, std::vector<ContactCandidate<D>>& gaps,
                       Flown* own = nullptr) const;
  bool meets_by_nearest(int touch, double when, double h, std::vector<ContactCandidate<D>>& gaps,
                        Flown* own) const;
  bool parts_at(int a, int b, double t, double h);
  bool features_change(const ContactConstraint& touch) const;
  void renew_features(int first, double low, double high, double h);
  void begin_flights(const State<D>& state, double h);
  void lay_down_ends(const State<D>& state, double h);
  void give_back_ends(const State<D>& state);
  void find_closing(const State<D>& state, double h);
  void find_turned_pairs(double h);
  void restore_features();
  bool has_nearest_features(const ImpactQueue::Due& due, double h);
  bool closed(int touch, double bounding_radius, double t, double h) const;
  bool gather_impact(int touch, double t, double h);
  void gather_ends(double t, double h);
  void begin_rows(int contacts);
  void set_rows(int k, const ContactConstraint& touch, const Vec<D>& normal, const Vec<D>& arm_a,
                const Vec<D>& arm_b, const BodyMotion<D>& a, const BodyMotion<D>& b);
  std::array<Row<D>, D> rows_of(const ContactConstraint& touch, const Vec<D>& normal, const Vec<D>& arm_a,
                                const Vec<D>& arm_b) const;
  void couple_rows(Eigen::Ref<Eigen::MatrixXd> K) const;
  void place_joints(int body, double t, double h);
  bool on_joints(const ContactConstraint& touch) const;
  bool locked(const ContactConstraint& touch);
  void build_impact_rows(double t, double h);
  bool solve_impact(double t, double h, std::vector<double>& work);
  void hold_until(double t);
  // act(body) for what moves of a side of a touch, and for all that hangs together with it on joints
  template <class Act>
  void each_tied(int body, Act&& act) const {
    if (body == int(model_.bodies.size()) || inactive_[body]) return;
    joints_.each_tied(body, act);
  }
  bool gains(const State<D>& state);
  void place(State<D>& state, double h);
  void warm_start_contacts(const State<D>& state, double h);
  void set_aims(int begin, int end, const State<D>& state, double h);
  void share_loads();
  void order_blows(double h);
  bool strike_later(double h);
  void moderate_warm_start();
  void solve_together();
  void shed_gains();
  void keep_impulses(const State<D>& state);
  void add_impulses(State<D>& state) const;
  // an impulse on a, and back on b; what does not move may be another thread's too
  void push(const ContactConstraint& touch, const Vec<D>& impulse) {
    moving_[touch.a].push(impulse, touch.arm_a), moving_[touch.b].push(-impulse, touch.arm_b);
  }
  // how fast a's matter moves against b's
  Vec<D> slip(const ContactConstraint& touch) const {
    const PointBody<D>&a = moving_[touch.a], &b = moving_[touch.b];
    const Vec<D> slips =
        a.v + cross_velocity<D>(a.w, touch.arm_a) - b.v - cross_velocity<D>(b.w, touch.arm_b);
    return slips + touch.belt + touch.drift;
  }
  // of bodies that are moved, and belts
  bool carries(int body) const {
    return !carries_.empty() && body < int(model_.bodies.size()) && carries_[std::size_t(body)];
  }
  Vec<D> belt(const ContactConstraint& touch) const;
  bool lasts(const ContactConstraint& touch, const Vec<D>& force) const;
  bool rubs_fully(const ContactConstraint& touch, const Vec<D>& force) const;
  bool slides_on(const ContactConstraint& touch, const Vec<D>& force, const Vec<D>& passes, double h) const;
  bool strikes(const ContactConstraint& touch, const Vec<D>& passes) const;
  void foresee_slip(int touch);
  void find_middles(const State<D>& state, double h);
  void center(int touch, bool bears);
  void find_bearing(const State<D>& state, double h);
  bool gives(int body) const {
    return !borne_.empty() && !inactive_[std::size_t(body)] && dynamics_.has(body);
  }
  void turn_friction(const State<D>& state);
  double leads() const;
  void gather_bodies(const State<D>& state);
  void take_out_contacts(State<D>& state, double h);
  void take_out(int body, double h, Vec<D>& x, Vec<D>& v, Orientation<D>* turn, AngularVec<D>* spin) const;
  double integrate_step(StepPart<D> part);
  void share_free_motion(State<D>& state, double h);
  void move_driven(State<D>& state, double t, double h);
  double given(const Vec<D>& impulse, const BodyMotion<D>& a, int body_a, const Vec<D>& arm_a,
               const BodyMotion<D>& b, int body_b, const Vec<D>& arm_b) const;
  double given_at(const ContactConstraint& touch, const Vec<D>& impulse) const;
  void find_strikes(double h);
  double normal_response(const ContactConstraint& touch) const;
  double find_overlaps(const State<D>& state, double h);
  void sort_overlaps();
  void push_apart(OverlapPair& pair);
  void report_contacts(State<D>& state, double h);
  void write_contacts(State<D>& state, double h) const;
  Contact<D> contact(const ContactConstraint& touch, double h) const;

  MayTouch<D> may_touch_;
  BroadPhase<D> broad_;
  Response<D> response_;
  std::vector<Contact<D>> near_, before_piece_;
  StruckSpeeds struck_speeds_;                // in the step
  std::vector<int> struck_bodies_, reached_;  // of these which are struck, and which of those sleep
  EnergyGuard<D> energy_guard_;
  // bodies, m: how far kinematic ones get from where their velocity takes them, and others where these
  // strike them; empty: none are kinematic
  std::vector<double> farther_;
  std::vector<double> width_;  // of bodies, m
  std::vector<char> round_;
  std::vector<Contact<D>> impulses_;    // of the substeps before
  mutable std::vector<double> closes_;  // 1/s, of each touch: how fast it closes; kNotNear: it is not near
  mutable std::vector<double> rates_;   // 1/s, of the touches that close

  std::vector<BodyMotion<D>> stances_, middles_;  // of bodies: where the substep begins, in its middle
  std::vector<double> margin_,
      swing_;  // bodies: m, see margin(); m/s, of its farthest point by its spin alone
  std::vector<double> thrown_, next_thrown_;  // bodies: m/s, how fast blows of the substep may make them
  std::vector<Bounds<D>> bounds_, wide_;      // of bodies in a step; and those that near_pairs_ are of
  std::vector<std::pair<int, int>> near_pairs_;
  std::vector<Apart> apart_;    // one for each
  std::vector<double> turned_;  // bodies: rad, how far each has turned since the first step
  std::vector<char> inactive_, inactive_then_, points_;
  std::vector<ContactCandidate<D>> gaps_;
  std::vector<ContactConstraint> touches_;  // ascending by key
  SpaceBatches batches_{model_.workers};    // of them, those that are iterated
  Settling settling_;
  std::vector<std::pair<int, int>> exhausted_;  // islands and their touches
  std::vector<Found> found_;
  std::vector<ContactCandidate<D>> features_;                 // theirs
  std::vector<ContactCandidate<D>> known_;                    // and before: of a key always the same
  double found_for_ = 0;                                      // s: of what time within the step
  std::vector<std::pair<int, ContactCandidate<D>>> renewed_;  // touches, and what they had before
  std::vector<int> all_, some_;
  std::vector<int> bearing_touches_;  // of bearing_
  std::vector<double> rubbed_;        // bodies, m/s^2: what the friction of these would give at most
  std::vector<Vec<D>> x_, x_free_, v_free_, gains_, bends_;
  std::vector<AngularVec<D>> spin_gains_, turn_bends_;
  std::vector<Orientation<D>> turn_, turn_free_;
  std::vector<AngularVec<D>> w_free_;
  std::vector<char> closing_;
  std::vector<int> components_;  // of joints: those with bodies that closing_ names
  Islands islands_;
  std::vector<OverlappingTouch> overlaps_;
  std::vector<OverlapPair> overlap_pairs_, sorted_overlaps_;
  PairLevels overlap_levels_;
  std::vector<int> overlap_begins_, overlap_places_;  // of each level
  std::vector<FirstBlow> first_blows_;
  std::vector<LaterBlow> later_blows_;
  double given_by_blows_ = 0;                       // J: by what is moved, with the blows before later ones
  std::vector<Vec<D>> free_slips_;                  // m/s, of each touch that slides: that of the free motion
  std::vector<char> known_force_;                   // of each touch: whether the state has a force for it
  std::vector<double> before_, gained_, returned_;  // of each island's impacts, J
  std::vector<ContactWork> works_;                  // of each touch
  std::vector<double> given_;                       // by the contacts of each island, J
  bool struck_ = false;                             // whether any body had an impact in this step
  std::vector<double> when_;                        // bodies: s, their last impact in it; or -1
  std::vector<double> rested_since_;                // bodies: s, the one before, or the beginning
  std::vector<Flown> borne_ends_;                   // of bodies on joints, with what contacts give
  std::vector<Flown> flown_;                        // after it, or as the step began
  mutable std::vector<Course> courses_;
  std::vector<Fastest> fastest_;
  std::vector<AngularVec<D>> twist_;  // bodies: what the step adds to angular momentum without contacts
  std::vector<Reach> reach_;          // of each touch
  std::vector<char> may_close_;       // of each touch: no limit says that it does not,
  std::vector<double> meets_at_;      // when it does, s,
  std::vector<char> nearest_;         // and whether by the features that are nearest then
  std::vector<std::vector<ContactCandidate<D>>> nearest_gaps_;  // of some touches: scratch
  std::vector<char> ends_;                                      // bodies: asked for where the step ends
  std::vector<TurningPair> turning_;
  ImpactQueue due_;                   // numbers of touches
  std::vector<double> strikes_;       // bodies: s, when what the iterations change begins to move them
  std::vector<int> rounds_;           // impacts of each body
  std::vector<char> crowded_;         // bodies whose impacts are left to the iterations
  ByBody around_;                     // touches
  std::vector<int> meets_, changed_;  // touches of an impact, and of all that it moves
  ExactIsland<D> exact_;
  InstantImpact<D> instant_;
  std::vector<Row<D>> impact_rows_;
  std::vector<RowResponse<D>> impact_responses_;
  std::vector<JointSolver<D>::JointResponse> tied_responses_;
  JointSolver<D>::JointResponse locked_response_;
  StruckEnds<D> struck_ends_;
  bool impact_tied_ = false;  // whether joints answer the impact
};

}  // namespace obscura::sim
