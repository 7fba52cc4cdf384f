// Names stand beside the heads of their lines, as far from each other as they are high, in the order of the
// heads. Lines that wind about each other so fast that names would flicker, or narrowly, keep their order.
// While an order
// holds, names glide: their distances from their heads are averaged over a while.

#include "draw/page/names_beside.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "draw/page/plot.h"

namespace obscura::draw {
namespace {

constexpr double kSettle = 0.02;  // of the run, at each side: over which the places of names are averaged
constexpr double kPassed =
    0.15;  // of the names' distance: lines that come so far past each other change order
constexpr double kBriefly = 0.02;  // of the run: an order for so short a while is none
constexpr double kNear = 0.5;      // of the names' distance: heads no farther past each other
constexpr double kShortly = 0.06;  // of the run: an order of heads so near, for so short a while, is none

// What holds for fewer instants than `least` says becomes what was before, or at the start what comes after;
// where nothing holds for longer, what holds for most of the time.
void drop_brief(std::vector<char>& all, const std::function<std::size_t(std::size_t, std::size_t)>& least) {
  std::size_t kept = 0;  // up to there
  for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
    while (last < all.size() && all[last] == all[first]) ++last;
    const bool holds = last - first >= least(first, last);
    if (holds && kept == 0) std::fill(all.begin(), all.begin() + std::ptrdiff_t(first), all[first]);
    if (holds) kept = last;
    if (!holds && kept > 0)
      std::fill(all.begin() + std::ptrdiff_t(first), all.begin() + std::ptrdiff_t(last), all[kept - 1]);
  }
  if (kept == 0 && !all.empty()) {
    const auto set = std::count(all.begin(), all.end(), 1);
    std::fill(all.begin(), all.end(), char(2 * std::size_t(set) > all.size()));
  }
}

// The lines from the uppermost down, at each instant: by the pairs' orders, each of which changes where the
// pair has passed each other, and not briefly.
std::vector<std::vector<int>> ranked(const std::vector<std::vector<double>>& heads,
                                     const std::vector<double>& heights) {
  const std::size_t n = heads.size(), count = heads[0].size();
  std::vector<std::vector<int>> under(n, std::vector<int>(count, 0));  // how many each is below
  std::vector<char> below(n);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double apart = (heights[i] + heights[j]) / 2, passed = kPassed * apart;
      const auto by = [&](std::size_t k) { return heads[k][i] - heads[k][j]; };
      for (std::size_t k = 0; k < n; ++k)
        below[k] = k == 0 ? by(k) >= 0 : below[k - 1] ? by(k) > -passed : by(k) > passed;
      // the order has changed since they met
      for (std::size_t k = n; k-- > 1;)
        if (below[k] != below[k - 1] && by(k - 1) != 0 && (by(k - 1) > 0) == (below[k] != 0))
          below[k - 1] = below[k];
      drop_brief(below, [&](std::size_t first, std::size_t last) {
        double most = 0;
        for (std::size_t k = first; k < last; ++k) most = std::max(most, std::abs(by(k)));
        return std::size_t((most < kNear * apart ? kShortly : kBriefly) * double(n));
      });
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

NamePlaces names_beside(const std::vector<std::vector<double>>& heads, const std::vector<double>& heights,
                        double low, double high) {
  const std::size_t n = heads.size(), count = n > 0 ? heads[0].size() : 0;
  if (count == 0) return {};
  const std::vector<std::vector<int>> orders = ranked(heads, heights);

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
      const std::vector<double> names = spread(heads[k], heights, low, high, orders[k]);
      for (std::size_t i = 0; i < count; ++i)
        sums[k - first + 1][i] = sums[k - first][i] + names[i] - heads[k][i];
    }
    for (std::size_t k = first; k < last; ++k) {
      const std::size_t from = std::max(first + reach, k) - reach - first;
      const std::size_t to = std::min(last, k + reach + 1) - first;
      std::vector<double> names = heads[k];
      for (std::size_t i = 0; i < count; ++i) names[i] += (sums[to][i] - sums[from][i]) / double(to - from);
      names = spread(names, heights, low, high, orders[k]);
      for (std::size_t i = 0; i < count; ++i) found.offsets[i][k] = names[i] - heads[k][i];
    }
  }
  return found;
}

}  // namespace obscura::draw
