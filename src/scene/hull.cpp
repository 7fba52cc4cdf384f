// The hull of points, by wrapping them: a plane is turned about an edge of a face until it meets the first
// point; with all points that lie in it, it is the face on the other side (Chand and Kapur, 1970). Faces of
// more than three corners come out whole.

#include "scene/hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <numbers>
#include <utility>

namespace obscura::scene {

namespace {

using sim::Vec3;

constexpr double kRounding = 1e-6;  // of the whole's size: as near as this is in the plane, or one place

class Wrapping {
 public:
  explicit Wrapping(const std::vector<Vec3>& points) : p_(points) {
    Vec3 low = p_[0], high = p_[0];
    for (const Vec3& p : p_) low = low.cwiseMin(p), high = high.cwiseMax(p);
    near_ = kRounding * (high - low).norm();
  }

  std::vector<std::vector<int>> faces() {
    std::vector<std::vector<int>> all;
    const std::vector<int> start = first();
    if (start.empty()) return {};
    std::map<std::pair<int, int>, bool> wrapped;  // edges whose face is known
    std::deque<std::vector<int>> open = {start};
    const std::size_t most = 2 * p_.size();  // faces of a hull, by Euler; more come of rounding alone
    while (!open.empty() && all.size() <= most) {
      const std::vector<int> face = open.front();
      open.pop_front();
      if (wrapped.contains({face[0], face[1]})) continue;
      all.push_back(face);
      for (std::size_t k = 0; k < face.size(); ++k) wrapped[{face[k], face[(k + 1) % face.size()]}] = true;
      for (std::size_t k = 0; k < face.size(); ++k) {
        const int a = face[(k + 1) % face.size()], b = face[k];
        if (!wrapped.contains({a, b})) open.push_back(across(a, b, normal(face)));
      }
    }
    return all;
  }

 private:
  Vec3 normal(const std::vector<int>& face) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 1; k + 1 < face.size(); ++k)
      sum += (p_[std::size_t(face[k])] - p_[std::size_t(face[0])])
                 .cross(p_[std::size_t(face[k + 1])] - p_[std::size_t(face[0])]);
    return sum.normalized();
  }

  // a face to begin with: that of the lowest edge, found by turning about it; none where all lie in a plane
  std::vector<int> first() {
    const int n = int(p_.size());
    int a = 0;
    for (int i = 1; i < n; ++i) {
      const Vec3 &p = p_[std::size_t(i)], &least = p_[std::size_t(a)];
      if (std::array{p.y(), p.x(), p.z()} < std::array{least.y(), least.x(), least.z()}) a = i;
    }
    // about the lowest point, in the upright plane along x: the point of the flattest way up
    int b = -1;
    for (int i = 0; i < n; ++i) {
      const Vec3 way = p_[std::size_t(i)] - p_[std::size_t(a)];
      if (std::max(std::abs(way.x()), std::abs(way.y())) <= near_) continue;
      if (b < 0) b = i;
      const Vec3 best = p_[std::size_t(b)] - p_[std::size_t(a)];
      const double left = best.x() * way.y() - best.y() * way.x();  // below the best one, seen along z
      if (left < 0 || (left == 0 && way.norm() > best.norm())) b = i;
    }
    if (b < 0) return {};
    // the plane through it along z leaves all others on one side
    const Vec3 out = (p_[std::size_t(b)] - p_[std::size_t(a)]).cross(Vec3::UnitZ()).normalized();
    std::vector<int> face = across(a, b, out);
    if (face.size() < 3) return {};
    // all in one plane: no solid
    const Vec3 up = normal(face);
    const bool flat = std::all_of(p_.begin(), p_.end(), [&](const Vec3& p) {
      return std::abs((p - p_[std::size_t(a)]).dot(up)) <= near_;
    });
    return flat ? std::vector<int>{} : face;
  }

