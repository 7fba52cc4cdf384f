#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sim/collide/may_touch.h"
#include "sim/collide/rails.h"
#include "sim/constraint/joints/joint.h"
#include "sim/constraint/joints/motors.h"
#include "sim/constraint/material.h"
#include "sim/constraint/response.h"
#include "sim/math/islands.h"
#include "sim/motion/forward_dynamics.h"
#include "sim/solve/cone/cone.h"
#include "sim/solve/contact_solver.h"
#include "sim/solve/sleep.h"

namespace obscura::sim {

/// The exact solver: contact and joint forces are part of the Runge-Kutta stages, found exactly
/// (sim/solve/cone/cone.h). A step is cut where something closes, opens, slips or stops: in `event` always,
/// in `contact` where it closes or stops, and a bounded number of times for each body. Bodies that cannot
/// meet in a step are stepped apart, so that the cuts of one are none of the other's. For scenes of up to
/// some hundred rows.
/// Its events divide the step anew for each group of bodies, so it merges stages of ContactSolver: collide()
/// only divides the bodies into groups, and advance() does all else from wake to project, from event to event
/// (step_group() in exact.cpp is that list). report() and sleep() are as in all solvers.
template <int D>
class ExactSolver final : public ContactSolver<D>, private System {
 public:
  /// The bodies that it steps: all, or single ones in a model that another solver steps.
  enum class Serves { all, lone };

  /// Both are kept by reference.
  ExactSolver(const Model<D>& model, const std::vector<Path<D>>& paths, Serves bodies = Serves::all);

  /// Divides the bodies into groups that cannot meet within the step.
  bool collide(StepPart<D> step) override;
  /// Moves group after group, from event to event, with contact forces inside the stages of the integrator.
  void advance(StepPart<D> step) override;
  void report(StepPart<D> step) override;
  void sleep(StepPart<D> step) override;

  void watch(Course<D>* course) override { course_ = course; }
  const Vec<D>* corrections() const override { return corrections_.empty() ? nullptr : corrections_.data(); }

  /// Moves one body that meets only walls and fixed bodies, and writes the forces of its contacts into those
  /// that `state` has already. Requires Serves::lone.
  void step_alone(State<D>& state, int body, double t, double h);

 private:
  // a contact or joint with its rows at this instant
  struct Constraint {
    enum class Kind { contact, joint, rope, lower, upper, motor, friction };
    Kind kind = Kind::contact;
    int of = 0;                 // candidate or joint
    int first = 0, rows = 0;    // in rows_
    int block = 0;              // in blocks_, its first
    double off = 0;             // of a gap or limit: the distance left, m or rad
    double offs[kMostHeld<D>];  // of a joint: the errors C of its rows
    Wound rope;                 // of a rope: as State::wound
    // of a contact
    Vec<D> point = Vec<D>::Zero(), normal = Vec<D>::Zero();
    // of a sliding contact: the direction of its slip at the start of the interval, room's frame
    Vec<D> slip = Vec<D>::Zero();
    bool slow = false;  // that direction is kept through the interval
    double taken = 0;   // how much of its slip friction takes away until the step ends, m/s
    // of friction that goes by a load, of a wire or a rope: the sign of the motion that it is against, how
    // much of the load it is at most, and the bounds that were tried and found last
    double rubs = 0, grip = 0, tried = 0, needed = 0;
    double began = 0;  // how fast its first row went before an impulse, m/s or rad/s
  };

  // poses and velocities
  struct Motion {
    std::vector<Vec<D>> x, v;
    std::vector<Orientation<D>> turn;
    std::vector<AngularVec<D>> spin;
    std::vector<BodySpin<D>> body_spin;
    std::vector<ChainState> chain_states;
  };

  // a pair that may collide: a body and a body or wall
  struct Couple {
    int a, b;
  };

