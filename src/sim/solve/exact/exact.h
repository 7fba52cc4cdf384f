#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sim/collide/may_touch.h"
#include "sim/constraint/joints/joint.h"
#include "sim/constraint/material.h"
#include "sim/constraint/response.h"
#include "sim/math/islands.h"
#include "sim/motion/forward_dynamics.h"
#include "sim/solve/contact_solver.h"
#include "sim/solve/exact/cone.h"

namespace obscura::sim {

/// The direct solver: contact and joint forces are part of the Runge-Kutta stages, found exactly
/// (sim/solve/exact/cone.h). A step is cut where something closes, opens, slips or stops: in `event` always,
/// in `contact` where it closes or stops, and a bounded number of times for each body. Bodies that cannot
/// meet in a step are stepped apart, so that the cuts of one are none of the other's. For scenes of up to
/// some hundred rows.
template <int D>
class ExactSolver final : public ContactSolver<D>, private System {
 public:
  /// Whom it serves: all bodies, or single ones of a model that another solver serves.
  enum class Serves { all, lone };

  /// Both are kept by reference.
  ExactSolver(const Model<D>& model, const std::vector<Path<D>>& paths, Serves whom = Serves::all);

  /// Moves `state` from t to t + h: its bodies, contacts, and which bodies sleep.
  void step(State<D>& state, double t, double h) override;

  /// Moves one body that meets nothing but walls and fixed bodies, and tells its contacts in `state` that are
  /// there already what they bear. Of Serves::lone.
  void step_alone(State<D>& state, int body, double t, double h);

 private:
  // something that keeps rows at the instant at hand
  struct Held {
    enum class Kind { contact, joint, rope, lower, upper, motor, friction };
    Kind kind = Kind::contact;
    int of = 0;                 // gap or joint
    int first = 0, rows = 0;    // in rows_
    int block = 0;              // in blocks_, its first
    double off = 0;             // of a gap or limit: what is left, m or rad
    double offs[kMostHeld<D>];  // of a joint: how far its rows are from where they belong
    Vec<D> point = Vec<D>::Zero(), normal = Vec<D>::Zero();  // of a contact
    Vec<D> slip = Vec<D>::Zero();  // of a contact that slides, its way where the stretch begins, room's frame
    bool slow = false;             // its way is that for all of the stretch
  };

  // how bodies stand and move
  struct Motion {
    std::vector<Vec<D>> x, v;
    std::vector<Orientation<D>> turn;
    std::vector<AngularVec<D>> spin;
    std::vector<BodySpin<D>> own;
    std::vector<ChainState> postures;
  };

  // two that may come through each other: a body and a body or wall
  struct Couple {
    int a, b;
  };

  // a part of the room that nothing joins to the rest in this step; its members lie in the lists of group_*
  struct Group {
    int root = 0;  // the lowest of its bodies, which tells it from others
    Subset subset;
    std::span<const int> joints;
    std::span<const Couple> couples;
    bool lone = false;  // one body, that nothing but walls can meet
  };

  // exact.cpp
  void advance(State<D>& state, double t, double h);
  void rates(double t, std::span<const double> d, std::span<const double> v, std::span<double> d_rate,
             std::span<double> v_rate) override;
  void ready(State<D>& state);
  bool sound(const State<D>& state) const;
  double motion(const State<D>& state) const;
  void keep(const State<D>& state, Motion& motion) const;
  void restore(const Motion& motion, State<D>& state) const;
  void settle(State<D>& state, double t, double h);
  double unseen(const State<D>& state) const;
  void report(State<D>& state);
  void remember();
  void part_ways();
  void break_joints(State<D>& state);

  // groups.cpp
  void bound_ways(const State<D>& state, double t, double h);
  void join_near(const State<D>& state);
  void list_groups(const State<D>& state);
  void enter(const Group& group);
  void enter_all();
  void begin_groups(State<D>& state);
  void measure_ways(const State<D>& state);
  void charge(int a, int b);
  int most_spent() const;

  // constraints.cpp
  void stand(const State<D>& state);
  AngularVec<D> turn_between(const State<D>& state, const Joint<D>& joint) const;
  void gather(const State<D>& state, bool all);
  void lay_rows(Held& held, const AngularVec<D>& turn);
  void lay_blocks(bool impulses);
  bool choose(State<D>& state, double t);
  bool jammed() const;
  void guess(double h);
  bool acts(const Held& held) const;
  double moves(int row) const;
  double along(int row, std::span<const double> rate) const;
  void push(int row, double f, std::span<double> rate) const;
  void jump(State<D>& state, const Row<D>& row, double p, bool places) const;
  void project(State<D>& state, bool impacts_follow = false);
  void pay_for(State<D>& state);

  // chain_responses.cpp
  double answer(int row) const;
  void jump(State<D>& state, bool places);
  void chain_forces();

  // slip.cpp
  void begin_slides(State<D>& state, double t, double h);
  void aim_slow_slides(State<D>& state, double t, double h);
  void turn_slides();

  // islands.cpp
  void split();
  void assemble();
  bool solve();
  void sweep(int sweeps);
  void hold();
  void least();
  template <class Solve>
  void each_part(std::vector<ConeMode<D>>& modes, Solve&& solve);

  // impacts.cpp
  double approach() const;
  bool coming_apart() const;
  void resolve_impacts(State<D>& state);
  void only_worst_pair();
  void strike(State<D>& state, double bounce);
  void note(const ContactKey& key, const Held& held, const Vec<D>& impulse);

  // sleep.cpp
  void join(const State<D>& state);
  bool wake(State<D>& state);
  void rest(State<D>& state, double t, double h);

