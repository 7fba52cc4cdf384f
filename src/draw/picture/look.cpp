#include "draw/picture/look.h"

namespace obscura::draw {

std::optional<sim::Vec3> followed(const Camera& camera, const sim::SceneInfo& cast,
                                  const sim::Snapshot& now) {
  const std::vector<int>& those = camera.follow;
  if (those.empty()) return {};
  if (those.size() == 1) return now.bodies[std::size_t(those[0])].position;
  sim::Vec3 sum = sim::Vec3::Zero();
  double mass = 0;
  for (const int body : those) {
    const double m = sim::mass(cast, now, body);
    sum += m * now.bodies[std::size_t(body)].position, mass += m;
  }
  return sim::Vec3(sum / mass);
}

}  // namespace obscura::draw