  // bodies that are stepped together, as they can meet no others in this step; its members lie in the lists
  // of step_
  struct Group {
    int root = 0;  // the lowest of its bodies, which tells it from others
    Subset subset;
    std::span<const int> joints;
    std::span<const Couple> couples;
    bool lone = false;  // one body, which only walls and fixed bodies can meet
  };

  // parameters: they follow from the model alone
  struct Limits {
    int row_joints = 0;                   // that no chain holds
    double touching_gap = 0;              // m: gaps up to this touch
    double rest_speed = 0;                // m/s: slower impacts do not bounce
    double least_speed = 0;               // m/s: what separates slower touches
    double unit_speed = 0;                // m/s: sqrt(g L), or L a second
    int most_cuts = 0;                    // of a step, by one body among others
    int most_openings = 0;                // cuts of a step by what lets go
    int most_faces = 0;                   // and by corners that leave their faces
    int patience = 0;                     // cuts of a step by one body before rest begins to grow
    double budget = 0;                    // rows^3 that a step may solve before it is done roughly
    double short_step = 0;                // of a step: what is done at once where there is no other way
    std::vector<double> bounding_radius;  // of each body, m
    std::vector<double> half_thickness;   // of each body, m; 0 of a point
    std::vector<Couple> couples;          // bodies that may touch others, or walls
    std::vector<int> bodies, joints, springs, chains;  // the numbers of all
    std::vector<std::vector<int>> tied_by_forces;      // bodies that forces between them tie together
    std::vector<int> fixed;                            // of Serves::lone: fixed bodies
    std::vector<std::vector<int>> rails;               // of each body, of a model that has some
    bool wires = false;                                // some joints are
    bool rubs = false;                                 // some have friction that goes by their load
  };
  static Limits make_limits(const Model<D>& model, Serves bodies);

  // the present step: its start, and its groups, whose members lie side by side in the lists
  struct Step {
    Motion begun;
    std::vector<char> frozen;   // where it began
    std::vector<char> broken;   // joints there
    std::vector<double> quiet;  // there
    Islands near;               // bodies that may meet, or are tied together
    std::vector<Group> groups;
    std::vector<int> group_bodies, group_joints, group_springs, group_chains;
    std::vector<Couple> group_couples;
    std::vector<int> group_of, old_root;  // one a body: its group, and the root of the one it was stepped in
    std::vector<int> group_sizes, group_ends;
    std::vector<char> kinds;
    std::vector<int> lone_body;                  // of Serves::lone
    std::vector<double> travel_bound;            // m: how far from where the step began each body may get
    std::vector<double> travelled;               // m: how far each has got
    std::vector<double> given;                   // J: by bodies that are moved, at the root of each group
    std::vector<int> cuts;                       // one a body: cuts of this step that it took part in
    std::vector<Contact<D>> contacts, impulses;  // of the groups that are done
    std::vector<int> on_piece;                   // as State::on_piece
  };

  // progress in the step of the present group
  struct Progress {
    double given = 0;                         // by bodies that are moved, J
    double rest_speed = 0;                    // m/s: that of limits_, or more after many cuts
    bool rough = false;                       // forces by Gauss-Seidel from here on
    bool limited = false;                     // a limit of work was met
    bool jumps = false;                       // a formula of the time jumps in this piece of a step
    double work = 0;                          // rows^3 solved
    double searches = 0;                      // how often more than once an interval couples were looked at
    int faces = 0;                            // how many more corners that leave their faces may cut it
    int openings = 0;                         // how many more contacts that let go may cut it
    std::vector<ContactKey> unclear;          // contacts whose forces do not predict their release
    std::vector<std::pair<int, int>> forced;  // pairs that open contacts would let penetrate at once: held
    bool forced_again = false;
    std::optional<ContactKey> released;              // what the last interval ended by
    std::optional<ContactKey> leaving;               // whose corner leaves its face there
    double late = kNever;                            // how far beyond its end, if it is not there yet
    double reserve_at_release = 0;                   // N: force_reserve() of that contact, at its start
    Couple cut_by{-1, -1};                           // what the last interval was cut by
    bool passes = false;                             // it was cut where a curve goes on in another run
    const std::vector<Contact<D>>* known = nullptr;  // sorted contacts to begin with
  };

