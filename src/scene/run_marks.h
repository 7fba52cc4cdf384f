#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/complaints.h"
#include "scene/document.h"
#include "sim/math/rational.h"

namespace obscura::scene {

/// When a mark is that the run does not come to, s.
inline constexpr std::int64_t kNever = 1'000'000;

/// What events say about a run: the instants that they mark, and when they stop it. s, as times of a scene
/// are kept: the first microsecond at which it has happened.
struct RunMarks {
  std::map<std::string, std::vector<sim::Rational>> instants;
  std::optional<sim::Rational> stop;

  /// That of "hit", or of "hit[2]", the second; none where the run does not come to it.
  std::optional<sim::Rational> at(const std::string& mark) const;
};

/// "hit[2]" as the name and the number of the time, from 1; nothing where it is none.
std::optional<std::pair<std::string, int>> parse_mark(const std::string& text);

/// The marks that a scene's conditions make, each once.
std::vector<std::string> declared_marks(const Node& top);

/// Puts the times of marks in the place of their names, wherever a checked document has a time of the film or
/// of the figure; without marks, or where the run does not come to one, takes out what waits for it. Shortens
/// the duration to the stop. Complains of marks that no condition makes.
struct MarksPut {
  std::vector<std::string> used;  // that are named
  bool figure_waits = false;      // the figure is of none that the run comes to
};
MarksPut put_marks(Node& top, const RunMarks* marks, Diagnostics& complaints);

}  // namespace obscura::scene
