#pragma once

#include <optional>
#include <string>
#include <vector>

#include "media/image.h"

namespace obscura::app {

/// One pair of pictures in a report.
struct Finding {
  std::string name;   // "room, t = 2.5 s"
  std::string state;  // "same", "differs", "missing", "updated", "failed": what the page filters by
  std::vector<std::string> lines;  // what is to be said of it, the verdict first
  std::optional<media::Image> expected, actual;
};

/// A page of HTML that needs nothing beside itself: for each finding the expected and the actual picture,
/// their difference, a slider between the two and a blink; a filter by state. What is the same has one
/// picture.
std::string report(const std::string& title, const std::vector<Finding>& findings);

/// Writes text to a file. Throws media::Error.
void write_text(const std::string& path, const std::string& text);

}  // namespace obscura::app
