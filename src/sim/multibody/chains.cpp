// Articulated bodies in the room: their joint coordinates are integrated, by Featherstone's algorithm
// (sim/multibody/articulated_body.h), so joints do not drift.
//   d' = v, for rotations in space dexp^-1(d, v)    v' = M^-1 (J' f - h)
//     f  all forces besides gravity, at the centres of the links

#include "sim/multibody/chains.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace obscura::sim {

namespace {

bool turns_first(JointType freedom) {
  return freedom == JointType::revolute || freedom == JointType::ball || freedom == JointType::free;
}

// a link's orientation; of q and -q the one nearer to `before`
Orientation<2> turn_of(const Articulation<2>& of, std::span<const double> q, int link, const Rotation<2>&,
                       const Orientation<2>&) {
  const Chain<2>& chain = *of.tree;
  double sum = of.offsets[link];
  for (int i = link; i >= 0; i = chain[i].parent) {
    if (turns_first(chain[i].joint.freedom)) sum += q[chain.q_start(i)];
  }
  return Orientation<2>(sum);
}
Orientation<3> turn_of(const Articulation<3>&, std::span<const double>, int, const Rotation<3>& rotation,
                       const Orientation<3>& before) {
  const Eigen::Quaterniond quaternion(rotation);
  const Orientation<3> turn = quaternion.coeffs() / std::sqrt(quaternion.squaredNorm());
  return turn.dot(before) < 0 ? Orientation<3>(-turn) : turn;
}

// a link's body as its chain stands
template <int D>
BodyMotion<D> standing(const Chain<D>& chain, const ChainKinematics<D>& stance, int link) {
  const Pose<D> pose = link_pose(chain, stance, link);
  return {pose.place, point_velocity<D>(stance, link, pose.place), pose.turn, stance.twist[link].w};
}

// from a link's origin to its centre
template <int D>
Vec<D> arm(const Chain<D>& chain, const ChainKinematics<D>& stance, int link) {
  return stance.joint[link].turn * chain.hung(link).link.place;
}

}  // namespace

template <int D>
Articulated<D>::Articulated(const Model<D>& model) : model_(model), places_(model.bodies.size(), -1) {
  for (const Articulation<D>& of : model.chains) {
    const Chain<D>& chain = *of.tree;
    const std::vector<double> zeros(std::size_t(chain.velocities()));
    trees_.push_back({&of, true, 0, 0, chain.home(), chain.home(), zeros, zeros, zeros,
                      ChainKinematics<D>(chain), ChainDynamics<D>(chain)});
  }
  std::vector<int> all(trees_.size());
  std::iota(all.begin(), all.end(), 0);
  gather({}, all);
}

template <int D>
void Articulated<D>::gather(const State<D>& state, std::span<const int> chains) {
  for (const int body : links_) places_[body] = -1;
  links_.clear(), where_.clear();
  size_ = 0;
  for (Tree& tree : trees_) tree.awake = false;
  for (const int i : chains) {
    Tree& tree = trees_[i];
    const std::vector<int>& bodies = tree.of->bodies;
    tree.awake = state.frozen.empty() || !state.frozen[bodies[0]];
    if (!tree.awake) continue;
    tree.start = size_, tree.first = int(links_.size());
    size_ += tree.chain().velocities();
    for (int link = 0; link < int(bodies.size()); ++link) {
      places_[bodies[link]] = int(links_.size());
      links_.push_back(bodies[link]), where_.push_back({i, link});
    }
  }
  part_.resize(std::size_t(size_));
}

template <int D>
void Articulated<D>::stand(Tree& tree, std::span<const double> q, std::span<const double> v) {
  std::copy(v.begin(), v.end(), tree.v.begin());
  sim::place<D>(tree.chain(), q, tree.stance);
  sim::move<D>(tree.chain(), v, tree.stance);
  factor(tree.chain(), tree.stance, tree.dynamics);
}

template <int D>
void Articulated<D>::load(const State<D>& state, std::span<double> v) {
  for (std::size_t i = 0; i < trees_.size(); ++i) {
    Tree& tree = trees_[i];
    if (!tree.awake) continue;
    tree.q = state.chain_states[i].q;
    std::copy(state.chain_states[i].v.begin(), state.chain_states[i].v.end(), tree.own(v).begin());
  }
}

