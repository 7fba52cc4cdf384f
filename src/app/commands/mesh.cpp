#include "app/commands/mesh.h"

#include <cmath>
#include <numbers>

namespace obscura::app {

namespace {

using Mesh = media::Glb::Mesh;
using sim::ShapeKind;
using sim::Vec3;

constexpr int kTube = 8;     // sides of a rod along places
constexpr int kAround = 32;  // corners of what is round

std::array<float, 3> narrowed(const Vec3& v) { return {float(v.x()), float(v.y()), float(v.z())}; }

void add_vertex(Mesh& mesh, const Vec3& place, const Vec3& normal) {
  mesh.positions.push_back(narrowed(place));
  mesh.normals.push_back(narrowed(normal.normalized()));
}

// a flat face, corners counter-clockwise seen from outside
void add_face(Mesh& mesh, const std::vector<Vec3>& loop) {
  Vec3 normal = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < loop.size(); ++k)
    normal += (loop[k] - loop[0]).cross(loop[k + 1] - loop[0]);
  const auto first = std::uint32_t(mesh.positions.size());
  for (const Vec3& corner : loop) add_vertex(mesh, corner, normal);
  for (std::uint32_t k = 1; k + 1 < loop.size(); ++k)
    mesh.triangles.insert(mesh.triangles.end(), {first, first + k, first + k + 1});
}

// a surface turned about y: rows of places (distance from the axis, height) and normals, from below upwards
struct Ring {
  double radius, height, out, up;
};
void add_turned(Mesh& mesh, const std::vector<Ring>& rings) {
  const auto first = std::uint32_t(mesh.positions.size());
  for (const Ring& ring : rings) {
    for (int k = 0; k <= kAround; ++k) {
      const double a = 2 * std::numbers::pi * k / kAround, s = std::sin(a), c = std::cos(a);
      add_vertex(mesh, {ring.radius * s, ring.height, ring.radius * c},
                 {ring.out * s, ring.up, ring.out * c});
    }
  }
  constexpr std::uint32_t row = kAround + 1;
  for (std::uint32_t i = 0; i + 1 < rings.size(); ++i) {
    for (std::uint32_t k = 0; k < kAround; ++k) {
      const std::uint32_t a = first + i * row + k, b = a + 1, c = a + row, d = c + 1;
      if (rings[i].radius > 0) mesh.triangles.insert(mesh.triangles.end(), {a, b, d});
      if (rings[i + 1].radius > 0) mesh.triangles.insert(mesh.triangles.end(), {a, d, c});
    }
  }
}

// a ball cut in halves that are `half` above and below the middle
void add_capsule(Mesh& mesh, double half, double radius) {
  std::vector<Ring> rings;
  constexpr int kUp = kAround / 4;
  for (const double side : {-1.0, 1.0}) {
    if (half == 0 && side > 0) rings.pop_back();  // the equator, once
    for (int k = 0; k <= kUp; ++k) {
      const double a = std::numbers::pi / 2 * (side < 0 ? k - kUp : k) / kUp;
      const bool pole = side < 0 ? k == 0 : k == kUp;
      const double c = pole ? 0 : std::cos(a), s = std::sin(a);
      rings.push_back({radius * c, side * half + radius * s, c, s});
    }
  }
  add_turned(mesh, rings);
}

void add_box(Mesh& mesh, const Vec3& h) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const Vec3 n = side * Vec3::Unit(axis), u = Vec3::Unit((axis + 1) % 3), v = n.cross(u);
      const auto at = [&](double a, double b) { return Vec3((n + a * u + b * v).cwiseProduct(h)); };
      add_face(mesh, {at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)});
    }
  }
}

// a polygon of the plane as thick as `depth`
void add_prism(Mesh& mesh, const std::vector<Vec3>& loop, double depth) {
  const Vec3 up(0, 0, depth / 2);
  std::vector<Vec3> front, back;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    front.push_back(loop[i] + up), back.push_back(loop[loop.size() - 1 - i] - up);
    const Vec3 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    add_face(mesh, {a - up, b - up, b + up, a + up});
  }
  add_face(mesh, front), add_face(mesh, back);
}

