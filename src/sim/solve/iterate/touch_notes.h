#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "sim/model/course.h"
#include "sim/model/state.h"

namespace obscura::sim {

/// Notes which watched bodies touch within a step of several substeps, for the conditions of events: for each
/// pair one span, from the beginning of the first substep in which it bears or is struck to the end of the
/// last. In between a contact may bear in one substep and not in the next, without a meaning.
template <int D>
class TouchNotes {
 public:
  void watch(Course<D>* course) { course_ = course; }
  /// Whether anything is watched.
  bool any() const { return course_ != nullptr; }
  /// Whether a contact of `a` with `b` is to be noted; b < 0: a wall.
  bool watches(int a, int b) const { return course_ && (course_->watches(a) || course_->watches(b)); }

  /// Begins a step. What touches now touches from its beginning on.
  void begin(const State<D>& state) {
    held_.clear(), found_.clear();
    if (!course_) return;
    for (const Contact<D>& it : state.contacts)
      if (it.touching != ContactMode::open && watches(it.key.a, it.key.b))
        held_.emplace_back(it.key.a, it.key.b);
  }
  /// The two touch in a substep from `begun` to `ended`, s from the beginning of the step.
  void note(int a, int b, double begun, double ended) {
    if (!watches(a, b)) return;
    const auto at =
        std::find_if(found_.begin(), found_.end(), [&](const auto& it) { return it.a == a && it.b == b; });
    if (at != found_.end()) {
      at->ended = ended;
      return;
    }
    const bool held = std::find(held_.begin(), held_.end(), std::pair(a, b)) != held_.end();
    found_.push_back({a, b, held ? 0 : begun, ended});
  }
  /// Ends a step.
  void end() {
    if (course_) course_->meetings.insert(course_->meetings.end(), found_.begin(), found_.end());
  }

 private:
  Course<D>* course_ = nullptr;
  std::vector<std::pair<int, int>> held_;
  std::vector<typename Course<D>::Meeting> found_;
};

}  // namespace obscura::sim
