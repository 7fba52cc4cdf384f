// Triangles are small enough, where others are near, for their colours to be even between their corners. All
// of a face are cut alike, and of a round surface all faces, and the places on an edge are the same to the
// bit from both its sides: where they were not, a sample of a pixel could lie on neither, and show what is
// behind.

#include "draw/space/darkness.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kDarkReach = 1.7;  // of the least half thickness of a body: how far its darkness reaches,
constexpr double kDarkReachMost = 0.06;  // and at most of the window
constexpr double kPieceWide = 0.4;       // of the reach: how large a piece may be,
constexpr double kPieceLeast = 9;        // and how small, page units
constexpr int kManyBodies = 64;          // from so many bodies on pieces are twice as large
constexpr int kMostPieces = 24;          // of an edge

Occlusion around(const SpaceFrame& s) {
  const auto& pieces = s.stage.pieces;
  const double most = kDarkReachMost * s.lens.window.width / s.lens.scale;
  // pieces of one body are dark alike where they meet
  std::vector<double> least(s.now.bodies.size(), 1e300);
  for (const Piece& piece : pieces) {
    double& of = least[std::size_t(piece.body)];
    of = std::min(of, piece.least);
  }
  std::vector<Occlusion::Body> bodies(pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Piece& piece = pieces[i];
    const sim::Snapshot::Body& body = s.now.bodies[std::size_t(piece.body)];
    Occlusion::Body& it = bodies[i];
    // points keep no light from anything
    if (piece.radius <= 0 && piece.form != Piece::Form::polyhedron) continue;
    it.reach = std::min(kDarkReach * least[std::size_t(piece.body)], most);
    if (piece.form == Piece::Form::polyhedron) {
      it.flat = &s.placed[i];
      for (const Vec3& v : it.flat->vertices) it.center += v / double(it.flat->vertices.size());
      for (const Vec3& v : it.flat->vertices) it.around = std::max(it.around, (v - it.center).norm());
      continue;
    }
    it.a = body.position + body.orientation * piece.a, it.b = body.position + body.orientation * piece.b;
    it.radius = piece.radius;
    it.center = (it.a + it.b) / 2, it.around = (it.a - it.b).norm() / 2 + it.radius;
  }
  return Occlusion(std::move(bodies), s.stage.look.ground ? s.stage.ground : std::nullopt);
}

// a place on the way from a to b, the same from b to a
Vec3 between(const Vec3& a, const Vec3& b, int i, int n) {
  const bool forth = std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  const Vec3 &from = forth ? a : b, &to = forth ? b : a;
  return from + double(forth ? i : n - i) * (to - from) / n;
}

}  // namespace

Darkness::Darkness(SpaceFrame& frame) : frame_(frame), occlusion_(around(frame)) {
  darkened_.resize(frame.corners.size(), 0);
}

void Darkness::darken(Corner& corner, int body, std::span<const int> others) const {
  const double dark = occlusion_.at(body, others, corner.place, corner.normal);
  if (!(dark > 0)) return;
  const Color ink{0x0C, 0x10, 0x16};
  corner.color.lit = mix(corner.color.lit, ink, dark),
  corner.color.shaded = mix(corner.color.shaded, ink, dark);
}

// how many pieces each edge of a triangle has; of half a rectangle its sides count, not the diagonal
int Darkness::pieces(int body, const std::array<Vec3, 3>& corners) const {
  std::array<double, 3> edges{};
  for (std::size_t i = 0; i < 3; ++i) edges[i] = (corners[(i + 1) % 3] - corners[i]).norm();
  std::sort(edges.begin(), edges.end());
  const double longest = edges[1];
  const double many = frame_.stage.pieces.size() > kManyBodies ? 2 : 1;
  const double page = many * kPieceLeast * frame_.stage.layout.weight / frame_.lens.scale_at(corners[0]);
  const double cell = std::max(many * kPieceWide * occlusion_.reach(body), page);
  return std::clamp(int(std::ceil(longest / cell)), 1, kMostPieces);
}

