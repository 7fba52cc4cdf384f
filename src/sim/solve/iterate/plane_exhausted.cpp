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
  // as pairs come, not as they are seated: a run that goes on seats them anew
  const auto place = [&](const std::pair<int, int>& of) {
    return std::pair(of.first, batches_[of.second / kLanes].first[of.second % kLanes]);
  };
  std::sort(lanes.begin(), lanes.end(), [&](const auto& p, const auto& q) { return place(p) < place(q); });
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
    for (int k = 0; k < g.touches[slot % kLanes]; ++k)
      if (may_bear(g, slot % kLanes, k)) touches.push_back({2 * slot + k, read_touch(2 * slot + k)});
  }
  const int rows = 2 * int(touches.size());
  island.resize(int(touches.size()));
  struct Side {
    int body;
    double x, y, turn;  // of the row
  };
  const auto side = [&](int i, bool of_b) -> Side {
    const Row<D>& row = touches[i / 2].at.rows[i % 2];
    const double sign = of_b ? -1 : 1;
    return {of_b ? row.b : row.a, sign * row.along[0], sign * row.along[1],
            sign * (of_b ? row.angular_b[0] : row.angular_a[0])};
  };
  for (int i = 0; i < rows; ++i) {
    const TouchRows& at = touches[i / 2].at;
    island.blocks[std::size_t(i / 2)] = {.mu = at.mu};
    island.speeds[i] = at.speed[i % 2], island.p[i] = at.impulse[i % 2];
    for (int j = 0; j <= i; ++j) {
      double sum = 0;
      for (const bool one : {false, true}) {
        const Side s = side(i, one);
        for (const bool other : {false, true}) {
          const Side o = side(j, other);
          if (s.body >= 0 && s.body == o.body)
            sum += moving_[s.body].im * (s.x * o.x + s.y * o.y) + ii_[s.body] * (s.turn * o.turn);
        }
      }
      island.K(i, j) = island.K(j, i) = sum;
    }
  }
  if (!island.solve()) return;
  for (int i = 0; i < rows; ++i) {
    double& impulse = touches[i / 2].at.impulse[i % 2];
    const double change = island.p[i] - impulse;
    impulse = island.p[i];
    for (const bool of_b : {false, true}) {
      const Side s = side(i, of_b);
      if (s.body < 0) continue;
      Motion& v = moving_[s.body];
      v.x += v.im * s.x * change, v.y += v.im * s.y * change, v.w += ii_[s.body] * s.turn * change;
    }
  }
  for (const Exhausted::Touch& touch : touches) write_touch(touch.number, touch.at);
}

// --- contacts one by one, numbered 2 slot + k, also for those of what hangs on joints
// (sim/solve/iterate/jointed_contacts.cpp)

bool PlaneIterative::may_bear(const ContactBatch& g, int lane, int k) {
  if (g.struck[k] >> lane & 1) return true;
  return !(g.gap[k][lane] > g.sight[lane]) && g.turns[k][lane] < plane::kOpen;
}

void PlaneIterative::list_touches(std::vector<TouchEnds>& touches) const {
  for (int i = 0; i < int(batches_.size()); ++i) {
    const ContactBatch& g = batches_[std::size_t(i)];
    for (int lane = 0; g.used && lane < kLanes; ++lane) {
      if (g.pair[lane] < 0) continue;
      for (int k = 0; k < g.touches[lane]; ++k) {
        if (!may_bear(g, lane, k)) continue;
        const int b = g.b[lane] < int(turns_.size()) ? g.b[lane] : -1;
        touches.push_back({g.first[lane] + k, 2 * (kLanes * i + lane) + k, g.a[lane], b});
      }
    }
  }
}

// m/s: what a touch of this gap is to have at the end of the substep at least
double PlaneIterative::least_speed(const ContactBatch& g, int slot, int k, double gap) const {
  const int lane = slot % kLanes;
  if (g.struck[k] >> lane & 1) return constants_.least[slot / kLanes].n[k][lane];
  return std::min(-gap / constants_.h, 0.0) - g.turns[k][lane];
}

