// The part of a line that a convex body hides. In page space (CameraProjection::seen) a plane n . p = d of
// the world is the plane
//   N = (n_r, -n_u, n_b - d' k),  D = n_b s/k + n_r m_x - n_u m_y        (perspective)
//   N = (n_r, -n_u, n_b),         D = s d' + n_r m_x - n_u m_y           (orthographic)
// n_r, n_u, n_b  the normal along the lens's right, up and back, d' = d - n . target, k = 1/distance, s  the
// scale, m  the middle of the page. It keeps its sides, and faces the eye where N_z > 0. A point of the page
// lies under the body if it is inside its outline; it is behind the body's front if it is behind every face
// that looks at the eye. Each condition is a half space, so a body hides one interval of a line: the
// intersection of as many half lines.

#include "draw/space/sight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kInside = 0.4;  // page units that a line must lie inside an outline
constexpr double kBehind = 0.5;  // and behind a face: bodies that touch do not hide each other's edges there
constexpr double kCell = 48;     // page units
constexpr double kRound = 6;     // page units: the front of a round thing of a larger radius is not flat
constexpr double kFacet = std::numbers::pi / 6;  // from one plane of such a front to the next
constexpr double kSeam = 2 * kBehind;            // so near to the front of its own thing a line is a seam
constexpr double kSamePlane = 0.99999;           // cosine between planes that are one
constexpr double kSightNear = 1e-3;              // least depth over the target's
constexpr double kShort = 0.25;  // page units: shorter parts are left out, shorter gaps closed

Eigen::Vector4d plane(const CameraProjection& lens, const Vec3& normal, const Vec3& point) {
  const double r = normal.dot(lens.right), u = normal.dot(lens.up), b = normal.dot(lens.back);
  const double d = normal.dot(point - lens.target), k = lens.per_distance;
  const double on_page = r * lens.middle.x() - u * lens.middle.y();
  Eigen::Vector4d p = k > 0 ? Eigen::Vector4d(r, -u, b - d * k, b * lens.scale / k + on_page)
                            : Eigen::Vector4d(r, -u, b, lens.scale * d + on_page);
  const double length = p.head<3>().norm();
  return length > 0 ? Eigen::Vector4d(p / length) : Eigen::Vector4d(0, 0, 0, 1);
}

}  // namespace

HiddenLines::HiddenLines(const CameraProjection& lens) : lens_(lens) {
  columns_ = std::max(1, int(std::ceil(lens.window.width / kCell)));
  rows_ = std::max(1, int(std::ceil(lens.window.height / kCell)));
}

void HiddenLines::close(Piece piece) {
  piece.end = int(planes_.size());
  const Rect& w = lens_.window;
  if (piece.x1 < w.x || piece.y1 < w.y || piece.x0 > w.x + w.width || piece.y0 > w.y + w.height) {
    planes_.resize(std::size_t(piece.begin));
    return;
  }
  pieces_.push_back(piece);
}

// what lies behind this plane may be hidden
void HiddenLines::add_front(const Vec3& normal, const Vec3& point) {
  Eigen::Vector4d p = plane(lens_, normal, point);
  // one that is turned away from the eye would hide what lies before it
  if (p.z() < 1e-6) return;
  p.w() -= kBehind;
  planes_.push_back(p);
}

int HiddenLines::group_of(int number) const {
  return number >= 0 && number < int(groups_.size()) ? groups_[std::size_t(number)] : -1;
}

