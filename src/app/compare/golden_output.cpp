#include "app/compare/golden_output.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "app/compare/format.h"
#include "app/compare/github.h"
#include "app/console/say.h"

namespace obscura::app {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostSummaryRows = 100;  // of a summary, which GitHub cuts at a megabyte

std::string title(const GoldenCase& it) {
  return it.time.empty() ? it.scene : fmt::format("{}, t = {} s", it.scene, it.time);
}

Json json_of_case(const GoldenCase& it) {
  Json json;
  json["scene"] = it.scene, json["file"] = it.scene_file;
  json["time"] = it.time.empty() ? Json() : Json(std::strtod(it.time.c_str(), nullptr));
  json["state"] = it.state, json["good"] = it.good();
  json["reference"] = it.time.empty() ? Json() : Json(it.file);
  json["choice"] = it.choice.empty() ? Json() : Json(it.choice);
  json["pictures"] = Json::object();
  static constexpr const char* kinds[] = {"actual", "difference"};
  for (std::size_t i = 0; i < it.attachments.size() && i < 2; ++i)
    json["pictures"][kinds[i]] = it.attachments[i];
  json["lines"] = it.lines;
  if (it.difference) json["difference"] = json_of(*it.difference);
  if (it.cause) json["cause"] = json_of(*it.cause);
  json["errors"] = it.error ? json_of(*it.error) : Json::array();
  json["seconds"] = it.seconds;
  return json;
}

}  // namespace

std::string golden_json(const std::vector<GoldenCase>& cases, int exit) {
  Json top = json_head("golden", exit);
  std::set<std::string> scenes;
  std::map<std::string, int> states;
  for (const GoldenCase& it : cases) scenes.insert(it.scene), ++states[it.state];
  top["scenes"] = scenes.size();
  top["states"] = states;
  top["moments"] = Json::array();
  for (const GoldenCase& it : cases) top["moments"].push_back(json_of_case(it));
  return text_of(top);
}

std::string golden_annotations(const std::vector<GoldenCase>& cases) {
  std::string all;
  for (const GoldenCase& it : cases) {
    if (it.good()) continue;
    if (it.error) {
      all += github::commands(*it.error);
      continue;
    }
    all += github::command({.file = it.scene_file,
                            .line = it.line,
                            .title = fmt::format("{}: {}", title(it), it.state),
                            .message = fmt::format("{}", fmt::join(it.lines, "\n"))});
  }
  return all;
}

std::string golden_summary(const std::vector<GoldenCase>& cases) {
  const std::size_t bad =
      std::size_t(std::count_if(cases.begin(), cases.end(), [](const auto& it) { return !it.good(); }));
  const std::string moments = counted(cases.size(), "moment");
  if (bad == 0) return fmt::format("### Golden images: {}, all good\n\n", moments);
  std::string all =
      fmt::format("### Golden images: {} of {} not good\n\n| moment | | |\n|---|---|---|\n", bad, moments);
  std::size_t rows = 0;
  for (const GoldenCase& it : cases) {
    if (it.good() || ++rows > kMostSummaryRows) continue;
    std::string lines;
    for (const std::string& line : it.lines) lines += (lines.empty() ? "" : "<br>") + github::escaped(line);
    all +=
        fmt::format("| {} | **{}** | {} |\n", github::escaped(title(it)), github::escaped(it.state), lines);
  }
  if (rows > kMostSummaryRows) all += fmt::format("\nand {} more\n", rows - kMostSummaryRows);
  return all + "\n";
}

}  // namespace obscura::app
