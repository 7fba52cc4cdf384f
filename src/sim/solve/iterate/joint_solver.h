#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "sim/constraint/joints/joint.h"
#include "sim/constraint/joints/motors.h"
#include "sim/constraint/response.h"
#include "sim/math/block_factors.h"
#include "sim/math/full_rank.h"
#include "sim/model/drives.h"
#include "sim/model/state.h"
#include "sim/motion/forward_dynamics.h"

namespace obscura::sim {

/// Joints of the iterative solvers. All equality rows are solved at once, exactly, by a sparse factorisation,
/// in linear time if the joints form trees: as forces in each stage of the free motion, as impulses in each
/// iteration after it. Ropes, limits, motors and dry friction are rows with bounds, solved one after another,
/// each with the reaction of the equality rows to it. In the free motion a rope that is taut is an equality
/// as long as it pulls, a limit that is reached as long as it pushes, a motor that has its speed and friction
/// that sticks as long as they are strong enough, else they are known forces. What comes to its end there is
/// stopped by an impulse at that time.
template <int D>
class JointSolver final : public System {
 public:
  /// Kept by reference.
  explicit JointSolver(const Model<D>& model);

  bool empty() const { return model_.joints.empty(); }
  /// Whether no row has bounds in this step: then one iteration is as good as many.
  bool plain() const { return active_ == 0; }

  /// Bodies on joints, ascending. The caller writes pose, velocity and orientation of each, by its number in
  /// the model, before it calls what follows, and reads them after.
  const std::vector<int>& bodies() const { return bodies_; }
  bool has(int body) const { return member_[body] != 0; }
  BodyMotion<D>& body_motion(int body) { return at_[body]; }
  Orientation<D>& turn(int body) { return turn_[body]; }

  /// Sizes the joints' fields of a state that has not been stepped.
  void prepare(State<D>& state) const;

  /// Collects the joints that are not broken and hold awake bodies.
  void gather(const State<D>& state);

  /// Before the first step: projects the velocities onto J v = 0 by impulses of the joints. Needed because
  /// half the displacement of a step comes from the velocities at its start. False: they are as they were.
  bool project_initial_velocities(State<D>& state);

  /// Steps the bodies that `dynamics` has gathered from t to t + h, with the joints' forces in each stage of
  /// the integrator, and those of their limits, motors and friction. Returns the work of kinematic bodies and
  /// motors, J. After gather(), with kinematic bodies as they are at t.
  double step(ForwardDynamics<D>& dynamics, Integrate* integrate, State<D>& state, double t, double h,
              Stages& stages);
  /// The system of that step: what `dynamics` has, and f with J v' + J' v = 0.
  void rates(double t, std::span<const double> d, std::span<const double> v, std::span<double> d_rate,
             std::span<double> v_rate) override;
  bool tied() const override { return true; }

  /// Computes the rows at the present poses.
  void compute_rows();
  /// For impacts within a substep, of a solver of its own: the rows of a component, and of the ends that
  /// `begun` has for it, where its bodies stand `time` s after the substep began. place(body, pose, turn)
  /// writes where one stands then; it comes with what `begun` has of it. After forget_places() where the
  /// substep is another.
  template <class Place>
  void compute_rows_at(double time, JointSolver& begun, int component, Place&& place) {
    const std::span<const JointResponse> ends = begun.reached_ends(component);
    if (placed_at_[std::size_t(component)] == time) return;
    placed_at_[std::size_t(component)] = time;
    const auto put = [&](int body) {
      at_[body] = begun.at_[body], turn_[body] = begun.turn_[body];
      place(body, at_[body], turn_[body]);
    };
    for (const int body : members(component)) put(body);
    // and what is fixed or driven there
    for (const int body : bodies_)
      if (component_of_body_[std::size_t(body)] < 0) put(body);
    compute_rows(component);
    take_ends(begun, component, int(ends.size()));
  }
  void forget_places() { placed_at_.assign(std::size_t(components()), -1.0); }
  /// What impacts have given bodies, the velocities of body_motion(), belongs to what iterations keep; of the
  /// components that `struck` has been asked for. After keep_row_speeds().
  /// What ends, motors and friction have given until the last impact, of h s, they do not take back.
  void keep_struck_speeds(const JointSolver& struck, double h);
  /// From here on iterations keep J v as it is at the present velocities, those of the free motion; or at
  /// zero.
  void keep_row_speeds();
  void stop_rows() {
    std::fill(targets_.begin(), targets_.end(), 0.0);
    holds_.assign(model_.joints.size(), {});
  }
  /// Starts a step of h (s) from there, at time t. All forces begin at zero.
  void begin(double h, double t = 0);

