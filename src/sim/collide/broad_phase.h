#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "sim/model/model.h"
#include "sim/shape/shape.h"

namespace obscura::sim {

/// Finds which bodies are near each other. Keeps its order for the next call, which only makes that call
/// faster: the result depends on the arguments alone.
template <int D>
class BroadPhase {
 public:
  /// All pairs (a, b), a < b, sorted, whose bounds overlap. Leaves out pairs of two still bodies, pairs of
  /// two points, and pairs for which `wanted` is false (empty: wants all). `points`: one a body; empty: no
  /// body is a point. Bounds with a NaN overlap nothing. Time is nearly linear in the number of bodies of
  /// similar size, wherever they are, and of points and still bodies even if they all lie at one place;
  /// bodies much taller or wider than most cost more. Allocates nothing once warm. Valid until the next call.
  const std::vector<std::pair<int, int>>& find(std::span<const Bounds<D>> bounds, std::span<const char> still,
                                               const std::function<bool(int, int)>& wanted = {},
                                               std::span<const char> points = {});
  /// How many pairs the last call compared.
  std::int64_t compared() const { return compared_; }

 private:
  struct Place {
    std::int64_t key = 0;  // sorts as the bounds' lower end along x
    int body = 0;

    bool operator<(const Place& other) const {
      return key < other.key || (key == other.key && body < other.body);
    }
  };
  struct Span {
    int first = 0, last = 0;  // bands, not wrapped
  };
  struct Entry {  // of an active body: where along x it ends, where along y it lies, m
    double right = 0, low = 0, high = 0;
    int body = 0;
  };

  void sort_along_x(std::span<const Bounds<D>> bounds);
  void lay_bands(std::span<const Bounds<D>> bounds, std::span<const char> still,
                 std::span<const char> points);
  void sweep(std::span<const Bounds<D>> bounds, const std::function<bool(int, int)>& wanted, int kinds);
  void sort_pairs(int bodies);

  std::vector<Place> order_;           // the memory of the last call
  std::vector<Span> spans_;            // one a body
  std::vector<char> kinds_;            // one a body: bit 0 still, bit 1 a point
  std::vector<int> starts_, lengths_;  // of each kind in each band, in active_
  std::vector<Entry> active_;          // band by band, those the sweep has entered and not left
  std::vector<int> near_;              // those in one band that one body's bounds may meet
  std::vector<std::pair<int, int>> found_, pairs_;
  std::vector<int> offsets_;  // of each a in pairs_
  std::int64_t compared_ = 0;
};

}  // namespace obscura::sim
