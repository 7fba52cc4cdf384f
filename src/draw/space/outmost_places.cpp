// The support point of a body's form in direction d, own frame; of a run it is the outmost of all bodies and
// instants, h(d) = max d . x.

#include "draw/space/outmost_places.h"

#include <algorithm>
#include <numeric>

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kGround = 0.5;  // of a normal upwards, at least: the ground's

/// Directions to the points of a small cubic lattice, one each: 98, at most 19 degrees apart, and the same
/// numbers everywhere.
const std::vector<Vec3>& directions() {
  static const std::vector<Vec3> all = [] {
    std::vector<Vec3> found;
    for (int x = -2; x <= 2; ++x)
      for (int y = -2; y <= 2; ++y)
        for (int z = -2; z <= 2; ++z)
          if (std::gcd(x, std::gcd(y, z)) == 1) found.push_back(Vec3(x, y, z).normalized());
    return found;
  }();
  return all;
}

/// The outmost place of a form in a direction, in the form's frame.
template <class Form>
Vec3 outmost(const Form& form, const Vec3& d) {
  Vec3 at = Vec3::Zero();
  if (!form.vertices.empty())
    at = *std::max_element(form.vertices.begin(), form.vertices.end(),
                           [&](const Vec3& a, const Vec3& b) { return a.dot(d) < b.dot(d); });
  else
    for (int i = 0; i < 3; ++i) at[i] = d[i] < 0 ? -form.half[i] : form.half[i];
  return at + form.radius * d;
}

}  // namespace

void OutmostPlaces::add(const sim::SceneInfo& cast, const sim::Snapshot& now) {
  const std::vector<Vec3>& towards = directions();
  all_.resize(towards.size());
  for (std::size_t i = 0; i < cast.bodies.size() && i < now.bodies.size(); ++i) {
    const sim::SceneInfo::Body& body = cast.bodies[i];
    if (body.bare) continue;
    const Eigen::Matrix3d turn = now.bodies[i].orientation.toRotationMatrix();
    for (std::size_t k = 0; k < towards.size(); ++k) {
      const auto own = [&](const Vec3& at) { offer(k, now.bodies[i].position + turn * at); };
      const Vec3 d = turn.transpose() * towards[k];
      if (body.parts.empty()) own(outmost(body, d));
      for (const sim::SceneInfo::Part& part : body.parts)
        own(part.center + part.turn * outmost(part, part.turn.conjugate() * d));
    }
  }
}

void OutmostPlaces::add_feet(const sim::SceneInfo& cast, const sim::Snapshot& now) {
  const sim::SceneInfo::Wall* ground = nullptr;
  double level = kGround;
  for (const sim::SceneInfo::Wall& wall : cast.walls) {
    const Vec3 up = wall.normal.normalized();
    const bool higher = ground && up.y() == level && up.dot(wall.point - ground->point) > 0;
    if (up.y() > level || higher) ground = &wall, level = up.y();
  }
  if (!ground) return;
  const Vec3 up = ground->normal.normalized();
  all_.resize(directions().size());
  for (std::size_t i = 0; i < cast.bodies.size() && i < now.bodies.size(); ++i) {
    if (cast.bodies[i].fixed || cast.bodies[i].bare) continue;
    const Vec3& at = now.bodies[i].position;
    for (std::size_t k = 0; k < all_.size(); ++k) offer(k, at - (at - ground->point).dot(up) * up);
  }
}

void OutmostPlaces::offer(std::size_t k, const Vec3& at) {
  const double far = at.dot(directions()[k]);
  if (far > all_[k].far) all_[k] = {far, at};
}

void OutmostPlaces::add(const OutmostPlaces& other) {
  all_.resize(std::max(all_.size(), other.all_.size()));
  for (std::size_t k = 0; k < other.all_.size(); ++k)
    if (other.all_[k].far > all_[k].far) all_[k] = other.all_[k];
}

std::vector<Vec3> OutmostPlaces::places() const {
  std::vector<Vec3> found;
  for (const Outmost& each : all_)
    if (each.far > -1e300) found.push_back(each.at);
  return found;
}

}  // namespace obscura::draw
