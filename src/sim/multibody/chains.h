#pragma once

#include <span>
#include <vector>

#include "sim/model/stance.h"
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

/// Puts the bodies of `state` by its chain_states.
template <int D>
void follow(const Model<D>& model, State<D>& state);

/// The chains of a model as they stand at an instant, and as one system in the displacements and velocities
/// of their joints. Links are told by their place in links().
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

  /// Begins displacements at `state`, whose velocities go into v.
  void load(const State<D>& state, std::span<double> v);

  /// Stands and moves as displaced by d since load(), or as `state`; articulated inertias too.
  void stand(std::span<const double> d, std::span<const double> v);
  void stand(const State<D>& state);

  /// How a link stands and moves.
  BodyMotion<D> body_motion(int link) const;

  /// Acceleration of a link at its centre where v' = 0.
  Twist<D> velocity_product(int link) const;

  /// Motion of each link at its centre that v has, at this stance: J v of all links.
  void motions(std::span<const double> v, std::vector<Twist<D>>& out);

  /// Adds to `row` what each velocity gives to the power of a wrench at the centre of a link: a row of J.
  void add_row(int link, const Wrench<D>& wrench, std::span<double> row);

  /// M^-1 of a row. `change` may not be `row`.
  void respond(std::span<const double> row, std::span<double> change);

  /// Forces besides gravity, at the centres of links, that rates() and joint_force() see: none, and more.
  void clear_forces();
  void pull(int link, const Wrench<D>& wrench);

  /// d' of the displacement d and v' of v, at this stance.
  void rates(std::span<const double> d, std::span<const double> v, std::span<double> d_rate,
             std::span<double> v_rate);

  /// Writes into `forces` what each joint that a chain holds puts on its a (N), at this stance.
  void joint_forces(std::vector<Vec<D>>& forces);

  /// Gives `state` where d and v since load() come to.
  void give(std::span<const double> d, std::span<const double> v, State<D>& state);

  /// Moves the velocities of `state` by `change`, or its places by that much.
  void jump(State<D>& state, std::span<const double> change, bool places) const;

  /// Moves the places of `state` by the mean of the velocities in `begun` and its own, through h (s), from
  /// those in `begun`.
  void advance(const std::vector<ChainState>& begun, double h, State<D>& state);

  /// Puts the links' bodies of `state` by its chain_states; stands there.
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
