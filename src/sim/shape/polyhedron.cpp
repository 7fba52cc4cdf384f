// Separating axes of convex polyhedra.
//   s(face)  = min over the other's corners p of n . (p - p_face)
//   s(edges) = n . (p_a - p_b)       n = +-(e_a x e_b) / |e_a x e_b|, if both edges are farthest along it
//   s        = max over the faces of both and all pairs of edges
// If s < 0 they overlap, and -s is the least depth. If s > 0 they are apart; then s is their distance when
// the nearest places are a vertex over a face or lie within two edges, and otherwise less than it.
//
// An edge e with faces L and R at its left and right is farthest along n, n across e, where n leads out of
// both: n . (L x e) <= 0 and n . (e x R) <= 0.

#include "sim/shape/polyhedron.h"

#include <algorithm>
#include <cmath>

namespace obscura::sim {

namespace {

constexpr double kParallelEdges = 1e-6;  // sine between two edges: below, they have no common normal

// corners of a box count by the axes on whose positive side they lie; face 2 k + 1 is the positive one of
// axis k; edge 4 k + i + 2 j runs along k on the sides i and j of the next two axes
constexpr int kBoxLoops[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                 {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

constexpr Polyhedron::Edge box_edge(int number) {
  const int axis = number / 4, next = (axis + 1) % 3, last = (axis + 2) % 3;
  const int i = number & 1, j = number >> 1 & 1;
  const int from = i << next | j << last;
  const int beside_next = 2 * next + i, beside_last = 2 * last + j;
  return i == j ? Polyhedron::Edge{from, from | 1 << axis, beside_next, beside_last}
                : Polyhedron::Edge{from, from | 1 << axis, beside_last, beside_next};
}

// the normal of a loop by Newell's method, which all vertices enter
Vec<3> loop_normal(const Core<3>& hull, int face) {
  const std::vector<int>& loop = hull.faces[face];
  const Vec<3>& first = hull.corners[loop[0]];
  Vec<3> sum = Vec<3>::Zero();
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
    sum += (hull.corners[loop[i]] - first).cross(hull.corners[loop[i + 1]] - first);
  }
  return sum / std::sqrt(sum.squaredNorm());
}

}  // namespace

Polyhedron::Polyhedron(const Core<3>& core, const BodyMotion<3>& at, const Vec<3>& origin)
    : core_(core), radius_(core.radius), x_(at.x - origin), turn_(at.room_from_body) {
  middle_ = x_;
  if (!core.middle.isZero(0)) middle_ += turn_ * core.middle;
  const auto stand = [&](const Orientation<3>& turn, const Vec<3>& half) {
    axes_ = turn == no_rotation<3>() ? turn_ : Rotation<3>(turn_ * rotation<3>(turn));
    arms_ = axes_ * half.asDiagonal();
  };
  if (core.box) {
    corners_ = 8, edges_ = 12, faces_ = 6;
    bounding_radius_ = std::sqrt(core.box->half.squaredNorm());
    stand(core.box->turn, core.box->half);
  } else if (core.capsule) {
    corners_ = 2, edges_ = 1;
    bounding_radius_ = core.capsule->half;
    stand(core.capsule->turn, {0, core.capsule->half, 0});
  } else if (!core.corners.empty()) {
    corners_ = int(core.corners.size()), faces_ = int(core.faces.size());
    Vec<3> middle = Vec<3>::Zero();
    for (const Vec<3>& vertex : core.corners) middle += vertex;
    middle /= corners_;
    for (const Vec<3>& vertex : core.corners) {
      bounding_radius_ = std::max(bounding_radius_, (vertex - middle).squaredNorm());
    }
    bounding_radius_ = std::sqrt(bounding_radius_);
    middle_ = x_ + turn_ * middle;
    find_edges();
  }
}

// finds the edges of a hull: each side of a loop once, from its lower vertex, with the face on the other side
void Polyhedron::find_edges() {
  const auto add = [&](const Edge& edge) {
    if (edges_ < kFewEdges) {
      few_[edges_] = edge;
    } else {
      many_.push_back(edge);
    }
    ++edges_;
  };
  const auto behind = [&](int from, int to) {
    for (int face = 0; face < faces_; ++face) {
      const std::vector<int>& loop = core_.faces[face];
      for (std::size_t i = 0; i < loop.size(); ++i) {
        if (loop[i] == to && loop[i + 1 < loop.size() ? i + 1 : 0] == from) return face;
      }
    }
    return -1;
  };
  for (int face = 0; face < faces_; ++face) {
    const std::vector<int>& loop = core_.faces[face];
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const int from = loop[i], to = loop[i + 1 < loop.size() ? i + 1 : 0];
      if (from < to) add({from, to, face, behind(from, to)});
    }
  }
}

Polyhedron::Edge Polyhedron::edge(int i) const {
  if (is_box()) return box_edge(i);
  if (faces_ == 0) return {0, 1, -1, -1};
  return i < kFewEdges ? few_[i] : many_[i - kFewEdges];
}

std::span<const int> Polyhedron::loop(int face) const {
  if (is_box()) return kBoxLoops[face];
  return core_.faces[face];
}

Vec<3> Polyhedron::normal(int face) const {
  if (is_box()) return (face & 1 ? 1 : -1) * axes_.col(face >> 1);
  return turn_ * loop_normal(core_, face);
}

Vec<3> Polyhedron::along(int edge) const {
  if (is_box()) return axes_.col(edge >> 2);
  if (faces_ == 0) return axes_.col(1);
  const Edge of = this->edge(edge);
  const Vec<3> way = core_.corners[of.to] - core_.corners[of.from];
  return turn_ * (way / std::sqrt(way.squaredNorm()));
}

int Polyhedron::edge_between(int corner, int other) const {
  if (is_box()) {
    const int axis = (corner ^ other) >> 1, next = (axis + 1) % 3, last = (axis + 2) % 3;
    return 4 * axis + (corner >> next & 1) + 2 * (corner >> last & 1);
  }
  for (int i = 0; i < edges_; ++i) {
    const Edge of = edge(i);
    if ((of.from == corner && of.to == other) || (of.from == other && of.to == corner)) return i;
  }
  return -1;
}

Vec<3> Polyhedron::own_corner(int i) const {
  if (!core_.corners.empty()) return core_.corners[i];
  Vec<3> place = Vec<3>::Zero();
  Orientation<3> turn = no_rotation<3>();
  if (core_.box) {
    place = core_.box->corner(i), turn = core_.box->turn;
  } else if (core_.capsule) {
    place[1] = i ? core_.capsule->half : -core_.capsule->half, turn = core_.capsule->turn;
  }
  if (turn != no_rotation<3>()) place = rotation<3>(turn) * place;
  return core_.middle + place;
}

Vec<3> Polyhedron::own_normal(int face) const {
  if (!is_box()) return loop_normal(core_, face);
  const double sign = face & 1 ? 1 : -1;
  if (core_.box->turn == no_rotation<3>()) return sign * Vec<3>::Unit(face >> 1);
  return sign * rotation<3>(core_.box->turn).col(face >> 1);
}

Vec<3> Polyhedron::own_along(int edge) const {
  if (is_box() || faces_ == 0) {
    const Orientation<3>& turn = is_box() ? core_.box->turn : core_.capsule->turn;
    const int axis = is_box() ? edge >> 2 : 1;
    if (turn == no_rotation<3>()) return Vec<3>::Unit(axis);
    return rotation<3>(turn).col(axis);
  }
  const Edge of = this->edge(edge);
  const Vec<3> way = core_.corners[of.to] - core_.corners[of.from];
  return way / std::sqrt(way.squaredNorm());
}

double reach_along(const Core<3>& core, const Rotation<3>& room_from_body, const Vec<3>& d) {
  const Vec<3> own = room_from_body.transpose() * d;
  const auto in_axes = [&](const Orientation<3>& turn) -> Vec<3> {
    return turn == no_rotation<3>() ? own : Vec<3>(rotation<3>(turn).transpose() * own);
  };
  if (core.box) return own.dot(core.middle) + in_axes(core.box->turn).cwiseAbs().dot(core.box->half);
  if (core.capsule)
    return own.dot(core.middle) + std::fabs(in_axes(core.capsule->turn)[1]) * core.capsule->half;
  if (core.corners.empty()) return own.dot(core.middle);
  double most = -1e300;
  for (const Vec<3>& corner : core.corners) most = std::max(most, own.dot(corner));
  return most;
}

int Polyhedron::farthest(const Vec<3>& d) const {
  if (corners_ == 1) return 0;
  if (is_box()) {
    const Vec<3> own = axes_.transpose() * d;
    return (own[0] > 0 ? 1 : 0) | (own[1] > 0 ? 2 : 0) | (own[2] > 0 ? 4 : 0);
  }
  if (faces_ == 0) return axes_.col(1).dot(d) > 0 ? 1 : 0;
  const Vec<3> own = turn_.transpose() * d;
  int best = 0;
  double most = own.dot(core_.corners[0]);
  for (int i = 1; i < corners_; ++i) {
    const double here = own.dot(core_.corners[i]);
    if (here > most) {
      most = here;
      best = i;
    }
  }
  return best;
}

int Polyhedron::facing(int corner, const Vec<3>& d) const {
  if (is_box()) {
    const Vec<3> own = axes_.transpose() * d;
    int best = 0;
    double most = -1e300;
    for (int axis = 0; axis < 3; ++axis) {
      const int side = corner >> axis & 1;
      const double here = side ? own[axis] : -own[axis];
      if (here > most) {
        most = here;
        best = 2 * axis + side;
      }
    }
    return best;
  }
  int best = 0;
  double most = -1e300;
  for (int face = 0; face < faces_; ++face) {
    const std::span<const int> around = loop(face);
    if (std::find(around.begin(), around.end(), corner) == around.end()) continue;
    const double here = normal(face).dot(d);
    if (here > most) {
      most = here;
      best = face;
    }
  }
  return best;
}

namespace {

// by the three axes of a box at once
FaceAxis of_box(const Polyhedron& of, const Polyhedron& other) {
  const Vec<3> away = of.axes().transpose() * (other.middle() - of.middle());
  const Rotation<3> seen = of.axes().transpose() * other.arms();
  const Vec<3> s = away.cwiseAbs() - of.half() - seen.cwiseAbs().rowwise().sum();
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (s[k] > s[axis]) axis = k;
  }
  const int face = 2 * axis + (away[axis] > 0 ? 1 : 0);
  return {s[axis], face, other.farthest(-of.normal(face))};
}

// by the nine common normals of two boxes' axes; the edges are those that face each other
EdgeAxis of_boxes(const Polyhedron& a, const Polyhedron& b, double enough) {
  const Vec<3> away = a.middle() - b.middle();
  EdgeAxis best;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      Vec<3> n = a.axes().col(i).cross(b.axes().col(j));
      const double sine = std::sqrt(n.squaredNorm());
      if (sine < kParallelEdges) continue;
      n /= away.dot(n) < 0 ? -sine : sine;
      const Vec<3> over_a = a.arms().transpose() * n, over_b = b.arms().transpose() * n;
      double value = away.dot(n);
      for (int k = 0; k < 3; ++k) {
        if (k != i) value -= std::fabs(over_a[k]);
        if (k != j) value -= std::fabs(over_b[k]);
      }
      if (!(value > best.value)) continue;
      const auto edge = [](int axis, const Vec<3>& low) {
        return 4 * axis + (low[(axis + 1) % 3] < 0 ? 1 : 0) + (low[(axis + 2) % 3] < 0 ? 2 : 0);
      };
      best = {value, edge(i, over_a), edge(j, Vec<3>(-over_b)), n};
      if (value > enough) return best;
    }
  }
  return best;
}

