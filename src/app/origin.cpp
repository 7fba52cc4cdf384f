#include "app/origin.h"

#include <xxhash.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace obscura::app {

std::string hash(const void* bytes, std::size_t size) {
  const XXH128_hash_t h = XXH3_128bits(bytes, size);
  return fmt::format("{:016x}{:016x}", h.high64, h.low64);
}

std::string hash(const std::string& text) { return hash(text.data(), text.size()); }

std::string state_hash(const std::vector<std::uint64_t>& words) {
  return hash(words.data(), words.size() * sizeof(std::uint64_t));
}

media::Tags Origin::tags(const std::string& title) const {
  nlohmann::ordered_json json;
  json["version"] = OBSCURA_VERSION;
  json["scene"] = {{"file", scene_file}, {"hash", scene_hash}, {"set", sets}, {"text", scene_text}};
  json["size"] = {width, height};
  json["theme"] = theme;
  json["fps"] = fps;
  if (shot) {
    json["frame"] = shot->frame;
    json["time"] = sim::text(shot->time);
  }
  if (frames > 0) json["frames"] = frames;
  json["state"] = state;
  json["gl"] = {{"version", gl_version}, {"renderer", gl_renderer}, {"native", native}};
  media::Tags tags = {{"Software", "obscura " OBSCURA_VERSION}, {"obscura", json.dump()}};
  if (!title.empty()) tags["Title"] = title;
  return tags;
}

}  // namespace obscura::app