  // the face along the edge from a to b whose other side has the normal `from`
  std::vector<int> across(int a, int b, const Vec3& from) const {
    const Vec3 &pa = p_[std::size_t(a)], edge = (p_[std::size_t(b)] - pa).normalized();
    const Vec3 in = from.cross(edge).normalized();  // in the known face's plane, away from its inside
    // angle from the continued plane, backwards: the least is met first
    int best = -1;
    Vec3 best_in = Vec3::Zero();
    for (int i = 0; i < int(p_.size()); ++i) {
      Vec3 way = p_[std::size_t(i)] - pa;
      way -= way.dot(edge) * edge;
      if (way.norm() <= near_) continue;
      way.normalize();
      if (best < 0 || turn(way, in, from) < turn(best_in, in, from)) best = i, best_in = way;
    }
    if (best < 0) return {};
    const Vec3 up = edge.cross(best_in);
    std::vector<int> in_plane;
    for (int i = 0; i < int(p_.size()); ++i)
      if (std::abs((p_[std::size_t(i)] - pa).dot(up)) <= near_) in_plane.push_back(i);
    return loop(in_plane, up, a, b);
  }

  // from 0 to pi; points in the known face are at pi, but for rounding
  static double turn(const Vec3& way, const Vec3& in, const Vec3& from) {
    const double angle = std::atan2(-way.dot(from), way.dot(in));
    return angle < -1 ? angle + 2 * std::numbers::pi : angle;
  }

  // the corners of points in a plane, counter-clockwise about `up`
  std::vector<int> loop(std::vector<int> points, const Vec3& up, int a, int b) const {
    const Vec3 x = (p_[std::size_t(b)] - p_[std::size_t(a)]).normalized(), y = up.cross(x);
    const auto at = [&](int i) {
      const Vec3 p = p_[std::size_t(i)] - p_[std::size_t(a)];
      return Eigen::Vector2d(p.dot(x), p.dot(y));
    };
    // Andrew's monotone chains
    std::sort(points.begin(), points.end(), [&](int i, int k) {
      const Eigen::Vector2d p = at(i), q = at(k);
      return std::array{p.x(), p.y(), double(i)} < std::array{q.x(), q.y(), double(k)};
    });
    const auto half = [&](auto begin, auto end) {
      std::vector<int> chain;
      for (auto it = begin; it != end; ++it) {
        while (chain.size() >= 2) {
          const Eigen::Vector2d p = at(chain[chain.size() - 2]), u = at(chain.back()) - p, v = at(*it) - p;
          if (u.x() * v.y() - u.y() * v.x() > near_ * v.norm()) break;
          chain.pop_back();
        }
        chain.push_back(*it);
      }
      chain.pop_back();
      return chain;
    };
    std::vector<int> all = half(points.begin(), points.end());
    const std::vector<int> back = half(points.rbegin(), points.rend());
    all.insert(all.end(), back.begin(), back.end());
    return all;
  }

  const std::vector<Vec3>& p_;
  double near_ = 0;
};

}  // namespace

sim::Hull hull(const std::vector<Vec3>& typed) {
  sim::Hull it;
  // each place once
  std::vector<Vec3> points;
  Vec3 size = Vec3::Zero();
  for (const Vec3& p : typed) size = size.cwiseMax((p - typed[0]).cwiseAbs());
  for (const Vec3& p : typed)
    if (std::none_of(points.begin(), points.end(),
                     [&](const Vec3& q) { return (p - q).norm() <= 2 * kRounding * size.norm(); }))
      points.push_back(p);
  if (points.size() < 4) return it;
  // those that lie on the hull alone, in the order given
  std::vector<std::vector<int>> faces = Wrapping(points).faces();
  std::vector<int> number(points.size(), -1);
  for (const std::vector<int>& face : faces)
    for (const int i : face) number[std::size_t(i)] = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = int(it.vertices.size());
    it.vertices.push_back(points[i]);
  }
  for (std::vector<int>& face : faces)
    for (int& i : face) i = number[std::size_t(i)];
  it.faces = std::move(faces);
  return it;
}

}  // namespace obscura::scene
