// Polyhedra that stand for round bodies.

#include "draw/space/polyhedron.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

namespace obscura::draw {
namespace {

using sim::Vec3;

/// A prism of n sides about y; with `pointed` a cone.
Polyhedron turned(int n, bool pointed) {
  std::vector<Vec3> vertices;
  std::vector<std::vector<int>> faces(1);
  for (int k = 0; k < n; ++k) {
    const double a = 2 * std::numbers::pi * k / n;
    vertices.push_back({std::cos(a), -1, std::sin(a)});
    faces[0].push_back(k);
  }
  if (pointed) {
    vertices.push_back({0, 1, 0});
    for (int k = 0; k < n; ++k) faces.push_back({(k + 1) % n, k, n});
  } else {
    faces.emplace_back();
    for (int k = 0; k < n; ++k) vertices.push_back(vertices[std::size_t(k)] + 2 * Vec3::UnitY());
    for (int k = n; k-- > 0;) faces[1].push_back(n + k);
    for (int k = 0; k < n; ++k) faces.push_back({(k + 1) % n, k, n + k, n + (k + 1) % n});
  }
  return polyhedron(vertices, faces);
}

TEST(RoundNormals, OfAPrismOfManySidesAreThoseOfACylinder) {
  const Polyhedron body = turned(24, false);
  const auto normals = round_normals(body);
  ASSERT_EQ(normals.size(), body.faces.size());
  for (std::size_t f = 0; f < body.faces.size(); ++f)
    for (std::size_t i = 0; i < normals[f].size(); ++i) {
      Vec3 out = body.vertices[std::size_t(body.faces[f].loop[i])];
      out.y() = 0;
      // its ends stay flat
      EXPECT_LT((normals[f][i] - (f < 2 ? body.faces[f].normal : out)).norm(), 1e-12) << f;
    }
}

/// At the tip each face keeps its own: a mean of all would look up.
TEST(RoundNormals, OfAConeAreRoundAtItsFootAndItsOwnAtTheTip) {
  const Polyhedron body = turned(24, true);
  const auto normals = round_normals(body);
  ASSERT_EQ(normals.size(), body.faces.size());
  for (std::size_t f = 1; f < body.faces.size(); ++f) {
    // the mean of it and its two neighbours
    EXPECT_LT((normals[f][2] - body.faces[f].normal).norm(), 0.02);
    const Vec3 foot = body.vertices[std::size_t(body.faces[f].loop[0])];
    EXPECT_NEAR(Vec3(normals[f][0].x(), 0, normals[f][0].z()).normalized().dot(Vec3(foot.x(), 0, foot.z())),
                1, 1e-12);
  }
}

/// Without its tip both faces of an edge have one normal at each end of it, all the way up.
TEST(RoundNormals, OfABluntedConeGoOnFromFaceToFace) {
  const Polyhedron body = blunted(turned(24, true));
  const auto normals = round_normals(body);
  std::map<int, Vec3> at;  // by vertex, of the round faces
  int ends = 0, shared = 0;
  for (std::size_t f = 0; f < body.faces.size(); ++f) {
    const Polyhedron::Face& face = body.faces[f];
    if (face.loop.size() == 24) {  // the foot, and where the tip was
      ++ends;
      EXPECT_NEAR(std::abs(face.normal.y()), 1, 1e-12);
      continue;
    }
    ASSERT_EQ(face.loop.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto [it, fresh] = at.try_emplace(face.loop[i], normals[f][i]);
      shared += !fresh;
      EXPECT_LT((it->second - normals[f][i]).norm(), 1e-12);
    }
  }
  EXPECT_EQ(ends, 2);
  EXPECT_GT(shared, 48);
  // closed: each edge has two faces, and corners, edges and faces are as Euler has them; the tip is left
  // alone
  for (const Polyhedron::Edge& edge : body.edges) EXPECT_GE(edge.right, 0);
  EXPECT_EQ(at.size() + body.faces.size(), body.edges.size() + 2);
  EXPECT_EQ(blunted(box({1, 2, 3})).vertices.size(), 8u);
  EXPECT_EQ(blunted(turned(24, false)).faces.size(), 26u);
}

TEST(RoundNormals, OfWhatHasEdgesAreNone) {
  EXPECT_TRUE(round_normals(box({1, 2, 3})).empty());
  EXPECT_TRUE(round_normals(turned(12, false)).empty());
}

}  // namespace
}  // namespace obscura::draw
