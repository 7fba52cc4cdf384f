#include "media/tags.h"

#include <nlohmann/json.hpp>

namespace obscura::media {

using Json = nlohmann::ordered_json;

std::string comment(const Tags& tags) {
  Json all = Json::object();
  for (const auto& [key, text] : tags) {
    const Json parsed = Json::parse(text, nullptr, false);
    // only where its text comes back to the byte
    const bool json = parsed.is_object() && parsed.dump() == text;
    all[key] = json ? parsed : Json(text);
  }
  return all.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Tags tags_of_comment(const std::string& text) {
  Tags tags;
  const Json all = Json::parse(text, nullptr, false);
  if (!all.is_object()) {
    if (!text.empty()) tags["Comment"] = text;
    return tags;
  }
  for (const auto& [key, value] : all.items())
    tags[key] = value.is_string() ? value.get<std::string>() : value.dump();
  return tags;
}

}  // namespace obscura::media
