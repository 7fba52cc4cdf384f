#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/force/forces.h"
#include "sim/math/lcp.h"
#include "sim/model/body_motion.h"
#include "sim/model/path.h"
#include "sim/shape/shape.h"

namespace obscura::sim {

/// Collisions with walls by the recipe of the course handout, §2.5 and §3.5: after integrating, a body that
/// is beyond a wall and moves outwards is put back onto the wall and given an impulse; repeated until no body
/// is beyond a wall and moves outwards.
template <int D>
class Handout {
 public:
  /// Both are kept by reference. `paths`: the way of each mouse.
  Handout(const Model<D>& model, const std::vector<Path<D>>& paths);

  /// Appends to `suspects` those of the bodies first .. first + count that may have come through a wall.
  void look(const State<D>& state, int first, int count, std::vector<int>& suspects);

  /// Lets the suspects collide at time t. Adds their touches and what became of the energy to the state.
  void collide(State<D>& state, std::span<const int> suspects, double t);

 private:
  // a body as the walls meet it
  struct Striker {
    const Body<D>* body = nullptr;
    BodyMotion<D> at;
    double speed = 0;  // square of how fast any of its points came, m^2/s^2
    std::span<const SupportVertex<D>> tips;
    bool centred = false;  // a particle: all it has is its centre, and a radius
  };
  // the impulses of one point at one wall
  struct Hit {
    int wall, point;
    Vec<D> impulse;
  };
  // a point of the body that is solved at a wall, together with others
  struct PointAtWall {
    int wall, point;
    Vec<D> arm;
    AngularVec<D> turn;  // arm x normal
  };

  Vec<D> arm(const Striker& s, int point, const Wall<D>& wall) const;
  double springs(const State<D>& state, int body, double t) const;
  bool particle_like(int body) const;
  bool bounce(State<D>& state, int body) const;
  bool particle(Striker& s);
  bool extended(Striker& s);
  bool meet(Striker& s, int wall);
  void meet_all(Striker& s);
  void strike(Striker& s, const PointAtWall* rows, int n, int rank);
  void put_inside(Striker& s) const;
  void hit(int wall, int point, const Vec<D>& impulse);

  const Model<D>& model_;
  const std::vector<Path<D>>& paths_;
  std::vector<double> bounding_radius_;  // how far each body reaches, m
  Forces<D> forces_;
  SupportVertices<D> tips_;
  std::vector<std::vector<int>> springs_;  // of each body
  std::vector<std::int64_t> signs_;        // a block's: negative where a body is outside
  std::vector<Hit> hits_;                  // of the body at hand
  std::vector<Vec<D>> arms_;               // of its tips, from its centre, m
  std::vector<double> distances_;          // of its tips from the wall at hand, m
  std::vector<char> striking_;
  std::vector<int> met_;  // tips that meet it in one instant
};

}  // namespace obscura::sim
