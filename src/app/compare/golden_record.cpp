#include "app/compare/golden_record.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include <nlohmann/json.hpp>

#include "media/error.h"
#include "scene/complaints.h"

namespace obscura::app {

namespace {

// Digits that tell one from all others, if not from what a forger makes: a thousand scenes of two moments are
// to be less than 200 kB of git.
constexpr std::size_t kStateDigits = 16, kPixelDigits = 12, kSceneDigits = 8;

}  // namespace

std::string pixel_hash(const media::Image& image) {
  const std::string all =
      fmt::format("{}x{} {}", image.width, image.height, hash(image.pixels.data(), image.pixels.size()));
  return hash(all).substr(0, kPixelDigits);
}

GoldenRecord::Moment moment_of(const Pictured& made) {
  return {made.origin.state.substr(0, kStateDigits), pixel_hash(made.image)};
}

GoldenRecord record_of(const std::vector<std::string>& times, const std::vector<Pictured>& made) {
  const Origin& origin = made.front().origin;
  GoldenRecord record;
  record.scene = origin.scene_hash.substr(0, kSceneDigits);
  record.gl = origin.gl_version + "; " + origin.gl_renderer;
  const std::string profile = " (Core Profile)";
  if (const std::size_t at = record.gl.find(profile); at != std::string::npos)
    record.gl.erase(at, profile.size());
  for (std::size_t i = 0; i < made.size(); ++i) record.moments[times[i]] = moment_of(made[i]);
  return record;
}

// a line a moment, so that git tells which of them a commit has changed
std::string GoldenRecord::text() const {
  std::string text = fmt::format("{{\n  \"scene\": \"{}\",\n  \"gl\": {}", scene, nlohmann::json(gl).dump());
  for (const auto& [time, moment] : moments)
    text += fmt::format(",\n  \"{}\": \"{} {}\"", time, moment.state, moment.pixels);
  return text + "\n}\n";
}

GoldenRecord read_record(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw media::Error(file + ": cannot be read");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (text.starts_with("version https://git-lfs"))
    throw media::Error(file + ": is a pointer of git-LFS; `git lfs pull` fetches what it stands for");
  const media::Error none(file + ": is no record of states and pictures that `obscura golden` wrote");
  try {
    GoldenRecord record;
    for (const auto& [key, value] : nlohmann::json::parse(text).get<nlohmann::json::object_t>()) {
      if (key == "scene")
        value.get_to(record.scene);
      else if (key == "gl")
        record.gl = scene::one_line(value.get<std::string>());
      else if (const auto both = value.get<std::string>(); both.size() == kStateDigits + 1 + kPixelDigits)
        record.moments[key] = {both.substr(0, kStateDigits), both.substr(kStateDigits + 1)};
      else
        throw none;
    }
    return record;
  } catch (const nlohmann::json::exception&) {
    throw none;
  }
}

}  // namespace obscura::app
