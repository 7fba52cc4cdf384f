#pragma once

#include <span>
#include <vector>

#include "sim/force/explosion.h"
#include "sim/force/forces.h"
#include "sim/force/spring.h"
#include "sim/model/drives.h"
#include "sim/model/path.h"
#include "sim/model/stance.h"
#include "sim/motion/integrator.h"
#include "sim/multibody/chains.h"

namespace obscura::sim {

/// Part of a model that moves by itself for a while, by number, ascending: bodies, the springs that end at
/// them, and the chains whose links they are.
struct Subset {
  std::span<const int> bodies, springs, chains;
};

/// The bodies that springs, hands and forces act on and the links of chains, gathered into one system: first
/// the centres, then the orientations of bodies that turn, then the joints of the chains. In space d and v of
/// an orientation are in the body's frame, and v is relative to the base spin (sim/math/lie_step.h): a row J
/// in the room's frame multiplies to_room(room_from_body, v'), and a torque adds from_room(room_from_body,
/// torque) / inertia.
template <int D>
class ForwardDynamics final : public System {
 public:
  /// `paths`: the way of each mouse. Both are kept by reference.
  ForwardDynamics(const Model<D>& model, const std::vector<Path<D>>& paths);

  /// From here on gather() leaves out bodies that fly (Forces::flies), but where an explosion acts.
  void leave_flying() { leaves_flying_ = true; }

  /// Whether anything of the model may ever tie a body.
  bool ever() const { return ever_; }

  /// Collects the bodies that springs, mice and forces act on in `state`; with `all_awake` all that can move
  /// and are awake, as while an explosion acts. Bodies with drag on the ground count too. To be called
  /// whenever a grip changes, a body falls asleep or wakes, or an explosion begins or ends.
  void gather(const State<D>& state, bool all_awake = false);
  /// The same for a part of the model: all else stays out of it.
  void gather(const State<D>& state, const Subset& of);

  bool has(int body) const { return member_[body] >= 0; }
  const std::vector<int>& bodies() const { return bodies_; }
  /// The chains, whose links move with the bodies.
  Articulated<D>& chains() { return chains_; }
  const Articulated<D>& chains() const { return chains_; }

  /// Moves the tied bodies of `state` from t to t + h; under more forces than those of springs, `with` has
  /// the rates.
  void step(Integrate* integrate, State<D>& state, double t, double h, Stages& stages,
            System* with = nullptr);

  /// v' of the tied bodies as they are at time t, in the order of d and v. Allocates nothing once gathered.
  std::span<const double> accelerations(const State<D>& state, double t);

  /// How the tied bodies stand and move at the stage that rates() saw last: bodies(), then the links of
  /// chains().
  const std::vector<BodyMotion<D>>& stances() const { return stances_; }

  /// The bodies that are moved, at the time that rates() saw last; in the order of Drives.
  const std::vector<DrivenMotion<D>>& driven() const { return driven_; }
  /// What those, and whatever else is booked at work(), did in the last step(), J.
  double work() const { return work_; }
  /// Where v' has the power of that, W; negative: nowhere.
  int work_place() const { return books_ ? chain_start() + chains_.size() : -1; }

  /// How many numbers d and v have: D of each body, then the spins of those that turn, then the chains', then
  /// the work of bodies that are moved.
  int size() const { return int(v_.size()); }
  int chain_start() const { return D * int(bodies_.size()) + kAngular<D> * turning_; }
  /// The index at which the spin of the body at `place` in bodies() starts; negative: it does not turn.
  int spin_start(int place) const {
    const int spinning = place - (int(bodies_.size()) - turning_);
    return spinning < 0 ? -1 : D * int(bodies_.size()) + kAngular<D> * spinning;
  }
  int place(int body) const { return member_[body]; }

  void rates(double t, std::span<const double> d, std::span<const double> v, std::span<double> d_rate,
             std::span<double> v_rate) override;

