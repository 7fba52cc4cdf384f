// A hierarchical grid: level L has cells of side h = 2^L, and holds the boxes whose longest side is in
// [h / 2, h), each in the cell of its centre. A box asks all levels from its own up: there the boxes that it
// may meet have their centres within h / 2 of it, which is three cells along each axis at most.

#include "scene/meetings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace obscura::scene {

namespace {

template <int D>
struct Cell {
  int level = 0;
  std::array<std::int64_t, D> at{};

  auto operator<=>(const Cell&) const = default;
};

template <int D>
struct LevelEntry {
  Cell<D> cell;
  int kind = 0, box = 0;

  auto operator<=>(const LevelEntry&) const = default;
};

template <int D>
std::uint64_t hash(const Cell<D>& cell) {
  std::uint64_t h = std::uint64_t(cell.level) * 0x9e3779b97f4a7c15u;
  for (const std::int64_t k : cell.at) {
    h = (h ^ std::uint64_t(k)) * 0xbf58476d1ce4e5b9u;
    h ^= h >> 29;
  }
  return h;
}

std::int64_t index(double x) {
  constexpr double kFarthest = 4e18;
  return std::int64_t(std::clamp(std::floor(x), -kFarthest, kFarthest));
}

// the cells of all levels, found by hashing
template <int D>
class Grid {
 public:
  Grid(std::span<const sim::Bounds<D>> boxes, std::span<const int> kinds) : boxes_(boxes) {
    double farthest = 0;
    for (std::size_t i = 0; i < boxes.size(); ++i)
      if (kinds[i] >= 0)
        farthest =
            std::max({farthest, boxes[i].lower.cwiseAbs().maxCoeff(), boxes[i].upper.cwiseAbs().maxCoeff()});
    // rounding may hide less than a cell
    slack_ = 8 * std::numeric_limits<double>::epsilon() * farthest;
    const int least = std::ilogb(std::max(16 * slack_, 1e-290));
    level_.assign(boxes.size(), least);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const double side = (boxes[i].upper - boxes[i].lower).maxCoeff();
      if (kinds[i] >= 0 && side > 0) level_[i] = std::max(least, std::ilogb(side) + 1);
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (kinds[i] < 0) continue;
      const double h = std::ldexp(1.0, level_[i]);
      LevelEntry<D> entry{{level_[i], {}}, kinds[i], int(i)};
      for (int k = 0; k < D; ++k)
        entry.cell.at[std::size_t(k)] = index((boxes[i].lower[k] + boxes[i].upper[k]) / 2 / h);
      entries_.push_back(entry);
      levels_.push_back(level_[i]);
    }
    std::sort(entries_.begin(), entries_.end());
    std::sort(levels_.begin(), levels_.end());
    levels_.erase(std::unique(levels_.begin(), levels_.end()), levels_.end());
    link();
  }

  // calls seen(box) for those near box i that are of its level and before it, or of a higher one; false: stop
  template <class Matter, class Seen>
  bool near(int i, const Matter& matter, const Seen& seen) const {
    const sim::Bounds<D>& own = boxes_[std::size_t(i)];
    const int level = level_[std::size_t(i)];
    for (auto of = std::lower_bound(levels_.begin(), levels_.end(), level); of != levels_.end(); ++of) {
      const double h = std::ldexp(1.0, *of), reach = h / 2 + slack_;
      Cell<D> low{*of, {}}, high{*of, {}};
      for (std::size_t k = 0; k < std::size_t(D); ++k) {
        low.at[k] = index((own.lower[int(k)] - reach) / h);
        high.at[k] = index((own.upper[int(k)] + reach) / h);
      }
      for (Cell<D> cell = low;;) {
        if (!in(cell, *of == level ? i : std::numeric_limits<int>::max(), matter, seen)) return false;
        std::size_t k = 0;
        for (; k < std::size_t(D) && cell.at[k] == high.at[k]; ++k) cell.at[k] = low.at[k];
        if (k == std::size_t(D)) break;
        ++cell.at[k];
      }
    }
    return true;
  }

 private:
  // the hash table, and of each entry where the next kind or cell begins
  void link() {
    const std::size_t n = entries_.size();
    next_kind_.assign(n, int(n));
    std::size_t cells = 0;
    for (std::size_t i = n; i-- > 0;) {
      const bool last = i + 1 == n || entries_[i + 1].cell != entries_[i].cell;
      next_kind_[i] = last || entries_[i + 1].kind != entries_[i].kind ? int(i) + 1 : next_kind_[i + 1];
      cells += last;
    }
    std::size_t slots = 16;
    while (slots < 2 * cells) slots *= 2;
    slots_.assign(slots, -1);
    for (std::size_t i = 0; i < n; ++i) {
      if (i > 0 && entries_[i - 1].cell == entries_[i].cell) continue;
      std::size_t slot = hash(entries_[i].cell) & (slots - 1);
      while (slots_[slot] >= 0) slot = (slot + 1) & (slots - 1);
      slots_[slot] = int(i);
    }
  }

  int first(const Cell<D>& cell) const {
    std::size_t slot = hash(cell) & (slots_.size() - 1);
    for (; slots_[slot] >= 0; slot = (slot + 1) & (slots_.size() - 1))
      if (entries_[std::size_t(slots_[slot])].cell == cell) return slots_[slot];
    return -1;
  }

  template <class Matter, class Seen>
  bool in(const Cell<D>& cell, int before, const Matter& matter, const Seen& seen) const {
    const int begin = first(cell), n = int(entries_.size());
    for (int e = begin; e >= 0 && e < n && entries_[std::size_t(e)].cell == cell;) {
      const int end = next_kind_[std::size_t(e)];
      if (matter(entries_[std::size_t(e)].kind))
        for (; e < end && entries_[std::size_t(e)].box < before; ++e)
          if (!seen(entries_[std::size_t(e)].box)) return false;
      e = end;
    }
    return true;
  }

  std::span<const sim::Bounds<D>> boxes_;
  double slack_ = 0;                    // m
  std::vector<int> level_;              // one a box
  std::vector<int> levels_;             // those that there are
  std::vector<LevelEntry<D>> entries_;  // sorted
  std::vector<int> next_kind_;          // one an entry
  std::vector<int> slots_;              // the first entry of a cell, or -1
};

}  // namespace

template <int D>
std::int64_t meetings(std::span<const sim::Bounds<D>> boxes, std::span<const int> kinds,
                      const std::function<bool(int, int)>& matter,
                      const std::function<bool(int, int)>& meet) {
  const Grid<D> grid(boxes, kinds);
  std::int64_t compared = 0;
  for (int i = 0; i < int(boxes.size()); ++i) {
    const int kind = kinds[std::size_t(i)];
    if (kind < 0) continue;
    const bool go_on = grid.near(
        i, [&](int other) { return matter(kind, other); },
        [&](int other) {
          ++compared;
          return !boxes[std::size_t(i)].meets(boxes[std::size_t(other)]) ||
                 meet(std::min(i, other), std::max(i, other));
        });
    if (!go_on) break;
  }
  return compared;
}

template std::int64_t meetings<2>(std::span<const sim::Bounds<2>>, std::span<const int>,
                                  const std::function<bool(int, int)>&, const std::function<bool(int, int)>&);
template std::int64_t meetings<3>(std::span<const sim::Bounds<3>>, std::span<const int>,
                                  const std::function<bool(int, int)>&, const std::function<bool(int, int)>&);

}  // namespace obscura::scene
