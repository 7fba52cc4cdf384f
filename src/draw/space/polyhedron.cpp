#include "draw/space/polyhedron.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kSameWay = 1 - 1e-10;  // cosine between faces of one plane
// of an edge, from the tip of a cone: where its faces end, in pieces that are not much wider at one end, for
// tones are even over triangles only; the last is where it is cut off
constexpr std::array kBlunt{0.45, 0.2, 0.08, 0.02, 0.002};
constexpr double kTouching = 1e-6;  // of a side: so near are faces that touch

/// Newell's normal of a loop: right for any flat polygon, and a mean for one that is not quite flat.
Vec3 normal_of(const std::vector<Vec3>& vertices, const std::vector<int>& loop) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < loop.size(); ++i)
    sum += vertices[loop[i]].cross(vertices[loop[(i + 1) % loop.size()]]);
  const double length = sum.norm();
  return length > 0 ? Vec3(sum / length) : Vec3::UnitY();
}

/// Fills in normals and edges. Vertices that faces do not meet at one edge are left without a neighbour.
void join(Polyhedron& body) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& v : body.vertices) middle += v / double(body.vertices.size());
  std::vector<Vec3> about;
  about.reserve(body.vertices.size());
  for (const Vec3& v : body.vertices) about.push_back(v - middle);

  std::map<std::pair<int, int>, int> known;  // an edge's vertices, the lower first -> edge
  for (int f = 0; f < int(body.faces.size()); ++f) {
    Polyhedron::Face& face = body.faces[f];
    face.normal = normal_of(about, face.loop);
    for (std::size_t i = 0; i < face.loop.size(); ++i) {
      const int a = face.loop[i], b = face.loop[(i + 1) % face.loop.size()];
      const auto [at, fresh] = known.try_emplace({std::min(a, b), std::max(a, b)}, int(body.edges.size()));
      if (fresh)
        body.edges.push_back({a, b, f, -1});
      else
        body.edges[at->second].right = f;
    }
  }
}

}  // namespace

Polyhedron Polyhedron::placed(const Eigen::Matrix3d& turn, const Vec3& at) const {
  Polyhedron body = *this;
  for (Vec3& v : body.vertices) v = turn * v + at;
  for (Face& face : body.faces) face.normal = turn * face.normal;
  return body;
}

std::vector<std::vector<Vec3>> round_normals(const Polyhedron& body) {
  const auto one = [&](int f, int g) { return body.faces[f].normal.dot(body.faces[g].normal) > kCrease; };
  if (std::none_of(body.edges.begin(), body.edges.end(),
                   [&](const Polyhedron::Edge& e) { return e.right >= 0 && one(e.left, e.right); }))
    return {};
  std::vector<std::vector<int>> at(body.vertices.size());  // the faces of each vertex
  for (int f = 0; f < int(body.faces.size()); ++f)
    for (int v : body.faces[f].loop) at[v].push_back(f);
  std::vector<std::vector<Vec3>> normals(body.faces.size());
  for (int f = 0; f < int(body.faces.size()); ++f)
    for (int v : body.faces[f].loop) {
      Vec3 sum = Vec3::Zero();
      for (int g : at[v])
        if (one(f, g)) sum += body.faces[g].normal;
      normals[f].push_back(sum.normalized());
    }
  return normals;
}

Polyhedron blunted(const Polyhedron& body) {
  std::vector<std::vector<int>> at(body.vertices.size());  // the faces of each vertex
  for (int f = 0; f < int(body.faces.size()); ++f)
    for (int v : body.faces[f].loop) at[v].push_back(f);
  // each face goes on in two others around the tip, and some look away from each other
  const auto tip = [&](int v) {
    bool apart = false;
    for (const int f : at[v]) {
      int like = 0;
      for (const int g : at[v]) {
        const bool one = body.faces[f].normal.dot(body.faces[g].normal) > kCrease;
        like += g != f && one, apart = apart || !one;
      }
      if (like < 2) return false;
    }
    return apart;
  };
  std::vector<int> tips;
  for (int v = 0; v < int(body.vertices.size()); ++v)
    if (tip(v)) tips.push_back(v);
  if (tips.empty()) return body;

  Polyhedron cut{.vertices = body.vertices, .faces = body.faces, .edges = {}};
  for (const int v : tips) {
    std::map<int, int> on;    // an edge's other vertex -> the first of the vertices on it
    std::map<int, int> next;  // around the cut
    const auto place = [&](int other) {
      const auto [it, fresh] = on.try_emplace(other, int(cut.vertices.size()));
      const Vec3 at_tip = body.vertices[v], way = body.vertices[other] - at_tip;
      for (std::size_t k = 0; fresh && k < kBlunt.size(); ++k)
        cut.vertices.push_back(at_tip + kBlunt[k] * way);
      return it->second;
    };
    for (const int f : at[v]) {
      const std::vector<int>& was = body.faces[f].loop;
      const std::size_t i = std::find(was.begin(), was.end(), v) - was.begin(), count = was.size();
      int before = place(was[(i + count - 1) % count]), after = place(was[(i + 1) % count]);
      std::vector<int>& loop = cut.faces[f].loop;
      const auto here = std::find(loop.begin(), loop.end(), v);
      *here = after, loop.insert(here, before);
      for (std::size_t k = 1; k < kBlunt.size(); ++k, ++before, ++after)
        cut.faces.push_back({{before, before + 1, after + 1, after}, Vec3::Zero()});
      next[after] = before;
    }
    Polyhedron::Face end{{}, Vec3::Zero()};
    for (int i = next.begin()->first; end.loop.size() < next.size(); i = next[i]) end.loop.push_back(i);
    cut.faces.push_back(std::move(end));
  }
  join(cut);
  return cut;
}

