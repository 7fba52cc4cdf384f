#include "app/run/checkpoint.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/run/frames.h"
#include "app/run/origin.h"
#include "media/error.h"
#include "media/file.h"
#include "scene/complaints.h"
#include "scene/difference.h"
#include "scene/error.h"

namespace obscura::app {

namespace {

// raised when a file of before would be read wrongly
constexpr const char* kHeading = "obscura checkpoint 1 ";

// keys that do not change what happens
bool of_the_look(const std::string& path) {
  constexpr std::array kKeys = {"title", "duration", "film", "look", "camera", "figure", "golden"};
  const std::string key = path.substr(0, path.find_first_of(".["));
  return std::find(kKeys.begin(), kKeys.end(), key) != kKeys.end();
}

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw media::Error(path + ": " + why);
}

// why `scene` cannot continue from a checkpoint of `of`
std::string other_scene(const scene::Source& of, const scene::Scene& scene) {
  if (of.text == scene.text && of.sets == scene.sets) return "";
  try {
    for (const scene::KeyDifference& one : scene::differences(of, {scene.text, scene.sets})) {
      if (of_the_look(one.path)) continue;
      const auto said = [](const std::string& value) { return value.empty() ? "not said" : value; };
      return fmt::format("is of another scene: there {} is {}, and here {}", one.path, said(one.a),
                         said(one.b));
    }
  } catch (const scene::Error&) {
    return "is of a scene that this obscura does not read";
  }
  return "";
}

}  // namespace

void write_checkpoint(const std::string& path, const scene::Scene& scene, const sim::Run& run, bool durable) {
  const std::vector<std::uint64_t> words = run.saved();
  std::vector<std::uint8_t> state;
  state.reserve(8 * words.size());
  for (const std::uint64_t word : words) {
    for (int byte = 0; byte < 8; ++byte) state.push_back(std::uint8_t(word >> 8 * byte));
  }
  const nlohmann::json json = {
      {"version", OBSCURA_VERSION},   {"file", scene.name},
      {"text", scene.text},           {"set", scene.sets},
      {"time", sim::text(run.now())}, {"state", nlohmann::json::binary(std::move(state))}};
  const std::vector<std::uint8_t> body = nlohmann::json::to_cbor(json);
  const std::string head = kHeading + hash(body.data(), body.size()) + "\n";
  media::File file(path);
  file.write({reinterpret_cast<const std::uint8_t*>(head.data()), head.size()});
  file.write(body);
  file.place(durable);
}

std::unique_ptr<sim::Run> run_from(const std::string& path, const scene::Scene& scene) {
  const std::string bytes = file_bytes(path);
  const std::size_t line = bytes.find('\n');
  const std::string head = bytes.substr(0, line);
  if (!head.starts_with("obscura checkpoint ")) refuse(path, "is no checkpoint");
  if (!head.starts_with(kHeading)) refuse(path, "is a checkpoint of another version of obscura");
  const std::string body = line == std::string::npos ? "" : bytes.substr(line + 1);
  if (head != kHeading + hash(body)) refuse(path, "is a damaged checkpoint: its bytes are not those written");

  scene::Source of;
  std::string version;
  std::vector<std::uint64_t> words;
  try {
    const nlohmann::json json = nlohmann::json::from_cbor(body);
    json.at("version").get_to(version), json.at("text").get_to(of.text), json.at("set").get_to(of.sets);
    const nlohmann::json::binary_t& state = json.at("state").get_binary();
    words.resize(state.size() / 8);
    for (std::size_t i = 0; i < 8 * words.size(); ++i) words[i / 8] |= std::uint64_t(state[i]) << 8 * (i % 8);
  } catch (const nlohmann::json::exception&) {
    refuse(path, "is a damaged checkpoint");
  }
  if (version != OBSCURA_VERSION)
    refuse(path, fmt::format("is of obscura {}, and this is {}: another version may go on differently",
                             scene::one_line(version), OBSCURA_VERSION));
  if (const std::string why = other_scene(of, scene); !why.empty()) refuse(path, why);
  auto run = words.empty() ? nullptr : scene.run(words);
  if (!run) refuse(path, "holds no state of this scene");
  return run;
}

}  // namespace obscura::app
