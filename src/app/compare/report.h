#pragma once

#include <optional>
#include <string>
#include <vector>

#include "media/image.h"

namespace obscura::app {

/// One pair of pictures in a report.
struct Finding {
  std::string name;   // "room, t = 2.5 s"
  std::string state;  // "same", "differs", "missing", "unreadable", ...: what the page filters by
  std::vector<std::string> lines;  // what is to be said of it, the verdict first
  std::optional<media::Image> expected, actual;
  std::string expected_by, actual_by;  // "obscura 0.2.0, OpenGL 4.5 (Mesa 22.3.6)"
  std::string choice;  // what --only takes to make the actual picture the reference; empty: nothing does
};

/// The heading of a report.
struct ReportTitle {
  std::string title;
  std::string command;  // of a shell, to which `--only CHOICE` is added; empty: nothing is to be approved
};

/// A page of HTML that needs no other file: for each finding the expected picture, the actual one and their
/// difference, beside each other, under a slider or blinking, with one zoom for all three and boxes around
/// the differences; a filter by state; and the command that makes the approved pictures the references. A
/// scene without differences has one picture.
std::string report(const ReportTitle& title, const std::vector<Finding>& findings);

/// Now, or what SOURCE_DATE_EPOCH says instead, in UTC: "2026-01-31 09:30".
std::string date();

/// Writes text to a file. Throws media::Error.
void write_text(const std::string& path, const std::string& text);

}  // namespace obscura::app
