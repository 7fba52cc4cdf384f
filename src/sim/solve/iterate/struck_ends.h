#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "sim/solve/iterate/instant_impact.h"
#include "sim/solve/iterate/joint_solver.h"

namespace obscura::sim {

/// The ends of joints, taut ropes and reached limits, of what an impact strikes: they push back in the same
/// instant, as the last rows of an InstantImpact. For the plane and for space.
template <int D>
class StruckEnds {
 public:
  using Response = typename JointSolver<D>::JointResponse;

  void clear() { ends_.clear(), components_.clear(); }

  /// Adds those of the component of a body that is struck, once; `struck`: the joints where the impact finds
  /// them. motion(member, v, w) gives how one of the
  /// component moves as the impact comes, m/s and rad/s, or is false where it does not; `left`: what part of
  /// the step comes after the impact.
  template <class Motion>
  void add(const JointSolver<D>& joints, JointSolver<D>& struck, int body, double left, Motion&& motion) {
    const int component = joints.component(body);
    if (component < 0 || std::count(components_.begin(), components_.end(), component) != 0) return;
    components_.push_back(component);
    const auto reached = struck.reached_ends(component);
    if (reached.empty()) return;
    for (const int member : joints.members(component)) {
      BodyMotion<D>& at = struck.body_motion(member);
      if (!motion(member, at.v, at.w) || !joints.stopped()) continue;
      // flights come to it by and by
      at.v += left * joints.jump(member), at.w += left * joints.spin_jump(member);
    }
    for (const Response& end : reached) ends_.push_back({&end, struck.row_speed(end)});
  }
  /// More than an impact takes are none.
  void drop_if_too_many() {
    if (int(ends_.size()) > InstantImpact<D>::kMostEnds) ends_.clear();
  }
  int count() const { return int(ends_.size()); }

  /// Writes their rows into an impact, K and J v, after those of contacts, whose responses these are.
  void couple(const JointSolver<D>& joints, std::span<const Response> contacts,
              InstantImpact<D>& impact) const {
    const int rows = int(contacts.size());
    for (int i = 0; i < count(); ++i) {
      const int row = rows + i;
      impact.speeds[row] = ends_[std::size_t(i)].speed;
      for (int j = 0; j <= row; ++j)
        impact.K(row, j) = impact.K(j, row) = joints.response_between(
            *ends_[std::size_t(i)].response,
            j < rows ? contacts[std::size_t(j)] : *ends_[std::size_t(j - rows)].response);
    }
  }
  /// Whether any has an impulse in an impact that has been solved.
  bool push(const InstantImpact<D>& impact) const {
    for (int i = 0; i < count(); ++i)
      if (impulse(impact, i) != 0) return true;
    return false;
  }
  /// act(body, change of its velocity, of its spin) by these impulses. The work of kinematic bodies by them,
  /// J.
  template <class Act>
  double apply(const JointSolver<D>& joints, const InstantImpact<D>& impact, Act&& act) const {
    double work = 0;
    for (int i = 0; i < count(); ++i) {
      const double p = impulse(impact, i);
      if (p == 0) continue;
      work += p * joints.given_at_end(*ends_[std::size_t(i)].response);
      joints.each_push(*ends_[std::size_t(i)].response, p, act);
    }
    return work;
  }

 private:
  struct End {
    const Response* response;
    double speed;  // J v as the impact comes
  };
  double impulse(const InstantImpact<D>& impact, int i) const {
    return impact.p[int(impact.p.size()) - count() + i];
  }

  std::vector<End> ends_;
  std::vector<int> components_;  // of joints
};

}  // namespace obscura::sim