  // the present interval, from one event to the next
  struct Interval {
    Motion begun;                                 // where it began
    double t = 0;                                 // s, when
    double given = 0;                             // by bodies that are moved within it, J
    double piece = 0;                             // s: of a step of the scheme
    std::vector<typename Drives<D>::Pace> paces;  // those' fastest within it
    Eigen::VectorXd velocities;                   // J v there
    std::vector<double> aims;                     // of motors there, one a constraint
    Eigen::VectorXd forces;                       // f there
    std::vector<ConeMode<D>> modes;               // as its stages keep them
    double slight = 0;                            // N: smaller normal forces count as none
    double loads = 0;                             // N: loads() there
    LimitMet rough;                               // as those of the state there
    WildestStep wildest;
  };

  // outcome, of the group at hand, then of the step
  struct Outcome {
    std::vector<Contact<D>> contacts, impulses;
    std::vector<Wrench<D>> joint_loads;  // on a, about its place
    std::vector<double> drags;           // of ropes with friction, as Wound::drag, N
  };

  // scratch: no function reads here what another left
  struct Scratch {
    std::vector<ContactCandidate<D>> candidates;
    std::vector<double> chain_change, rate;
    std::vector<Twist<D>> motions;  // of the links
    std::vector<ConeBlock<D>> blocks;
    std::vector<ConeMode<D>> modes;
    Eigen::VectorXd f, ways;
    std::vector<int> rows, wanted_rows, chosen;  // of the island at hand; of them, and of all, those wanted
    std::vector<char> wanted;
    Eigen::MatrixXd K;  // of the island at hand
    Eigen::VectorXd island_b, island_f;
    std::vector<ConeBlock<D>> island_blocks;
    std::vector<ConeMode<D>> island_modes;
    Motion saved, put, struck_from;
    std::vector<Contact<D>> near;
    std::vector<ContactCandidate<D>> on_rails;
    std::vector<double> accelerations;  // one a body, m/s^2
    std::vector<char> struck;           // one a body: at this instant, or what it touches
    std::vector<int> unheld;            // bodies of joints that broke
    std::vector<Vec<D>> placed;         // x before positions are projected
    std::vector<AngularVec<D>> turns;   // of bodies, by all rows together, rad
  };

  static constexpr double kComing = 10;  // resting speeds: what comes down faster strikes

  // exact.cpp
  void step_group(State<D>& state, double t, double h);
  void rates(double t, std::span<const double> d, std::span<const double> v, std::span<double> d_rate,
             std::span<double> v_rate) override;
  // bodies that touch may roll off an edge or begin to slip in a stage; ropes and limits that hold are found
  // anew from event to event
  bool smooth() const override {
    return std::none_of(constraints_.begin(), constraints_.end(), [](const Constraint& constraint) {
      return constraint.kind == Constraint::Kind::contact;
    });
  }
  bool tied() const override { return !constraints_.empty(); }
  void collect_bodies(State<D>& state);
  bool all_finite(const State<D>& state) const;
  double kinetic_energy(const State<D>& state) const;
  void save(const State<D>& state, Motion& motion) const;
  void restore(const Motion& motion, State<D>& state) const;
  void hold_again(State<D>& state);
  bool floats() const;
  void land(State<D>& state, double h);
  void step_by_impulses(State<D>& state, double t, double h);
  double time_unseen(const State<D>& state) const;
  void write_contacts(State<D>& state);
  void record_forces(const State<D>& state);
  Wrench<D> load(const Constraint& constraint) const;
  Wrench<D> load_of_coil(const State<D>& state, int joint) const;
  void release_contact();
  void break_joints(State<D>& state);
  bool break_loaded(State<D>& state, double done);
  void note_contacts(double begun, double ended);
  void note_motion(const State<D>& state, double begun, double ended);

