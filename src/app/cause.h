#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/origin.h"
#include "app/parting.h"

namespace obscura::app {

/// Why two pictures differ, as their origins tell.
struct Cause {
  enum class Kind { scene, state, look, gl, pixels, unknown };
  Kind kind = Kind::unknown;
  std::vector<std::string> lines;  // a sentence each, the cause first
  std::optional<Parting> states;   // where they part
};

/// "scene", "state", "look", "gl", "pixels", "unknown".
const char* name(Cause::Kind kind);

/// Looks for the cause: another scene, whose states part or not; another state of one scene; other flags
/// about its look; another OpenGL; or pixels alone. Simulates both scenes again where their states differ.
Cause cause(const std::optional<Origin>& a, const std::optional<Origin>& b);

/// The hash of the state at an origin's instant, simulated again by this program. Throws scene::Error; none
/// where the run ends before it.
std::optional<std::string> state_again(const Origin& origin);

}  // namespace obscura::app