void HiddenLines::add(const Polyhedron& body, int number, int group) {
  if (group >= 0 && number >= 0) {
    if (number >= int(groups_.size())) groups_.resize(std::size_t(number) + 1, -1);
    groups_[std::size_t(number)] = group;
  }
  std::vector<Vec3> at;
  at.reserve(body.vertices.size());
  Piece piece{number, group, int(planes_.size()), 0, 1e300, 1e300, -1e300, -1e300};
  Point middle = Point::Zero();
  for (const Vec3& v : body.vertices) {
    if (lens_.depth(v) < kSightNear) return;
    at.push_back(lens_.seen(v));
    piece.x0 = std::min(piece.x0, at.back().x()), piece.x1 = std::max(piece.x1, at.back().x());
    piece.y0 = std::min(piece.y0, at.back().y()), piece.y1 = std::max(piece.y1, at.back().y());
    middle += at.back().head<2>() / double(body.vertices.size());
  }
  std::vector<char> front(body.faces.size());
  for (std::size_t f = 0; f < body.faces.size(); ++f) {
    Eigen::Vector4d p = plane(lens_, body.faces[f].normal, body.vertices[body.faces[f].loop[0]]);
    front[f] = p.z() > 0;
    if (group >= 0 && !front[f]) piece.backs.push_back(p);
    if (p.z() < 1e-6) continue;
    p.w() -= kBehind;
    planes_.push_back(p);
  }
  for (const Polyhedron::Edge& edge : body.edges) {
    if (edge.right < 0 || front[edge.left] == front[edge.right]) continue;
    const Point along = (at[edge.b] - at[edge.a]).head<2>();
    const double length = along.norm();
    if (length < 1e-9) continue;
    Point n = Point(along.y(), -along.x()) / length;
    if (n.dot(middle - at[edge.a].head<2>()) > 0) n = -n;
    planes_.push_back({n.x(), n.y(), 0, n.dot(at[edge.a].head<2>()) - kInside});
  }
  close(piece);
}

void HiddenLines::add_disc(const std::vector<Vec3>& rim, const Vec3& center, double radius, int number) {
  if (lens_.depth(center) < kSightNear) return;
  Piece piece{number, -1, int(planes_.size()), 0, 1e300, 1e300, -1e300, -1e300};
  std::vector<Point> at;
  at.reserve(rim.size());
  for (const Vec3& v : rim) {
    if (lens_.depth(v) < kSightNear) return;
    at.push_back(lens_.page(v));
    piece.x0 = std::min(piece.x0, at.back().x()), piece.x1 = std::max(piece.x1, at.back().x());
    piece.y0 = std::min(piece.y0, at.back().y()), piece.y1 = std::max(piece.y1, at.back().y());
  }
  // The region behind its front: behind planes that lie in the ball, close to its surface. Of a small one the
  // contour's plane is near enough.
  const Vec3 sight = lens_.sight(center);
  const Point middle = lens_.page(center);
  if (radius * lens_.scale_at(center) < kRound) {
    add_front(sight, rim[0]);
  } else {
    const Vec3 side = (rim[0] - center).cross(sight).normalized(), up = sight.cross(side);
    const double inner = radius * std::cos(0.75 * kFacet);
    add_front(sight, center + inner * sight);
    for (int ring = 1; ring < 3; ++ring)
      for (int k = 0; k < 4 * ring + 2; ++k) {
        const double polar = ring * kFacet, turn = 2 * std::numbers::pi * k / (4 * ring + 2);
        const Vec3 n =
            std::cos(polar) * sight + std::sin(polar) * (std::cos(turn) * side + std::sin(turn) * up);
        add_front(n, center + inner * n);
      }
  }
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Point along = at[(i + 1) % at.size()] - at[i];
    const double length = along.norm();
    if (length < 1e-9) continue;
    Point n = Point(along.y(), -along.x()) / length;
    if (n.dot(middle - at[i]) > 0) n = -n;
    planes_.push_back({n.x(), n.y(), 0, n.dot(at[i]) - kInside});
  }
  close(piece);
}