// an edge, and the ways from it into its faces
struct Wedge {
  Vec<3> place, along, left = Vec<3>::Zero(), right = Vec<3>::Zero();

  Wedge(const Polyhedron& of, int number) : along(of.along(number)) {
    const Polyhedron::Edge edge = of.edge(number);
    place = of.corner(edge.from);
    if (edge.left >= 0) left = of.normal(edge.left).cross(along);
    if (edge.right >= 0) right = along.cross(of.normal(edge.right));
  }
};

}  // namespace

FaceAxis greatest_separation(const Polyhedron& of, const Polyhedron& other, double enough) {
  if (of.is_box() && other.is_box()) return of_box(of, other);
  FaceAxis best;
  for (int face = 0; face < of.faces(); ++face) {
    const Vec<3> n = of.normal(face);
    const int deepest = other.farthest(-n);
    const double value = n.dot(other.corner(deepest) - of.corner(of.loop(face)[0]));
    if (value > best.value) best = {value, face, deepest};
    if (value > enough) break;
  }
  return best;
}

EdgeAxis greatest_edge_separation(const Polyhedron& a, const Polyhedron& b, double enough) {
  if (a.is_box() && b.is_box()) return of_boxes(a, b, enough);
  constexpr double kLevel = 1e-12;  // rounding of what lies in a face
  EdgeAxis best;
  for (int i = 0; i < a.edges(); ++i) {
    const Wedge of_a(a, i);
    for (int j = 0; j < b.edges(); ++j) {
      const Wedge of_b(b, j);
      Vec<3> n = of_a.along.cross(of_b.along);
      const double sine = std::sqrt(n.squaredNorm());
      if (sine < kParallelEdges) continue;
      n /= sine;
      const double ways[4] = {n.dot(of_a.left), n.dot(of_a.right), -n.dot(of_b.left), -n.dot(of_b.right)};
      const bool up = *std::min_element(ways, ways + 4) >= -kLevel;
      const bool down = *std::max_element(ways, ways + 4) <= kLevel;
      const double along = n.dot(of_a.place - of_b.place);
      const bool back = up && down ? along < 0 : down;
      if (!up && !down) continue;
      const double value = back ? -along : along;
      if (value > best.value) best = {value, i, j, back ? Vec<3>(-n) : n};
      if (value > enough) return best;
    }
  }
  return best;
}

