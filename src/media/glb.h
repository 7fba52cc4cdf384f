#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace obscura::media {

/// A run as glTF 2.0 has it: meshes, nodes that show them, and how the nodes move. Metres, y up, z towards
/// the viewer.
struct Glb {
  /// A surface of triangles, counter-clockwise seen from outside, of one colour.
  struct Mesh {
    std::string name;
    std::vector<std::array<float, 3>> positions, normals;  // normals unit, one a position
    std::vector<std::uint32_t> triangles;                  // three a triangle
    std::array<float, 4> color{1, 1, 1, 1};                // linear

    bool operator==(const Mesh&) const = default;
  };
  /// A thing at the instants of `times`. A list of one says that it stays so.
  struct Node {
    std::string name;
    int mesh = -1;
    std::vector<std::array<float, 3>> translations;
    std::vector<std::array<float, 4>> rotations;  // unit quaternions x, y, z, w
    std::vector<std::array<float, 3>> scales;     // empty: as large as its mesh
  };

  std::string name, generator;
  std::vector<Mesh> meshes;
  std::vector<Node> nodes;
  std::vector<float> times;  // s, increasing
};

/// Writes it as one binary file. Throws Error naming the path.
void write_glb(const std::string& path, const Glb& scene);

}  // namespace obscura::media