template <int D>
void Articulated<D>::stand(std::span<const double> d, std::span<const double> v) {
  for (Tree& tree : trees_) {
    if (!tree.awake) continue;
    tree.chain().displace(tree.q, tree.own(d), tree.held);
    stand(tree, tree.held, tree.own(v));
  }
}

template <int D>
void Articulated<D>::stand(const State<D>& state) {
  for (std::size_t i = 0; i < trees_.size(); ++i) {
    if (trees_[i].awake) stand(trees_[i], state.chain_states[i].q, state.chain_states[i].v);
  }
}

template <int D>
BodyMotion<D> Articulated<D>::body_motion(int link) const {
  const Tree& tree = trees_[where_[link].tree];
  return standing(tree.chain(), tree.stance, where_[link].link);
}

template <int D>
Twist<D> Articulated<D>::velocity_product(int link) const {
  const Tree& tree = trees_[where_[link].tree];
  const int i = where_[link].link;
  return {
      tree.stance.velocity_product[i].w,
      point_drift<D>(tree.stance, i, Vec<D>(tree.stance.joint[i].place + arm(tree.chain(), tree.stance, i)))};
}

template <int D>
void Articulated<D>::motions(std::span<const double> v, std::vector<Twist<D>>& out) {
  out.resize(links_.size());
  for (const Tree& tree : trees_) {
    if (!tree.awake) continue;
    const Chain<D>& chain = tree.chain();
    const std::span<const double> own = tree.own(v);
    for (int i = 0; i < chain.size(); ++i) {
      Twist<D> sum;
      if (const int up = chain[i].parent; up >= 0)
        sum = shifted(out[std::size_t(tree.first + up)], tree.stance.arm[i]);
      for (int j = chain.v_start(i); j < chain.v_start(i + 1); ++j) sum += tree.stance.freedom[j] * own[j];
      out[std::size_t(tree.first + i)] = sum;
    }
    for (int i = 0; i < chain.size(); ++i) {
      Twist<D>& it = out[std::size_t(tree.first + i)];
      it = shifted(it, arm(chain, tree.stance, i));
    }
  }
}

template <int D>
void Articulated<D>::add_row(int link, const Wrench<D>& wrench, std::span<double> row) {
  const Tree& tree = trees_[where_[link].tree];
  const int i = where_[link].link;
  const std::span<double> part = tree.own(std::span<double>(part_)), own = tree.own(row);
  sim::row<D>(tree.chain(), tree.stance, i, transformed_to_origin(wrench, arm(tree.chain(), tree.stance, i)),
              part);
  for (std::size_t j = 0; j < part.size(); ++j) own[j] += part[j];
}

template <int D>
void Articulated<D>::respond(std::span<const double> row, std::span<double> change) {
  for (Tree& tree : trees_) {
    if (!tree.awake) continue;
    const std::span<const double> own = tree.own(row);
    const std::span<double> its = tree.own(change);
    if (std::all_of(own.begin(), own.end(), [](double x) { return x == 0; }))
      std::fill(its.begin(), its.end(), 0.0);
    else
      sim::respond<D>(tree.chain(), tree.stance, own, tree.dynamics, its);
  }
}

template <int D>
void Articulated<D>::clear_forces() {
  for (Tree& tree : trees_)
    std::fill(tree.dynamics.applied.begin(), tree.dynamics.applied.end(), Wrench<D>{});
}

template <int D>
void Articulated<D>::pull(int link, const Wrench<D>& wrench) {
  Tree& tree = trees_[where_[link].tree];
  const int i = where_[link].link;
  tree.dynamics.applied[i] += transformed_to_origin(wrench, arm(tree.chain(), tree.stance, i));
}

template <int D>
void Articulated<D>::rates(std::span<const double> d, std::span<const double> v, std::span<double> d_rate,
                           std::span<double> v_rate) {
  for (Tree& tree : trees_) {
    if (!tree.awake) continue;
    tree.chain().displacement_rate(tree.own(d), tree.own(v), tree.own(d_rate));
    accelerate<D>(tree.chain(), tree.stance, tree.own(v), tree.tau, model_.gravity, tree.dynamics,
                  tree.own(v_rate));
  }
}