  // events.cpp
  double stretch(State<D>& state, double t, double h, bool& cut);
  void smooth(State<D>& state, double t, double h);
  double crossing(const State<D>& state, double h, Couple& first);
  double closing(const State<D>& state, double h, Couple couple);
  double tightening(const State<D>& state, double h, Couple& first);
  double stopping(Couple& first) const;
  double grasp(const Held& held, const Eigen::VectorXd& f) const;
  double letting_go(const Held*& which);
  double way(const State<D>& state, int body, double h) const;
  bool may_close(const State<D>& state, double h, Couple couple) const;
  AngularVec<D> turn_part(const State<D>& state, const Joint<D>& joint, double h, double part) const;
  void find(const State<D>& state, double margin);
  double gap_of(const ContactKey& key, double otherwise);
  template <class Found>
  void near(const std::vector<BodyMotion<D>>& at, Couple couple, double margin, Found&& found);
  BodyMotion<D> between(const State<D>& state, int body, double h, double part) const;

  Material material(const ContactKey& key) const { return sim::material(model_, key.a, key.b); }

  const Model<D>& model_;
  MayTouch<D> may_touch_;
  Integrate* integrate_;
  ForwardDynamics<D> free_;
  Stages stages_;
  Cone<D> cone_;

  int row_joints_ = 0;                   // that no chain holds
  double closed_ = 0;                    // m: gaps up to this touch
  double rest_ = 0;                      // m/s: slower impacts do not bounce
  double pace_ = 0;                      // m/s: sqrt(g L), or L a second
  double still_ = 0;                     // m/s: slower is not at all, at the speeds at hand
  int most_cuts_ = 0;                    // of a step, by one body among others
  int most_openings_ = 0;                // cuts of a step by what lets go
  int patience_ = 0;                     // cuts of a step by one body before rest begins to grow
  double budget_ = 0;                    // rows^3 that a step may solve before it is done roughly
  double short_ = 0;                     // of a step: what is done at once where there is no other way
  std::vector<double> bounding_radius_;  // how far each body reaches, m
  std::vector<double> half_thickness_;   // of each body, m; 0 of a point
  std::vector<Couple> couples_;          // bodies that may touch others, or walls

  // groups of a step: the members of each lie side by side in these lists
  Group active_;  // that is stepped
  std::vector<Group> groups_;
  std::vector<int> every_body_, every_joint_, every_spring_, every_chain_;
  std::vector<int> group_bodies_, group_joints_, group_springs_, group_chains_;
  std::vector<Couple> group_couples_;
  std::vector<int> lone_body_, fixed_;  // of Serves::lone: the body at hand; the fixed ones
  Islands near_;
  std::vector<int> group_of_, old_root_;  // one a body: its group, and the root of the one it was stepped in
  std::vector<int> group_sizes_, group_ends_;
  std::vector<char> kinds_;
  Couple charged_{-1, -1};       // the pair whose event ended the last interval
  std::vector<double> reach_;    // m: how far from where the step began each body may get
  std::vector<double> strayed_;  // m: how far each has got
  std::vector<int> spent_;       // one a body: cuts of this step that it took part in
  std::vector<char> frozen_then_;
  std::vector<double> quiet_then_;
  Motion first_;  // where the step began

  // of the instant at hand
  std::vector<BodyMotion<D>> stances_;  // one a body
  Response<D> response_;
  std::vector<ContactCandidate<D>> gaps_, some_;
  std::vector<Held> held_;
  std::vector<Row<D>> rows_;
  ChainResponse<D> chain_response_;  // of rows_
  std::vector<double> chain_change_;
  std::vector<Twist<D>> motions_;  // of the links
  std::vector<ConeBlock<D>> blocks_;
  std::vector<ConeMode<D>> modes_, holding_;  // as chosen, and as the stages keep them
  std::vector<ConeBlock<D>> chosen_blocks_;
  std::vector<ConeMode<D>> chosen_modes_;
  Eigen::VectorXd chosen_f_;
  // parts that share no body
  int parts_ = 0;
  std::vector<std::vector<int>> members_;  // of held_, one list a part
  Islands roots_;
  std::vector<int> part_of_, part_rows_, part_chosen_;
  std::vector<ConeBlock<D>> part_blocks_;
  std::vector<ConeMode<D>> part_modes_;
  std::vector<char> wanted_;
  Eigen::MatrixXd K_;  // of the part at hand
  Eigen::VectorXd part_b_, part_f_;
  Eigen::VectorXd b_, f_, warm_;      // warm_: forces to begin with
  Eigen::VectorXd slips_;             // J v where the stretch began
  Eigen::VectorXd pressed_;           // f there
  int openings_ = 0;                  // how many more may cut this step
  double slight_ = 0;                 // N: less presses nothing
  double grasp_at_let_go_ = 0;        // N: what it had left when that stretch began
  std::optional<ContactKey> let_go_;  // what the last stretch ended by
  std::vector<int> chosen_;
  Islands islands_;
  std::vector<char> ripe_;
  std::vector<double> rate_;
  std::vector<ContactKey> vague_;            // contacts whose opening is not looked for in this step
  std::vector<std::pair<int, int>> forced_;  // couples that would come through each other at once
  bool forced_again_ = false;
  bool rough_ = false;  // of this step: forces by sweeps from here on
  double work_ = 0;     // of this step: rows^3 solved
  double looks_ = 0;    // of this step: how often more than once a stretch couples were looked at
  Motion begun_, saved_, put_;
  Eigen::VectorXd ways_;
  std::vector<Vec<D>> placed_;  // x before places are put right
  // of the group at hand, then of the step. known_: sorted contacts to begin with
  std::vector<Contact<D>> contacts_, impulses_, all_contacts_, all_impulses_;
  const std::vector<Contact<D>>* known_ = nullptr;
  std::vector<Vec<D>> joint_forces_;  // of this step
};

}  // namespace obscura::sim
