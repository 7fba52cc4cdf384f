// The tree of a chain: Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 4.
// Every link has one frame for all the algorithms, its joint's; quantities that the caller gives in the
// link's own frame are converted once.

#include "sim/multibody/chain.h"

#include <cassert>

namespace obscura::sim {

namespace {

// the same inertia in axes turned by `turn`
template <int D>
SpinTensor<D> turned_inertia([[maybe_unused]] const Rotation<D>& turn, const SpinTensor<D>& inertia) {
  if constexpr (D == 2) {
    return inertia;
  } else {
    return turn * inertia * turn.transpose();
  }
}

}  // namespace

template <int D>
Chain<D>::Chain(std::vector<Link<D>> links) : links_(std::move(links)) {
  for (int i = 0; i < size(); ++i) {
    const Link<D>& link = links_[i];
    assert(link.parent >= -1 && link.parent < i);
    assert(link.joint.freedom != JointType::free || link.parent == -1);
    q_start_.push_back(q_start_.back() + sim::positions<D>(link.joint.freedom));
    v_start_.push_back(v_start_.back() + sim::velocities<D>(link.joint.freedom));

    LinkInJointFrame hung;
    hung.link = link.joint.on_link.inverse();
    hung.on_parent = link.parent < 0 ? link.joint.on_parent : hung_[link.parent].link * link.joint.on_parent;
    hung.com = hung.link * link.com;
    hung.inertia = turned_inertia<D>(hung.link.turn, link.inertia);
    hung_.push_back(hung);
  }
}

template <int D>
std::vector<double> Chain<D>::home() const {
  std::vector<double> q(positions());
  for (int i = 0; i < size(); ++i) put_home<D>(links_[i].joint.freedom, q_of(i, std::span<double>(q)));
  return q;
}

template <int D>
void Chain<D>::displace(std::span<const double> q, std::span<const double> d, std::span<double> out) const {
  for (int i = 0; i < size(); ++i) {
    sim::displace<D>(links_[i].joint.freedom, q_of(i, q), v_of(i, d), q_of(i, out));
  }
}

template <int D>
void Chain<D>::displacement_rate(std::span<const double> d, std::span<const double> v,
                                 std::span<double> out) const {
  for (int i = 0; i < size(); ++i) {
    sim::displacement_rate<D>(links_[i].joint.freedom, v_of(i, d), v_of(i, v), v_of(i, out));
  }
}

template class Chain<2>;
template class Chain<3>;

}  // namespace obscura::sim
