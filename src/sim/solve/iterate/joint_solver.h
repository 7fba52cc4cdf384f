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
#include "sim/model/state.h"

namespace obscura::sim {

/// Joints as the iterative solver holds them. What they keep as equalities is solved all at once, exactly, by
/// a sparse factorisation: linear in the number of joints where they form trees. Ropes, limits, motors and
/// dry friction are rows with bounds, one after another, each with what the joints answer to it.
template <int D>
class JointSolver {
 public:
  /// Kept by reference.
  explicit JointSolver(const Model<D>& model);

  bool empty() const { return model_.joints.empty(); }
  /// Whether no row has bounds in this step: then one iteration is as good as many.
  bool plain() const { return active_ == 0; }

  /// Bodies that joints have, ascending; how each stands and moves, by its number in the model, and its turn:
  /// written by the caller before and read after each of what follows.
  const std::vector<int>& bodies() const { return bodies_; }
  bool has(int body) const { return member_[body] != 0; }
  BodyMotion<D>& body_motion(int body) { return at_[body]; }
  Orientation<D>& turn(int body) { return turn_[body]; }

  /// Makes room for the joints in a state that no step has seen yet.
  void prepare(State<D>& state) const;

  /// Which joints hold in this state.
  void gather(const State<D>& state);

  /// Before the first step: velocities with which no joint comes apart, by the impulses of its joints. A step
  /// goes half its way with the velocities it begins with.
  void project_initial_velocities(State<D>& state);

  /// Rows where bodies stand now.
  void compute_rows();
  /// A step of h (s) from there, and from time t. All forces begin at zero.
  void begin(double h, double t = 0);

  /// Velocities under which no joint comes apart: of all, or of one component. What shares no body that moves
  /// is a component; component -1: of ropes between bodies that nothing else joins.
  void iterate();
  void iterate(int component);
  /// The same once, of velocities that are none: places that are put right. Impulses stay as they are.
  void solve_positions();
  int components() const { return factors_.components(); }
  /// The component that a body's joints are of, or -1.
  int component(int body) const { return component_of_body_[body]; }
  /// The components of the joints of these bodies, ascending, -1 among them. Valid until the next call.
  std::span<const int> components_of(std::span<const int> bodies);
  /// The bodies of a component, ascending.
  std::span<const int> members(int component) const { return members_[component]; }

  /// A push of two bodies along a row, and what the joints answer to a unit of it. A body without joints may
  /// be pushed too: its stance is the caller's to write, where that has a say.
  struct JointResponse {
    Row<D> row;
    int components[2] = {-1, -1};   // of its bodies; the second, if it is another
    std::vector<double> answer[2];  // impulses of the rows of each, in the order of elimination
    std::vector<std::pair<int, double>> affected[2];  // which of them it moves by a unit, and how fast
  };
  /// Fills in what is not the row, once rows are laid.
  void compute_response(JointResponse& response);
  /// How fast the row of one moves by a unit of the other, joints answering, 1/kg.
  double response_between(const JointResponse& p, const JointResponse& q) const;
  /// act(body, change of its velocity, of its spin) for an impulse, and for what answers it.
  template <class Act>
  void each_push(const JointResponse& response, double impulse, Act&& act) const {
    each_push(response.row, impulse, act);
    for (int s = 0; s < 2; ++s) {
      each_row(response.components[s],
               [&](int k, int r) { each_push(rows_[r], response.answer[s][k] * impulse, act); });
    }
  }

  /// What bodies that are moved give by a unit of impulse along a row, and by what joints answer to it, J.
  double given(const JointResponse& response) const;

  /// After a step: places back onto the joints, velocities along them where bodies now stand.
  void finish(double h);
  /// What bodies that are moved have given through joints in the step that was finished last, J.
  double given() const { return work_; }