void HiddenLines::add_rod(const Vec3& a, const Vec3& b, double radius_a, double radius_b, int number) {
  const Vec3 way = b - a, across = way.cross(lens_.sight((a + b) / 2));
  const double length = across.norm();
  if (length < 1e-12 * way.norm() || way.norm() == 0) return;
  const Vec3 side = across / length;
  const std::array<Vec3, 4> quad{a - radius_a * side, a + radius_a * side, b + radius_b * side,
                                 b - radius_b * side};
  Piece piece{number, -1, int(planes_.size()), 0, 1e300, 1e300, -1e300, -1e300};
  std::array<Point, 4> at;
  Point middle = Point::Zero();
  for (int i = 0; i < 4; ++i) {
    if (lens_.depth(quad[i]) < kSightNear) return;
    at[i] = lens_.page(quad[i]);
    middle += at[i] / 4;
    piece.x0 = std::min(piece.x0, at[i].x()), piece.x1 = std::max(piece.x1, at[i].x());
    piece.y0 = std::min(piece.y0, at[i].y()), piece.y1 = std::max(piece.y1, at[i].y());
  }
  Vec3 normal = side.cross(way).normalized();
  if (normal.dot(lens_.sight(a)) < 0) normal = -normal;
  if (radius_a != radius_b || radius_a * lens_.scale_at((a + b) / 2) < kRound) {
    add_front(normal, a);
  } else {
    const double inner = radius_a * std::cos(kFacet / 2);
    for (int k = -2; k <= 2; ++k) {
      const Vec3 n = std::cos(k * kFacet) * normal + std::sin(k * kFacet) * side;
      add_front(n, a + inner * n);
    }
  }
  for (int i = 0; i < 4; ++i) {
    const Point along = at[(i + 1) % 4] - at[i];
    const double l = along.norm();
    if (l < 1e-9) continue;
    Point n = Point(along.y(), -along.x()) / l;
    if (n.dot(middle - at[i]) > 0) n = -n;
    // the ends are open: the next piece of a tube goes on there
    planes_.push_back({n.x(), n.y(), 0, n.dot(at[i]) - (i % 2 == 0 ? 0 : std::min(kInside, 0.2 * l))});
  }
  close(piece);
}

void HiddenLines::finish() {
  cells_.assign(std::size_t(columns_) * rows_, {});
  const Rect& w = lens_.window;
  for (int i = 0; i < int(pieces_.size()); ++i) {
    const Piece& p = pieces_[i];
    const int c0 = std::clamp(int((p.x0 - w.x) / kCell), 0, columns_ - 1),
              c1 = std::clamp(int((p.x1 - w.x) / kCell), 0, columns_ - 1),
              r0 = std::clamp(int((p.y0 - w.y) / kCell), 0, rows_ - 1),
              r1 = std::clamp(int((p.y1 - w.y) / kCell), 0, rows_ - 1);
    for (int r = r0; r <= r1; ++r)
      for (int c = c0; c <= c1; ++c) cells_[std::size_t(columns_) * r + c].push_back(i);
  }
  stamp_.assign(pieces_.size(), 0);
}

