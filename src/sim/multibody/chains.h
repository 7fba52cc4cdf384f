#pragma once

#include <span>
#include <vector>

#include "sim/model/body_motion.h"
#include "sim/multibody/articulated_body.h"

namespace obscura::sim {

/// A link that weighs what the body weighs and has its frame: its joint and parent are the caller's.
template <int D>
Link<D> link_of(const Body<D>& body);

/// A chain of the model over links that are bodies already, link i being bodies[i]: marks those `linked`, and
/// gives the state its numbers, all joints at home and at rest.
template <int D>
void articulate(World<D>& world, std::vector<Link<D>> links, std::vector<int> bodies);

/// Builds chains from bodies and the joints between them as they stand: pins, hinges, sliders and welds, to
/// each other and to the room. Each connected part is a tree of its own; a part without a joint to the room
/// has a free first body. Joints that would close a loop, rods and ropes stay joints. Impulses between the
/// bodies project the velocities onto those that the joints allow. Requires that the bodies turn and that
/// none is fixed or already a link.
template <int D>
void articulate(World<D>& world, const std::vector<int>& bodies);

/// Sets poses and velocities of the links' bodies in `state` from its chain_states.
template <int D>
void follow(const Model<D>& model, State<D>& state);

/// Sets the joint velocities of the chains to those that their bodies have in `state`, projected onto what the
/// joints allow; and those of the bodies after them.
template <int D>
void take_velocities(const Model<D>& model, State<D>& state);

/// All chains of a model as one system in the displacements and velocities of their joints, with their
/// kinematics at an instant. Links are numbered as in links().
template <int D>
class Articulated {
 public:
  /// Kept by reference.
  explicit Articulated(const Model<D>& model);

  /// Chains that take part in all that follows: those of `chains` (numbers in the model) that are not frozen
  /// in `state`.
  void gather(const State<D>& state, std::span<const int> chains);

  /// The bodies of the chains that are awake, chain after chain.
  const std::vector<int>& links() const { return links_; }
  /// The index of a body in links(); -1 if it is not a link.
  int link(int body) const { return places_[body]; }
  /// How many numbers d and v have.
  int size() const { return size_; }

  /// Starts displacements d = 0 at `state`, and copies its joint velocities into v.
  void load(const State<D>& state, std::span<double> v);

  /// Computes kinematics and articulated inertias: displaced by d since load(), or as in `state`.
  void stand(std::span<const double> d, std::span<const double> v);
  void stand(const State<D>& state);

  /// Pose and velocity of a link.
  BodyMotion<D> body_motion(int link) const;

  /// Acceleration of a link at its centre where v' = 0.
  Twist<D> velocity_product(int link) const;

  /// J v: the velocity of each link at its centre.
  void motions(std::span<const double> v, std::vector<Twist<D>>& out);

  /// Adds J' w to `row`: the generalised force of a wrench w at the centre of a link.
  void add_row(int link, const Wrench<D>& wrench, std::span<double> row);

  /// M^-1 of a row. `change` may not be `row`.
  void respond(std::span<const double> row, std::span<double> change);

  /// Forces besides gravity, at the centres of links, for rates() and joint_loads(): sets them to zero; adds
  /// one.
  void clear_forces();
  void pull(int link, const Wrench<D>& wrench);

  /// d' of the displacement d and v' of v, at this stance.
  void rates(std::span<const double> d, std::span<const double> v, std::span<double> d_rate,
             std::span<double> v_rate);

  /// Writes into `loads` what each joint that a chain holds puts on its a at this stance, without its limits,
  /// motor, friction and spring: the force (N), and the torque about its place (N m).
  void joint_loads(std::vector<Wrench<D>>& loads);

  /// Writes the joint coordinates and velocities for d and v since load() into `state`.
  void give(std::span<const double> d, std::span<const double> v, State<D>& state);

  /// Adds `change` to the joint velocities of `state`; if `places`, to its joint coordinates.
  void jump(State<D>& state, std::span<const double> change, bool places) const;

  /// Sets the joint coordinates of `state` to those in `begun` plus h (s) times the mean of the velocities in
  /// `begun` and in `state`.
  void advance(const std::vector<ChainState>& begun, double h, State<D>& state);

  /// Sets the links' bodies of `state` from its chain_states, and computes the kinematics there.
  void follow(State<D>& state);

 private:
  struct Tree {
    const Articulation<D>* of;
    bool awake = true;
    int start = 0, first = 0;       // of its numbers in d and v, of its links in links(); where it is awake
    std::vector<double> q, held;    // where displacements begin, and at the stage at hand
    std::vector<double> v;          // at the stage at hand
    std::vector<double> tau, rate;  // tau: none
    ChainKinematics<D> stance;
    ChainDynamics<D> dynamics;

    const Chain<D>& chain() const { return *of->tree; }
    template <class Numbers>
    Numbers own(Numbers all) const {
      return all.subspan(std::size_t(start), std::size_t(chain().velocities()));
    }
  };
  struct Where {
    int tree, link;
  };

  void stand(Tree& tree, std::span<const double> q, std::span<const double> v);
  void show(const Tree& tree, std::span<const double> q, State<D>& state) const;

  const Model<D>& model_;
  std::vector<Tree> trees_;
  std::vector<int> links_, places_;  // places_: one a body
  std::vector<Where> where_;         // one a link of links()
  int size_ = 0;
  std::vector<double> part_;
};

}  // namespace obscura::sim
