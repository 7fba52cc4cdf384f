#include "app/compare/format.h"

#include <nlohmann/json.hpp>

namespace obscura::app {

using Json = nlohmann::ordered_json;

void add_format(const Command& command, Format& format) {
  command
      .choice("--format", format,
              {{"text", Format::text}, {"json", Format::json}, {"github", Format::github}},
              "text, json (docs/json.md) or github (annotations and a summary) [text]")
      .type("FORMAT");
}

Json json_head(const char* command, int exit) {
  return {{"obscura", OBSCURA_VERSION}, {"command", command}, {"exit", exit}};
}

Json json_of(const media::Difference& d) {
  const Json box = {
      {"x", d.left}, {"y", d.top}, {"width", d.right - d.left + 1}, {"height", d.bottom - d.top + 1}};
  return {{"pixels", d.pixels},         {"solid", d.solid}, {"largest", d.largest},
          {"alpha_only", d.alpha_only}, {"box", box},       {"at", Json::array({d.x, d.y})}};
}

Json json_of(const Cause& cause) {
  Json json = {{"kind", name(cause.kind)}, {"lines", cause.lines}};
  if (const auto& parting = cause.states)
    json["states"] = {{"step", parting->step},
                      {"time", parting->time},
                      {"body", parting->body},
                      {"quantity", parting->quantity}};
  return json;
}

Json json_of(const scene::Error& error) {
  Json all = Json::array();
  for (const scene::Complaint& it : error.complaints)
    all.push_back({{"file", it.file}, {"line", it.line}, {"column", it.column}, {"message", it.message}});
  return all;
}

std::string text_of(const Json& json) {
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace obscura::app