std::array<Row<2>, 2> PlaneIterative::rows_of(const ContactBatch& g, int lane,
                                              const plane::TouchRow& r) const {
  std::array<Row<D>, D> rows;
  auto& [normal, across] = rows;
  normal.a = across.a = g.a[lane], normal.b = across.b = g.b[lane] < int(turns_.size()) ? g.b[lane] : -1;
  normal.along = {r.nx, r.ny}, normal.angular_a[0] = r.na, normal.angular_b[0] = r.nb;
  across.along = {-r.ny, r.nx}, across.angular_a[0] = r.ta, across.angular_b[0] = r.tb;
  return rows;
}

PlaneIterative::TouchRows PlaneIterative::read_touch(int number) const {
  const int slot = number / 2, k = number % 2, lane = slot % kLanes;
  const ContactBatch& g = batches_[std::size_t(slot / kLanes)];
  const plane::TouchRow r = middle_row(g, lane, k, middle_[g.a[lane]], middle_[g.b[lane]]);
  const Motion &va = moving_[g.a[lane]], &vb = moving_[g.b[lane]];
  TouchRows touch;
  touch.rows = rows_of(g, lane, r);
  touch.speed = {normal_speed(r, va, vb) - least_speed(g, slot, k, r.gap),
                 tangent_speed(r, va, vb) + g.surface[k][lane]};
  touch.impulse = {g.p[k][lane], g.q[k][lane]};
  touch.mu = g.mu[lane], touch.per_width = g.per_width[lane];
  return touch;
}

void PlaneIterative::write_touch(int number, const TouchRows& its) {
  const int slot = number / 2, k = number % 2, lane = slot % kLanes;
  ContactBatch& g = batches_[std::size_t(slot / kLanes)];
  g.p[k][lane] = its.impulse[0], g.q[k][lane] = its.impulse[1];
}

// --- those that joints leave nothing to move (sim/solve/iterate/locked_contacts.cpp)

std::array<Row<2>, 2> PlaneIterative::begun_rows(int number) const {
  const int slot = number / 2, lane = slot % kLanes;
  const ContactBatch& g = batches_[std::size_t(slot / kLanes)];
  const plane::TouchRow r = plane::row(g, lane, number % 2, poses_[g.a[lane]], poses_[g.b[lane]]);
  return rows_of(g, lane, r);
}

bool PlaneIterative::open_touch(int number) {
  const int slot = number / 2, k = number % 2, lane = slot % kLanes;
  ContactBatch& g = batches_[std::size_t(slot / kLanes)];
  if (g.struck[k] >> lane & 1) return false;
  const plane::TouchRow r = middle_row(g, lane, k, middle_[g.a[lane]], middle_[g.b[lane]]);
  const double x = -(g.p[k][lane] * r.nx - g.q[k][lane] * r.ny),
               y = -(g.p[k][lane] * r.ny + g.q[k][lane] * r.nx);
  const auto push = [&](int body, double sign, double turn) {
    Motion& v = moving_[std::size_t(body)];
    v.x += sign * v.im * x, v.y += sign * v.im * y, v.w += sign * ii_[std::size_t(body)] * turn;
  };
  push(g.a[lane], 1, -(r.na * g.p[k][lane] + r.ta * g.q[k][lane]));
  push(g.b[lane], -1, -(r.nb * g.p[k][lane] + r.tb * g.q[k][lane]));
  g.p[k][lane] = g.q[k][lane] = 0, g.turns[k][lane] = plane::kOpen;
  return true;
}

void PlaneIterative::bear_touch(StepPart<D> part, int number, double force) {
  const int slot = number / 2, k = number % 2, lane = slot % kLanes;
  ContactBatch& g = batches_[std::size_t(slot / kLanes)];
  const plane::TouchRow r = middle_row(g, lane, k, middle_[g.a[lane]], middle_[g.b[lane]]);
  g.p[k][lane] = force * r.nx, g.q[k][lane] = force * r.ny;
  if (part.substep + 1 < substeps_) return;
  Contact<D>& contact = part.state.contacts[std::size_t(g.first[lane] + k)];
  contact.force = {g.p[k][lane], g.q[k][lane]};
  if (force > 0) contact.touching = ContactMode::stick;
}

}  // namespace obscura::sim