// Ericson, Real-Time Collision Detection, 2005, §5.1.9
Nearest nearest(const Vec<3>& p0, const Vec<3>& p1, const Vec<3>& q0, const Vec<3>& q1) {
  const Vec<3> d = p1 - p0, e = q1 - q0, r = p0 - q0;
  const double dd = d.squaredNorm(), ee = e.squaredNorm(), er = e.dot(r), dr = d.dot(r);
  double s = 0, t = 0;
  if (dd > 0 && ee > 0) {
    const double de = d.dot(e), denominator = d.cross(e).squaredNorm();
    if (denominator > 0) s = std::clamp((de * er - dr * ee) / denominator, 0.0, 1.0);
    t = (de * s + er) / ee;
    if (t < 0) {
      t = 0;
      s = std::clamp(-dr / dd, 0.0, 1.0);
    } else if (t > 1) {
      t = 1;
      s = std::clamp((de - dr) / dd, 0.0, 1.0);
    }
  } else if (dd > 0) {
    s = std::clamp(-dr / dd, 0.0, 1.0);
  } else if (ee > 0) {
    t = std::clamp(er / ee, 0.0, 1.0);
  }
  return {s, t, std::sqrt((r + s * d - t * e).squaredNorm())};
}

bool over(const Polyhedron& solid, int face, const Vec<3>& place, double slack) {
  const std::span<const int> loop = solid.loop(face);
  const Vec<3> n = solid.normal(face);
  Vec<3> from = solid.corner(loop.back());
  for (const int corner : loop) {
    const Vec<3> to = solid.corner(corner), inward = n.cross(to - from);
    if (inward.dot(place - from) < -slack * std::sqrt(inward.squaredNorm())) return false;
    from = to;
  }
  return true;
}

