// Groups: bodies that cannot meet in a step are stepped separately, each group with cuts of its own.
//   s_i = 1.1 h sqrt(v^2 + 2 E_w / m) + h^2 |a|       E_w  energy of spin: walls may turn it into speed
// bounds how far body i gets in a step of h. Two whose bounds overlap are of one group, and so are bodies
// tied together by joints, springs and chains. If a body got farther all the same, struck by a heavier one,
// the bodies that it may have reached are stepped again together with it.

#include <algorithm>
#include <cmath>

#include "sim/collide/contact_key.h"
#include "sim/energy/energy.h"
#include "sim/solve/exact/exact.h"

namespace obscura::sim {

namespace {

constexpr double kSpare = 1.1;

// kinds of sets of bodies, step_.kinds
constexpr char kAsleep = 0, kFree = 1, kBusy = 2;

// the list of `count` items by group: items of group g from ends[g - 1] to ends[g]. `group_of` answers an
// item's group, below zero: none
template <class Item, class GroupOf>
void by_group(int groups, int count, const GroupOf& group_of, std::vector<int>& ends, std::vector<Item>& list,
              const auto& item) {
  ends.assign(std::size_t(groups) + 1, 0);
  int all = 0;
  for (int i = 0; i < count; ++i) {
    if (const int g = group_of(i); g >= 0) ++ends[g + 1], ++all;
  }
  for (int g = 0; g < groups; ++g) ends[g + 1] += ends[g];
  list.resize(std::size_t(all));
  for (int i = 0; i < count; ++i) {
    if (const int g = group_of(i); g >= 0) list[ends[g]++] = item(i);
  }
}

}  // namespace

// bounds how far each body may get in a step of h from t
template <int D>
void ExactSolver<D>::bound_travel(const State<D>& state, double t, double h) {
  const auto rate = dynamics_.accelerations(state, t);
  const double g = std::sqrt(model_.gravity.squaredNorm());
  for (int body = 0; body < int(step_.travel_bound.size()); ++body) {
    step_.travel_bound[body] = 0;
    if (!response_.moves(body)) continue;
    double a = g;
    if (const int place = dynamics_.place(body); !model_.bodies[body].linked && place >= 0)
      a = std::sqrt(Eigen::Map<const Vec<D>>(rate.data() + D * place).squaredNorm());
    const double v = std::sqrt(2 * kinetic(model_, state, body) / model_.bodies[body].mass);
    step_.travel_bound[body] = kSpare * h * v + h * h * a;
  }
  for (int i = 0; i < drives_.size(); ++i)
    step_.travel_bound[std::size_t(drives_.body(i))] = kSpare * drives_.travel(i, t, h);
  // fixed bodies too
  update_poses(state), pose_driven(t);
}

// step_.near: which bodies may meet, or are tied together
template <int D>
void ExactSolver<D>::join_near_bodies(const State<D>& state) {
  step_.near.reset(limits_.bodies);
  for (int body = 0; body < int(step_.travel_bound.size()); ++body)
    step_.travel_bound[body] = std::max(step_.travel_bound[body], step_.travelled[body]);
  const auto link = [&](int a, int b) {
    if (a < 0 || b < 0 || model_.bodies[a].fixed || model_.bodies[b].fixed) return;
    step_.near.join(a, b);
  };
  for (const Spring<D>& spring : model_.springs) link(spring.a.body, spring.b.body);
  for (const std::vector<int>& together : limits_.tied_by_forces) {
    for (const int body : together) link(body, together[0]);
  }
  for (const Articulation<D>& chain : model_.chains) {
    for (const int body : chain.bodies) link(body, chain.bodies[0]);
  }
  for (int i = 0; i < int(model_.joints.size()); ++i) {
    // one that breaks within the step holds them up to there
    if (step_.broken[i]) continue;
    const Joint<D>& joint = model_.joints[i];
    link(joint.a.body, joint.b.body);
    if (joint.over.empty() && wound(state, std::size_t(i)).with <= 0) continue;
    // of many bodies: all that are free with the first of them
    int free = -1;
    each_body_held(model_, state, std::size_t(i), [&](int body) {
      if (body < 0 || model_.bodies[body].fixed) return;
      if (free >= 0) link(free, body);
      free = body;
    });
  }
  for (const Couple& couple : limits_.couples) {
    const auto [a, b] = couple;
    if (b < 0 || model_.bodies[a].fixed || model_.bodies[b].fixed) continue;
    const double far = limits_.bounding_radius[a] + limits_.bounding_radius[b] + step_.travel_bound[a] +
                       step_.travel_bound[b] + limits_.touching_gap;
    if ((step_.begun.x[a] - step_.begun.x[b]).squaredNorm() <= far * far) step_.near.join(a, b);
  }
}

// step_.groups of step_.near: the sets that are stepped together, and their members
template <int D>
void ExactSolver<D>::list_groups(const State<D>& state) {
  classify_sets(state);
  number_groups();
  list_members(state);
}

// kind and size of each set, at its root: asleep sets, in which no mouse holds a body, are left out; single
// bodies that reach nothing are free; all others are busy
template <int D>
void ExactSolver<D>::classify_sets(const State<D>& state) {
  const int n = int(model_.bodies.size());
  std::vector<char>& kind = step_.kinds;
  std::vector<int>& size = step_.group_sizes;
  kind.assign(n, kAsleep), size.assign(n, 0);
  for (int body = 0; body < n; ++body) {
    if (model_.bodies[body].fixed) continue;
    const int root = step_.near.root(body);
    ++size[root];
    if (!state.frozen[body]) kind[root] = size[root] > 1 ? kBusy : std::max<char>(kind[root], kFree);
    if (size[root] > 1 && kind[root] == kFree) kind[root] = kBusy;
  }
  const auto busy = [&](int body) {
    if (body < 0 || model_.bodies[body].fixed) return;
    char& it = kind[step_.near.root(body)];
    if (it == kFree) it = kBusy;
  };
  for (const Grip<D>& grip : state.grips) {
    if (grip.body >= 0 && !model_.bodies[grip.body].fixed) kind[step_.near.root(grip.body)] = kBusy;
  }
  for (const Joint<D>& joint : model_.joints) joint.each_body(busy);
  find_reached();
}

// sets that reach a wall or a fixed body are busy
template <int D>
void ExactSolver<D>::find_reached() {
  for (const Couple& couple : limits_.couples) {
    const auto [a, b] = couple;
    const bool a_fixed = model_.bodies[a].fixed;
    const int body = a_fixed ? b : a;
    if (!a_fixed && b >= 0 && !model_.bodies[b].fixed) continue;
    char& kind = step_.kinds[step_.near.root(body)];
    if (kind != kFree) continue;
    const double far = limits_.bounding_radius[body] + step_.travel_bound[body] + limits_.touching_gap;
    bool meets;
    if (b < 0) {
      const Wall<D>& wall = model_.walls[-1 - b];
      meets = (step_.begun.x[body] - wall.point).dot(wall.normal) <= far;
    } else {
      const int other = a_fixed ? a : b;
      const double all = far + limits_.bounding_radius[other] + step_.travel_bound[other];
      meets = (step_.begun.x[body] - poses_[other].x).squaredNorm() <= all * all;
    }
    if (meets) kind = kBusy;
  }
}

// numbers the groups by their lowest bodies; all free bodies are one group, as nothing cuts their step
template <int D>
void ExactSolver<D>::number_groups() {
  const int n = int(model_.bodies.size());
  const std::vector<char>& kind = step_.kinds;
  const std::vector<int>& size = step_.group_sizes;
  step_.groups.clear();
  int free = -1;
  step_.group_of.assign(n, -1);
  for (int body = 0; body < n; ++body) {
    if (model_.bodies[body].fixed) continue;
    const int root = step_.near.root(body);
    if (kind[root] == kAsleep) continue;
    int& group = kind[root] == kFree ? free : step_.group_of[root];
    if (group < 0) {
      group = int(step_.groups.size());
      step_.groups.emplace_back();
      step_.groups.back().root = body;
      step_.groups.back().lone = kind[root] != kFree && size[root] == 1;
    }
    step_.group_of[body] = group;
  }
}

// the members of each group
template <int D>
void ExactSolver<D>::list_members(const State<D>& state) {
  const int groups = int(step_.groups.size());
  const auto lay = [&](auto& list, int count, const auto& group_of, const auto& item, const auto& give) {
    by_group(groups, count, group_of, step_.group_ends, list, item);
    for (int g = 0; g < groups; ++g) {
      const int from = g > 0 ? step_.group_ends[g - 1] : 0;
      give(step_.groups[g],
           std::span(list).subspan(std::size_t(from), std::size_t(step_.group_ends[g] - from)));
    }
  };
  const auto self = [](int i) { return i; };
  const auto either = [&](int a, int b) {
    return a >= 0 && step_.group_of[a] >= 0 ? step_.group_of[a] : b >= 0 ? step_.group_of[b] : -1;
  };
  lay(
      step_.group_bodies, int(model_.bodies.size()), [&](int i) { return step_.group_of[i]; }, self,
      [](Group& group, auto list) { group.subset.bodies = list; });
  lay(
      step_.group_springs, int(model_.springs.size()),
      [&](int i) { return either(model_.springs[i].a.body, model_.springs[i].b.body); }, self,
      [](Group& group, auto list) { group.subset.springs = list; });
  lay(
      step_.group_chains, int(model_.chains.size()),
      [&](int i) { return step_.group_of[model_.chains[i].bodies[0]]; }, self,
      [](Group& group, auto list) { group.subset.chains = list; });
  lay(
      step_.group_joints, int(model_.joints.size()),
      [&](int i) {
        int group = -1;
        each_body_held(model_, state, std::size_t(i),
                       [&](int body) { group = group < 0 ? either(body, -1) : group; });
        return group;
      },
      self, [](Group& group, auto list) { group.joints = list; });
  lay(
      step_.group_couples, int(limits_.couples.size()),
      [&](int i) {
        const auto [a, b] = limits_.couples[i];
        const int of_a = step_.group_of[a];
        if (b < 0) return of_a;
        const int of_b = step_.group_of[b];
        if (model_.bodies[a].fixed) return of_b;
        if (model_.bodies[b].fixed) return of_a;
        return of_a == of_b ? of_a : -1;
      },
      [&](int i) { return limits_.couples[i]; }, [](Group& group, auto list) { group.couples = list; });
}

// sizes what groups need of a state
template <int D>
void ExactSolver<D>::resize_for(State<D>& state) {
  const std::size_t n = model_.bodies.size();
  state.frozen.resize(n), state.quiet.resize(n), state.broken.resize(model_.joints.size());
  state.joint_forces.resize(model_.joints.size(), Vec<D>::Zero());
  state.joint_torques.resize(model_.joints.size(), AngularVec<D>::Zero());
  if (limits_.wires) state.on_piece.resize(model_.joints.size());
  poses_.resize(n), island_of_.resize(n);
  roots_.reset(int(n));
}

template <int D>
void ExactSolver<D>::step_alone(State<D>& state, int body, double t, double h) {
  if (poses_.size() != model_.bodies.size()) {
    resize_for(state);
    step_.travelled.resize(poses_.size()), step_.cuts.resize(poses_.size());
    for (const int fixed : limits_.fixed) poses_[fixed] = body_motion(state, fixed);
  }
  step_.lone_body.assign(1, body), step_.group_couples.clear();
  for (int wall = 0; wall < int(model_.walls.size()); ++wall)
    step_.group_couples.push_back({body, -1 - wall});
  for (const int fixed : limits_.fixed) {
    const auto [a, b] = std::minmax(body, fixed);
    if (may_touch_(a, b)) step_.group_couples.push_back({a, b});
  }
  active_ = {};
  active_.root = body, active_.lone = true;
  active_.subset.bodies = step_.lone_body, active_.couples = step_.group_couples;
  step_.travelled[body] = 0, step_.cuts[body] = 0;
  cone_.thorough = model_.collision == Collision::event;
  save(state, step_.begun);
  step_group(state, t, h);
  write_lone_contacts(state, body);
}

// The forces and impulses of a lone body's contacts, into those that `state` has: into the one of the same
// features, else into the nearest one of the same pair, so that none is lost.
template <int D>
void ExactSolver<D>::write_lone_contacts(State<D>& state, int body) {
  std::vector<Contact<D>>& found = outcome_.contacts;
  for (const Contact<D>& struck : outcome_.impulses) {
    const auto at = std::find_if(found.begin(), found.end(),
                                 [&](const Contact<D>& contact) { return contact.key == struck.key; });
    if (at != found.end()) {
      at->impulse = struck.impulse;
    } else {
      found.push_back(struck);
    }
  }
  // the plane's iterative solver has keys of its own; a feature below zero pads a pair
  const auto exact_key = [&](const ContactKey& key) {
    if constexpr (D == 2) return narrow_phase_key(model_, key);
    return key;
  };
  for (Contact<D>& contact : state.contacts) {
    if (contact.key.a != body && contact.key.b != body) continue;
    contact.force.setZero(), contact.impulse.setZero(), contact.touching = ContactMode::open;
    const ContactKey key = contact.key, exact = exact_key(key);
    const auto at =
        std::find_if(found.begin(), found.end(), [&](const Contact<D>& other) { return other.key == exact; });
    if (at == found.end()) continue;
    contact = *at, contact.key = key;
    found.erase(at);
  }
  for (const Contact<D>& left : found) {
    Contact<D>* nearest = nullptr;
    double least = 1e300;
    for (Contact<D>& contact : state.contacts) {
      if (contact.key.a != left.key.a || contact.key.b != left.key.b || exact_key(contact.key).feature < 0)
        continue;
      const double distance = (contact.point - left.point).squaredNorm();
      if (distance < least) least = distance, nearest = &contact;
    }
    if (!nearest) continue;
    nearest->force += left.force, nearest->impulse += left.impulse;
    if (nearest->touching == ContactMode::open) nearest->touching = left.touching;
  }
}

// selects a group: all that follows is for it alone
template <int D>
void ExactSolver<D>::activate(const Group& group) {
  active_ = group;
}

// selects all bodies again
template <int D>
void ExactSolver<D>::activate_all() {
  active_ = {};
  active_.subset = {limits_.bodies, limits_.springs, limits_.chains};
  active_.joints = limits_.joints;
  active_.couples = limits_.couples;
  progress_.known = &outcome_.contacts;
}

// how far the bodies at hand have got
template <int D>
void ExactSolver<D>::measure_travel(const State<D>& state) {
  for (const int body : active_.subset.bodies)
    step_.travelled[body] =
        std::max(step_.travelled[body], std::sqrt((state.x[body] - step_.begun.x[body]).squaredNorm()));
}

// counts a cut for the bodies a and b (negative: none, or a wall); for all bodies if neither is one
template <int D>
void ExactSolver<D>::count_cut(int a, int b) {
  if (a >= 0) ++step_.cuts[a];
  if (b >= 0) ++step_.cuts[b];
  if (a >= 0 || b >= 0) return;
  for (const int body : active_.subset.bodies) ++step_.cuts[body];
}

// the most cuts that one of the bodies at hand took part in
template <int D>
int ExactSolver<D>::cuts_so_far() const {
  int most = 0;
  for (const int body : active_.subset.bodies) most = std::max(most, step_.cuts[body]);
  return most;
}

#define OBSCURA_INSTANTIATE(D)                                                 \
  template void ExactSolver<D>::bound_travel(const State<D>&, double, double); \
  template void ExactSolver<D>::join_near_bodies(const State<D>&);             \
  template void ExactSolver<D>::list_groups(const State<D>&);                  \
  template void ExactSolver<D>::activate(const Group&);                        \
  template void ExactSolver<D>::resize_for(State<D>&);                         \
  template void ExactSolver<D>::step_alone(State<D>&, int, double, double);    \
  template void ExactSolver<D>::activate_all();                                \
  template void ExactSolver<D>::measure_travel(const State<D>&);               \
  template void ExactSolver<D>::count_cut(int, int);                           \
  template int ExactSolver<D>::cuts_so_far() const
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim
