#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "scene/error.h"
#include "scene/scene.h"
#include "sim/step/run.h"

namespace obscura::scene {

/// A mode and a solver, as [physics] has them.
struct Manner {
  std::string name, keys;
};
inline const std::vector<Manner> kManners = {
    {"contact", "[physics]\ncollision = \"contact\"\nsolver = \"direct\""},
    {"event", "[physics]\ncollision = \"event\""},
    {"iterative", "[physics]\ncollision = \"contact\"\nsolver = \"iterative\""},
};

/// 20 m without walls, its middle at the origin; `room`: more of its keys.
inline std::string plane_without_walls(const Manner& manner, const std::string& room = "") {
  return "duration = 1000\n[room]\nsize = [20, 20]\ncorner = [-10, -10]\nwalls = \"none\"\n" + room + "\n" +
         manner.keys + "\n";
}
inline std::string space_without_walls(const Manner& manner, const std::string& room = "") {
  return "duration = 1000\n[room]\nsize = [20, 20, 20]\ncorner = [-10, -10, -10]\nwalls = \"none\"\n" + room +
         "\n" + manner.keys + "\n";
}

/// A room of either dimension without walls and gravity.
inline std::string empty_room(const Manner& manner, int dimension, const std::string& room = "") {
  return dimension == 2 ? plane_without_walls(manner, "gravity = [0, 0]\n" + room)
                        : space_without_walls(manner, "gravity = [0, 0, 0]\n" + room);
}
/// A ball, in the plane a disc; `more`: the rest of its keys.
inline std::string disc(const std::string& name, double mass, double radius, const std::string& more) {
  return fmt::format("[[ball]]\nname = \"{}\"\nmass = {}\nradius = {}\n{}\n", name, mass, radius, more);
}

/// What parse() says against a text; empty: nothing.
inline std::string refusal(const std::string& text) {
  try {
    parse(text, "a.toml", {});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// The run of a scene that a test has as a text.
struct TextRun {
  std::string text;
  std::unique_ptr<sim::Run> run;
  mutable double asked = 0;

  explicit TextRun(const std::string& scene, const std::vector<std::string>& sets = {})
      : text(scene), run(parse(scene, "a.toml", sets).run()) {}

  /// The instant at t, s, to a microsecond; not before the last. A trouble ends the test.
  sim::Snapshot at(double t) const {
    if (t < asked) ADD_FAILURE() << "goes back to " << t << " s, from " << asked << " s";
    asked = t;
    auto outcome = run->at(*sim::parse_rational(fmt::format("{:.6f}", t)));
    if (const auto* trouble = std::get_if<sim::Trouble>(&outcome)) {
      throw std::runtime_error(trouble->body + " " + trouble->quantity + " " + trouble->what + " " +
                               trouble->likely);
    }
    return std::get<sim::Snapshot>(outcome);
  }
  sim::Vec3 place(double t, std::size_t body = 0) const { return at(t).bodies[body].position; }
};

/// The number of a body by its name.
inline std::size_t number_of(const TextRun& scene, const std::string& name) {
  const auto& all = scene.run->scene_info().bodies;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].name == name) return i;
  ADD_FAILURE() << name;
  return 0;
}

/// A time as at() has it.
inline double to_a_microsecond(double t) { return std::round(t * 1e6) / 1e6; }

}  // namespace obscura::scene