  /// One iteration: velocities with J v as it was and rows within bounds; of all joints, or of one component.
  /// Joints of different components share no moving body. Component -1: ropes between bodies without other
  /// joints.
  void iterate();
  void iterate(int component) { iterate(component, false); }
  /// One iteration for position correction: the velocities of body_motion() are displacements. Leaves the
  /// impulses as they are.
  void solve_positions();
  /// Whether the last step() stopped a joint at its end, or a rope where it was taut, within itself: then
  /// bodies on joints have gone where no velocity of the step's ends leads.
  bool stopped() const { return stopped_; }
  /// What that has changed in all of the velocity, m/s, and spin, rad/s, of a body of bodies(); where
  /// stopped().
  const Vec<D>& jump(int body) const { return jumps_[std::size_t(body)]; }
  const AngularVec<D>& spin_jump(int body) const { return spin_jumps_[std::size_t(body)]; }
  int components() const { return factors_.components(); }
  /// The component of a body's joints, or -1.
  int component(int body) const { return component_of_body_[body]; }
  /// The components of the joints of these bodies, ascending, -1 among them. Valid until the next call.
  std::span<const int> components_of(std::span<const int> bodies);
  /// The bodies of a component, ascending.
  std::span<const int> members(int component) const { return members_[component]; }

  /// act(body) of a body and of all that hangs together with it on joints: one impact strikes them all.
  template <class Act>
  void each_tied(int body, Act&& act) const {
    if (empty() || component(body) < 0) return act(body);
    for (const int member : members(component(body))) act(member);
  }

  /// A row between two bodies, and the reaction of the joints to a unit of impulse along it. A body without
  /// joints may be one of the two; the caller writes its pose, where the row depends on it.
  struct JointResponse {
    Row<D> row;
    int components[2] = {-1, -1};   // of its bodies; the second, if it is another
    std::vector<double> answer[2];  // impulses of the rows of each, in the order of elimination
    std::vector<std::pair<int, double>> affected[2];  // which of them it moves by a unit, and how fast
  };
  /// Makes room for the reaction to any row, so that none allocates later.
  void reserve(JointResponse& response) const {
    for (int s = 0; s < 2; ++s)
      response.answer[s].reserve(rows_.size()), response.affected[s].reserve(rows_.size());
  }
  /// Computes the reaction to response.row. After compute_rows(), of the component of its bodies.
  void compute_response(JointResponse& response);
  /// Whether joints leave a row nothing to move; after compute_response().
  bool holds(const JointResponse& response) const { return effective_mass(response) == 0; }
  /// What the joints answer to an impulse along the row belongs to what they have given in the step.
  void answer(const JointResponse& response, double impulse) {
    for (int s = 0; s < 2; ++s) {
      each_row(response.components[s], [&](int k, int r) {
        impulses_[r] += response.answer[s][k] * impulse, totals_[r] += response.answer[s][k] * impulse;
      });
    }
  }
  /// The speed along the row of p by a unit of impulse along that of q, with the joints' reaction, 1/kg.
  double response_between(const JointResponse& p, const JointResponse& q) const;
  /// Whether joints leave the row of a response nothing to move where the substep begins, so that no push
  /// along it does anything. The row is to be that of then, too: of two times, what is rigid yields a little.
  bool locks(JointResponse& response) {
    compute_response(response);
    return effective_mass(response) == 0;
  }
  /// act(body, change of its velocity, of its spin) for an impulse along the row and the joints' reactions.
  template <class Act>
  void each_push(const JointResponse& response, double impulse, Act&& act) const {
    each_push(response.row, impulse, act);
    for (int s = 0; s < 2; ++s) {
      each_row(response.components[s],
               [&](int k, int r) { each_push(rows_[r], response.answer[s][k] * impulse, act); });
    }
  }

