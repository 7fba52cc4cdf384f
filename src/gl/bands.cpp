#include "gl/bands.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace obscura::gl {

namespace {

constexpr int kFew = 64;             // edges that need no bands
constexpr int kEach = 16;            // edges for which a band is worth its quad
constexpr float kSlack = 1.0f / 64;  // px, for the rounding of slopes
constexpr float kFar = 1e6f;         // px, beyond every picture

}  // namespace

std::vector<Band> banded(std::span<const Edge> edges, float y0, float y1, std::vector<Edge>& list) {
  const int n = int(edges.size()), begin = int(list.size());
  const float top = std::floor(y0), rows = std::ceil(y1) - top;
  const int most = n <= kFew || !(rows >= 1) ? 1 : n / kEach;
  const float high = std::max(1.0f, std::ceil(rows / float(most)));
  const int count = rows >= 1 ? std::max(1, int(std::ceil(rows / high))) : 1;
  if (count == 1) {
    list.insert(list.end(), edges.begin(), edges.end());
    return {{y0, y1, begin, n}};
  }

  // by counting: first how many edges each band has, then which
  const auto of = [&](float y) {
    return int(std::clamp(std::floor((y - top) / high), 0.0f, float(count - 1)));
  };
  std::vector<Band> bands(std::size_t(count), Band{});
  for (const Edge& edge : edges) {
    const int last = of(std::max(edge.py, edge.qy));
    for (int k = of(std::min(edge.py, edge.qy)); k <= last; ++k) ++bands[std::size_t(k)].count;
  }
  int all = begin;
  for (int k = 0; k < count; ++k) {
    Band& band = bands[std::size_t(k)];
    band.y0 = k == 0 ? y0 : top + float(k) * high;
    band.y1 = k + 1 == count ? y1 : top + float(k + 1) * high;
    band.first = all;
    all += band.count;
    band.count = 0;
  }
  list.resize(std::size_t(all));
  for (const Edge& edge : edges) {
    const int last = of(std::max(edge.py, edge.qy));
    for (int k = of(std::min(edge.py, edge.qy)); k <= last; ++k) {
      Band& band = bands[std::size_t(k)];
      list[std::size_t(band.first + band.count++)] = edge;
    }
  }
  return bands;
}

bool convex(std::span<const Edge> edges) {
  bool left = false, right = false;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Edge &a = edges[i], &b = edges[(i + 1) % edges.size()];
    const float turn = (a.qx - a.px) * (b.qy - b.py) - (a.qy - a.py) * (b.qx - b.px);
    left = left || turn < 0, right = right || turn > 0;
  }
  return left != right;
}

// The left side of a convex polygon is a convex function of y and its right side a concave one, so that of
// rows the narrowest place is the first or the last.
Columns columns(std::span<const Edge> edges, int y0, int y1) {
  constexpr float far = std::numeric_limits<float>::infinity();
  const float rows[2] = {float(y0), float(y1)};
  float left[2] = {far, far}, right[2] = {-far, -far};  // where it is cut by the upper and lower side
  float low = far, high = -far;
  for (const Edge& edge : edges) {
    if (edge.py >= rows[0] && edge.py <= rows[1])
      low = std::min(low, edge.px), high = std::max(high, edge.px);
    for (int k = 0; k < 2; ++k) {
      const float y = rows[k];
      if (edge.py == edge.qy || std::min(edge.py, edge.qy) > y || std::max(edge.py, edge.qy) < y) continue;
      const float x = edge.px + (y - edge.py) / (edge.qy - edge.py) * (edge.qx - edge.px);
      left[k] = std::min(left[k], x), right[k] = std::max(right[k], x);
    }
  }
  low = std::min({low, left[0], left[1]}), high = std::max({high, right[0], right[1]});
  if (!(low <= high)) return {};
  const auto whole = [](float x) { return int(std::clamp(x, -kFar, kFar)); };
  Columns all;
  all.part0 = whole(std::floor(low - kSlack)), all.part1 = whole(std::ceil(high + kSlack));
  if (left[0] <= right[0] && left[1] <= right[1]) {
    all.full0 = whole(std::ceil(std::max(left[0], left[1]) + kSlack));
    all.full1 = std::max(all.full0, whole(std::floor(std::min(right[0], right[1]) - kSlack)));
  }
  return all;
}

}  // namespace obscura::gl
