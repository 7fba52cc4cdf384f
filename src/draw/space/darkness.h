#pragma once

#include <array>
#include <vector>

#include "draw/space/occlusion.h"
#include "draw/space/space.h"

namespace obscura::draw {

/// Darkens the surfaces of a panel's bodies where others are near.
class Darkness {
 public:
  explicit Darkness(SpaceFrame& frame);

  /// Appends the triangle at `k` of the frame's triangles, which is of `chunk`, to `list`: in pieces where
  /// its darkness is not even.
  void lay(const Chunk& chunk, std::size_t k, std::vector<std::uint32_t>& list);

 private:
  void darken(Corner& corner, int body, std::span<const int> others) const;
  int pieces(int body, const std::array<sim::Vec3, 3>& corners) const;
  void cut(const Chunk& chunk, std::size_t k);

  SpaceFrame& frame_;
  Occlusion occlusion_;
  std::vector<char> darkened_;  // one a corner: it is as dark as it shall be
  std::vector<int> others_;
  std::size_t cut_begin_ = 0, cut_end_ = 0;  // of the triangles at hand that are cut alike
  int cut_pieces_ = 0;                       // of their edges; 0: none of them is cut
};

}  // namespace obscura::draw