  // groups.cpp
  void bound_travel(const State<D>& state, double t, double h);
  void join_near_bodies(const State<D>& state);
  void list_groups(const State<D>& state);
  void classify_sets(const State<D>& state);
  void find_reached();
  void number_groups();
  void list_members(const State<D>& state);
  void activate(const Group& group);
  void activate_all();
  void resize_for(State<D>& state);
  void write_lone_contacts(State<D>& state, int body);
  void measure_travel(const State<D>& state);
  void count_cut(int a, int b);
  int cuts_so_far() const;

  // constraints.cpp
  void update_poses(const State<D>& state);
  void pose_driven(double t);
  // what the motor of a constraint aims at, at the poses and the time at hand
  typename Motors<D>::Aim aim(const Constraint& constraint);
  // whether a joint holds anything that moves by forces
  bool moves(const Joint<D>& joint) const {
    return joint.any_body([&](int body) { return response_.moves(body); });
  }
  // whether a joint of a state holds anything that moves
  bool holds_any(const State<D>& state, int joint) const {
    if (state.broken[std::size_t(joint)] || one_with_another(state, std::size_t(joint))) return false;
    bool any = false;
    each_body_held(model_, state, std::size_t(joint), [&](int body) { any = any || response_.moves(body); });
    return any;
  }
  // a body of a row that moves by forces
  int mover(const Row<D>& row) const {
    return side_that(row, [&](int body) { return response_.moves(body); });
  }
  bool shifts(int body) const { return response_.moves(body) || drives_.number(body) >= 0; }
  BodyMotion<D> end_pose(const State<D>& state, int body) const;
  const BodyMotion<D>& pose(int body) const {
    static const BodyMotion<D> room;
    return body < 0 ? room : poses_[std::size_t(body)];
  }
  AngularVec<D> rounds_of(const State<D>& state, int body) const;
  double given(int row) const;
  double motor_power() const;
  void aim_at_end();
  JointTurn<D> turn_between(const State<D>& state, const Joint<D>& joint) const;
  JointTurn<D> turn_of(const State<D>& state, const Constraint& constraint) const;
  void collect_constraints(const State<D>& state, double fastest = 1e300, double reach = 0,
                           double near_ends = 0);
  void collect_returning(const State<D>& state, double t);
  void rebuild_rows(const State<D>& state);
  void build_jacobian(Constraint& constraint, const JointTurn<D>& turn);
  void build_blocks(bool impulses, double last = 0);
  void predict_velocities(std::span<const double> rate, double h);
  static constexpr int kMostRubs = 50;  // rounds of friction that goes by a load
  bool solve_laws(std::span<const double> rate);
  bool begin_to_slip();
  bool solve_modes(State<D>& state, double t);
  double loads() const;
  bool jammed() const;
  void warm_start_rows(double h);
  static bool holds(const Constraint& constraint, ModeKind kind);
  bool active(const Constraint& constraint) const {
    return holds(constraint, modes_[std::size_t(constraint.block)].kind);
  }
  double row_velocity(int row) const;
  // a way, speed or acceleration of a row, and a force or impulse, where rows are compared
  double in_metres(int row, double x) const {
    return x * sim::in_metres(rows_[std::size_t(row)], model_.scale);
  }
  double in_newtons(int row, double f) const {
    return f / sim::in_metres(rows_[std::size_t(row)], model_.scale);
  }
  double row_acceleration(int row, std::span<const double> rate) const;
  void add_accelerations(int row, double f, std::span<double> rate) const;
  void apply_impulses(State<D>& state, const Row<D>& row, double p, bool places);
  void project_state(State<D>& state, double h, bool impacts_follow = false);
  void pay_for_lift(State<D>& state);

  // chain_responses.cpp
  double self_coupling(int row) const;
  void apply_impulses(State<D>& state, bool places);
  void record_chain_forces();

