#include "sim/solve/iterate/settling.h"

#include <algorithm>

#include "sim/solve/iterate/substeps.h"

namespace obscura::sim {

void Settling::begin(std::span<const ContactConstraint<3>> contacts, std::span<const int> which,
                     std::span<const PointBody<3>> moving, std::span<const int> never) {
  const int n = int(moving.size());
  flags.assign(moving.size(), kNow);
  for (const int body : never) flags[std::size_t(body)] = kNever;
  const auto counts = [&](int body) {
    return moving[std::size_t(body)].inverse_mass > 0 && !(flags[std::size_t(body)] & kNever);
  };
  sets_.reset(n), pairs_.clear();
  for (const int i : which) {
    const ContactConstraint<3>& contact = contacts[std::size_t(i)];
    if (pairs_.empty() || pairs_.back().a != contact.a || pairs_.back().b != contact.b) {
      if (counts(contact.a) && counts(contact.b)) sets_.join(contact.a, contact.b);
      pairs_.push_back({contact.a, contact.b});
    }
    Pair& pair = pairs_.back();
    ++pair.contacts, pair.rate = std::max(pair.rate, contact.rate);
  }
  islands.clear(), island_of.assign(moving.size(), -1);
  for (const Pair& pair : pairs_) {
    if ((flags[std::size_t(pair.a)] | flags[std::size_t(pair.b)]) & kNever) continue;
    const int body = counts(pair.a) ? pair.a : pair.b;
    if (!counts(body)) continue;
    int& number = island_of[std::size_t(sets_.root(body))];
    if (number < 0) number = int(islands.size()), islands.emplace_back();
    Island& island = islands[std::size_t(number)];
    island.contacts += pair.contacts, island.rate = std::max(island.rate, pair.rate);
    if (pair.rate < kQuiet) island.quiet += pair.contacts;
  }
  for (int i = 0; i < n; ++i) {
    if (const int number = island_of[std::size_t(sets_.root(i))]; number >= 0 && counts(i)) {
      Island& island = islands[std::size_t(number)];
      island_of[std::size_t(i)] = number, ++island.last;
      island.mass += 1 / moving[std::size_t(i)].inverse_mass;
    }
  }
  int first = 0;
  for (Island& island : islands) {
    const int count = island.last;
    island.first = island.last = first, first += count;
  }
  bodies.resize(std::size_t(first));
  for (int i = 0; i < n; ++i) {
    if (const int number = island_of[std::size_t(i)]; number >= 0)
      bodies[std::size_t(islands[std::size_t(number)].last++)] = i;
  }
  narrowed = false;
  before_.assign(moving.begin(), moving.end());
}

void Settling::compare_velocities(std::span<const PointBody<3>> moving, std::span<const double> radii) {
  constexpr double kAlike = 1e-3;  // of what counts as no correction
  for (Island& island : islands) {
    if (!island.open) continue;
    double most = 0;
    for (int i = island.first; i < island.last; ++i) {
      const auto body = std::size_t(bodies[std::size_t(i)]);
      const PointBody<3>& now = moving[body];
      PointBody<3>& then = before_[body];
      const double r = radii[body];
      const double turns = r * r * (now.w - then.w).squaredNorm();
      most = std::max(most, ((now.v - then.v).squaredNorm() + turns) / (r * r));
      then = now;
    }
    if (most <= kAlike * kAlike * island.settled * island.settled) island.changed = false;
  }
}

bool Settling::close_settled() {
  bool any = false;
  for (Island& island : islands) {
    if (!island.open) continue;
    island.open = island.changed && island.spent < island.budget;
    any = any || island.open, narrowed = narrowed || !island.open;
    if (island.open) continue;
    island.exhausted = island.changed;
    for (int i = island.first; i < island.last; ++i) flags[std::size_t(bodies[std::size_t(i)])] = 0;
  }
  return any;
}

void Settling::activate_next() {
  for (const Island& island : islands) {
    if (!island.open) continue;
    for (int i = island.first; i < island.last; ++i) {
      unsigned char& flag = flags[std::size_t(bodies[std::size_t(i)])];
      flag = island.follows || (flag & kNext) ? kNow : 0;
    }
  }
}

}  // namespace obscura::sim