std::vector<std::vector<char>> continued(const Polyhedron& body, const Polyhedron& other) {
  std::vector<std::vector<char>> found;
  for (const Polyhedron::Face& face : body.faces) {
    std::vector<char>& sides = found.emplace_back(face.loop.size(), 0);
    for (const Polyhedron::Face& next : other.faces) {
      if (face.normal.dot(next.normal) < kSameWay) continue;
      for (std::size_t i = 0; i < face.loop.size(); ++i) {
        const Vec3& a = body.vertices[std::size_t(face.loop[i])];
        const Vec3 side = body.vertices[std::size_t(face.loop[(i + 1) % face.loop.size()])] - a;
        const double length = side.norm(), least = kTouching * length;
        const Vec3 along = side / length, out = along.cross(face.normal);
        // how far the other face reaches along the side, and from it outwards
        double from = 1e300, to = -1e300, near = 1e300, far = -1e300, off = 0;
        for (const int v : next.loop) {
          const Vec3 p = other.vertices[std::size_t(v)] - a;
          from = std::min(from, p.dot(along)), to = std::max(to, p.dot(along));
          near = std::min(near, p.dot(out)), far = std::max(far, p.dot(out));
          off = std::max(off, std::abs(p.dot(face.normal)));
        }
        if (off < least && near < least && far > least && from < length - least && to > least) sides[i] = 1;
      }
    }
  }
  return found;
}

Polyhedron box(const Vec3& half) {
  Polyhedron body;
  for (int i = 0; i < 8; ++i)
    body.vertices.push_back(half.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  for (const auto& loop :
       {std::vector<int>{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}})
    body.faces.push_back({loop, Vec3::Zero(), -1});
  join(body);
  return body;
}

Polyhedron polyhedron(std::span<const Vec3> vertices, std::span<const std::vector<int>> faces) {
  Polyhedron body;
  body.vertices.assign(vertices.begin(), vertices.end());
  for (const std::vector<int>& loop : faces) {
    if (loop.size() >= 3) body.faces.push_back({loop, Vec3::Zero(), -1});
  }
  join(body);
  return body;
}

Polyhedron cut(const Polyhedron& body, const Vec3& point, const Vec3& normal, int side) {
  std::vector<double> height;
  height.reserve(body.vertices.size());
  bool all = true;
  for (const Vec3& v : body.vertices) {
    height.push_back((v - point).dot(normal));
    all = all && height.back() >= 0;
  }
  if (all) return body;

  // the kept part of each face; a cut edge gets a new vertex
  Polyhedron left;
  std::vector<int> kept(body.vertices.size(), -1);
  std::map<std::pair<int, int>, int> crossings;
  const auto keep = [&](int v) {
    if (kept[v] < 0) kept[v] = int(left.vertices.size()), left.vertices.push_back(body.vertices[v]);
    return kept[v];
  };
  const auto crossing = [&](int a, int b) {
    const auto [at, fresh] =
        crossings.try_emplace({std::min(a, b), std::max(a, b)}, int(left.vertices.size()));
    if (fresh) {
      const double s = height[a] / (height[a] - height[b]);
      left.vertices.push_back(body.vertices[a] + s * (body.vertices[b] - body.vertices[a]));
    }
    return at->second;
  };
  std::map<int, int> after;  // along the new face: each new vertex's next
  for (const Polyhedron::Face& face : body.faces) {
    std::vector<int> loop;
    int out = -1, in = -1;
    for (std::size_t i = 0; i < face.loop.size(); ++i) {
      const int a = face.loop[i], b = face.loop[(i + 1) % face.loop.size()];
      if (height[a] >= 0) loop.push_back(keep(a));
      if ((height[a] >= 0) == (height[b] >= 0)) continue;
      loop.push_back(crossing(a, b));
      (height[a] >= 0 ? out : in) = loop.back();
    }
    if (loop.size() < 3) continue;
    left.faces.push_back({loop, face.normal, face.side});
    if (out >= 0 && in >= 0) after[in] = out;
  }
  if (after.size() >= 3) {
    std::vector<int> loop;
    int at = after.begin()->first;
    for (std::size_t i = 0; i < after.size(); ++i) {
      loop.push_back(at);
      const auto next = after.find(at);
      if (next == after.end()) break;
      at = next->second;
    }
    left.faces.push_back({loop, -normal, side});
  }
  join(left);
  return left;
}

}  // namespace obscura::draw
