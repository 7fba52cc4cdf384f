#include "sim/step/outside_room.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <span>

#include "sim/model/body_motion.h"
#include "sim/model/wall_name.h"
#include "sim/shape/shape.h"

namespace obscura::sim {

namespace {

constexpr double kPressed = 1e-2;       // of a bounding radius: deeper no contact leaves what it pressed
constexpr double kPressedPoint = 1e-6;  // of the room's scale: a point has no radius
constexpr double kDigits = 1e-9;        // of a position: what is read and set again

// How far a body reaches beyond a wall, m; negative inside. However it is turned, that is at least how far
// its centre lies, which is within its hull; a ball reaches alike at any turn.
template <int D>
double reach(const Body<D>& body, std::span<const SupportVertex<D>> vertices, const BodyMotion<D>& at,
             const Wall<D>& wall, bool any_turn) {
  const double centre = -(at.x - wall.point).dot(wall.normal);
  if (body.fixed || (any_turn && !(vertices.size() == 1 && vertices[0].at.isZero(0)))) return centre;
  double most = -std::numeric_limits<double>::infinity();
  for (const SupportVertex<D>& vertex : vertices)
    most = std::max(most, vertex.radius - (at.x + at.arm(vertex.at) - wall.point).dot(wall.normal));
  return most;
}

}  // namespace

template <int D>
std::optional<Outside> outside(const Model<D>& model, const State<D>& before, const State<D>& now,
                               bool any_turn) {
  std::optional<SupportVertices<D>> vertices;
  for (int i = 0; i < int(model.bodies.size()); ++i) {
    const int k = turning(now, i);
    const bool set = now.x[std::size_t(i)] != before.x[std::size_t(i)] ||
                     (k >= 0 && now.turn[std::size_t(k)] != before.turn[std::size_t(k)]);
    if (!set) continue;
    if (!vertices) vertices.emplace(model.bodies);
    const Body<D>& body = model.bodies[std::size_t(i)];
    const BodyMotion<D> was = body_motion(before, i), is = body_motion(now, i);
    const double digits = kDigits * (model.scale + is.x.cwiseAbs().maxCoeff());
    const double pressed =
        std::max({kPressed * bounding_radius(body.shape), kPressedPoint * model.scale, digits});
    for (std::size_t w = 0; w < model.walls.size(); ++w) {
      const auto reaches = [&](const BodyMotion<D>& at) {
        return reach<D>(body, (*vertices)[i], at, model.walls[w], any_turn && k >= 0);
      };
      const double far = reaches(is);
      if (far <= pressed || far <= reaches(was) + digits) continue;
      char metres[32];
      std::snprintf(metres, sizeof metres, "%.3g", far);
      const auto name = wall_name<D>(model.walls[w].normal);
      return Outside{
          i, std::string(metres) + " m beyond " + (name ? std::string(*name) : "wall " + std::to_string(w))};
    }
  }
  return std::nullopt;
}

template std::optional<Outside> outside<2>(const Model<2>&, const State<2>&, const State<2>&, bool);
template std::optional<Outside> outside<3>(const Model<3>&, const State<3>&, const State<3>&, bool);

}  // namespace obscura::sim
