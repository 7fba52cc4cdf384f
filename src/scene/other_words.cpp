#include "scene/other_words.h"

#include <algorithm>
#include <array>
#include <initializer_list>

namespace obscura::scene {

namespace {

// tables of things that move, and of what they are made of
constexpr std::array<std::string_view, 7> kThings = {"particle", "ball", "box", "capsule",
                                                     "polygon",  "hull", "body"};

// where tables stand
constexpr std::string_view kTop = "the top";

struct Other {
  std::initializer_list<std::string_view> words;
  std::string_view hint;
  std::string_view owner = "";  // things, if none
};

}  // namespace

std::string_view other_word(std::string_view key, std::string_view owner) {
  static const Other kOthers[] = {
      {{"restitution", "bounciness", "bounce", "cor", "coefficient_of_restitution", "e"},
       "; it is 'elasticity' here"},
      {{"mu", "friction_coefficient", "coefficient_of_friction", "slidingfriction"},
       "; it is 'friction' here"},
      {{"friction_static", "mu_s", "mu_static"}, "; it is 'static_friction' here"},
      {{"kinetic_friction", "friction_kinetic", "dynamic_friction", "friction_dynamic", "mu_k", "mu_kinetic"},
       "; it is 'friction' here, and 'static_friction' of what does not slip"},
      {{"rolling_friction", "friction_rolling", "rolling_resistance", "rollingresistance"},
       "; it is a [[force]] with a 'torque' here, such as \"-0.02*tanh(spin/0.01)\""},
      {{"angular_velocity", "angularvelocity", "omega", "w", "rotation_speed"},
       "; it is 'spin' here, in degrees per second"},
      {{"v", "vel", "linear_velocity", "linearvelocity", "speed"}, "; it is 'velocity' here"},
      {{"pos", "x", "at", "location", "translation", "center", "centre", "place"}, "; it is 'position' here"},
      {{"theta", "rot", "euler", "yaw", "tilt"}, "; it is 'angle' here, in degrees; in space 'orientation'"},
      {{"static", "locked", "immovable", "pinned", "anchored", "frozen"}, "; it is 'fixed = true' here"},
      {{"kinematic", "driven", "path"}, "; what moves as it is told has a 'motion' here"},
      {{"moment", "moment_of_inertia", "I", "diaginertia"}, "; it is 'inertia' here"},
      {{"com", "cog", "center_of_gravity"}, "; it is 'center_of_mass' here"},
      {{"width", "height", "w_h", "dimensions", "extents", "half_extents"},
       "; it is 'size' here, all of it",
       "box"},
      {{"r", "diameter"}, "; it is 'radius' here", "ball"},
      {{"m", "weight"}, "; it is 'mass' here, in kilograms"},
      {{"q"}, "; it is 'charge' here"},
      {{"force", "forces", "torque"}, "; a force is a table of its own: [[force]] with 'on'"},
      {{"damping", "linear_damping", "air_resistance"}, "; it is 'drag' here, or 'quadratic_drag'"},
      {{"k", "constant", "spring_constant", "rate"}, "; it is 'stiffness' here", "spring"},
      {{"c", "damper", "damping_constant"}, "; it is 'damping' here", "spring"},
      {{"a", "b", "body_a", "body_b", "ends", "from", "to", "bodies", "anchors"},
       "; it is 'between' here, its two ends",
       "spring"},
      {{"natural_length", "l0", "free_length"}, "; it is 'rest_length' here", "spring"},
      {{"breaks"},
       "; an event lets it go: [[when]] with a value such as \"block.spring_force > 50\", and do = [{ "
       "release = "
       "\"...\" }]",
       "spring"},
      {{"a", "b", "body_a", "body_b", "bodies", "parent", "child", "connects", "anchors"},
       "; it is 'between' here, its two ends",
       "joint"},
      {{"anchor", "pivot", "place", "position", "point"}, "; it is 'at' here", "joint"},
      {{"limit", "range", "lower", "upper", "low", "high", "min", "max", "lower_angle", "upper_angle"},
       "; it is limits = [lowest, highest] here",
       "joint"},
      {{"speed", "motor_speed", "max_torque", "max_motor_torque"},
       "; it is motor = { speed = ..., most = ... } here",
       "joint"},
      {{"width", "height", "resolution", "pixels", "dimensions"},
       "; it is size = [width, height] here, in pixels",
       "film"},
      {{"framerate", "frame_rate", "frames_per_second", "rate"}, "; it is 'fps' here", "film"},
      {{"start", "begin", "from", "end", "stop", "to"},
       "; a film shows the run from 0 to 'duration', which stands at the top; `obscura render --from 2 --to "
       "5` "
       "makes a part of it",
       "film"},
      {{"format", "container", "output", "file"}, "; the file's name says it: -o film.mp4", "film"},
      {{"arrow", "arrows", "vectors"}, "; did you mean [[film.vector]]?", "film"},
      {{"text", "texts", "words", "annotation", "labels"}, "; did you mean [[film.label]]?", "film"},
      {{"arrow", "arrows", "vectors"}, "; did you mean [[figure.vector]]?", "figure"},
      {{"text", "texts", "words", "annotation", "labels"}, "; did you mean [[figure.label]]?", "figure"},
      {{"between", "a", "b", "ends", "bodies"},
       "; an angle is 'at' its vertex, from 'from' to 'to'",
       "figure.angle"},
      {{"between", "a", "b", "ends", "bodies"},
       "; an angle is 'at' its vertex, from 'from' to 'to'",
       "film.angle"},
      {{"circle", "disc", "disk", "sphere"}, "; did you mean [[ball]]?", kTop},
      {{"rectangle", "rect", "square", "cube", "cuboid", "block", "crate"}, "; did you mean [[box]]?", kTop},
      {{"simulation", "solver", "engine"}, "; did you mean [physics]?", kTop},
      {{"world", "environment"}, "; did you mean [room]?", kTop},
  };
  if (owner.empty()) owner = kTop;
  const bool thing = std::find(kThings.begin(), kThings.end(), owner) != kThings.end();
  for (const Other& each : kOthers) {
    if (each.owner.empty() ? !thing : each.owner != owner) continue;
    if (std::find(each.words.begin(), each.words.end(), key) != each.words.end()) return each.hint;
  }
  return {};
}

}  // namespace obscura::scene
