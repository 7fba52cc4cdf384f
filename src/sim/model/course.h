#pragma once

#include <vector>

#include "sim/math/lie_step.h"
#include "sim/model/body_motion.h"
#include "sim/model/state.h"

namespace obscura::sim {

/// A place and an orientation with their velocities.
template <int D>
struct Instant {
  Vec<D> x = Vec<D>::Zero(), v = Vec<D>::Zero();
  Orientation<D> turn = no_rotation<D>();
  AngularVec<D> spin = AngularVec<D>::Zero();
};

template <int D>
Instant<D> instant(const State<D>& state, int body) {
  Instant<D> it{state.x[std::size_t(body)], state.v[std::size_t(body)], no_rotation<D>(),
                AngularVec<D>::Zero()};
  if (const int k = turning(state, body); k >= 0)
    it.turn = state.turn[std::size_t(k)], it.spin = state.spin[std::size_t(k)];
  return it;
}

/// Smooth motion of a body, between impacts: the cubic through both ends. Times are counted from where the
/// course begins, s.
template <int D>
struct CoursePiece {
  double begun = 0, ended = 0;
  Instant<D> from, to;

  Instant<D> at(double t) const {
    const double h = ended - begun;
    if (!(h > 0)) return to;
    const double s = (t - begun) / h, r = 1 - s;
    Instant<D> it;
    it.x = r * r * (1 + 2 * s) * from.x + s * s * (3 - 2 * s) * to.x + h * s * r * (r * from.v - s * to.v);
    it.v = 6 * s * r / h * (to.x - from.x) + r * (1 - 3 * s) * from.v + s * (3 * s - 2) * to.v;
    it.turn = between<D>(from.turn, from.spin, to.turn, to.spin, h, s);
    it.spin = r * from.spin + s * to.spin;
    return it;
  }
};

/// How chosen bodies go through a step, as what moves them finds it: for the conditions of events
/// (sim/step/events.h).
template <int D>
struct Course {
  /// Two that touch, in the order of a ContactKey: for a while, or in one impact.
  struct Meeting {
    int a = -1, b = -1;
    double begun = 0, ended = 0;
  };

  /// A joint that breaks within the step.
  struct Break {
    int joint = -1;
    double at = 0;
  };

  std::vector<char> watched;                        // one a body
  std::vector<std::vector<CoursePiece<D>>> pieces;  // one list a body, in the order of time
  std::vector<Meeting> meetings;
  std::vector<Break> breaks;

  bool watches(int body) const { return body >= 0 && watched[std::size_t(body)] != 0; }

  void clear() {
    for (auto& all : pieces) all.clear();
    meetings.clear(), breaks.clear();
  }
  /// What is known of a body, which is moved anew.
  void forget(int body) {
    if (!watches(body)) return;
    pieces[std::size_t(body)].clear();
    std::erase_if(meetings, [&](const Meeting& it) { return it.a == body || it.b == body; });
  }
};

}  // namespace obscura::sim
