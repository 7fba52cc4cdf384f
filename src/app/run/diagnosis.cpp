#include "app/run/diagnosis.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/run/compared.h"
#include "app/run/trouble.h"
#include "scene/difference.h"
#include "scene/error.h"

namespace obscura::app {

namespace {

constexpr std::size_t kMostKeys = 6, kMostBodiesTold = 6;

std::string or_absent(const std::string& value) { return value.empty() ? "left out" : value; }

// "the scenes differ: crate.mass is 1 and 1.0000000000000002"
std::string scene_line(const Origin& a, const Origin& b) {
  const std::string files = a.scene_file == b.scene_file ? a.scene_file : a.scene_file + ", " + b.scene_file;
  std::vector<scene::KeyDifference> keys;
  try {
    keys = scene::differences({a.scene_text, a.sets}, {b.scene_text, b.sets});
  } catch (const scene::Error& error) {
    return fmt::format("other scene ({}), and one is no scene that this obscura reads: {}", files,
                       error.what());
  }
  if (keys.empty())
    return a.sets == b.sets ? fmt::format("other scene text ({}), in comments and layout alone", files)
                            : fmt::format("other scene ({}): other --set", files);
  std::string line = fmt::format("other scene ({}): ", files);
  for (std::size_t i = 0; i < keys.size() && i < kMostKeys; ++i)
    line += fmt::format("{}{} is {} and {}", i ? "; " : "", keys[i].path, or_absent(keys[i].a),
                        or_absent(keys[i].b));
  if (keys.size() > kMostKeys) line += fmt::format("; and {} more", keys.size() - kMostKeys);
  return line;
}

// the settings that flags chose
std::vector<std::string> look_lines(const Origin& a, const Origin& b) {
  std::vector<std::string> lines;
  const auto differ = [&](const char* what, const std::string& left, const std::string& right) {
    if (left != right)
      lines.push_back(fmt::format("other {}: {} and {}", what, or_absent(left), or_absent(right)));
  };
  differ("theme", a.theme, b.theme);
  differ("camera", a.camera, b.camera);
  if (a.transparent != b.transparent) lines.push_back("one is without the ground (--transparent)");
  if (a.frames > 0 && b.frames > 0) {
    differ("frame rate", a.fps, b.fps);
    differ("frames of the film", a.shots, b.shots);
  }
  differ("encoder", a.encoder, b.encoder);
  differ("preset", a.preset, b.preset);
  if (a.crf != b.crf) lines.push_back("other quality (--crf)");
  return lines;
}

std::vector<std::string> gl_lines(const Origin& a, const Origin& b) {
  std::vector<std::string> lines;
  if (a.native != b.native)
    lines.push_back("one was drawn with all of a processor's instructions (--native)");
  if (a.gl_version != b.gl_version || a.gl_renderer != b.gl_renderer)
    lines.push_back(fmt::format("other OpenGL: {}, {} and {}, {}", a.gl_version, a.gl_renderer, b.gl_version,
                                b.gl_renderer));
  return lines;
}

// the first frame of two films that shows another instant: its number, and both instants; none of stills
struct OtherInstant {
  std::int64_t frame = 0;
  double a = 0, b = 0;  // s
};
std::optional<OtherInstant> other_instant(const Origin& a, const scene::Scene& scene_a, const Origin& b,
                                          const scene::Scene& scene_b) {
  if (a.frames == 0 || b.frames == 0) return {};
  const Shots left = shots_of(a, scene_a), right = shots_of(b, scene_b);
  for (std::int64_t i = 0; i < std::min(left.size(), right.size()); ++i)
    if (const Shot one = left[i], two = right[i]; one.time != two.time)
      return OtherInstant{i, sim::value(one.time), sim::value(two.time)};
  return {};
}

// one scene, two states: which of them this program makes
void judge_one_scene(const Origin& a, const Origin& b, Cause& cause) {
  cause.kind = Cause::Kind::state;
  cause.lines.push_back("other state of the same scene");
  try {
    if (const std::string line = first_difference(a, b); !line.empty()) cause.lines.push_back(line);
    const auto again = simulated(a);
    const bool mine = again && same_states(*again, a), yours = again && same_states(*again, b);
    cause.lines.push_back(fmt::format("this obscura ({}) simulates {}; A is by {}, B by {}", OBSCURA_VERSION,
                                      mine    ? "A's state"
                                      : yours ? "B's state"
                                              : "neither of them",
                                      a.version, b.version));
  } catch (const scene::Error& error) {
    cause.lines.push_back(fmt::format("this obscura does not read the scene: {}", error.what()));
  } catch (const UsageError& error) {
    cause.lines.push_back(error.what());
  }
}

// for two scenes: the first difference of their states, if there is one
void judge_scenes(const Origin& a, const Origin& b, bool drawn_apart, Cause& cause) {
  cause.kind = Cause::Kind::scene;
  cause.lines.push_back(scene_line(a, b));
  if (a.shot->time != b.shot->time) return;
  const char* same = drawn_apart ? "states are the same: only the drawing differs"
                                 : "states and pictures are the same: what differs does not show in them";
  const bool known = same_states(a, b) && (a.frames == 0 || (a.states && b.states && a.shots == b.shots));
  // a still may tell of its whole run: by a plot, by what the camera is to hold
  if (known && a.frames == 0 && !drawn_apart) {
    cause.lines.push_back(same);
    return;
  }
  try {
    const scene::Scene left = scene_of(a), right = scene_of(b);
    const auto other = other_instant(a, left, b, right);
    if (known && a.frames > 0 && !other) {
      cause.lines.push_back(same);
      return;
    }
    // the rest of a movie's film is looked at too
    const Shots shots = shots_of(a, left);
    sim::Rational until = shots[shots.size() - 1].time;
    if (known && until < left.duration) until = left.duration;
    if (other)
      cause.lines.push_back(fmt::format("frames show other instants: frame {} t = {:g} s and t = {:g} s",
                                        other->frame, other->a, other->b));
    else if (const std::string line = first_difference(a, b); !line.empty())
      cause.lines.push_back(line);
    cause.states = parting(left, right, until);
    if (other && cause.states)
      cause.lines.push_back(cause.states->text());
    else if (other)
      cause.lines.push_back("at one instant states are the same");
    else if (cause.states && known)
      cause.lines.push_back(fmt::format(
          "states are the same at t = {:g} s, but not through the run, of which plots and views tell; {}",
          sim::value(a.shot->time), cause.states->text()));
    else if (cause.states)
      cause.lines.push_back(cause.states->text());
    else if (same_states(a, b))
      cause.lines.push_back(same);
    else
      cause.lines.push_back(
          fmt::format("states differ there, and not when this obscura ({}) simulates both", OBSCURA_VERSION));
  } catch (const scene::Error& error) {
    cause.lines.push_back(fmt::format("this obscura does not read a scene: {}", error.what()));
  } catch (const UsageError& error) {
    cause.lines.push_back(error.what());
  }
}

}  // namespace

std::string other_scene(const Origin& a, const Origin& b) {
  try {
    if (scene::differences({a.scene_text, a.sets}, {b.scene_text, b.sets}).empty()) return "";
  } catch (const scene::Error&) {
    // said of it as a whole
  }
  return scene_line(a, b);
}

std::vector<std::string> filmed_otherwise(const Origin& a, const Origin& b, bool drawn) {
  std::vector<std::string> lines;
  if (drawn && (a.width != b.width || a.height != b.height))
    lines.push_back(fmt::format("size: {}x{}, and now {}x{}", a.width, a.height, b.width, b.height));
  if (a.frames == 0) return lines;
  if (a.fps != b.fps) lines.push_back(fmt::format("frame rate: {}, and now {}", a.fps, b.fps));
  const scene::Scene left = scene_of(a), right = scene_of(b);
  const std::int64_t there = shots_of(a, left).size(), now = shots_of(b, right).size();
  if (there != now) lines.push_back(fmt::format("frames: {}, and now {}", there, now));
  if (const auto other = other_instant(a, left, b, right))
    lines.push_back(
        fmt::format("frame {}: t = {:g} s, and now t = {:g} s", other->frame, other->a, other->b));
  return lines;
}

const char* name(Cause::Kind kind) {
  switch (kind) {
    case Cause::Kind::scene:
      return "scene";
    case Cause::Kind::state:
      return "state";
    case Cause::Kind::look:
      return "look";
    case Cause::Kind::gl:
      return "gl";
    case Cause::Kind::pixels:
      return "pixels";
    case Cause::Kind::unknown:
      return "unknown";
  }
  return "";
}

Cause cause(const std::optional<Origin>& a, const std::optional<Origin>& b, bool drawn_apart) {
  Cause cause;
  if (!a || !b) {
    cause.lines.push_back(
        !a && !b ? "neither says where it comes from: the cause is not known"
                 : fmt::format("{} does not say where it comes from: the cause is not known", a ? "B" : "A"));
    return cause;
  }
  const bool filmed = !a->trajectory.empty() || !b->trajectory.empty();
  const bool other_time = a->shot->time != b->shot->time;
  const auto look = look_lines(*a, *b), gl = gl_lines(*a, *b);
  if (filmed && a->state != b->state) {
    const auto shows = [](const Origin& it) {
      return it.trajectory.empty() ? "the simulation" : it.trajectory + ", another program's run";
    };
    cause.kind = Cause::Kind::state;
    cause.lines.push_back(a->trajectory == b->trajectory
                              ? fmt::format("other state: {} has other numbers there", shows(*a))
                              : fmt::format("other state: A shows {}, B {}", shows(*a), shows(*b)));
  } else if (a->scene_text != b->scene_text || a->sets != b->sets) {
    judge_scenes(*a, *b, drawn_apart, cause);
  } else if (!other_time && !same_states(*a, *b)) {
    judge_one_scene(*a, *b, cause);
  }
  if (other_time) {
    if (cause.lines.empty()) cause.kind = Cause::Kind::state;
    cause.lines.push_back(fmt::format("other instant: t = {:g} s and t = {:g} s", sim::value(a->shot->time),
                                      sim::value(b->shot->time)));
  }
  if (cause.lines.empty() && !look.empty()) cause.kind = Cause::Kind::look;
  if (cause.lines.empty() && look.empty()) cause.kind = gl.empty() ? Cause::Kind::pixels : Cause::Kind::gl;
  cause.lines.insert(cause.lines.end(), look.begin(), look.end());
  cause.lines.insert(cause.lines.end(), gl.begin(), gl.end());
  if (cause.lines.empty())
    cause.lines.push_back(a->version == b->version
                              ? "pixels only: scene, state and OpenGL are the same"
                              : fmt::format("pixels only: scene, state and OpenGL are the same; drawn by "
                                            "obscura {} and {}",
                                            a->version, b->version));
  return cause;
}

bool same_states(const Origin& a, const Origin& b) {
  if (a.state != b.state) return false;
  return !a.states || !b.states || a.shots != b.shots || a.fps != b.fps || *a.states == *b.states;
}

std::string first_difference(const Origin& a, const Origin& b) {
  if (!a.states || !b.states || a.shots != b.shots || a.fps != b.fps) return "";
  const auto apart = Checksums::apart(*a.states, *b.states);
  if (!apart) return "";
  if (!apart->first) return "states differ in frames that have no checksums of their own";
  const scene::Scene scene = scene_of(a);
  const Shots shots = shots_of(a, scene);
  const auto frame = [&](std::int64_t i) {
    const Shot shot = shots[std::clamp<std::int64_t>(i, 0, shots.size() - 1)];
    return fmt::format("frame {} (t = {:g} s)", shot.frame, sim::value(shot.time));
  };
  if (apart->ended) return "one of the runs ends before " + frame(*apart->first);
  // a still is one frame, and is known to differ: it is its bodies that can be told
  if (a.frames == 0 && !apart->bodies_known) return "";
  std::string text = "states differ";
  if (a.frames > 0 && (*apart->first == 0 || apart->same == *apart->first - 1))
    text += fmt::format(" from {} on", frame(*apart->first));
  else if (a.frames > 0)
    text += fmt::format(", first between {} and {}", frame(std::max<std::int64_t>(0, apart->same)),
                        frame(*apart->first));
  if (!apart->bodies_known) return text;
  if (apart->bodies.empty()) return text + ": every body has the same position and motion";
  std::vector<std::string> all;
  const auto list = [&](const scene::Scene& of, const std::string& variant) {
    const auto run = of.run();
    for (const sim::SceneInfo::Body& body : run->scene_info().bodies)
      all.push_back(variant.empty() ? body.name : fmt::format("{} ({})", body.name, variant));
  };
  for (const Ahead::Run& run : compared(scene)) list(run.scene, run.look.name);
  if (all.empty()) list(scene, "");
  std::string names;
  std::size_t told = 0;
  for (const std::size_t body : apart->bodies) {
    if (body >= all.size()) return text;
    if (told == kMostBodiesTold) break;
    names += (told++ ? ", " : "") + all[body];
  }
  if (apart->bodies.size() > told) names += fmt::format(" and {} more", apart->bodies.size() - told);
  if (apart->bodies_at != *apart->first) text += fmt::format("; at {}", frame(apart->bodies_at));
  return fmt::format("{}: {} {}", text, apart->bodies.size() == 1 ? "body" : "bodies", names);
}

std::optional<Origin> simulated(const Origin& origin) {
  const scene::Scene scene = scene_of(origin);
  const Shots shots = shots_of(origin, scene);
  // those of all runs that the film shows
  std::vector<std::unique_ptr<sim::Run>> runs;
  std::size_t bodies = 0;
  for (const scene::Scene& each : filmed(scene)) {
    runs.push_back(each.shown_run());
    runs.back()->heed(interrupted);
    bodies += runs.back()->scene_info().bodies.size();
  }
  // as many frames as a film that was cut short has; only the first state if the origin has no others
  const std::int64_t count = origin.states ? std::min(origin.states->frames(), shots.size()) : 1;
  Origin again = origin;
  again.states.reset();
  Checksums states(shots.size(), bodies);
  for (std::int64_t i = 0; i < count; ++i) {
    sim::Snapshot all;
    std::vector<std::string> hashes;
    for (const auto& run : runs) {
      const auto found = run->at(i == 0 ? origin.shot->time : shots[i].time);
      const auto* moment = std::get_if<sim::Snapshot>(&found);
      if (!moment) break;
      all.bodies.insert(all.bodies.end(), moment->bodies.begin(), moment->bodies.end());
      hashes.push_back(state_hash(run->words()));
    }
    if (hashes.size() < runs.size() && i == 0) return {};
    if (hashes.size() < runs.size()) break;
    const std::string state = hash_of_states(hashes);
    if (i == 0) again.state = state;
    states.add(i, state, all);
  }
  states.close();
  if (origin.states) again.states = states;
  return again;
}

}  // namespace obscura::app
