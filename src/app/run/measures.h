#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "sim/math/rational.h"
#include "sim/model/trouble.h"

namespace obscura::app {

/// A question about a run: one number of its states (app/run/columns.h), or their hash, at an instant or over
/// the whole run. "energy.total@5", "crate.position.y@max".
struct Question {
  /// `at` 5 s, at the `end` of the duration, or over the instants at the ends of its steps, from 0 to the
  /// duration, both counted: the largest, the smallest, the mean over time (of straight lines between them),
  /// and when first it is largest or smallest.
  /// Or `at` an instant that events of the run mark, "hit" or "hit[2]".
  enum class Over { at, end, max, min, mean, argmax, argmin, mark };
  std::string text;  // as it was typed
  std::string path;  // "energy.total"
  Over over = Over::end;
  sim::Rational at{};  // s
  std::string mark;    // its name
  int time = 1;        // the which time
};

/// The questions of a list, between commas. Throws UsageError.
std::vector<Question> questions(const std::string& list);

/// Whether a scene's states have what is asked for. Throws UsageError where not.
void check(const std::vector<Question>& asked, const scene::Scene& scene);

/// The answers of one run, as text that reads back to the bit; empty where the run did not come so far, or
/// to a mark.
struct Answers {
  std::vector<std::string> values;
  std::optional<sim::Trouble> trouble;
  std::vector<std::string> limit_notes{};  // app/run/trouble.h
};

/// Runs a scene as far as the questions need. Throws UsageError where its states have no such number,
/// Interrupted where a signal asks for an end.
Answers answers(const scene::Scene& scene, const std::vector<Question>& asked);

}  // namespace obscura::app
