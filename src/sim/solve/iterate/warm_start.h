#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "sim/math/islands.h"
#include "sim/math/orientation.h"
#include "sim/model/model.h"
#include "sim/solve/iterate/moving_body.h"

namespace obscura::sim {

/// Iterations begin with the forces of the last substep. Those of a blow are far too large for the first
/// substep of a step with fewer, and few iterations would not take them back: a heap that has just landed
/// would be thrown up. Contacts never give energy, so an island to which forces times h would give some
/// begins with a share s of them,
///   E(s) - E(0) = s v . M dv + s^2 dv . M dv / 2        dv  what they change of the velocities v
/// that with the least E(s): 0 <= s < 1/2. Islands with joints, belts or moved bodies are left out: what
/// joints answer is not in dv, and moved bodies may give energy.
template <int D>
class WarmStart {
 public:
  /// Kept by reference.
  explicit WarmStart(const Model<D>& model) : model_(model) {}

  /// Before the forces: one a body, and one that never moves.
  void begin(const std::vector<MovingBody<D>>& bodies) { before_ = bodies; }

  /// Whether forces have given anything to some body. `radius`: bounding radii, m.
  bool gave(const std::vector<MovingBody<D>>& bodies, const std::vector<double>& radius) const {
    for (std::size_t i = 0; i < radius.size(); ++i) {
      if (inverse_mass(bodies[i]) > 0 && moves(bodies[i], radius[i]) > moves(before_[i], radius[i]))
        return true;
    }
    return false;
  }

  /// The share that each island keeps, into the velocities; false where all keep all. each_pair(act) calls
  /// act(a, b) for each two bodies that forces push, or a body and the one that never moves; exempt(body);
  /// axes(body): room from body.
  template <class EachPair, class Exempt, class Axes>
  bool moderate(std::vector<MovingBody<D>>& bodies, EachPair&& each_pair, Exempt&& exempt, Axes&& axes) {
    const int n = int(model_.bodies.size());
    islands_.reset(n), gains_.assign(std::size_t(n), {});
    const auto moving = [&](int body) { return body < n && inverse_mass(bodies[std::size_t(body)]) > 0; };
    each_pair([&](int a, int b) {
      if (moving(a) && moving(b)) islands_.join(a, b);
    });
    each_pair([&](int a, int b) {
      if (!exempt(a) && !exempt(b)) return;
      for (const int body : {a, b})
        if (moving(body)) gains_[std::size_t(islands_.root(body))].exempt = true;
    });
    for (int i = 0; i < n; ++i) {
      if (!moving(i)) continue;
      const MovingBody<D>&was = before_[std::size_t(i)], &is = bodies[std::size_t(i)];
      const Vec<D> dv = velocity(is) - velocity(was);
      const AngularVec<D> dw = spin(is) - spin(was);
      const Body<D>& body = model_.bodies[std::size_t(i)];
      AngularVec<D> twist = AngularVec<D>::Zero();
      if (body.turns() && !dw.isZero(0)) twist = inertia_times<D>(body.inertia, axes(i), dw);
      Gain& gain = gains_[std::size_t(islands_.root(i))];
      gain.linear += body.mass * velocity(was).dot(dv) + spin(was).dot(twist);
      gain.square += body.mass * dv.squaredNorm() + dw.dot(twist);
    }
    bool any = false;
    for (Gain& gain : gains_) {
      if (gain.exempt || !(gain.linear + 0.5 * gain.square > 0)) continue;
      gain.share = std::clamp(-gain.linear / gain.square, 0.0, 1.0), any = true;
    }
    for (int i = 0; any && i < n; ++i) {
      const double part = moving(i) ? share(i) : 1;
      if (part == 1) continue;
      const MovingBody<D>& was = before_[std::size_t(i)];
      MovingBody<D>& is = bodies[std::size_t(i)];
      set_velocity(is, Vec<D>(velocity(was) + part * (velocity(is) - velocity(was))),
                   AngularVec<D>(spin(was) + part * (spin(is) - spin(was))));
    }
    return any;
  }

  /// Of the last moderate(): what a body that moves keeps.
  double share(int body) { return gains_[std::size_t(islands_.root(body))].share; }

 private:
  // of an island, at its root: v . M dv and dv . M dv, J
  struct Gain {
    double linear = 0, square = 0, share = 1;
    bool exempt = false;
  };
  static double moves(const MovingBody<D>& body, double radius) {
    return velocity(body).squaredNorm() + radius * radius * spin(body).squaredNorm();
  }

  const Model<D>& model_;
  std::vector<MovingBody<D>> before_;
  Islands islands_;
  std::vector<Gain> gains_;
};

}  // namespace obscura::sim
