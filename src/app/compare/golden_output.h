#pragma once

#include <string>
#include <vector>

#include "app/compare/golden_case.h"

namespace obscura::app {

/// All cases as one JSON object (docs/json.md); as JUnit's XML is in golden_case.h.
std::string golden_json(const std::vector<GoldenCase>& cases, int exit);

/// The failures, as annotations of GitHub's: workflow commands, a line each.
std::string golden_annotations(const std::vector<GoldenCase>& cases);

/// The same as Markdown, for the summary of a step: a table of what is not good, with the cause.
std::string golden_summary(const std::vector<GoldenCase>& cases);

}  // namespace obscura::app