template <class Form>
void add(Mesh& mesh, const Form& form, double depth) {
  switch (form.kind) {
    case ShapeKind::point:
      return add_capsule(mesh, 0, depth / 10);
    case ShapeKind::ball:
      return add_capsule(mesh, 0, form.radius);
    case ShapeKind::capsule:
      return add_capsule(mesh, form.half.y(), form.radius);
    case ShapeKind::box:
      return add_box(mesh, form.half.z() > 0 ? form.half : Vec3(form.half.x(), form.half.y(), depth / 2));
    case ShapeKind::polygon:
      return add_prism(mesh, form.vertices, depth);
    case ShapeKind::hull:
      for (const std::vector<int>& face : form.faces) {
        std::vector<Vec3> loop;
        for (const int i : face) loop.push_back(form.vertices[std::size_t(i)]);
        add_face(mesh, loop);
      }
      return;
    case ShapeKind::compound:
      return;
  }
}

}  // namespace

Mesh surface(const sim::SceneInfo::Body& body, double depth) {
  Mesh mesh;
  if (body.kind != ShapeKind::compound) {
    add(mesh, body, depth);
    return mesh;
  }
  for (const sim::SceneInfo::Part& part : body.parts) {
    Mesh own;
    add(own, part, depth);
    // corners of polygons and hulls are in the body's frame already
    const bool placed = part.kind == ShapeKind::polygon || part.kind == ShapeKind::hull;
    const auto first = std::uint32_t(mesh.positions.size());
    for (std::size_t i = 0; i < own.positions.size(); ++i) {
      const auto &p = own.positions[i], &n = own.normals[i];
      const Vec3 place(p[0], p[1], p[2]), normal(n[0], n[1], n[2]);
      add_vertex(mesh, placed ? place : Vec3(part.center + part.turn * place),
                 placed ? normal : part.turn * normal);
    }
    for (const std::uint32_t i : own.triangles) mesh.triangles.push_back(first + i);
  }
  return mesh;
}

Mesh rod() {
  Mesh mesh;
  add_turned(mesh, {{0, -0.5, 0, -1}, {1, -0.5, 0, -1}});
  add_turned(mesh, {{1, -0.5, 1, 0}, {1, 0.5, 1, 0}});
  add_turned(mesh, {{1, 0.5, 0, 1}, {0, 0.5, 0, 1}});
  return mesh;
}

Mesh tube(const std::vector<Vec3>& way, double radius) {
  Mesh mesh;
  if (way.size() < 2) return mesh;
  // a frame that turns no more than the way does
  Vec3 along = (way[1] - way[0]).normalized();
  Vec3 across = along.unitOrthogonal();
  for (std::size_t i = 0; i < way.size(); ++i) {
    const Vec3 d = i + 1 < way.size() ? Vec3(way[i + 1] - way[i]) : Vec3(way[i] - way[i - 1]);
    if (d.norm() > 0) along = d.normalized();
    across = (across - along * along.dot(across)).normalized();
    const Vec3 up = along.cross(across);
    for (int k = 0; k <= kTube; ++k) {
      const double a = 2 * std::numbers::pi * k / kTube;
      const Vec3 out = std::cos(a) * across + std::sin(a) * up;
      add_vertex(mesh, way[i] + radius * out, out);
    }
  }
  constexpr std::uint32_t row = kTube + 1;
  for (std::uint32_t i = 0; i + 1 < way.size(); ++i) {
    for (std::uint32_t k = 0; k < kTube; ++k) {
      const std::uint32_t a = i * row + k, b = a + 1, c = a + row, d = c + 1;
      mesh.triangles.insert(mesh.triangles.end(), {a, b, d, a, d, c});
    }
  }
  return mesh;
}

Mesh floor(const Vec3& low, const Vec3& high) {
  Mesh mesh;
  add_face(mesh,
           {{low.x(), 0, high.z()}, {high.x(), 0, high.z()}, {high.x(), 0, low.z()}, {low.x(), 0, low.z()}});
  return mesh;
}

}  // namespace obscura::app
