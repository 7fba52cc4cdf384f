// Ambient occlusion. A place p with normal n sees less of the sky where, above it, the next body is nearer
// than the free height would be:
//   g(h)  = max(0, 1 - d(p + h n) / h)^2           d   distance to the body, m
//   dark  = 1 - product over bodies (1 - k (g(r) + g(r / 3)) / 2)
// r is how far the darkness reaches, in proportion to the thinner of the two. A place on a face that another
// body's face continues stays as bright as it is: there d = h. Closed formulas, so there is no noise.
// After Quilez, "ambient occlusion by distance fields".

#include "draw/space/occlusion.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kDark = 0.5;  // k

double near_part(double distance, double height) {
  const double g = std::clamp(1 - distance / height, 0.0, 1.0);
  return g * g;
}

}  // namespace

// The farthest of its planes, and beyond the edge with the one that is farthest across it.
double distance(const Polyhedron& body, const Vec3& place) {
  double first = -1e300;
  const Polyhedron::Face* most = nullptr;
  for (const Polyhedron::Face& face : body.faces) {
    const double d = face.normal.dot(place - body.vertices[std::size_t(face.loop[0])]);
    if (d > first) first = d, most = &face;
  }
  if (first <= 0) return first;
  double across = 0;
  for (const Polyhedron::Face& face : body.faces) {
    const double cosine = face.normal.dot(most->normal), sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
    if (sine < 0.05) continue;
    const double d = face.normal.dot(place - body.vertices[std::size_t(face.loop[0])]);
    across = std::max(across, (d - first * cosine) / sine);
  }
  return std::sqrt(first * first + across * across);
}

std::optional<Occlusion::Block> Occlusion::block(const Body& body) {
  if (!body.flat || body.flat->faces.size() != 6 || body.flat->vertices.size() != 8) return {};
  const auto square = [](double cosine) { return std::abs(cosine) < 1e-9; };
  const auto& faces = body.flat->faces;
  Block found;
  found.axes.row(0) = faces[0].normal;
  const auto next = std::find_if(faces.begin(), faces.end(), [&](const Polyhedron::Face& face) {
    return square(face.normal.dot(faces[0].normal));
  });
  if (next == faces.end()) return {};
  found.axes.row(1) = next->normal;
  found.axes.row(2) = faces[0].normal.cross(next->normal);
  for (const Polyhedron::Face& face : faces) {
    const Vec3 n = found.axes * face.normal;
    if (int(square(n.x())) + int(square(n.y())) + int(square(n.z())) != 2) return {};
  }
  found.half = (found.axes * (body.flat->vertices[0] - body.center)).cwiseAbs();
  return found;
}

Occlusion::Occlusion(std::vector<Body> bodies, const std::optional<Ground>& ground)
    : bodies_(std::move(bodies)), ground_(ground), near_(bodies_.size()) {
  for (const Body& each : bodies_) blocks_.push_back(block(each));
  // in the order of their left ends
  std::vector<int> order(bodies_.size());
  std::iota(order.begin(), order.end(), 0);
  const auto left = [&](int i) {
    const Body& it = bodies_[std::size_t(i)];
    return it.center.x() - it.around;
  };
  std::sort(order.begin(), order.end(),
            [&](int i, int k) { return left(i) != left(k) ? left(i) < left(k) : i < k; });
  double most = 0;
  for (const Body& each : bodies_) most = std::max(most, each.reach);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Body& a = bodies_[std::size_t(order[i])];
    for (std::size_t k = i + 1; k < order.size() && left(order[k]) < a.center.x() + a.around + most; ++k) {
      const Body& b = bodies_[std::size_t(order[k])];
      const double apart = a.around + b.around + std::min(a.reach, b.reach);
      if ((a.center - b.center).squaredNorm() > apart * apart) continue;
      near_[std::size_t(order[i])].push_back(order[k]);
      near_[std::size_t(order[k])].push_back(order[i]);
    }
    if (!ground_) continue;
    if ((a.center - ground_->point).dot(ground_->normal) < a.around + a.reach)
      near_[std::size_t(order[i])].push_back(-1);
  }
  for (std::vector<int>& each : near_) std::sort(each.begin(), each.end());
}

// What lies behind a face's plane does not darken it.
void Occlusion::near(int body, std::span<const Vec3> corners, const Vec3& normal,
                     std::vector<int>& found) const {
  found.clear();
  const double own = reach(body), least = 1e-6 * own;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : corners) middle += p / double(corners.size());
  double wide = 0;
  for (const Vec3& p : corners) wide = std::max(wide, (p - middle).norm());
  for (const int other : near(body)) {
    if (other < 0) {
      double low = 1e300;
      for (const Vec3& p : corners) low = std::min(low, distance(-1, p));
      if (low < own * (1 - normal.dot(ground_->normal)) - least) found.push_back(other);
      continue;
    }
    const Body& it = bodies_[std::size_t(other)];
    const double far = wide + it.around + 2 * std::min(own, it.reach);
    if ((it.center - middle).squaredNorm() > far * far) continue;
    double before = -1e300;
    if (it.flat)
      for (const Vec3& v : it.flat->vertices) before = std::max(before, normal.dot(v - middle));
    else
      for (const Vec3& end : {it.a, it.b}) before = std::max(before, normal.dot(end - middle) + it.radius);
    if (before > least) found.push_back(other);
  }
}

double Occlusion::distance(int body, const Vec3& place) const {
  if (body < 0) return (place - ground_->point).dot(ground_->normal);
  const Body& it = bodies_[std::size_t(body)];
  if (const auto& block = blocks_[std::size_t(body)]) {
    const Vec3 q = (block->axes * (place - it.center)).cwiseAbs() - block->half;
    return q.maxCoeff() > 0 ? q.cwiseMax(0.0).norm() : q.maxCoeff();
  }
  if (it.flat) return draw::distance(*it.flat, place);
  const Vec3 way = it.b - it.a;
  const double length = way.squaredNorm();
  const double part = length > 0 ? std::clamp((place - it.a).dot(way) / length, 0.0, 1.0) : 0;
  return (place - it.a - part * way).norm() - it.radius;
}

double Occlusion::at(int body, std::span<const int> others, const Vec3& place, const Vec3& normal) const {
  const double own = bodies_[std::size_t(body)].reach;
  double light = 1;
  for (const int other : others) {
    const double reach = other < 0 ? own : std::min(own, bodies_[std::size_t(other)].reach);
    if (!(reach > 0)) continue;
    if (other >= 0) {
      const Body& it = bodies_[std::size_t(other)];
      const double far = it.around + 2 * reach;
      if ((place - it.center).squaredNorm() > far * far) continue;
    }
    // what leaves the far height free leaves the near one free
    const double high = distance(other, place + reach * normal);
    double g = near_part(high, reach);
    if (high < reach) g += near_part(distance(other, place + reach / 3 * normal), reach / 3);
    light *= 1 - kDark * g / 2;
  }
  return 1 - light;
}

}  // namespace obscura::draw
