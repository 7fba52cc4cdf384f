#include "app/run/origin.h"

#include <xxhash.h>

#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "app/console/exit.h"
#include "app/run/imported_run.h"
#include "app/run/run_marks.h"
#include "scene/complaints.h"
#include "scene/difference.h"
#include "scene/error.h"

namespace obscura::app {

namespace {

// beyond what any file of ours says: a size, and frames of 1e6 s at 1000 a second a thousand times slowed
// down
constexpr std::int64_t kMostPixels = 1'000'000, kMostFramesOfMovie = 1'000'000'000'000;

}  // namespace

std::optional<std::int64_t> whole(const nlohmann::json& json, std::int64_t least, std::int64_t most) {
  if (!json.is_number_integer()) return {};
  if (json.is_number_unsigned() && json.get<std::uint64_t>() > std::uint64_t(most)) return {};
  const auto n = json.get<std::int64_t>();
  return n < least || n > most ? std::nullopt : std::optional(n);
}

std::string hash(const void* bytes, std::size_t size) {
  const XXH128_hash_t h = XXH3_128bits(bytes, size);
  return fmt::format("{:016x}{:016x}", h.high64, h.low64);
}

std::string hash(const std::string& text) { return hash(text.data(), text.size()); }

std::string state_hash(const std::vector<std::uint64_t>& words) {
  return hash(words.data(), words.size() * sizeof(std::uint64_t));
}

std::string Origin::drawn_by() const {
  return fmt::format("obscura {}, OpenGL {}, {}{}", version, gl_version, gl_renderer,
                     native ? ", --native" : "");
}

std::string Origin::set_flags() const {
  return sets.empty() ? "" : fmt::format("--set {}", fmt::join(sets, " --set "));
}

media::Tags Origin::tags(const std::string& title) const {
  nlohmann::ordered_json json;
  json["version"] = version;
  json["scene"] = {{"file", scene_file}, {"hash", scene_hash}, {"set", sets}, {"text", scene_text}};
  json["size"] = {width, height};
  json["theme"] = theme;
  if (!camera.empty()) json["camera"] = camera;
  if (transparent) json["transparent"] = true;
  json["fps"] = fps;
  if (shot) {
    json["frame"] = shot->frame;
    json["time"] = sim::text(shot->time);
  }
  if (frames > 0) {
    json["frames"] = frames;
    json["shots"] = shots;
    json["encoder"] = {{"name", encoder}, {"preset", preset}};
    if (crf) json["encoder"]["crf"] = *crf;
  }
  json["state"] = state;
  if (states) json["states"] = states->json();
  if (!programs.empty()) json["programs"] = programs;
  if (!trajectory.empty()) json["trajectory"] = trajectory;
  json["gl"] = {{"version", gl_version}, {"renderer", gl_renderer}, {"native", native}};
  media::Tags tags = {{"Software", "obscura " OBSCURA_VERSION},
                      {"obscura", json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)}};
  if (!title.empty()) tags["Title"] = title;
  return tags;
}

std::string discord(const Origin& there, const Origin& here) {
  const auto differ = [](const char* what, const std::string& a, const std::string& b) {
    const auto said = [](const std::string& text) { return text.empty() ? std::string("none") : text; };
    return fmt::format("{} is {} there, and {} here", what, said(a), said(b));
  };
  if (there.scene_hash != here.scene_hash || there.sets != here.sets) {
    try {
      const auto all = scene::differences({there.scene_text, there.sets}, {here.scene_text, here.sets});
      if (!all.empty()) return differ(("the scene's " + all[0].path).c_str(), all[0].a, all[0].b);
    } catch (const scene::Error&) {
    }
    return "the scene's text is another";
  }
  const auto size = [](const Origin& o) { return fmt::format("{}x{}", o.width, o.height); };
  const auto crf = [](const Origin& o) { return o.crf ? fmt::format("{}", *o.crf) : std::string(); };
  const auto word = [](bool yes) { return std::string(yes ? "on" : "off"); };
  struct Fact {
    const char* what;
    std::string a, b;
  };
  for (const Fact& fact : {Fact{"obscura's version", there.version, here.version},
                           {"the size", size(there), size(here)},
                           {"the frame rate", there.fps, here.fps},
                           {"the theme", there.theme, here.theme},
                           {"the camera", there.camera, here.camera},
                           {"--transparent", word(there.transparent), word(here.transparent)},
                           {"forces of a program", fmt::format("{}", fmt::join(there.programs, ", ")),
                            fmt::format("{}", fmt::join(here.programs, ", "))},
                           {"the run", there.trajectory, here.trajectory},
                           {"the choice of frames", there.shots, here.shots},
                           {"the encoder", there.encoder, here.encoder},
                           {"the preset", there.preset, here.preset},
                           {"crf", crf(there), crf(here)},
                           {"--native", word(there.native), word(here.native)},
                           {"OpenGL", there.gl_version, here.gl_version},
                           {"the renderer", there.gl_renderer, here.gl_renderer}}) {
    if (fact.a != fact.b) return differ(fact.what, fact.a, fact.b);
  }
  return "";
}

