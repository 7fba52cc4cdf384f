// Chains made of bodies and what joins them. A joint's frame is turned as the link it carries, so that all
// joints are at home where the bodies stand.
//   v = M^-1 sum J' (m v, I w)        what joints leave of the velocities that the bodies have

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "sim/multibody/chains.h"

namespace obscura::sim {

namespace {

// the angle of a rotation of the plane, within pi
double angle(const Rotation<2>& r) {
  const double c = r(0, 0), s = r(1, 0);
  // by its half, taken where it is well known
  Eigen::Vector4d half = Eigen::Vector4d::Zero();
  if (c >= 0) {
    half[3] = std::sqrt(0.5 * (1 + c)), half[2] = 0.5 * s / half[3];
  } else {
    half[2] = std::sqrt(0.5 * (1 - c)), half[3] = 0.5 * s / half[2];
  }
  return logarithm(half)[2];
}

// the angle of every link at q = 0, in the plane; in space unused
template <int D>
std::vector<double> offsets([[maybe_unused]] const Chain<D>& chain) {
  std::vector<double> all;
  if constexpr (D == 2) {
    std::vector<double> joints;
    for (int i = 0; i < chain.size(); ++i) {
      const auto& hung = chain.hung(i);
      const int up = chain[i].parent;
      joints.push_back((up < 0 ? 0 : joints[up]) + angle(hung.on_parent.turn));
      all.push_back(joints.back() + angle(hung.link.turn));
    }
  }
  return all;
}

// the joint type of a chain for a joint of the scene; joints of all other kinds stay as they are
template <int D>
std::optional<JointType> freedom(JointKind kind) {
  switch (kind) {
    case JointKind::pin:
      return D == 2 ? JointType::revolute : JointType::ball;
    case JointKind::hinge:
      return JointType::revolute;
    case JointKind::slider:
      return JointType::prismatic;
    case JointKind::weld:
      return JointType::weld;
    default:
      return {};
  }
}

// the turn and then the place of a body, as the numbers of what flies
template <int D>
void put_pose(const State<D>& state, int body, std::vector<double>& q) {
  const Orientation<D>& turn = state.turn[turning(state, body)];
  q.assign(turn.data(), turn.data() + turn.size());
  q.insert(q.end(), state.x[body].data(), state.x[body].data() + D);
}

// projects the bodies' velocities onto those that the joints of a chain allow
template <int D>
void carry_over(const Model<D>& model, const State<D>& state, const Articulation<D>& its,
                ChainState& posture) {
  const Chain<D>& chain = *its.tree;
  ChainKinematics<D> stance(chain);
  ChainDynamics<D> dynamics(chain);
  place<D>(chain, posture.q, stance);
  factor(chain, stance, dynamics);
  std::vector<Wrench<D>> momenta(its.bodies.size());
  std::vector<double> along(posture.v.size());
  for (int i = chain.size() - 1; i >= 0; --i) {
    const int body = its.bodies[i], k = turning(state, body);
    const Rotation<D> axes = rotation<D>(state.turn[k]);
    const Body<D>& it = model.bodies[body];
    const Wrench<D> own{to_room<D>(axes, it.inertia.cwiseProduct(from_room<D>(axes, state.spin[k]))),
                        it.mass * state.v[body]};
    momenta[i] += transformed_to_origin(own, stance.com[i]);
    for (int j = chain.v_start(i); j < chain.v_start(i + 1); ++j)
      along[j] = power(momenta[i], stance.freedom[j]);
    if (const int up = chain[i].parent; up >= 0)
      momenta[up] += transformed_to_origin(momenta[i], stance.arm[i]);
  }
  respond<D>(chain, stance, along, dynamics, posture.v);
}

template <int D>
class Growing {
 public:
  Growing(World<D>& world, const std::vector<int>& bodies) : world_(world), bodies_(bodies) {
    free_.assign(world.model.bodies.size(), 0);
    for (const int body : bodies) {
      assert(world.model.bodies[body].turns() && !world.model.bodies[body].fixed &&
             !world.model.bodies[body].linked);
      free_[body] = 1;
    }
  }

  void grow() {
    const std::vector<Joint<D>>& joints = world_.model.joints;
    for (int j = 0; j < int(joints.size()); ++j) {
      const int a = joints[j].a.body, b = joints[j].b.body;
      if (a < 0 && b >= 0 && free_[b]) tree(b, j);
      if (b < 0 && a >= 0 && free_[a]) tree(a, j);
    }
    for (const int body : bodies_) {
      if (free_[body]) tree(body, -1);
    }
  }