  /// Gives the bodies a motion that joints let them have, and that leaves still only rows along which none
  /// lets them move, and hardly any others. After compute_rows(); the caller writes velocities anew.
  void try_motion();
  /// Contacts along whose normals joints leave nothing to move: the forces that they bear beside the joints,
  /// N, which bear so much less, in what keep() writes. After find_end_forces().
  void share_loads(std::span<const JointResponse> contacts, std::span<double> forces, double h);

  /// The work of kinematic bodies by a unit of impulse along a row and by the joints' reactions to it, J.
  double given(const JointResponse& response) const;

  /// The limits of a component that are reached where a substep begins or its free motion leads, and its
  /// ropes that are taut there: of each its row, away from its end, and the reaction to it. They push bodies
  /// at once, as joints hold them, where these are struck. Found once a substep, after keep_row_speeds().
  std::span<const JointResponse> reached_ends(int component);
  /// J v of a row by the velocities of body_motion(), m/s or rad/s.
  double row_speed(const JointResponse& response) const { return row_speed(response.row); }
  double row_speed(const Row<D>& row) const { return speed(row, at_); }
  /// The work of kinematic bodies by a unit of impulse at an end, J.
  double given_at_end(const JointResponse& end) const { return given(end.row) + given(end); }

  /// After a step: projects positions onto C = 0 and velocities onto J v = 0 at the new positions.
  /// `least`: s, of a step that is part of one; what earlier steps have left is put back as within so long.
  void finish(double h, double least = 0);
  /// The work of kinematic bodies through joints, and of motors, in the step that was finished last, J.
  double given() const { return work_; }
  /// Bodies that rows with bounds have pushed, directly or through joints, since clear_pushed(), one a body;
  /// null: none.
  const std::vector<char>* pushed() const { return any_pushed_ ? &pushed_ : nullptr; }
  void clear_pushed() { pushed_.assign(member_.size(), 0), any_pushed_ = false; }
  /// How far the centre of a body of bodies() was moved then to project the positions, m.
  Vec<D> displacement(int body) const { return at_[body].x - unprojected_[body]; }

  /// act(row, spare) for each loaded row of a component. spare: the change of velocity that the row can still
  /// give within the step, its bound less its present impulse; infinite for equality rows and for loaded
  /// limits and ropes.
  template <class Act>
  void each_bearing(int component, Act&& act) const {
    each_row(component, [&](int, int r) {
      if (!loose_[std::size_t(r)]) act(rows_[r], kWithoutEnd);
    });
    for (int i = component_first_[component + 1]; i < component_first_[component + 2]; ++i) {
      const Bounded& b = bounded_[by_component_[i]];
      if (b.load == lower || b.load == upper) {
        if (b.impulse > 0) act(b.row, kWithoutEnd);
      } else {
        act(b.row, std::max(0.0, b.most - std::fabs(b.impulse)) / b.effective_mass);
      }
    }
  }

  /// The forces without contacts of the joints where a step has led, at time t, for keep().
  void find_end_forces(const State<D>& state, double t);
  /// Whether a joint may break, so that forces are asked for after each substep.
  bool may_break() const { return may_break_; }
  /// Writes forces into the state: those at the end of the step without contacts, and what contacts have
  /// changed of them, in the mean of the step. If `of` is given, those of the last iterations alone, of
  /// joints of the bodies it marks.
  void keep(State<D>& state, double h, const std::vector<char>* of = nullptr) const;

  /// Breaks joints that are loaded beyond their strength, from the next step on. True if one broke.
  bool break_joints(State<D>& state) const;

 private:
  static constexpr double kWithoutEnd = std::numeric_limits<double>::infinity();
  // of the scene's size: how far off joints may stay, and ropes and still be taut
  static constexpr double kPut = 1e-9, kTaut = 1e-8;
  static constexpr double kErrs = 1e-4;      // and by how much the integrator errs in a step at most
  static constexpr double kAims = 1e-6;      // of its speed: what a motor may be off it that has it
  static constexpr double kArrives = 1e-10;  // of its size, 1/s: slower a joint stays where it is
  static constexpr double kEndless = 1e300;

