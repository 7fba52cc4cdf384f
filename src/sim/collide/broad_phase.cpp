// A sweep along x over horizontal bands. Bodies enter in the order of their lower ends; each looks only at
// those in its own bands that the sweep has not yet left; those of a band are kept in four lists, moving or
// still and points or not, so that it passes over the lists that cannot concern it. Bands are as high as two
// bodies and wrap around, as a hash would, so that one body far away does not spoil them; a pair is told in
// the first band that both share. The order along x is nearly that of the last step, so that sorting it by
// insertion is linear.

#include "sim/collide/broad_phase.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

namespace obscura::sim {

namespace {

constexpr int kBands = 256;         // a power of two
constexpr int kBodyKinds = 4;       // of bodies: moving, still, moving points, still points
constexpr double kMostBands = 1e9;  // bands; beyond, all share one

// sorts as the number does, and NaN somewhere
std::int64_t sortable(double x) {
  const auto bits = std::bit_cast<std::int64_t>(x);
  return bits >= 0 ? bits : bits ^ 0x7fffffffffffffff;
}

int band(double y) {
  if (!(y > -kMostBands)) return -int(kMostBands);
  const auto toward_zero = int(std::min(y, kMostBands));
  return toward_zero - (double(toward_zero) > y);
}

// mean height, without those that are far above it
template <int D>
double usual_height(std::span<const Bounds<D>> bounds) {
  double limit = 1e300, mean = 0;
  for (int round = 0; round < 2; ++round) {
    double sum = 0;
    int n = 0;
    for (const Bounds<D>& one : bounds) {
      const double height = one.upper[1] - one.lower[1];
      if (!(height <= limit)) continue;
      sum += height;
      ++n;
    }
    mean = n > 0 ? sum / n : 0;
    limit = 4 * mean;
  }
  return mean;
}

}  // namespace

template <int D>
const std::vector<std::pair<int, int>>& BroadPhase<D>::find(std::span<const Bounds<D>> bounds,
                                                            std::span<const char> still,
                                                            const std::function<bool(int, int)>& wanted,
                                                            std::span<const char> points) {
  assert(bounds.size() == still.size() && (points.empty() || points.size() == still.size()));
  found_.clear();
  pairs_.clear();
  compared_ = 0;
  if (std::find(still.begin(), still.end(), 0) == still.end()) return pairs_;
  sort_along_x(bounds);
  lay_bands(bounds, still, points);
  sweep(bounds, wanted, points.empty() ? 2 : kBodyKinds);
  sort_pairs(int(bounds.size()));
  return pairs_;
}

template <int D>
void BroadPhase<D>::sort_along_x(std::span<const Bounds<D>> bounds) {
  if (order_.size() != bounds.size()) {
    order_.resize(bounds.size());
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i].body = int(i);
  }
  for (Place& place : order_) place.key = sortable(bounds[place.body].lower[0]);

  // by insertion, unless it is far from sorted
  std::size_t moves = 0;
  for (std::size_t i = 1; i < order_.size(); ++i) {
    const Place place = order_[i];
    std::size_t k = i;
    for (; k > 0 && place < order_[k - 1]; --k) order_[k] = order_[k - 1];
    order_[k] = place;
    moves += i - k;
    if (moves > 8 * order_.size()) {
      std::sort(order_.begin(), order_.end());
      return;
    }
  }
}

template <int D>
void BroadPhase<D>::lay_bands(std::span<const Bounds<D>> bounds, std::span<const char> still,
                              std::span<const char> points) {
  const double usual = usual_height<D>(bounds);
  const double bands_per_metre = usual > 0 ? 0.5 / usual : 1;
  spans_.resize(bounds.size());
  kinds_.resize(bounds.size());
  starts_.assign(kBands * kBodyKinds + 1, 0);
  lengths_.assign(kBands * kBodyKinds, 0);
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const int first = band(bounds[i].lower[1] * bands_per_metre);
    const int last = std::min(band(bounds[i].upper[1] * bands_per_metre), first + kBands - 1);
    spans_[i] = {first, last};
    kinds_[i] = char((still[i] ? 1 : 0) + (!points.empty() && points[i] ? 2 : 0));
    for (int k = first; k <= last; ++k) ++starts_[(k & (kBands - 1)) * kBodyKinds + kinds_[i] + 1];
  }
  for (int k = 0; k < kBands * kBodyKinds; ++k) starts_[k + 1] += starts_[k];
  near_.resize(bounds.size());
  const int all = starts_.back();
  if (active_.size() < std::size_t(all)) active_.resize(all + all / 2);
}

template <int D>
void BroadPhase<D>::sweep(std::span<const Bounds<D>> bounds, const std::function<bool(int, int)>& wanted,
                          int kinds) {
  Entry* const active = active_.data();
  const int* const starts = starts_.data();
  const Span* const spans = spans_.data();
  int *const lengths = lengths_.data(), *const near_bodies = near_.data();
  for (const Place& place : order_) {
    const int body = place.body, kind = kinds_[body];
    const Bounds<D>& own = bounds[body];
    const Span span = spans[body];
    const double left = own.lower[0], low = own.lower[1], high = own.upper[1];
    for (int k = span.first; k <= span.last; ++k) {
      const int lists = (k & (kBands - 1)) * kBodyKinds;
      for (int of = 0; of < kinds; ++of) {
        // two that are still, or points, do not concern each other
        if ((of & kind) != 0) continue;
        const int list = lists + of, length = lengths[list];
        Entry* const in_band = active + starts[list];

        // forgets those that the sweep has left, and collects the near, without a branch to guess
        int kept = 0, near = 0;
        for (int i = 0; i < length; ++i) {
          const Entry other = in_band[i];
          const bool entered = other.right >= left;
          in_band[kept] = other;
          kept += entered;
          near_bodies[near] = other.body;
          near += entered & (low <= other.high) & (other.low <= high);
        }
        lengths[list] = kept;
        compared_ += length;

        for (int i = 0; i < near; ++i) {
          const int other = near_bodies[i];
          if (((std::max(span.first, spans[other].first) - k) & (kBands - 1)) != 0) continue;
          if constexpr (D > 2) {
            if (!own.meets(bounds[other])) continue;
          }
          const auto [a, b] = std::minmax(body, other);
          if (!wanted || wanted(a, b)) found_.emplace_back(a, b);
        }
      }
      const int list = lists + kind;
      active[starts[list] + lengths[list]++] = {own.upper[0], low, high, body};
    }
  }
}

// by counting on a, then by b
template <int D>
void BroadPhase<D>::sort_pairs(int bodies) {
  offsets_.assign(bodies + 1, 0);
  for (const auto& pair : found_) ++offsets_[pair.first + 1];
  for (int a = 0; a < bodies; ++a) offsets_[a + 1] += offsets_[a];
  pairs_.resize(found_.size());
  for (const auto& pair : found_) pairs_[offsets_[pair.first]++] = pair;
  auto from = pairs_.begin();
  for (int a = 0; a < bodies; ++a) {
    const auto to = pairs_.begin() + offsets_[a];
    if (to - from > 1) std::sort(from, to);
    from = to;
  }
}

template class BroadPhase<2>;
template class BroadPhase<3>;

}  // namespace obscura::sim