// the triangles of the face of the one at `k`
void Darkness::cut(const Chunk& chunk, std::size_t k) {
  const std::vector<std::uint32_t>& triangles = frame_.triangles;
  const bool round = !frame_.stage.pieces[std::size_t(chunk.piece)].normals.empty();
  cut_begin_ = round ? chunk.begin : k, cut_end_ = cut_begin_, cut_pieces_ = 0;
  bool any = false;
  while (cut_end_ < chunk.end && (round || triangles[cut_end_] == triangles[k])) {
    const auto place = [&](std::size_t i) { return frame_.corners[triangles[cut_end_ + i]].place; };
    const std::array<Vec3, 3> places{place(0), place(1), place(2)};
    occlusion_.near(chunk.piece, places, frame_.corners[triangles[cut_end_]].normal, others_);
    any = any || !others_.empty();
    cut_pieces_ = std::max(cut_pieces_, pieces(chunk.piece, places));
    cut_end_ += 3;
  }
  if (!any) cut_pieces_ = 0;
}

void Darkness::lay(const Chunk& chunk, std::size_t k, std::vector<std::uint32_t>& list) {
  const std::array<std::uint32_t, 3> at{frame_.triangles[k], frame_.triangles[k + 1],
                                        frame_.triangles[k + 2]};
  const int body = chunk.piece;
  const auto whole = [&] { list.insert(list.end(), at.begin(), at.end()); };
  if (body < 0 || body >= int(frame_.stage.pieces.size()) || occlusion_.near(body).empty()) return whole();
  // a round body has small triangles
  if (frame_.stage.pieces[std::size_t(body)].form != Piece::Form::polyhedron) {
    for (const std::uint32_t i : at)
      if (!std::exchange(darkened_[i], char(1))) darken(frame_.corners[i], body, occlusion_.near(body));
    return whole();
  }
  if (k < cut_begin_ || k >= cut_end_) cut(chunk, k);
  const int n = cut_pieces_;
  if (n == 0) return whole();
  const std::array<Corner, 3> corners{frame_.corners[at[0]], frame_.corners[at[1]], frame_.corners[at[2]]};
  const std::array<Vec3, 3> places{corners[0].place, corners[1].place, corners[2].place};
  occlusion_.near(body, places, corners[0].normal, others_);

  // rows of pieces from the first corner to the edge of the other two
  const auto same = [&](const Corner& c) {
    return c.color.lit == corners[0].color.lit && c.color.shaded == corners[0].color.shaded;
  };
  const bool even = same(corners[1]) && same(corners[2]);
  const auto place = [&](int row, int i) {
    if (row == n) return between(places[1], places[2], i, n);
    if (i == 0) return between(places[0], places[1], row, n);
    if (i == row) return between(places[0], places[2], row, n);
    return Vec3(places[0] +
                (double(row - i) * (places[1] - places[0]) + double(i) * (places[2] - places[0])) / n);
  };
  const auto first = std::uint32_t(frame_.corners.size());
  for (int row = 0; row <= n; ++row)
    for (int i = 0; i <= row; ++i) {
      Corner corner = corners[0];
      corner.place = place(row, i);
      // of a round surface the colours differ
      const auto mixed = [&](Color Shaded::*of) {
        if (even) return corners[0].color.*of;
        const double along = row > 0 ? double(i) / row : 0;
        return mix(corners[0].color.*of, mix(corners[1].color.*of, corners[2].color.*of, along),
                   double(row) / n);
      };
      corner.color = {mixed(&Shaded::lit), mixed(&Shaded::shaded)};
      darken(corner, body, others_);
      frame_.corners.push_back(corner);
    }
  const auto index = [&](int row, int i) { return first + std::uint32_t(row * (row + 1) / 2 + i); };
  for (int row = 0; row < n; ++row)
    for (int i = 0; i <= row; ++i) {
      for (const std::uint32_t v : {index(row, i), index(row + 1, i), index(row + 1, i + 1)})
        list.push_back(v);
      if (i == row) continue;
      for (const std::uint32_t v : {index(row, i), index(row + 1, i + 1), index(row, i + 1)})
        list.push_back(v);
    }
}

}  // namespace obscura::draw