double core_separation(const Polyhedron& a, const Polyhedron& b) {
  const double s = std::max({greatest_separation(a, b, 1e300).value, greatest_separation(b, a, 1e300).value,
                             greatest_edge_separation(a, b, 1e300).value});
  if (s <= 0 && a.faces() + b.faces() > 0) return s;

  // apart: corners over faces, and edges with their ends
  double least = 1e300;
  const auto corners_over = [&](const Polyhedron& base, const Polyhedron& other) {
    for (int face = 0; face < base.faces(); ++face) {
      const Vec<3> n = base.normal(face), origin = base.corner(base.loop(face)[0]);
      for (int i = 0; i < other.corners(); ++i) {
        const Vec<3> place = other.corner(i);
        const double height = n.dot(place - origin);
        if (height >= 0 && height < least && over(base, face, place, 0)) least = height;
      }
    }
  };
  corners_over(a, b), corners_over(b, a);
  for (int i = 0; i < std::max(1, a.edges()); ++i) {
    const Polyhedron::Edge p = a.edges() ? a.edge(i) : Polyhedron::Edge{};
    for (int j = 0; j < std::max(1, b.edges()); ++j) {
      const Polyhedron::Edge q = b.edges() ? b.edge(j) : Polyhedron::Edge{};
      least =
          std::min(least, nearest(a.corner(p.from), a.corner(p.to), b.corner(q.from), b.corner(q.to)).apart);
    }
  }
  return least;
}

}  // namespace obscura::sim