 private:
  // one end of a tie: a point of a tied body, a place that stays, or a hand
  struct Hold {
    int member = -1;             // place in bodies_, and from there on in links(); -1: not a tied body
    int mouse = -1;              // the mouse that holds it; -1: none
    int drive = -1;              // the body of that is moved; -1: none
    Vec<D> at = Vec<D>::Zero();  // in the body's frame; else a place in the room
  };
  struct Tie {
    Hold a, b;
    SpringLaw law;
  };
  // a side of a joint with a spring: a tied body, one that is moved, or one that stands still
  struct JointSide {
    int member = -1, drive = -1, body = -1;
    BodyMotion<D> still;
    Rotation<D> begun = Rotation<D>::Identity();   // as the step began
    AngularVec<D> rounds = AngularVec<D>::Zero();  // and its angle then, in the plane
  };
  struct JointTie {
    int joint;
    JointSide a, b;
  };
  // a tied body that the ground brakes
  struct Braked {
    int member;
    double rate;    // c/m, 1/s
    Vec<D> normal;  // of the ground
  };
  struct Moving {
    Vec<D> arm, place, velocity;
  };

  Hold hold(const State<D>& state, const End<D>& end) const;
  void gather_marked(const State<D>& state, const Subset& of);
  void load(const State<D>& state);
  int pieces(const State<D>& state, double h) const;
  void fly(Integrate* integrate, State<D>& state, double t, double h, Stages& stages);
  void piece(Integrate* integrate, State<D>& state, double t, double h, Stages& stages, System& rates);
  Moving moving(const Hold& hold, double t) const;
  JointSide joint_side(const State<D>& state, int body) const;
  const BodyMotion<D>& motion_of(const JointSide& side) const;
  AngularVec<D> rounds_of(const JointSide& side) const;
  double push_joint(const JointTie& tie, std::span<double> v_rate);
  void push(const Hold& hold, const Vec<D>& arm, const Vec<D>& force, std::span<double> v_rate);
  void push(int member, const Wrench<D>& by, std::span<double> v_rate);

  const Model<D>& model_;
  const std::vector<Path<D>>& paths_;
  Drives<D> drives_;
  std::vector<DrivenMotion<D>> driven_;
  bool books_ = false;  // some bodies are moved, or move what touches them
  double work_ = 0;
  Articulated<D> chains_;
  std::vector<int> bodies_;      // ascending: those that turn come last
  std::vector<int> member_;      // a body's place in bodies_, a link's after them, or -1
  std::vector<int> all_;         // bodies_ and the links
  std::vector<int> numbers_[3];  // of all bodies, springs, chains
  std::vector<Tie> ties_;        // springs in order, then mice in order
  std::vector<int> sprung_;      // joints with a spring
  std::vector<JointTie> joint_ties_;
  bool ever_ = false, leaves_flying_ = false;
  bool only_forces_ = false, flying_ = false;  // nothing else of the model ties; all that is gathered flies
  Blasts<D> blasts_;
  Forces<D> forces_;
  std::vector<Wrench<D>> pushes_;  // of forces_, one a member
  SupportVertices<D> tips_;
  std::vector<int> acting_;             // explosions that act
  std::vector<Wrench<D>> held_;         // by the paper's scheme, one a member; empty where nothing is
  std::vector<int> dragged_;            // members with drag on the ground
  std::vector<Braked> braked_;          // those that stand on it
  std::vector<double> gravity_, drag_;  // a component each; drag_ empty where there is none
  int turning_ = 0;                     // how many turn
  std::vector<int> wheels_;             // bodies that no step may turn far in one piece

  std::vector<Vec<D>> x_;  // where the step began
  std::vector<Orientation<D>> turn_;
  std::vector<AngularVec<D>> base_;     // see sim/math/lie_step.h
  std::vector<BodyMotion<D>> stances_;  // at the stage at hand
  std::vector<double> d_, v_, d_rate_, v_rate_;
};

}  // namespace obscura::sim