  /// act(row, how much faster it could make it within the step, beside what it bears) for each row of a
  /// component that bears something: without end of what joints keep and of limits and ropes that are pulled
  /// at.
  template <class Act>
  void each_bearing(int component, Act&& act) const {
    each_row(component, [&](int, int r) { act(rows_[r], kWithoutEnd); });
    for (int i = component_first_[component + 1]; i < component_first_[component + 2]; ++i) {
      const Bounded& b = bounded_[by_component_[i]];
      if (b.load == lower || b.load == upper) {
        if (b.impulse > 0) act(b.row, kWithoutEnd);
      } else {
        act(b.row, std::max(0.0, b.most - std::fabs(b.impulse)) / b.give);
      }
    }
  }

  /// Forces of the step into the state; only of joints of the bodies marked in `of`, where that is given.
  void keep(State<D>& state, double h, const std::vector<char>* of = nullptr) const;

  /// Joints that are loaded beyond what they bear are no more from the next step on. True where one broke.
  bool break_joints(State<D>& state) const;

 private:
  static constexpr double kWithoutEnd = std::numeric_limits<double>::infinity();

  // what keeps within bounds
  enum Load { lower, upper, motor, friction };  // a rope is an upper
  struct Bounded : JointResponse {
    int joint = 0;
    Load load = lower;
    double least = 0, most = 0, target = 0;  // N s or N m s; m/s or rad/s
    double give = 0;                         // what a unit of impulse changes, joints answering, inverted
    double impulse = 0;
    bool taut = false;  // a rope that is at its length when the step begins
    double put = 0;     // kg m: what put its bodies back where the step had left the rope too long
    double gave = 0;    // what bodies that are moved gave by a unit of impulse as the step began
    int first = 0;      // of its row in yields_
  };

  void plan();
  AngularVec<D> turn_between(const Joint<D>& joint) const;
  // whether a joint holds anything that moves by forces
  bool moves(const Joint<D>& joint) const {
    return joint.any_body([&](int body) { return response_.moves(body); });
  }
  const BodyMotion<D>& side(int body) const { return body < 0 ? room_ : at_[body]; }
  double given(const Row<D>& row) const;
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
  double give(const Bounded& bounded) const;
  bool update_bounded();
  void couple_bounded();
  void push_bounded(int component);
  void shift_bounded(const Bounded& bounded, double by);
  bool left(const Bounded& bounded, double& off) const;
  double position_error();
  bool near() const;
  void project_positions(double h);
  void damped_newton();
  void book();

  const Model<D>& model_;
  Motors<D> motors_;
  double ends_ = 0;  // s: when the step ends
  BodyMotion<D> room_;
  std::vector<int> bodies_;
  std::vector<char> member_;
  std::vector<BodyMotion<D>> at_;
  std::vector<Orientation<D>> turn_;
  std::vector<BodyMotion<D>> begun_at_;  // before they are put back
  std::vector<Orientation<D>> begun_turn_;
  Response<D> response_;

  std::vector<char> broken_, frozen_;  // that the plan is of
  bool planned_ = false;
  std::vector<int> held_;                   // joints with equalities: the blocks
  std::vector<std::pair<int, int>> pairs_;  // of blocks that share a body that moves
  std::vector<int> component_of_body_;
  std::vector<std::vector<int>> members_;  // of components
  std::vector<int> some_parts_;
  Blocks<kMostHeld<D>> factors_;  // of K = J M^-1 J'
  std::vector<Row<D>> rows_, old_rows_;
  bool driven_ = false;               // some bodies are moved
  std::vector<double> gives_, gave_;  // what those give by a unit along each row, now and then
  double work_ = 0;
  std::vector<double> impulses_, totals_, rhs_, shifts_, ways_;
  std::vector<Bounded> bounded_;  // the first `active_`
  std::size_t active_ = 0;
  std::vector<int> by_component_,
      component_first_;         // of them, those of component -1 first; where each component's begin
  std::vector<double> yields_;  // of a component: what its rows with bounds do to each other
  std::vector<double> speeds_, changes_;
};

}  // namespace obscura::sim
