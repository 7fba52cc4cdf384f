#include "sim/solve/exact/couples.h"

#include <algorithm>
#include <vector>

#include "sim/collide/may_touch.h"
#include "sim/collide/rails.h"

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
  // what has rails is touched by points, and what is nothing but rails by what touches those alone
  std::vector<char> rails(model.bodies.size(), 0);
  for (const Rail<D>& rail : model.rails) rails[std::size_t(rail.body)] = 1;
  const auto is_dot = [&](int body) {
    return is_point(model.bodies[std::size_t(body)].shape) && !rails[std::size_t(body)];
  };
  const auto passes = [&](int rail, int other) {
    return model.bodies[std::size_t(rail)].bare && !touches_rails(model.bodies[std::size_t(other)].shape);
  };
  for (int body = 0; body < int(model.bodies.size()); ++body) {
    const Body<D>& it = model.bodies[body];
    if (it.handout) continue;
    all.push_back(body);
    if (!it.fixed) moving.push_back(body);
    if (!is_dot(body)) wide.push_back(body);
  }
  const MayTouch<D> allowed(model);
  for (const int a : all) {
    const Body<D>& p = model.bodies[a];
    if (!p.fixed) {
      for (int wall = 0; wall < int(model.walls.size()); ++wall) found(a, -1 - wall);
    }
    const bool point = is_dot(a);
    const std::vector<int>& others = p.fixed ? moving : point ? wide : all;
    for (auto b = std::upper_bound(others.begin(), others.end(), a); b != others.end(); ++b) {
      const Body<D>& q = model.bodies[*b];
      if ((p.fixed && q.fixed) || (point && is_dot(*b))) continue;
      if (passes(a, *b) || passes(*b, a)) continue;
      if (allowed(a, *b)) found(a, *b);
    }
  }
}

template double couples<2>(const Model<2>&);
template double couples<3>(const Model<3>&);
template void list_couples<2>(const Model<2>&, const std::function<void(int, int)>&);
template void list_couples<3>(const Model<3>&, const std::function<void(int, int)>&);

}  // namespace obscura::sim