 private:
  // all that hangs on a body, which hangs on the room by a joint or flies
  void tree(int root, int joint) {
    if (joint >= 0 && !holds(joint)) return;
    links_.clear(), members_.clear(), held_.clear();
    add(root, -1, joint);
    for (int up = 0; up < int(members_.size()); ++up) {
      for (int j = 0; j < int(world_.model.joints.size()); ++j) {
        const Joint<D>& it = world_.model.joints[j];
        const int a = it.a.body, b = it.b.body;
        if (a < 0 || b < 0 || !holds(j)) continue;
        if (a == members_[up] && free_[b])
          add(b, up, j);
        else if (b == members_[up] && free_[a])
          add(a, up, j);
      }
    }
    articulate(world_, links_, members_);
    Articulation<D>& made = world_.model.chains.back();
    made.joints = held_;
    ChainState& posture = world_.state.chain_states.back();
    if (joint < 0) {
      std::vector<double> pose;
      put_pose(world_.state, root, pose);
      std::copy(pose.begin(), pose.end(), posture.q.begin());
    }
    if constexpr (D == 2) {
      for (std::size_t i = 0; i < made.bodies.size(); ++i) {
        made.offsets[i] = world_.state.turn[turning(world_.state, made.bodies[i])][0];
        if (joint < 0) made.offsets[i] -= posture.q[0];
      }
    }
    carry_over(world_.model, world_.state, made, posture);
  }

  bool holds(int joint) const {
    const Joint<D>& it = world_.model.joints[joint];
    return freedom<D>(it.kind) && !it.linked && !it.later;
  }

  Rotation<D> turned(int body) const {
    if (body < 0) return Rotation<D>::Identity();
    return rotation<D>(world_.state.turn[turning(world_.state, body)]);
  }

  void add(int body, int parent, int joint) {
    Link<D> link = link_of(world_.model.bodies[body]);
    link.parent = parent;
    if (joint < 0) {
      link.joint.freedom = JointType::free;
    } else {
      Joint<D>& it = world_.model.joints[joint];
      it.linked = true;
      const bool mine = it.a.body == body;
      const End<D>&own = mine ? it.a : it.b, &other = mine ? it.b : it.a;
      const Rotation<D> room_from_link = turned(body);
      link.joint.freedom = *freedom<D>(it.kind);
      link.joint.on_link.place = own.local;
      link.joint.on_parent = {turned(other.body).transpose() * room_from_link, other.local};
      link.joint.axis = room_from_link.transpose() * (turned(it.b.body) * it.axis);
    }
    free_[body] = 0;
    links_.push_back(link), members_.push_back(body), held_.push_back(joint);
  }

  World<D>& world_;
  const std::vector<int>& bodies_;
  std::vector<char> free_;  // one a body: whether it is still to be a link
  // the tree under construction
  std::vector<Link<D>> links_;
  std::vector<int> members_, held_;
};

}  // namespace

template <int D>
Link<D> link_of(const Body<D>& body) {
  Link<D> link;
  link.mass = body.mass;
  link.inertia = SpinTensor<D>(body.inertia.asDiagonal());
  return link;
}

template <int D>
void articulate(World<D>& world, std::vector<Link<D>> links, std::vector<int> bodies) {
  assert(links.size() == bodies.size());
  for (const int body : bodies) world.model.bodies[body].linked = true;
  auto tree = std::make_shared<const Chain<D>>(std::move(links));
  world.state.chain_states.push_back({tree->home(), std::vector<double>(std::size_t(tree->velocities()))});
  std::vector<double> angles = offsets(*tree);
  std::vector<int> none(bodies.size(), -1);
  world.model.chains.push_back({std::move(tree), std::move(bodies), std::move(none), std::move(angles)});
}

template <int D>
void articulate(World<D>& world, const std::vector<int>& bodies) {
  Growing<D>(world, bodies).grow();
}

template <int D>
void take_velocities(const Model<D>& model, State<D>& state) {
  for (std::size_t k = 0; k < model.chains.size(); ++k)
    carry_over(model, state, model.chains[k], state.chain_states[k]);
  follow(model, state);
}

template Link<2> link_of<2>(const Body<2>&);
template Link<3> link_of<3>(const Body<3>&);
template void articulate<2>(World<2>&, std::vector<Link<2>>, std::vector<int>);
template void articulate<3>(World<3>&, std::vector<Link<3>>, std::vector<int>);
template void articulate<2>(World<2>&, const std::vector<int>&);
template void articulate<3>(World<3>&, const std::vector<int>&);
template void take_velocities<2>(const Model<2>&, State<2>&);
template void take_velocities<3>(const Model<3>&, State<3>&);

}  // namespace obscura::sim
