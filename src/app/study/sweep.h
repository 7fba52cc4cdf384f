#pragma once

#include <string>
#include <vector>

namespace obscura::app {

/// Whether a sweep of these can be: its keys, their values, and what is measured of the first run. Throws
/// what `obscura sweep` would end with, UsageError or scene::Error.
void check_sweep(const std::string& scene, const std::vector<std::string>& sets,
                 const std::vector<std::string>& vary, const std::vector<std::string>& measure,
                 const std::string& out);

}  // namespace obscura::app