  // slip.cpp
  double begin_slip_directions(State<D>& state, double t, double h);
  void aim_slow_slips(State<D>& state, double t, double h);
  void turn_slip_directions();

  // exact_islands.cpp
  void find_islands();
  void build_K();
  bool solve();
  static constexpr int kMostRoughSweeps = 4000;
  void solve_roughly(int most = kMostRoughSweeps);
  void solve_held();
  void solve_least_norm();
  template <class Solve>
  void each_island(std::vector<ConeMode<D>>& modes, Solve&& solve);

  // impacts.cpp
  double closing_speed(const Constraint& constraint) const;
  double closing_speed() const;
  bool coming_apart() const;
  void resolve_contact_impacts(State<D>& state);
  void keep_fastest_pair(const State<D>& state);
  void solve_impacts(State<D>& state, double bounce);
  void attempt_impacts(State<D>& state, double bounce);
  void record_impulse(const ContactKey& key, const Constraint& constraint, const Vec<D>& impulse);

  // exact_sleep.cpp
  bool wake_reached(State<D>& state, bool all);
  void find_contacts_awake(State<D>& state, double margin, bool all = false);
  bool wake_struck(State<D>& state);
  void wake_near_driven(State<D>& state, double t, double h);
  void put_to_sleep(State<D>& state, double t, double h);
  void find_accelerations(State<D>& state, double t);

  // events.cpp
  static constexpr double kNever = 2;  // a part of the interval
  double advance_to_event(State<D>& state, double t, double h, bool& cut);
  void integrate(State<D>& state, double t, double h);
  bool integrates(State<D>& state, double t, double h);
  void build_rows(const State<D>& state, double t);
  double first_event(const State<D>& state, double h, Couple& first, bool& passes, const Constraint*& stops);
  template <class Gap>
  double clipping_time(Gap&& gap, double from, double to, double at_from, double at_to);
  double closing_time(const State<D>& state, double h, Couple couple);
  double tightening_time(const State<D>& state, double h, Couple& first);
  static bool is_bounded(const Constraint& constraint) {
    return constraint.kind == Constraint::Kind::motor || constraint.kind == Constraint::Kind::friction;
  }
  double time_to_aims(State<D>& state, double t, double h);
  double slip_left(const Constraint& constraint);
  double stopping_time(const Constraint*& which);
  double stopping_length(State<D>& state, double t, const Constraint& which, double low, double high);
  void begin_again(State<D>& state, double t);
  double breaking_time(const State<D>& state, Couple& which) const;
  double travel(const State<D>& state, int body, double h) const;
  bool may_close(const State<D>& state, double h, Couple couple) const;
  JointTurn<D> turn_between_at(const State<D>& state, const Joint<D>& joint, double h, double part);
  void find_contacts(const State<D>& state, double margin);
  double gap_of(const ContactKey& key, double otherwise);
  template <class Found>
  void near_contacts(const std::vector<BodyMotion<D>>& at, Couple couple, double margin, Found&& found);
  BodyMotion<D> pose_at(const State<D>& state, int body, double h, double part);
  double force_couple(Couple couple);

  // face_ends.cpp
  double feature_time(const State<D>& state, double h);
  Vec<D> slid(const State<D>& state, Couple couple, const Vec<D>& place, double h, double from, double to);
  double end_of_faces(const State<D>& state, Couple couple, double h, double low);

  // releases.cpp
  double force_reserve(const Constraint& constraint, const Eigen::VectorXd& f) const;
  double release_time(const Constraint*& which);
  bool pulls_wildly() const;
  const Constraint* bears_alone(const ContactKey& key) const;
  double release_length(State<D>& state, double t, const Constraint& which, double low, double high);
  double let_go_at(State<D>& state, double t);
  double lawful_length(State<D>& state, double t, double length);