  // a row with bounds
  enum Load { lower, upper, motor, friction, none };  // a rope is an upper
  struct Bounded : JointResponse {
    int joint = 0;
    Load load = lower;
    double least = 0, most = 0, target = 0;  // N s or N m s; m/s or rad/s
    double effective_mass = 0;               // effective mass, with the joints' reaction
    double impulse = 0;
    double put = 0;                     // kg m or kg m^2: pseudo-impulse of the position projection
    bool put_back = false;              // by it, from beyond its end
    double at_end = 0, rate_there = 0;  // of that what the end of the step gave; of a motor its speed before
    double ends = 0;                    // rad or m: of a motor, the coordinate that its speed leads to
    double begun_drive_work = 0;  // work of kinematic bodies by a unit of impulse, at the start of the step
    int first = 0;                // start of its row in yields_
  };

  // An end that a joint may come to: of its length, way or angle, or of a speed that a motor or friction
  // changes.
  struct Stop {
    int block = 0;
    Load load = upper;
    double excess = 0;           // of the speed over its aim where the step ends
    double left = 0, speed = 0;  // m or rad, how far it is where an interval begins and how fast it leaves
    double sign = 1;             // of the speed, less its aim
    double ends = 0;             // m or rad: how far it is where the step ends
  };

  void plan();
  void compute_rows(int component);
  void find_reached_ends(int component);
  void take_ends(const JointSolver& begun, int component, int count);
  JointTurn<D> turn_between(const Joint<D>& joint) const;
  // whether a joint holds anything that moves by forces
  bool moves(const Joint<D>& joint) const {
    return joint.any_body([&](int body) { return response_.moves(body); });
  }
  Wound wound_of(std::size_t joint) const { return joint < wound_.size() ? wound_[joint] : Wound{}; }
  // the same with the pieces of a rope that are one with it; of one that is one with another nothing
  bool holds_any(int joint) const {
    const Wound rope = wound_of(std::size_t(joint));
    bool any = false;
    each_body_held(model_.joints[std::size_t(joint)], rope,
                   [&](int body) { any = any || response_.moves(body); });
    return any && rope.with >= 0;
  }
  const BodyMotion<D>& side(int body) const { return body < 0 ? room_ : at_[body]; }
  double row_acceleration(const Row<D>& row, std::span<const double> v_rate) const;
  double given(const Row<D>& row) const;
  // what a unit of force along a row of a joint puts on its a
  Wrench<D> load(int joint, const Row<D>& row) const {
    const Joint<D>& it = model_.joints[std::size_t(joint)];
    return load_on_a(it, row, side(it.a.body), side(it.b.body));
  }
  void push(const Row<D>& row, double impulse);
  template <class Act>
  void each_push(const Row<D>& row, double impulse, Act&& act) const {
    each_response(row, response_.of(row, at_), impulse,
                  [&](int body, const Vec<D>& dv, const AngularVec<D>& spin, double p) {
                    act(body, dv, AngularVec<D>(p * spin));
                  });
  }
  void shift(const Row<D>& row, double by);
  // rows of a component in the order of elimination: the k-th of it is row r
  template <class Act>
  void each_row(int component, Act&& act) const {
    if (component < 0) return;
    int k = 0;
    for (int place = factors_.begin(component); place < factors_.end(component); ++place) {
      const int block = factors_.at(place), first = factors_.first(block);
      for (int r = first; r < first + factors_.size(block); ++r) act(k++, r);
    }
  }
  void collect_bounded(double h);
  double effective_mass(const JointResponse& bounded) const;
  static bool within(const Bounded& b) { return b.impulse > b.least && b.impulse < b.most; }
  void renew(Bounded& bounded);
  bool update_bounded(double h);
  void couple_bounded();
  void push_bounded(int component);
  // last: none follows, so what holds is brought to rest exactly
  void iterate(int component, bool last);
  Bounded& together(std::size_t place) {
    return bounded_[std::size_t(by_component_[std::size_t(together_[place])])];
  }
  void couple_together(int begin);
  void solve_together();
  void solve_within(int begin, int end);
  void shift_bounded(Bounded& bounded, double by);
  double left(int joint, Load load) const;
  double left(const Stop& stop, double t);
  double excess(const Stop& stop, double t);
  double size(int joint) const;
  double in_metres(int joint) const;
  double fall(int joint) const;
  bool holding(const Bounded& bounded) const {
    return holds_[std::size_t(bounded.joint)].load == bounded.load;
  }
  // Whether an end that held through the free motion still does: if its speed is as that left it, it is off
  // by the integrator's error alone.
  bool held_there(const Bounded& bounded, double h) const {
    if (!holding(bounded)) return false;
    const double its = size(bounded.joint),
                 change = speed(bounded.row, at_) - holds_[std::size_t(bounded.joint)].target;
    return std::fabs(left(bounded.joint, bounded.load)) <=
           (h * std::fabs(change) <= kTaut * its ? kErrs : kTaut) * its;
  }
  int bounded_row(int block) const { return factors_.first(block) + factors_.size(block) - 1; }
  void bounded_row(int block, Load load, Row<D>& row) const;
  void set_poses(const State<D>& state, double t);
  // act(i, coordinate) for each joint with a motor that acts, at the poses at hand
  template <class Act>
  void each_motor(Act&& act) {
    for (std::size_t i = 0; i < model_.joints.size(); ++i) {
      const Joint<D>& joint = model_.joints[i];
      if (!joint.motor || broken_[i] || !moves(joint)) continue;
      Row<D> row;
      double value = 0;
      free_row(joint, side(joint.a.body), side(joint.b.body), turn_between(joint), row, value);
      act(i, Coordinate{value, speed(row, at_)});
    }
  }
  void begin_motors();
  void end_motors();
  bool has_speed(int joint, double rate, double aimed, double h) const {
    return std::fabs(rate - aimed) <=
           kAims * (std::fabs(aimed) + size(joint) * h * h) + kArrives * size(joint);
  }
  void free_row_of(int joint, Row<D>& row, double& value) const {
    const Joint<D>& it = model_.joints[std::size_t(joint)];
    free_row(it, side(it.a.body), side(it.b.body), turn_between(it), row, value);
  }
  bool choose_holding(double t, double h);
  void set_loose();
  void loosen_all();
  bool release();
  bool drop_puller();
  bool overrun(double t);
  void note_ends(double t);
  bool leaps(const State<D>& state, double h) const;
  double least_left(double t);
  double slow_end(int joint) const;
  bool goes_round(int joint, double way) const;
  double strike(State<D>& state, double t);
  double push_known(std::span<double> v_rate);
  void push_rates(const Row<D>& row, double f, std::span<double> v_rate);
  void solve_forces(double t, std::span<const double> v_rate);
  void save(const State<D>& state);
  void restore(State<D>& state) const;
  void put_motors();
  enum class PutEnds { held, beyond, again };
  void put_ends(double h, PutEnds which);
  bool ends_strayed() const;
  double close_joints();
  double position_error();
  bool near() const;
  void project_positions(double h);
  void damped_newton();
  void book(double h);

