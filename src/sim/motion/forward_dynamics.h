#pragma once

#include <array>
#include <span>
#include <vector>

#include "sim/force/close_passages.h"
#include "sim/force/explosion.h"
#include "sim/force/forces.h"
#include "sim/force/spring.h"
#include "sim/model/body_motion.h"
#include "sim/model/drives.h"
#include "sim/model/path.h"
#include "sim/motion/forced_flight.h"
#include "sim/motion/integrator.h"
#include "sim/motion/persistent_contact.h"
#include "sim/multibody/chains.h"

namespace obscura::sim {

/// Part of a model that moves by itself for a while, by number, ascending: bodies, the springs that end at
/// them, and the chains whose links they are.
struct Subset {
  std::span<const int> bodies, springs, chains;
};

/// The dynamics of all bodies that are coupled: those that springs, hands and forces act on, and the links of
/// chains. One system; d and v hold, one after another,
///   D numbers a body          displacement and velocity of its centre, room's frame
///   1 or 3 a turning body     rotation and spin; in space both in the body's frame, the spin relative to the
///                             base spin of sim/math/lie_step.h
///   chains                    joint coordinates
///   1, if any are kinematic   the work of kinematic bodies
/// So in space a row J of the room's frame multiplies to_room(room_from_body, v'), and a torque of the room's
/// frame adds from_room(room_from_body, torque) / inertia to v'.
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
  /// and are awake, as while an explosion acts; of `also` those that can move and are awake. Bodies with drag
  /// on the ground count too. To be called whenever a grip changes, a body falls asleep or wakes, or an
  /// explosion begins or ends.
  void gather(const State<D>& state, bool all_awake = false, std::span<const int> also = {});
  /// The same for a part of the model: all else stays out of it.
  void gather(const State<D>& state, const Subset& of);

  /// Marks those with springs and drag, and those that hands, forces and explosions act on: what moves them
  /// may depend on how they move.
  void mark_forced(const State<D>& state, std::vector<char>& forced) const;
  /// Contacts whose forces act on the gathered bodies too, until the next call; to be called after gather().
  void bear(const State<D>& state, std::span<const PersistentContact<D>> contacts);

  bool has(int body) const { return member_[body] >= 0; }
  const std::vector<int>& bodies() const { return bodies_; }
  /// The chains, whose links move with the bodies.
  Articulated<D>& chains() { return chains_; }
  const Articulated<D>& chains() const { return chains_; }

  /// Moves the coupled bodies of `state` from t to t + h, in pieces where they turn far or pass each other
  /// closely. `with`: the system to integrate instead of this one, one that adds forces to rates(), as
  /// ExactSolver adds those of contacts.
  void step(Integrate* integrate, State<D>& state, double t, double h, Stages& stages,
            System* with = nullptr);

  /// v' of the coupled bodies as they are at time t, in the order of d and v. Allocates nothing once
  /// gathered.
  std::span<const double> accelerations(const State<D>& state, double t);

  /// Pose and velocity of the coupled bodies at the stage that rates() saw last, of accelerations() or of a
  /// step() `with` another system: bodies(), then the links of chains().
  const std::vector<BodyMotion<D>>& stances() const { return stances_; }

  /// The kinematic bodies at the time that rates() saw last, in the order of Drives.
  const std::vector<DrivenMotion<D>>& driven() const { return driven_; }
  /// The work (J) of kinematic bodies in the last step(), and what `with` added at work_place().
  double work() const { return work_; }
  /// How long the last step() was for its forces: the largest Roughness::ratio, by Runge and Kutta's scheme.
  double rough() const { return rough_; }
  /// The index in v' of the power of kinematic bodies, W; negative: there are none.
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
  // one end of a tie: a point of a coupled body, a fixed place, a hand, or a point of a kinematic body
  struct Hold {
    int member = -1;             // place in bodies_, and from there on in links(); -1: not coupled
    int mouse = -1;              // the mouse that holds it; -1: none
    int drive = -1;              // the drive that moves its body; -1: none
    Vec<D> at = Vec<D>::Zero();  // in the body's frame; else a place in the room
  };
  struct Tie {
    Hold a, b;
    SpringLaw law;
  };
  // a side of a joint with a spring: a coupled, kinematic or still body
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
  // what nothing but contacts moves goes on as it did where the step began
  struct Coasting {
    BodyMotion<D> begun;
    Orientation<D> turn = no_rotation<D>();
    bool goes = false;
  };
  struct PersistentTie {
    PersistentContact<D> contact;
    JointSide a, b;
    Coasting a_coasts, b_coasts;
  };
  // a coupled body that the ground brakes
  struct Braked {
    int member;
    double rate;    // c/m, 1/s
    Vec<D> normal;  // of the ground
  };
  struct Moving {
    Vec<D> arm, place, velocity;
  };

  Hold hold(const State<D>& state, const End<D>& end) const;
  template <class Act>
  void each_forced(const State<D>& state, const Act& act) const;
  void gather_marked(const State<D>& state, const Subset& of);
  void load(const State<D>& state);
  int pieces(const State<D>& state, double h) const;
  void go(Integrate* integrate, State<D>& state, double t, double h, Stages& stages, System& rates);
  void fly(Integrate* integrate, State<D>& state, double t, double h, Stages& stages);
  void piece(Integrate* integrate, State<D>& state, double t, double h, Stages& stages, System& rates);
  Moving moving(const Hold& hold, double t) const;
  Coasting coasting(const State<D>& state, int body) const;
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
  bool books_ = false;  // some bodies are kinematic or have belts
  double rough_ = 0;
  double work_ = 0;
  bool posed_ = true;  // poses at each stage are asked for from outside
  Articulated<D> chains_;
  std::vector<int> bodies_;      // ascending: those that turn come last
  std::vector<int> member_;      // a body's place in bodies_, a link's after them, or -1
  std::vector<int> all_;         // bodies_ and the links
  std::vector<int> numbers_[3];  // of all bodies, springs, chains
  std::vector<Tie> ties_;        // springs in order, then mice in order
  std::vector<int> sprung_;      // joints with a spring
  std::vector<JointTie> joint_ties_;
  std::vector<PersistentTie> bearing_;
  std::array<std::vector<double>, 4> from_contacts_;  // of v', what these gave in the last stages
  int stage_ = 0;
  double begun_ = 0;  // s: the step
  bool ever_ = false, leaves_flying_ = false;
  bool only_forces_ = false, flying_ = false;  // nothing else of the model ties; all that is gathered flies
  Blasts<D> blasts_;
  Forces<D> forces_;
  ClosePassages<D> passages_;
  ForcedFlight<D> forced_flight_;
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