  // rails.cpp
  bool has_rails(int body) const {
    return body >= 0 && !limits_.rails.empty() && !limits_.rails[std::size_t(body)].empty();
  }
  void near_rails(const std::vector<BodyMotion<D>>& at, Couple couple, double margin);
  void known_places(const ContactKey& key, std::vector<double>& along) const;
  void choose_rail_contacts();
  double rail_closing_time(const State<D>& state, double h, Couple couple);
  double passing_time(const State<D>& state, double h);
  AngularVec<D> wire_pose(int joint) const;
  void follow_wires(const State<D>& state);
  bool rub(int round);
  void leave_wires(State<D>& state);
  void let_go_of_wires(State<D>& state);

  // whether a contact has more friction at hand than where it slips
  bool grips(const Constraint& contact) const {
    return material(candidates_[contact.of].key).friction < blocks_[contact.block].mu;
  }
  Material material(const ContactKey& key) const {
    if (const Rail<D>* rail = rail_of(model_, key))
      return mixed(Material(model_.bodies[rail->body == key.a ? key.b : key.a]), *rail);
    return sim::material(model_, key.a, key.b);
  }

  const Model<D>& model_;
  const MayTouch<D> may_touch_;
  Drives<D> drives_;
  Motors<D> motors_;
  double now_ = 0;  // s: the time of poses_
  const Limits limits_;
  Integrate* integrate_;
  ForwardDynamics<D> dynamics_;
  Stages stages_;
  Cone<D> cone_;
  Response<D> response_;
  Sleep<D> sleep_;

  Course<D>* course_ = nullptr;
  double stepped_ = 0;  // s: how far the group at hand has come in its step

  Step step_;
  Group active_;  // that is stepped
  Progress progress_;
  Interval interval_;
  Outcome outcome_;
  Scratch scratch_;

  // the present instant
  bool belts_ = false;                   // some bodies have one
  double still_speed_ = 0;               // m/s: slower is rounding, at the speeds at hand
  std::vector<BodyMotion<D>> poses_;     // one a body
  std::vector<DrivenMotion<D>> driven_;  // those of bodies that are moved, in the order of drives_
  std::vector<ContactCandidate<D>> candidates_;
  std::vector<int> on_piece_;  // of the joints of the group at hand, as State::on_piece
  std::vector<Constraint> constraints_;
  std::vector<Constraint> leaving_, returning_;  // see collect_constraints()
  std::vector<Row<D>> rows_;
  ChainResponse<D> chain_response_;  // of rows_
  std::vector<ConeBlock<D>> blocks_;
  std::vector<ConeMode<D>> modes_;
  Eigen::VectorXd b_, f_, warm_;  // warm_: forces to begin with
  // its islands, which share no body
  int islands_ = 0;
  std::vector<std::vector<int>> island_members_;  // of constraints_, one list an island
  Islands roots_;
  std::vector<int> island_of_;       // one a body
  std::vector<Vec<D>> corrections_;  // one a body, of this step, m: see corrections(); empty: none
};

// every gap below the margin, if they are near at all
template <int D>
template <class Found>
void ExactSolver<D>::near_contacts(const std::vector<BodyMotion<D>>& at, Couple couple, double margin,
                                   Found&& found) {
  const auto [a, b] = couple;
  scratch_.candidates.clear();
  if (b < 0) {
    const Wall<D>& wall = model_.walls[-1 - b];
    if ((at[a].x - wall.point).dot(wall.normal) > limits_.bounding_radius[a] + margin) return;
    sim::collide(a, model_.bodies[a].shape, at[a], -1 - b, wall, margin, scratch_.candidates);
  } else {
    const double far = limits_.bounding_radius[a] + limits_.bounding_radius[b] + margin;
    if ((at[a].x - at[b].x).squaredNorm() > far * far) return;
    if (model_.bodies[a].bare || model_.bodies[b].bare) return;
    sim::collide(a, model_.bodies[a].shape, at[a], b, model_.bodies[b].shape, at[b], margin,
                 scratch_.candidates);
  }
  for (const ContactCandidate<D>& gap : scratch_.candidates) found(gap);
}

}  // namespace obscura::sim