  const Model<D>& model_;
  Motors<D> motors_;
  double ends_ = 0;  // s: when the step ends
  double span_ = 0;  // s: how long it is
  BodyMotion<D> room_;
  std::vector<int> bodies_;
  std::vector<char> member_;
  std::vector<char> pushed_;
  bool any_pushed_ = false;
  std::vector<BodyMotion<D>> at_;
  std::vector<Orientation<D>> turn_;
  std::vector<BodyMotion<D>> begun_at_;  // before they are put back
  std::vector<Orientation<D>> begun_turn_;
  std::vector<BodyMotion<D>> again_at_;  // before ends are put again
  std::vector<Orientation<D>> again_turn_;
  std::vector<Vec<D>> unprojected_;  // centres before the positions were projected
  Response<D> response_;

  std::vector<char> broken_, frozen_;  // of the state, when plan() ran
  std::vector<Wound> wound_;           // as State::wound
  bool planned_ = false;
  std::vector<int> held_;              // joints: the blocks. A row that is loose is empty
  std::vector<char> loose_;            // one a row: of ropes, limits, motors; all but in the free motion
  std::vector<int> bounded_blocks_;    // whose last row is of a rope, a limit or a motor
  std::vector<char> has_bounded_row_;  // of blocks: whether they are among these
  struct ReachedEnds {
    bool known = false;  // in this substep
    int count = 0;
    std::vector<JointResponse> ends;          // the first `count` are in use
    std::vector<std::pair<int, Load>> which;  // of each its block, and as what it holds
  };
  std::vector<ReachedEnds> reached_;  // of components
  std::vector<double> left_;          // of components: what part of the substep is after their last impact
  std::vector<double> placed_at_;     // s, of components: when their rows are of; or negative
  std::vector<std::vector<int>> with_ends_;  // blocks with ropes or limits, of components
  std::vector<char> floating_;               // components: whether nothing holds them to what does not move
  bool may_break_ = false;
  std::vector<std::pair<int, int>> pairs_;  // of blocks that share a body that moves
  std::vector<int> component_of_body_;
  std::vector<std::vector<int>> members_;  // of components
  std::vector<int> some_parts_;
  Blocks<kMostHeld<D>> factors_;  // of K = J M^-1 J'
  std::vector<Row<D>> rows_, old_rows_;
  bool driven_ = false;  // some bodies are kinematic
  std::vector<double> drive_works_,
      begun_drive_works_;  // their work by a unit along each row: now, at the start of the step
  double work_ = 0;
  std::vector<double> impulses_, totals_, rhs_, shifts_, ways_;
  std::vector<double> targets_;  // of J v, m/s or rad/s
  // of the free motion
  Drives<D> drives_;
  ForwardDynamics<D>* dynamics_ = nullptr;  // while it is stepped
  const State<D>* begun_ = nullptr;
  bool first_stage_ = true, stopped_ = false;
  std::vector<Vec<D>> jumps_;  // bodies
  std::vector<AngularVec<D>> spin_jumps_;
  // Of the bounded row of a block, in the free motion.
  struct Acting {
    Load load = none;  // as which it is an equality
    bool released = false;
    double drive = 0, rub = 0;   // of a motor without its speed and of friction that slides, N or N m
    double first = 0, last = 0;  // of the equality in the first and last stage
    double spare = 0;            // the least in all stages that it was within its bounds
    double beyond = 0;           // the force of that stage
  };
  std::vector<Acting> acting_;  // one a block
  std::vector<Stop> stops_;
  std::vector<int> overrun_;  // numbers of stops_
  struct Hold {
    Load load = none;   // in the free motion
    double target = 0;  // m/s or rad/s: of J v
    // of motors and friction: what J v is to be for no excess of their speed where the step ends
    bool knows = false;
    double aims[4] = {};
    double given[4] = {};  // N or N m: what it has given as each load, in the mean
    double bends[2] = {};  // of a limit or rope: how much faster it closes in the end than on the way, < 0
  };
  std::vector<Hold> holds_;  // one a joint
  struct Saved {
    Vec<D> x = Vec<D>::Zero(), v = Vec<D>::Zero();
    Orientation<D> turn = no_rotation<D>();
    AngularVec<D> spin = AngularVec<D>::Zero();
    BodySpin<D> body_spin;
  };
  std::vector<Saved> saved_;  // bodies that are stepped
  LimitMet saved_rough_;      // and what the state had noted of them
  WildestStep saved_wildest_;
  struct Coordinate {
    double value = 0, rate = 0;  // rad or m; a second
  };
  // one a joint: of those with a motor, where the step begins, and the rate to which their free motion leads
  std::vector<Coordinate> begun_motors_;
  std::vector<double> free_motors_;
  std::vector<double> end_rates_;
  std::vector<Wrench<D>> end_loads_;  // of each joint of held_ at the end of the step, on a
  std::vector<double> end_forces_;    // of each row there
  std::vector<double> loads_;         // of each row, with contacts; N or N m
  std::vector<double> relief_;        // of each row: what contacts that it locks bear in its place
  std::vector<Bounded> bounded_;      // the first `active_` are in use
  std::size_t active_ = 0;
  std::vector<int> by_component_;     // numbers of them by component, those of component -1 first
  std::vector<int> component_first_;  // where each component begins there
  std::vector<double> yields_;        // of a component: the coupling of its rows with bounds
  std::vector<double> speeds_, changes_;
  std::vector<int> together_;  // of by_component_: rows that are solved together
  std::vector<double> coupling_, offs_, sizes_, puts_;
  FullRank ends_together_;
};

}  // namespace obscura::sim