template <int D>
void Articulated<D>::joint_loads(std::vector<Wrench<D>>& loads) {
  for (Tree& tree : trees_) {
    if (!tree.awake) continue;
    accelerate<D>(tree.chain(), tree.stance, tree.v, tree.tau, model_.gravity, tree.dynamics, tree.rate);
    for (int i = 0; i < tree.chain().size(); ++i) {
      const int joint = tree.of->joints[i];
      if (joint < 0) continue;
      const Joint<D>& its = model_.joints[std::size_t(joint)];
      const bool is_a = its.a.body == tree.of->bodies[std::size_t(i)];
      const Wrench<D> on_link = joint_wrench(tree.chain(), tree.stance, tree.dynamics, i);
      const Wrench<D> on_a = is_a ? on_link : on_link * -1;
      // from the link's origin to the place of a
      const int a = is_a ? i : tree.chain()[i].parent;
      const BodyMotion<D> at = a < 0 ? BodyMotion<D>() : standing(tree.chain(), tree.stance, a);
      const Vec<D> arm = at.x + at.arm(its.a.local) - tree.stance.joint[i].place;
      loads[std::size_t(joint)] = {AngularVec<D>(on_a.n - moment<D>(arm, on_a.f)), on_a.f};
    }
  }
}

template <int D>
void Articulated<D>::give(std::span<const double> d, std::span<const double> v, State<D>& state) {
  for (std::size_t i = 0; i < trees_.size(); ++i) {
    Tree& tree = trees_[i];
    if (!tree.awake) continue;
    ChainState& posture = state.chain_states[i];
    tree.chain().displace(tree.q, tree.own(d), posture.q);
    const std::span<const double> own = tree.own(v);
    std::copy(own.begin(), own.end(), posture.v.begin());
  }
  follow(state);
}

template <int D>
void Articulated<D>::jump(State<D>& state, std::span<const double> change, bool places) const {
  for (std::size_t i = 0; i < trees_.size(); ++i) {
    const Tree& tree = trees_[i];
    if (!tree.awake) continue;
    ChainState& posture = state.chain_states[i];
    const std::span<const double> own = tree.own(change);
    if (places) {
      tree.chain().displace(posture.q, own, posture.q);
    } else {
      for (std::size_t j = 0; j < own.size(); ++j) posture.v[j] += own[j];
    }
  }
}

template <int D>
void Articulated<D>::advance(const std::vector<ChainState>& begun, double h, State<D>& state) {
  for (std::size_t i = 0; i < trees_.size(); ++i) {
    Tree& tree = trees_[i];
    if (!tree.awake) continue;
    ChainState& posture = state.chain_states[i];
    for (std::size_t j = 0; j < posture.v.size(); ++j)
      tree.rate[j] = 0.5 * h * (begun[i].v[j] + posture.v[j]);
    tree.chain().displace(begun[i].q, tree.rate, posture.q);
  }
  follow(state);
}

template <int D>
void Articulated<D>::follow(State<D>& state) {
  stand(state);
  for (std::size_t i = 0; i < trees_.size(); ++i) {
    if (trees_[i].awake) show(trees_[i], state.chain_states[i].q, state);
  }
}

template <int D>
void Articulated<D>::show(const Tree& tree, std::span<const double> q, State<D>& state) const {
  for (int link = 0; link < tree.chain().size(); ++link) {
    const int body = tree.of->bodies[link];
    const BodyMotion<D> at = standing(tree.chain(), tree.stance, link);
    state.x[body] = at.x, state.v[body] = at.v;
    const int k = turning(state, body);
    if (k < 0) continue;
    state.turn[k] = turn_of(*tree.of, q, link, at.room_from_body, state.turn[k]);
    state.spin[k] = at.w;
  }
}

template <int D>
void follow(const Model<D>& model, State<D>& state) {
  assert(state.chain_states.size() == model.chains.size());
  if (!model.chains.empty()) Articulated<D>(model).follow(state);
}

template void follow<2>(const Model<2>&, State<2>&);
template void follow<3>(const Model<3>&, State<3>&);
template class Articulated<2>;
template class Articulated<3>;

}  // namespace obscura::sim
