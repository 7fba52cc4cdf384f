// Sleep of the exact solver: which candidates would not accelerate if they stood still altogether. Stillness
// alone proves nothing: a block that has just begun to slide is slow too. Here velocities are exact, so that
// only what has none to speak of is asked, and nothing is left that contacts would have to hold.

#include "sim/solve/sleep.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "sim/solve/exact/exact.h"

namespace obscura::sim {

namespace {

constexpr double kStill = 0.1;  // s: what has not moved for so long is still

}  // namespace

// Wakes what something awake touches or holds; what lies still beside it only with `all`. True where it did.
template <int D>
bool ExactSolver<D>::wake_reached(State<D>& state, bool all) {
  const auto& bodies = active_.subset.bodies;
  if (std::none_of(bodies.begin(), bodies.end(), [&](int body) { return state.frozen[body] != 0; }))
    return false;
  scratch_.near.clear();
  // What only lies beside, and is as still itself, wakes nothing: two islands would wake each other in turns.
  const auto still = [&](int body) {
    return body >= 0 && !state.frozen[body] && state.quiet[body] >= kStill;
  };
  const auto bears = [&](const ContactKey& key) {
    const Contact<D>* known = find_contact<D>(state.contacts, key);
    return known && known->touching != ContactMode::open;
  };
  for (const ContactCandidate<D>& gap : candidates_) {
    if (!all && (still(gap.key.a) || still(gap.key.b)) && !bears(gap.key)) continue;
    // all of them touch
    scratch_.near.emplace_back();
    scratch_.near.back().key = gap.key, scratch_.near.back().gap = -limits_.touching_gap;
  }
  return sleep_.wake(state, scratch_.near, 0, 0);
}

// Contacts up to a gap of `margin`, m, with those of what wakes by them; with `all` of what wakes by these,
// too.
template <int D>
void ExactSolver<D>::find_contacts_awake(State<D>& state, double margin, bool all) {
  find_contacts(state, margin);
  for (bool more = true; more && wake_reached(state, all); more = all) {
    collect_bodies(state);
    find_contacts(state, margin);
  }
}

// Wakes what touches something that is struck at this instant, through all that lies between: asleep it would
// be a wall. By the rows at hand; true where it did.
template <int D>
bool ExactSolver<D>::wake_struck(State<D>& state) {
  const auto sleeps = [&](int body) { return state.frozen[std::size_t(body)] != 0; };
  const std::span<const int> bodies = active_.subset.bodies;
  if (std::none_of(bodies.begin(), bodies.end(), sleeps)) return false;
  std::vector<char>& struck = scratch_.struck;
  struck.assign(model_.bodies.size(), 0);
  const auto gives_way = [&](int body) {
    return body >= 0 && !model_.bodies[std::size_t(body)].fixed && drives_.number(body) < 0;
  };
  const auto strike = [&](int body) {
    if (!gives_way(body) || struck[std::size_t(body)]) return false;
    struck[std::size_t(body)] = 1;
    return true;
  };
  for (const Constraint& constraint : constraints_) {
    if (!(closing_speed(constraint) > still_speed_)) continue;
    for (int row = constraint.first; row < constraint.first + constraint.rows; ++row) {
      strike(rows_[std::size_t(row)].a), strike(rows_[std::size_t(row)].b);
      for (const RowSide<D>& side : rows_[std::size_t(row)].more) strike(side.body);
    }
  }
  bool any = false;
  for (bool more = true; more;) {
    for (bool spreads = true; spreads;) {
      spreads = false;
      for (const ContactCandidate<D>& gap : candidates_) {
        const int a = gap.key.a, b = gap.key.b;
        if (!gives_way(a) || !gives_way(b) || struck[std::size_t(a)] == struck[std::size_t(b)]) continue;
        spreads = strike(a) || strike(b);
      }
    }
    std::vector<int> woken;
    std::copy_if(bodies.begin(), bodies.end(), std::back_inserter(woken),
                 [&](int body) { return struck[std::size_t(body)] && sleeps(body); });
    more = !woken.empty(), any = any || more;
    if (!more) break;
    std::vector<char> before(state.frozen.begin(), state.frozen.end());
    sleep_.wake(state, woken);
    for (const int body : bodies)
      if (before[std::size_t(body)] && !sleeps(body)) strike(body);
    collect_bodies(state);
    find_contacts(state, limits_.touching_gap);
  }
  return any;
}

// wakes what bodies that are moved, and belts, may touch within the step
template <int D>
void ExactSolver<D>::wake_near_driven(State<D>& state, double t, double h) {
  sleep_.wake_near_driven(state, [&](int body) {
    const int i = drives_.number(body);
    return i < 0 ? 0 : drives_.travel(i, t, h);
  });
}

// after a step of h to time t
template <int D>
void ExactSolver<D>::put_to_sleep(State<D>& state, double t, double h) {
  for (int i = 0; i < int(model_.bodies.size()); ++i) {
    if (!response_.moves(i)) continue;
    const int k = turning(state, i);
    sleep_.advance_timer(state, i, state.v[i].squaredNorm(), k < 0 ? 0 : state.spin[k].squaredNorm(), h);
  }
  const std::span<typename Sleep<D>::Island> islands = sleep_.candidates(state);
  if (islands.empty()) return;
  save(state, interval_.begun);
  for (const auto& island : islands) sleep_.halt(state, island);
  find_accelerations(state, t);
  restore(interval_.begun, state);
  for (auto& island : islands) {
    island.residual = 0;
    for (const int body : island.bodies)
      island.residual = std::max(island.residual, scratch_.accelerations[body]);
  }
  if (sleep_.put_to_sleep(state)) record_forces(state);
}

// the acceleration that bodies would have from here, m/s^2 of the fastest point; infinite if no forces are
// found
template <int D>
void ExactSolver<D>::find_accelerations(State<D>& state, double t) {
  find_contacts(state, limits_.touching_gap);
  scratch_.accelerations.assign(model_.bodies.size(), std::numeric_limits<double>::infinity());
  if (!solve_modes(state, t)) return;
  const auto still = dynamics_.accelerations(state, t);
  scratch_.rate.assign(still.begin(), still.end());
  for (int i = 0; i < int(rows_.size()); ++i) add_accelerations(i, f_[i], scratch_.rate);
  const auto& members = dynamics_.bodies();
  for (int k = 0; k < int(members.size()); ++k) {
    double& a = scratch_.accelerations[members[k]];
    a = std::sqrt(Eigen::Map<const Vec<D>>(scratch_.rate.data() + D * k).squaredNorm());
    if (const int at = dynamics_.spin_start(k); at >= 0)
      a += limits_.bounding_radius[members[k]] *
           std::sqrt(Eigen::Map<const AngularVec<D>>(scratch_.rate.data() + at).squaredNorm());
  }
  const auto& links = dynamics_.chains().links();
  dynamics_.chains().motions(
      std::span<const double>(scratch_.rate)
          .subspan(std::size_t(dynamics_.chain_start()), std::size_t(dynamics_.chains().size())),
      scratch_.motions);
  for (std::size_t k = 0; k < links.size(); ++k) {
    const Twist<D>& rate = scratch_.motions[k];
    scratch_.accelerations[links[k]] =
        std::sqrt(rate.v.squaredNorm()) + limits_.bounding_radius[links[k]] * std::sqrt(rate.w.squaredNorm());
  }
}

template void ExactSolver<2>::wake_near_driven(State<2>&, double, double);
template void ExactSolver<3>::wake_near_driven(State<3>&, double, double);
template void ExactSolver<2>::find_contacts_awake(State<2>&, double, bool);
template bool ExactSolver<2>::wake_struck(State<2>&);
template void ExactSolver<2>::put_to_sleep(State<2>&, double, double);
template void ExactSolver<3>::find_contacts_awake(State<3>&, double, bool);
template bool ExactSolver<3>::wake_struck(State<3>&);
template void ExactSolver<3>::put_to_sleep(State<3>&, double, double);

}  // namespace obscura::sim
