#include "sim/solve/exact/couples.h"

#include <algorithm>
#include <vector>

#include "sim/collide/may_touch.h"

namespace obscura::sim {

template <int D>
double couples(const Model<D>& model) {
  double bodies = 0, points = 0, fixed = 0, fixed_points = 0;
  for (const Body<D>& body : model.bodies) {
    if (body.handout) continue;
    const bool point = is_point(body.shape);
    ++(body.fixed ? (point ? fixed_points : fixed) : (point ? points : bodies));
  }
  return 0.5 * bodies * (bodies - 1) + bodies * (points + fixed + fixed_points) + points * fixed +
         (bodies + points) * double(model.walls.size());
}

template <int D>
void list_couples(const Model<D>& model, const std::function<void(int, int)>& found) {
  std::vector<int> all, moving, wide;
  for (int body = 0; body < int(model.bodies.size()); ++body) {
    const Body<D>& it = model.bodies[body];
    if (it.handout) continue;
    all.push_back(body);
    if (!it.fixed) moving.push_back(body);
    if (!is_point(it.shape)) wide.push_back(body);
  }
  const MayTouch<D> allowed(model);
  for (const int a : all) {
    const Body<D>& p = model.bodies[a];
    if (!p.fixed) {
      for (int wall = 0; wall < int(model.walls.size()); ++wall) found(a, -1 - wall);
    }
    const bool point = is_point(p.shape);
    const std::vector<int>& others = p.fixed ? moving : point ? wide : all;
    for (auto b = std::upper_bound(others.begin(), others.end(), a); b != others.end(); ++b) {
      const Body<D>& q = model.bodies[*b];
      if ((p.fixed && q.fixed) || (point && is_point(q.shape))) continue;
      if (allowed(a, *b)) found(a, *b);
    }
  }
}

template double couples<2>(const Model<2>&);
template double couples<3>(const Model<3>&);
template void list_couples<2>(const Model<2>&, const std::function<void(int, int)>&);
template void list_couples<3>(const Model<3>&, const std::function<void(int, int)>&);

}  // namespace obscura::sim
