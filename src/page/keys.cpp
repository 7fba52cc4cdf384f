#include "page/keys.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace obscura::page {
namespace {

struct CubicPiece {
  std::int64_t end = 0, a = 0, b = 0;  // in steps
};

// The piece over n frames from values[from] on, which begins at `start` steps; none where a frame is farther
// from it than `bound` steps.
std::optional<CubicPiece> piece(const std::vector<double>& values, std::size_t from, std::size_t n,
                                std::int64_t start, double step, double bound) {
  CubicPiece found;
  const auto at = [&](std::size_t k) { return values[from + k] / step; };
  found.end = std::llround(at(n));
  const double p = double(start), q = double(found.end);
  if (n == 1) return found;
  // least squares for what a straight line leaves
  double aa = 0, ab = 0, bb = 0, ra = 0, rb = 0;
  for (std::size_t k = 1; k < n; ++k) {
    const double u = double(k) / double(n), v = 1 - u, f = 3 * u * v * v, g = 3 * u * u * v;
    const double r = at(k) - (p + u * (q - p));
    aa += f * f, ab += f * g, bb += g * g, ra += f * r, rb += g * r;
  }
  const double det = aa * bb - ab * ab;
  if (n == 2 || !(det > 1e-12 * aa * bb)) {
    // one frame between: a = b
    found.a = found.b = std::llround(ra / (aa + ab));
  } else {
    found.a = std::llround((ra * bb - rb * ab) / det), found.b = std::llround((rb * aa - ra * ab) / det);
  }
  for (std::size_t k = 1; k < n; ++k) {
    const double u = double(k) / double(n), v = 1 - u;
    const double there = p + u * (q - p) + 3 * u * v * (v * double(found.a) + u * double(found.b));
    if (!(std::abs(there - at(k)) <= bound)) return {};
  }
  return found;
}

}  // namespace

void Numbers::add(std::int64_t n) {
  auto bits = (std::uint64_t(n) << 1) ^ std::uint64_t(n >> 63);
  for (; bits >= 0x80; bits >>= 7) bytes_ += char(bits | 0x80);
  bytes_ += char(bits);
}

void Course::add(double value, std::int64_t times) {
  if (!runs_.empty() && runs_.back().first == value)
    runs_.back().second += times;
  else
    runs_.emplace_back(value, times);
  size_ += times;
}

std::vector<double> Course::values() const {
  std::vector<double> all;
  all.reserve(std::size_t(size_));
  for (const auto& [value, times] : runs_) all.insert(all.end(), std::size_t(times), value);
  return all;
}

void write_keys(const std::vector<double>& values, double bound, KeyStreams& out) {
  const double step = bound / kKeySteps;
  std::int64_t start = std::llround(values.front() / step);
  out.starts.add(start);
  for (std::size_t from = 0; from + 1 < values.size();) {
    const std::size_t most = values.size() - 1 - from;
    const auto fits = [&](std::size_t n) { return piece(values, from, n, start, step, kKeySteps); };
    // twice as long as long as it fits, then halved in between
    std::size_t good = 1, bad = 2;
    CubicPiece best = *fits(1);
    while (good < most) {
      const std::size_t n = std::min(bad, most);
      const auto longer = fits(n);
      if (!longer) {
        bad = n;
        break;
      }
      best = *longer, good = n, bad = 2 * n;
    }
    while (good < most && bad - good > 1) {
      const std::size_t middle = (good + bad) / 2;
      if (const auto longer = fits(middle))
        best = *longer, good = middle;
      else
        bad = middle;
    }
    out.gaps.add(std::int64_t(good));
    out.ends.add(best.end - start);
    if (good > 1) out.bends.add(best.a), out.bends.add(best.b);
    start = best.end, from += good;
  }
}

}  // namespace obscura::page
