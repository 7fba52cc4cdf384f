#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/run/first_difference.h"
#include "app/run/origin.h"

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
/// about its look; another OpenGL; or pixels alone. Simulates both scenes again where their states differ,
/// and for stills that do, `drawn_apart`, through the whole run.
Cause cause(const std::optional<Origin>& a, const std::optional<Origin>& b, bool drawn_apart = true);

/// "other scene (a.toml): crate.mass is 1 and 2"; empty where two scenes say the same.
std::string other_scene(const Origin& a, const Origin& b);

/// What two films of these origins show otherwise because they are filmed otherwise, a line each: the frame
/// rate, the number of frames, and the first frame of another instant; with `drawn` also the size. Of stills
/// the size alone. Throws scene::Error and UsageError.
std::vector<std::string> filmed_otherwise(const Origin& a, const Origin& b, bool drawn);

/// Whether two origins have the same states: the first that they show, and all if both have all.
bool same_states(const Origin& a, const Origin& b);

/// For origins whose states differ: the first frame and the bodies that do, as far as their checksums tell:
/// "states differ from frame 137 on (t = 2.283 s): body ball". Empty if they do not tell.
std::string first_difference(const Origin& a, const Origin& b);

/// An origin with the states of its frames as this program simulates them, up to where the run ends. Throws
/// scene::Error and UsageError; none where it ends before the first.
std::optional<Origin> simulated(const Origin& origin);

}  // namespace obscura::app
