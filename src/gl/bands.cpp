#include "gl/bands.h"

#include <algorithm>
#include <cmath>

namespace obscura::gl {

namespace {

constexpr int kFew = 64;   // edges that need no bands
constexpr int kEach = 16;  // edges for which a band is worth its quad

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

}  // namespace obscura::gl
