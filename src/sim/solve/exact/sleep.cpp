// Rest, by the rule of sim/constraint/mobility.h. What has been still for a while, with all that it touches,
// and would not accelerate if it stood still altogether, is frozen: its velocity becomes zero exactly and
// steps leave it alone, until something awake touches it or pulls at it. Stillness alone proves nothing: a
// block that has just begun to slide is slow too. Here velocities are exact, so that only what has none to
// speak of is asked, and nothing is left that contacts would have to hold.

#include <algorithm>
#include <cmath>

#include "sim/constraint/mobility.h"
#include "sim/solve/exact/exact.h"

namespace obscura::sim {

namespace {

constexpr double kStatic = 1e-10;  // of g: what rest may accelerate by

}  // namespace

// islands: bodies joined by contacts, springs and joints; fixed bodies join none
template <int D>
void ExactSolver<D>::join_touching(const State<D>& state) {
  touching_.reset(int(model_.bodies.size()));
  const auto link = [&](int a, int b) {
    if (a < 0 || b < 0 || model_.bodies[a].fixed || model_.bodies[b].fixed) return;
    touching_.join(a, b);
  };
  for (const Contact<D>& contact : state.contacts) link(contact.key.a, contact.key.b);
  for (const Spring<D>& spring : model_.springs) link(spring.a.body, spring.b.body);
  for (const Articulation<D>& chain : model_.chains) {
    for (const int body : chain.bodies) link(body, chain.bodies[0]);
  }
  for (int i = 0; i < int(model_.joints.size()); ++i) {
    if (!state.broken[i]) link(model_.joints[i].a.body, model_.joints[i].b.body);
  }
}

// thaws what something awake touches or holds, with all that it is joined to. True where it did
template <int D>
bool ExactSolver<D>::wake(State<D>& state) {
  const auto& bodies = active_.subset.bodies;
  if (std::none_of(bodies.begin(), bodies.end(), [&](int body) { return state.frozen[body] != 0; }))
    return false;
  scratch_.chosen.clear();
  const auto meet = [&](int a, int b) {
    if (a < 0 || b < 0) return;
    if (state.frozen[a] && response_.moves(b)) scratch_.chosen.push_back(a);
    if (state.frozen[b] && response_.moves(a)) scratch_.chosen.push_back(b);
  };
  for (const ContactCandidate<D>& gap : candidates_) meet(gap.key.a, gap.key.b);
  for (const Grip<D>& grip : state.grips) {
    if (grip.body >= 0 && state.frozen[grip.body]) scratch_.chosen.push_back(grip.body);
  }
  if (scratch_.chosen.empty()) return false;
  join_touching(state);
  for (const int woken : scratch_.chosen) {
    for (int i = 0; i < int(state.frozen.size()); ++i) {
      if (touching_.root(i) == touching_.root(woken)) state.frozen[i] = 0, state.quiet[i] = 0;
    }
  }
  return true;
}

// freezes what rests, at time t after a step of h
template <int D>
void ExactSolver<D>::put_to_sleep(State<D>& state, double t, double h) {
  const double g = std::sqrt(model_.gravity.squaredNorm()), none = slow(model_).none;
  const int n = int(model_.bodies.size());
  bool ripe = false;
  for (int i = 0; i < n; ++i) {
    if (!response_.moves(i)) continue;
    double fast = std::sqrt(state.v[i].squaredNorm());
    if (const int k = turning(state, i); k >= 0)
      fast += limits_.bounding_radius[i] * std::sqrt(state.spin[k].squaredNorm());
    state.quiet[i] = fast <= none ? state.quiet[i] + h : 0;
    ripe = ripe || state.quiet[i] >= kWait;
  }
  if (!ripe) return;

  // islands of which all have been still long enough, and no hand holds one
  join_touching(state);
  scratch_.ripe.assign(n, 1);
  for (int i = 0; i < n; ++i) {
    if (response_.moves(i) && state.quiet[i] < kWait) scratch_.ripe[touching_.root(i)] = 0;
  }
  for (const Grip<D>& grip : state.grips) {
    if (grip.body >= 0) scratch_.ripe[touching_.root(grip.body)] = 0;
  }
  save(state, interval_.begun);
  bool any = false;
  for (int i = 0; i < n; ++i) {
    if (!response_.moves(i) || !scratch_.ripe[touching_.root(i)]) continue;
    any = true;
    state.v[i].setZero();
    if (const int k = turning(state, i); k >= 0) state.spin[k].setZero();
  }
  if (!any) return;
  for (std::size_t i = 0; i < model_.chains.size(); ++i) {
    const int body = model_.chains[i].bodies[0];
    if (response_.moves(body) && scratch_.ripe[touching_.root(body)])
      std::fill(state.postures[i].v.begin(), state.postures[i].v.end(), 0.0);
  }

  // what they would do at rest
  find_contacts(state, limits_.touching_gap);
  const bool found = solve_modes(state, t);
  const auto still = free_.accelerations(state, t);
  scratch_.rate.assign(still.begin(), still.end());
  for (int i = 0; i < int(rows_.size()); ++i) add_accelerations(i, f_[i], scratch_.rate);
  const auto& members = free_.bodies();
  for (int k = 0; k < int(members.size()); ++k) {
    const int body = members[k];
    double a = std::sqrt(Eigen::Map<const Vec<D>>(scratch_.rate.data() + D * k).squaredNorm());
    if (const int at = free_.spin_start(k); at >= 0)
      a += limits_.bounding_radius[body] *
           std::sqrt(Eigen::Map<const AngularVec<D>>(scratch_.rate.data() + at).squaredNorm());
    if (!found || !(a <= kStatic * g)) scratch_.ripe[touching_.root(body)] = 0;
  }
  const auto& links = free_.chains().links();
  free_.chains().motions(std::span<const double>(scratch_.rate).subspan(std::size_t(free_.chain_start())),
                         scratch_.motions);
  for (std::size_t k = 0; k < links.size(); ++k) {
    const double a = std::sqrt(scratch_.motions[k].v.squaredNorm()) +
                     limits_.bounding_radius[links[k]] * std::sqrt(scratch_.motions[k].w.squaredNorm());
    if (!found || !(a <= kStatic * g)) scratch_.ripe[touching_.root(links[k])] = 0;
  }

  // which islands stay at rest, and which go on
  any = false;
  const auto decide = [&](int body) {
    if (scratch_.ripe[touching_.root(body)]) {
      state.frozen[body] = 1;
      any = true;
      return;
    }
    state.v[body] = interval_.begun.v[body];
    if (const int k = turning(state, body); k >= 0) state.spin[k] = interval_.begun.spin[k];
    if (state.quiet[body] >= kWait) state.quiet[body] = 0;
  };
  for (const int body : members) decide(body);
  for (const int body : links) decide(body);
  for (std::size_t i = 0; i < model_.chains.size(); ++i) {
    if (!state.frozen[model_.chains[i].bodies[0]]) state.postures[i].v = interval_.begun.postures[i].v;
  }
  if (any) record_forces();
}

template void ExactSolver<2>::join_touching(const State<2>&);
template bool ExactSolver<2>::wake(State<2>&);
template void ExactSolver<2>::put_to_sleep(State<2>&, double, double);
template void ExactSolver<3>::join_touching(const State<3>&);
template bool ExactSolver<3>::wake(State<3>&);
template void ExactSolver<3>::put_to_sleep(State<3>&, double, double);

}  // namespace obscura::sim
