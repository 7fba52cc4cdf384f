#include "gl/head.h"

#include <algorithm>

namespace obscura::gl {
namespace {

template <class Thing>
bool alike(const std::vector<Thing>& a, int a0, int a1, const std::vector<Thing>& b, int b0, int b1) {
  return std::equal(a.begin() + a0, a.begin() + a1, b.begin() + b0, b.begin() + b1);
}

bool alike(const draw::List& a, const draw::Stroke& s, const draw::List& b, const draw::Stroke& t) {
  return s.closed == t.closed && s.cap == t.cap && s.blend == t.blend && s.whole == t.whole &&
         alike(a.nodes, s.begin, s.end, b.nodes, t.begin, t.end);
}

bool alike(const draw::List& a, const draw::Polygon& s, const draw::List& b, const draw::Polygon& t) {
  return s.fill == t.fill && alike(a.points, s.begin, s.end, b.points, t.begin, t.end);
}

// whether thing i of one list and thing k of the other, both of a kind, are drawn alike
bool alike(draw::Kind kind, const draw::List& a, std::size_t i, const draw::List& b, std::size_t k) {
  switch (kind) {
    case draw::Kind::disc:
      return a.discs[i] == b.discs[k];
    case draw::Kind::box:
      return a.boxes[i] == b.boxes[k];
    case draw::Kind::stroke:
      return alike(a, a.strokes[i], b, b.strokes[k]);
    case draw::Kind::polygon:
      return alike(a, a.polygons[i], b, b.polygons[k]);
    case draw::Kind::text:
      return a.texts[i] == b.texts[k];
  }
  return false;
}

bool alike_around(const draw::List& a, const draw::Batch& s, const draw::List& b, const draw::Batch& t) {
  if (s.kind != t.kind || s.halo != t.halo || (s.clip < 0) != (t.clip < 0)) return false;
  return s.clip < 0 || a.clips[std::size_t(s.clip)] == b.clips[std::size_t(t.clip)];
}

}  // namespace

Reach common_head(const draw::List& a, const draw::List& b) {
  const int batches = int(std::min(a.batches.size(), b.batches.size()));
  for (int n = 0; n < batches; ++n) {
    const draw::Batch &s = a.batches[std::size_t(n)], &t = b.batches[std::size_t(n)];
    if (!alike_around(a, s, b, t)) return {n, 0};
    const int of_a = s.end - s.begin, of_b = t.end - t.begin, most = std::min(of_a, of_b);
    int same = 0;
    while (same < most && alike(s.kind, a, std::size_t(s.begin + same), b, std::size_t(t.begin + same)))
      ++same;
    if (same < of_a || same < of_b) return {n, same};
  }
  return {batches, 0};
}

}  // namespace obscura::gl