Origin origin_of(const scene::Scene& scene) {
  Origin origin;
  origin.version = OBSCURA_VERSION;
  origin.scene_hash = hash(scene.text);
  origin.scene_file = scene::one_line(std::filesystem::path(scene.file).filename().string());
  origin.scene_text = scene.text, origin.sets = scene.sets;
  origin.width = scene.film.width, origin.height = scene.film.height;
  origin.theme = scene.look.theme == draw::Theme::paper ? "paper" : "screen";
  if (scene.dimension() == 3 && scene.cameras.size() == 1) origin.camera = scene.cameras[0].name;
  origin.fps = sim::text(scene.film.fps);
  origin.trajectory = scene.trajectory_file;
  origin.programs = scene.programs();
  return origin;
}

std::optional<Origin> origin_in(const media::Tags& tags) {
  const auto found = tags.find("obscura");
  if (found == tags.end()) return {};
  try {
    const auto json = nlohmann::json::parse(found->second);
    Origin origin;
    const auto word = [](const nlohmann::json& of) { return scene::one_line(of.get<std::string>()); };
    origin.version = word(json.at("version"));
    const auto& scene = json.at("scene");
    origin.scene_file = std::filesystem::path(word(scene.at("file"))).filename().string();
    origin.scene_hash = word(scene.at("hash"));
    scene.at("text").get_to(origin.scene_text), scene.at("set").get_to(origin.sets);
    const auto width = whole(json.at("size").at(0), 1, kMostPixels),
               height = whole(json.at("size").at(1), 1, kMostPixels);
    origin.theme = word(json.at("theme")), origin.fps = word(json.at("fps"));
    if (json.contains("camera")) origin.camera = word(json["camera"]);
    origin.transparent = json.value("transparent", false);
    const auto time = sim::parse_rational(json.at("time").get<std::string>());
    const auto fps = sim::parse_rational(origin.fps);
    const auto frame = whole(json.at("frame"), 0, kMostFramesOfMovie),
               frames = json.contains("frames") ? whole(json["frames"], 1, kMostFramesOfMovie) : 0;
    if (!width || !height || !time || *time < sim::Rational{} || !fps || fps->num <= 0 || !frame || !frames)
      return {};
    origin.width = int(*width), origin.height = int(*height);
    origin.shot = Shot{*frame, *time};
    origin.frames = *frames;
    if (json.contains("shots")) origin.shots = word(json["shots"]);
    if (json.contains("encoder")) {
      const auto& encoder = json["encoder"];
      origin.encoder = word(encoder.at("name")), origin.preset = word(encoder.at("preset"));
      if (encoder.contains("crf")) origin.crf = encoder["crf"].get<double>();
    }
    origin.state = word(json.at("state"));
    if (json.contains("states")) origin.states = Checksums::read(json["states"]);
    if (json.contains("programs"))
      for (const auto& name : json["programs"]) origin.programs.push_back(word(name));
    if (json.contains("trajectory")) origin.trajectory = word(json["trajectory"]);
    const auto& gl = json.at("gl");
    origin.gl_version = word(gl.at("version")), origin.gl_renderer = word(gl.at("renderer"));
    origin.native = gl.value("native", false);
    return origin;
  } catch (const nlohmann::json::exception&) {
    return {};
  }
}

scene::Scene scene_of(const Origin& origin) {
  if (!origin.programs.empty())
    throw scene::Error({{origin.scene_file, 0, 0,
                         fmt::format("has a force '{}' that a program computed: it cannot be run again",
                                     origin.programs.front())}});
  scene::Scene scene = with_run_marks(scene::parse(origin.scene_text, origin.scene_file, origin.sets));
  scene.film.width = origin.width, scene.film.height = origin.height;
  scene.film.fps = *sim::parse_rational(origin.fps);
  scene.film.preset = origin.preset, scene.film.crf = origin.crf, scene.film.codec = origin.encoder;
  scene.look.theme = origin.theme == "screen" ? draw::Theme::screen : draw::Theme::paper;
  if (!origin.camera.empty() && scene.cameras.size() > 1) choose_camera(origin.camera, scene);
  if (origin.run) {
    // a frame between two rows was asked for when it was made
    std::vector<std::string> notes;
    show_run(*origin.run, true, scene, notes);
    scene.film.shutter = 0;
  }
  return scene;
}

Shots shots_of(const Origin& origin, const scene::Scene& scene) {
  if (origin.frames == 0) return Shots::again(*origin.shot, scene.film.fps, scene.film.speed);
  Shots shots = Shots::film(scene.duration, scene.film.fps, scene.film.speed);
  if (!origin.shots.empty()) shots.only(origin.shots, "its frames");
  return shots;
}

void choose_camera(const std::string& name, scene::Scene& scene) {
  std::string known;
  for (const draw::Camera& camera : scene.cameras) {
    if (camera.name == name) {
      scene.cameras = {draw::Camera(camera)};
      return;
    }
    if (!camera.name.empty()) known += (known.empty() ? "" : ", ") + camera.name;
  }
  throw UsageError(
      fmt::format("--camera {}: the scene has {}", name, known.empty() ? "one without a name" : known));
}

}  // namespace obscura::app
