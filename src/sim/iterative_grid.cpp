#include "sim/iterative_grid.h"

#include <algorithm>
#include <cmath>

namespace obscura::sim::sweep {

namespace {

constexpr std::int64_t kWide = 16;  // cells: more, and it is held against everyone

}  // namespace

Grid::Cells Grid::cells(const Bounds& b) const {
  const auto cell = [&](double at) {
    return std::int64_t(std::floor(std::clamp(at * per_cell_, -1e15, 1e15)));
  };
  return {cell(b.left), cell(b.bottom), cell(b.right), cell(b.top)};
}

void Grid::fill(const std::vector<Bounds>& bounds) {
  bounds_ = &bounds;
  const int n = int(bounds.size());
  wide_.clear();
  is_wide_.assign(n, 0);
  if (n == 0) return;

  // as wide as three of four of them
  widths_.clear();
  for (const Bounds& b : bounds) widths_.push_back(std::max(b.right - b.left, b.top - b.bottom));
  std::nth_element(widths_.begin(), widths_.begin() + 3 * n / 4, widths_.end());
  per_cell_ = 1 / std::max(widths_[3 * n / 4], 1e-9);

  int bits = 1;
  while (1 << bits < 2 * n) ++bits;
  shift_ = 64 - bits;
  start_.assign((std::size_t(1) << bits) + 1, 0);

  // count, then place: entries of a bucket ascend
  for (int i = 0; i < n; ++i) {
    const Cells c = cells(bounds[i]);
    if ((c.right - c.left + 1) > kWide || (c.right - c.left + 1) * (c.top - c.bottom + 1) > kWide) {
      wide_.push_back(i), is_wide_[i] = 1;
      continue;
    }
    for (auto y = c.bottom; y <= c.top; ++y)
      for (auto x = c.left; x <= c.right; ++x) ++start_[bucket(x, y) + 1];
  }
  for (std::size_t k = 1; k < start_.size(); ++k) start_[k] += start_[k - 1];
  entries_.resize(start_.back());
  for (int i = n; i-- > 0;) {
    if (is_wide_[i]) continue;
    const Cells c = cells(bounds[i]);
    for (auto y = c.bottom; y <= c.top; ++y)
      for (auto x = c.left; x <= c.right; ++x) entries_[--start_[bucket(x, y) + 1]] = i;
  }
  // now start_[k + 1] begins bucket k
}

void Grid::after(int i, std::vector<int>& out) const {
  out.clear();
  const std::vector<Bounds>& bounds = *bounds_;
  const Bounds& mine = bounds[i];
  if (is_wide_[i]) {
    for (int j = i + 1; j < int(bounds.size()); ++j)
      if (mine.meets(bounds[j])) out.push_back(j);
    return;
  }
  const Cells c = cells(mine);
  for (auto y = c.bottom; y <= c.top; ++y) {
    for (auto x = c.left; x <= c.right; ++x) {
      const std::size_t k = bucket(x, y) + 1;
      const int last = k + 1 < start_.size() ? start_[k + 1] : int(entries_.size());
      for (int e = start_[k]; e < last; ++e) {
        const int j = entries_[e];
        if (j > i && mine.meets(bounds[j])) out.push_back(j);
      }
    }
  }
  for (const int j : wide_)
    if (j > i && mine.meets(bounds[j])) out.push_back(j);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

}  // namespace obscura::sim::sweep
