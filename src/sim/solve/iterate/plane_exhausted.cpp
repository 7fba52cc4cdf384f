// Which islands are solved exactly (sim/solve/iterate/exact_island.h), and their rows.

#include <algorithm>

#include "sim/solve/iterate/plane.h"

namespace obscura::sim {

namespace {

using plane::ActiveBodies;
using plane::ContactBatch;
using plane::kLanes;

}  // namespace

// the islands of bodies that are still active
void PlaneIterative::solve_exhausted() {
  const std::vector<unsigned char>& flags = active_bodies_.bodies;
  const auto active = [](unsigned char flag) {
    return (flag & (ActiveBodies::kNow | ActiveBodies::kNever)) == ActiveBodies::kNow;
  };
  if (std::none_of(flags.begin(), flags.end(), active)) return;
  const int n = int(turns_.size());
  const auto moves = [&](int body) { return moving_[body].im > 0; };
  const auto each_lane = [&](auto&& act) {
    for (ContactBatch& g : batches_) {
      for (int lane = 0; g.used && lane < kLanes; ++lane) {
        if (g.pair[lane] >= 0 && !((flags[g.a[lane]] | flags[g.b[lane]]) & ActiveBodies::kNever))
          act(g, lane);
      }
    }
  };
  exhausted_.sets.reset(n + 1);
  each_lane([&](ContactBatch& g, int lane) {
    if (moves(g.a[lane]) && moves(g.b[lane])) exhausted_.sets.join(g.a[lane], g.b[lane]);
  });
  // contacts of each island, at its root; none where it has settled
  exhausted_.contacts.assign(n + 1, -1);
  for (int i = 0; i < n; ++i) {
    if (moves(i) && active(flags[i])) exhausted_.contacts[exhausted_.sets.root(i)] = 0;
  }
  const auto root = [&](const ContactBatch& g, int lane) {
    return exhausted_.sets.root(moves(g.a[lane]) ? g.a[lane] : g.b[lane]);
  };
  each_lane([&](ContactBatch& g, int lane) {
    if (int& count = exhausted_.contacts[root(g, lane)]; count >= 0) count += g.touches[lane];
  });
  std::vector<std::pair<int, int>>& lanes = exhausted_.lanes;
  lanes.clear();
  each_lane([&](ContactBatch& g, int lane) {
    const int count = exhausted_.contacts[root(g, lane)];
    if (count > 0 && count <= kFewSolved)
      lanes.emplace_back(root(g, lane), kLanes * int(&g - batches_.data()) + lane);
  });
  std::sort(lanes.begin(), lanes.end());
  for (std::size_t first = 0, last = 0; first < lanes.size(); first = last) {
    while (last < lanes.size() && lanes[last].first == lanes[first].first) ++last;
    solve_together(std::span(lanes).subspan(first, last - first));
  }
}

// the contacts of some lanes
void PlaneIterative::solve_together(std::span<const std::pair<int, int>> lanes) {
  std::vector<Exhausted::Touch>& touches = exhausted_.touches;
  ExactIsland<2>& island = exhausted_.island;
  touches.clear();
  for (const auto& [root, slot] : lanes) {
    const ContactBatch& g = batches_[slot / kLanes];
    const int lane = slot % kLanes;
    for (int k = 0; k < g.touches[lane]; ++k) {
      const plane::TouchRow r = middle_row(g, lane, k, middle_[g.a[lane]], middle_[g.b[lane]]);
      const bool struck = g.struck[k] >> lane & 1;
      if (r.gap > g.sight[lane] && !struck) continue;
      touches.push_back({slot, k, r});
    }
  }
  const int rows = 2 * int(touches.size());
  exhausted_.island.resize(int(touches.size()));
  struct Side {
    int body;
    double x, y, turn;  // of the row
  };
  const auto side = [&](int i, bool of_b) -> Side {
    const auto& [slot, k, r] = touches[i / 2];
    const ContactBatch& g = batches_[slot / kLanes];
    const double sign = of_b ? -1 : 1;
    const int body = of_b ? g.b[slot % kLanes] : g.a[slot % kLanes];
    if (i % 2 == 0) return {body, sign * r.nx, sign * r.ny, sign * (of_b ? r.nb : r.na)};
    return {body, -sign * r.ny, sign * r.nx, sign * (of_b ? r.tb : r.ta)};
  };
  for (int i = 0; i < rows; ++i) {
    const auto& [slot, k, r] = touches[i / 2];
    const ContactBatch& g = batches_[slot / kLanes];
    const int lane = slot % kLanes;
    const Motion &va = moving_[g.a[lane]], &vb = moving_[g.b[lane]];
    if (i % 2 == 0) {
      island.blocks[std::size_t(i / 2)] = {.mu = g.mu[lane]};
      const bool struck = g.struck[k] >> lane & 1;
      const double least = struck ? constants_.least[slot / kLanes].n[k][lane]
                                  : std::min(-r.gap / constants_.h, 0.0) - g.turns[k][lane];
      island.speeds[i] = normal_speed(r, va, vb) - least, island.p[i] = g.p[k][lane];
    } else {
      island.speeds[i] = tangent_speed(r, va, vb) + g.surface[k][lane];
      island.p[i] = g.q[k][lane];
    }
    for (int j = 0; j <= i; ++j) {
      double sum = 0;
      for (const bool one : {false, true}) {
        const Side s = side(i, one);
        const double ii = s.body < int(ii_.size()) ? ii_[s.body] : 0;
        for (const bool other : {false, true}) {
          const Side o = side(j, other);
          if (s.body == o.body) sum += moving_[s.body].im * (s.x * o.x + s.y * o.y) + ii * (s.turn * o.turn);
        }
      }
      island.K(i, j) = island.K(j, i) = sum;
    }
  }
  const Eigen::VectorXd before = island.p;
  if (!island.solve()) return;
  for (int i = 0; i < rows; ++i) {
    const auto& [slot, k, r] = touches[i / 2];
    ContactBatch& g = batches_[slot / kLanes];
    (i % 2 == 0 ? g.p : g.q)[k][slot % kLanes] = island.p[i];
    const double change = island.p[i] - before[i];
    for (const bool of_b : {false, true}) {
      const Side s = side(i, of_b);
      Motion& v = moving_[s.body];
      const double ii = s.body < int(ii_.size()) ? ii_[s.body] : 0;
      v.x += v.im * s.x * change, v.y += v.im * s.y * change, v.w += ii * s.turn * change;
    }
  }
}

}  // namespace obscura::sim
