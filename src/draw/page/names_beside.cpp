// Names stand beside the heads of their lines, as far from each other as they are high, in the order of the
// heads. Lines that wind about each other so fast that names would flicker keep their order. While an order
// holds, names glide: their distances from their heads are averaged over a while.

#include "draw/page/names_beside.h"

#include <algorithm>
#include <numeric>

#include "draw/page/plot.h"

namespace obscura::draw {
namespace {

constexpr double kSettle = 0.02;   // of the run, at each side: over which the places of names are averaged
constexpr double kPassed = 0.5;    // of the names' distance: so far past each other lines change their order
constexpr double kBriefly = 0.02;  // of the run: an order for so short a while is none

// What holds for fewer than `least` instants becomes what was before, or at the start what comes after; where
// nothing holds for longer, what holds for most of the time.
void drop_brief(std::vector<char>& all, std::size_t least) {
  std::size_t kept = 0;  // up to there
  for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
    while (last < all.size() && all[last] == all[first]) ++last;
    if (last - first >= least && kept == 0)
      std::fill(all.begin(), all.begin() + std::ptrdiff_t(first), all[first]);
    if (last - first >= least) kept = last;
    if (last - first < least && kept > 0)
      std::fill(all.begin() + std::ptrdiff_t(first), all.begin() + std::ptrdiff_t(last), all[kept - 1]);
  }
  if (kept == 0 && !all.empty()) {
    const auto set = std::count(all.begin(), all.end(), 1);
    std::fill(all.begin(), all.end(), char(2 * std::size_t(set) > all.size()));
  }
}

// The lines from the uppermost down, at each instant: by the pairs' orders, each of which changes where the
// pair has passed each other, and not briefly.
std::vector<std::vector<int>> ranked(const std::vector<std::vector<double>>& heads, double passed) {
  const std::size_t n = heads.size(), count = heads[0].size(), least = std::size_t(kBriefly * double(n));
  std::vector<std::vector<int>> under(n, std::vector<int>(count, 0));  // how many each is below
  std::vector<char> below(n);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      for (std::size_t k = 0; k < n; ++k) {
        const double by = heads[k][i] - heads[k][j];
        below[k] = k == 0 ? by >= 0 : below[k - 1] ? by > -passed : by > passed;
      }
      drop_brief(below, least);
      for (std::size_t k = 0; k < n; ++k) ++under[k][below[k] ? i : j];
    }
  }
  std::vector<std::vector<int>> orders(n);
  for (std::size_t k = 0; k < n; ++k) {
    orders[k] = k > 0 ? orders[k - 1] : std::vector<int>(count);
    if (k == 0) std::iota(orders[0].begin(), orders[0].end(), 0);
    std::stable_sort(orders[k].begin(), orders[k].end(),
                     [&](int a, int b) { return under[k][std::size_t(a)] < under[k][std::size_t(b)]; });
  }
  return orders;
}

}  // namespace

NamePlaces names_beside(const std::vector<std::vector<double>>& heads, double apart, double low,
                        double high) {
  const std::size_t n = heads.size(), count = n > 0 ? heads[0].size() : 0;
  if (count == 0) return {};
  const std::vector<std::vector<int>> orders = ranked(heads, kPassed * apart);

  NamePlaces found{{count, std::vector<double>(n, 0)}, {}};
  found.changes.resize(count);
  const auto reach = std::size_t(kSettle * double(n));
  for (std::size_t first = 0, last = 0; first < n; first = last) {
    while (last < n && orders[last] == orders[first]) ++last;
    for (std::size_t rank = 0; first > 0 && rank < count; ++rank) {
      const int line = orders[first][rank];
      if (line != orders[first - 1][rank]) found.changes[std::size_t(line)].push_back(first);
    }
    // the mean over the instants around each with this order, by sums of all before
    std::vector<std::vector<double>> sums(last - first + 1, std::vector<double>(count, 0));
    for (std::size_t k = first; k < last; ++k) {
      const std::vector<double> names = spread(heads[k], apart, low, high, orders[k]);
      for (std::size_t i = 0; i < count; ++i)
        sums[k - first + 1][i] = sums[k - first][i] + names[i] - heads[k][i];
    }
    for (std::size_t k = first; k < last; ++k) {
      const std::size_t from = std::max(first + reach, k) - reach - first;
      const std::size_t to = std::min(last, k + reach + 1) - first;
      std::vector<double> names = heads[k];
      for (std::size_t i = 0; i < count; ++i) names[i] += (sums[to][i] - sums[from][i]) / double(to - from);
      names = spread(names, apart, low, high, orders[k]);
      for (std::size_t i = 0; i < count; ++i) found.offsets[i][k] = names[i] - heads[k][i];
    }
  }
  return found;
}

}  // namespace obscura::draw