void HiddenLines::seen(const Vec3& from, const Vec3& to, int own, int too, Parts& parts,
                       std::span<const Vec3> faces, double end) const {
  parts.clear();
  if (lens_.depth(from) < kSightNear || lens_.depth(to) < kSightNear) return;
  const Vec3 a = lens_.seen(from), b = lens_.seen(to), way = b - a;
  const double length = way.head<2>().norm();
  const Rect& w = lens_.window;
  const double x0 = std::min(a.x(), b.x()), x1 = std::max(a.x(), b.x());
  const double y0 = std::min(a.y(), b.y()), y1 = std::max(a.y(), b.y());
  const int group = group_of(own);
  if (x1 < w.x || y1 < w.y || x0 > w.x + w.width || y0 > w.y + w.height) return;

  // the planes of its own faces
  planes_at_.clear();
  for (const Vec3& normal : faces) planes_at_.push_back(plane(lens_, normal, from));
  const auto continues = [&](const Piece& piece) {
    if (group < 0 || piece.group != group || planes_at_.empty()) return false;
    for (int i = piece.begin; i < piece.end; ++i) {
      Eigen::Vector4d p = planes_[i];
      if (!(p.z() > 0)) continue;
      p.w() += kBehind;
      for (const Eigen::Vector4d& own_face : planes_at_)
        if (own_face.head<3>().dot(p.head<3>()) > kSamePlane && std::abs(own_face.w() - p.w()) < kSeam)
          return true;
    }
    // or covers one: what the line bounds is not seen there
    for (const Eigen::Vector4d& p : piece.backs)
      for (const Eigen::Vector4d& own_face : planes_at_)
        if (own_face.head<3>().dot(p.head<3>()) < -kSamePlane && std::abs(own_face.w() + p.w()) < kSeam)
          return true;
    return false;
  };

  // the lines that each piece hides
  hidden_.clear();
  ++stamps_;
  const auto visit = [&](int index) {
    if (stamp_[index] == stamps_) return;
    stamp_[index] = stamps_;
    const Piece& piece = pieces_[index];
    if (piece.number == own || piece.number == too) return;
    if (x1 < piece.x0 || x0 > piece.x1 || y1 < piece.y0 || y0 > piece.y1) return;
    double low = 0, high = 1, before = 0, after = 0;
    const double ahead = group >= 0 && piece.group == group ? 0 : end / std::max(length, 1e-9);
    const bool own_face = continues(piece);
    for (int i = piece.begin; i < piece.end; ++i) {
      const Eigen::Vector4d& p = planes_[i];
      // inside where height + t rise < 0
      const bool seam = group >= 0 && piece.group == group && p.z() > 0;
      const double more = seam ? kSeam : own_face ? 2 * kInside : 0;
      const double height = p.head<3>().dot(a) - p.w() - more, rise = p.head<3>().dot(way);
      if (height >= 0 && height + rise >= 0) return;
      if (height < 0 && height + rise < 0) continue;
      const double t = height / -rise;
      // an outline is a plane along the third axis
      if (height < 0 && t < high) high = t, after = p.z() == 0 ? ahead : 0;
      if (height >= 0 && t > low) low = t, before = p.z() == 0 ? ahead : 0;
      if (low >= high) return;
    }
    hidden_.push_back({low - before, high + after});
  };
  const int c0 = std::clamp(int((x0 - w.x) / kCell), 0, columns_ - 1),
            c1 = std::clamp(int((x1 - w.x) / kCell), 0, columns_ - 1),
            r0 = std::clamp(int((y0 - w.y) / kCell), 0, rows_ - 1),
            r1 = std::clamp(int((y1 - w.y) / kCell), 0, rows_ - 1);
  for (int r = r0; r <= r1; ++r)
    for (int c = c0; c <= c1; ++c)
      for (int index : cells_[std::size_t(columns_) * r + c]) visit(index);

  // and what is left
  std::sort(hidden_.begin(), hidden_.end());
  const double least = kShort / std::max(length, 1e-9);
  double at = 0;
  for (const auto& [low, high] : hidden_) {
    if (low - at > least) parts.push_back({at, low});
    at = std::max(at, high);
  }
  if (1 - at > std::min(least, 0.5)) parts.push_back({at, 1});
}

bool HiddenLines::seen(const Vec3& place, int own, int too) const {
  Parts parts;
  // a point is a line without a length
  seen(place, place, own, too, parts);
  return !parts.empty();
}

std::vector<Vec3> contour(const CameraProjection& lens, const Vec3& center, double radius, int count) {
  const Vec3 sight = lens.sight(center);
  double forward = 0, wide = radius;
  if (lens.perspective()) {
    const double far = (lens.eye() - center).norm();
    forward = std::min(radius * radius / far, radius);
    wide = std::sqrt(std::max(radius * radius - forward * forward, 0.0));
  }
  const Vec3 side = lens.up.cross(sight).normalized(), up = sight.cross(side);
  std::vector<Vec3> rim;
  rim.reserve(std::size_t(count));
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    rim.push_back(center + forward * sight + wide * (std::cos(angle) * side + std::sin(angle) * up));
  }
  return rim;
}

int roundness(double page_radius) {
  // a chord leaves the circle by 0.15 page units at most
  const double half = std::acos(std::clamp(1 - 0.15 / std::max(page_radius, 0.3), -1.0, 1.0));
  return std::clamp(int(std::ceil(std::numbers::pi / half / 4)) * 4, 8, 96);
}

}  // namespace obscura::draw
