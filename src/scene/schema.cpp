// The language as a JSON Schema (draft 7), for completion and checks in editors: one property for each row of
// the table of keys.

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "scene/document.h"
#include "scene/keys.h"
#include "scene/table.h"

namespace obscura::scene {

namespace {

using Json = nlohmann::ordered_json;

Json object(const std::string& owner);

Json json_literal(const Node& node) {
  if (node.is_integer()) return std::get<std::int64_t>(node.value);
  if (node.is_number()) return node.number();
  if (const bool* flag = std::get_if<bool>(&node.value)) return *flag;
  if (node.is_text()) return node.text();
  if (node.is_table()) {
    Json table = Json::object();
    for (const Entry& each : node.table()) table[each.key] = json_literal(each.node);
    return table;
  }
  Json list = Json::array();
  if (node.is_list())
    for (const Node& each : node.list()) list.push_back(json_literal(each));
  return list;
}

// a bound as the language has it: 1 rather than 1.0
Json bound(double x) { return x == std::floor(x) && std::abs(x) < 1e15 ? Json(std::int64_t(x)) : Json(x); }

Json ranged(Json type, const Range& range) {
  if (std::isfinite(range.low)) type[range.above ? "exclusiveMinimum" : "minimum"] = bound(range.low);
  if (std::isfinite(range.high)) type["maximum"] = bound(range.high);
  return type;
}

Json list_of(Json items, int least, int most) {
  Json list = {{"type", "array"}, {"items", std::move(items)}, {"minItems", least}};
  if (most > 0) list["maxItems"] = most;
  return list;
}

Json any_of(std::vector<Json> ways) { return {{"anyOf", std::move(ways)}}; }

Json vector(const Range& range = {}, int dimension = 0) {
  return list_of(ranged({{"type", "number"}}, range), dimension == 3 ? 3 : 2, dimension == 2 ? 2 : 3);
}

Json words(const std::vector<std::string>& choices) { return {{"type", "string"}, {"enum", choices}}; }

// over copies: { from, to } as well
Json between(const Json& one) {
  return {{"type", "object"},
          {"properties", {{"from", one}, {"to", one}}},
          {"required", {"from", "to"}},
          {"additionalProperties", false}};
}

Json value(const Key& key) {
  const Json string = {{"type", "string"}}, whole = ranged({{"type", "integer"}}, key.range);
  const Json number = ranged({{"type", "number"}}, key.range);
  switch (key.form) {
    case Form::table:
      return object(key.path);
    case Form::tables:
      return list_of(object(key.path), 0, 0);
    case Form::cameras:
      return any_of({object(key.path), list_of(object(key.path), 1, 0)});
    case Form::number:
      return key.varies ? any_of({number, list_of(number, 1, 0), between(number)}) : number;
    case Form::integer:
      return whole;
    case Form::boolean:
      return {{"type", "boolean"}};
    case Form::text:
      return key.varies ? any_of({string, list_of(string, 1, 0)}) : string;
    case Form::thing:
      return string;
    case Form::things:
      return list_of(string, 1, 0);
    case Form::name:
      return {{"type", "string"}, {"pattern", "^[A-Za-z_][A-Za-z0-9_-]*$"}};
    case Form::label:
      return {
          {"type", "string"},
          {"pattern",
           R"(^[^\u0000-\u001f\u007f-\u009f/\\:*?"<>|%{}. -]([^\u0000-\u001f\u007f-\u009f/\\:*?"<>|%{}]*[^\u0000-\u001f\u007f-\u009f/\\:*?"<>|%{}. ])?$)"}};
    case Form::rational:
      return any_of({number, {{"type", "string"}, {"pattern", "^[0-9.]+(/[0-9.]+)?$"}}});
    case Form::speeds:
      return any_of({number,
                     {{"type", "string"}, {"pattern", "^[0-9.]+(/[0-9.]+)?$"}},
                     list_of(object(key.path), 1, 0)});
    case Form::choice:
      return words(key.choices);
    case Form::choices:
      return list_of(words(key.choices), 0, 0);
    case Form::color:
      return key.varies ? any_of({string, list_of(string, 1, 0), between(string)})
                        : any_of({string, list_of(string, 1, 0)});
    case Form::vector:
      return key.varies
                 ? any_of({vector(key.range, key.dimension), between(vector(key.range, key.dimension))})
                 : vector(key.range, key.dimension);
    case Form::spin:
      return any_of({number, list_of(number, 1, 0), between(number), between(vector(key.range, 3))});
    case Form::turn:
      return any_of({vector({}, 3),
                     {{"type", "object"},
                      {"properties", {{"axis", vector({}, 3)}, {"angle", {{"type", "number"}}}}},
                      {"required", {"axis", "angle"}},
                      {"additionalProperties", false}}});
    case Form::walls:
      return any_of({words(key.choices), list_of(object(key.path), 0, 0)});
    case Form::pixels:
      return list_of(whole, 2, 2);
    case Form::count:
      return any_of({whole, list_of(whole, 1, 3)});
    case Form::offset:
      return any_of({vector(), list_of(vector(), 1, 3)});
    case Form::which:
    case Form::states:
      return any_of({{{"type", "boolean"}}, string});
    case Form::points:
      return list_of(vector({}, key.dimension), 3, 0);
    case Form::pairs:
      return list_of(list_of(string, 2, 2), 0, 0);
    case Form::limits:
      return list_of({{"type", "number"}}, 2, 2);
    case Form::times: {
      const Json time = any_of({number, {{"type", "string"}}});
      return any_of({time, list_of(time, 1, 0)});
    }
    case Form::cue:
      return any_of({number,
                     string,
                     {{"type", "object"},
                      {"properties", {{"time", any_of({number, string})}, {"after", number}}},
                      {"required", {"time"}},
                      {"additionalProperties", false}}});
    case Form::couple:
      return list_of(string, 2, 2);
    case Form::place:
    case Form::places:
    case Form::ends: {
      const Json point = {{"type", "object"},
                          {"properties", {{"body", string}, {"local", vector()}, {"at", string}}},
                          {"required", {"body"}},
                          {"additionalProperties", false}};
      const Json end = any_of({string, vector(), point});
      if (key.form == Form::places) return list_of(end, 1, 0);
      return key.form == Form::place ? end : list_of(end, 2, 2);
    }
    case Form::path:
      return list_of(list_of({{"type", "number"}}, 3, 4), 2, 0);
    case Form::curve: {
      const Json spline = list_of(vector(), 1, 0);
      return list_of(any_of({vector(),
                             {{"type", "object"},
                              {"properties", {{"through", vector()}, {"to", vector()}}},
                              {"required", {"to"}},
                              {"additionalProperties", false}},
                             {{"type", "object"},
                              {"properties", {{"spline", spline}}},
                              {"required", {"spline"}},
                              {"additionalProperties", false}}}),
                     2, 0);
    }
    case Form::bodies:
      return any_of({string, list_of(string, 1, 0)});
    case Form::expression:
      return any_of({string, number});
    case Form::expressions:
      return list_of(any_of({string, number}), 2, 3);
    case Form::torque:
      return any_of({string, number, list_of(any_of({string, number}), 3, 3)});
    case Form::numbers:
      return {{"type", "object"}, {"additionalProperties", any_of({number, string})}};
    case Form::any:
      return Json::object();
    case Form::moment:
      return any_of({number, string});
    case Form::trails:
      return any_of(
          {number, {{"type", "object"}, {"additionalProperties", {{"type", "number"}, {"minimum", 0}}}}});
  }
  return {};
}

// a key with its line for the reader
Json property(const Key& key) {
  Json it = value(key);
  std::string text = key.doc;
  if (!key.unit.empty()) text += fmt::format(" [{}]", key.unit);
  if (!key.absent.empty()) text += fmt::format(" Left out: {}.", key.absent);
  it["description"] = text;
  if (!key.fallback.empty() && key.absent.empty())
    it["default"] = json_literal(fallback(key.path, key.dimension == 3 ? 3 : 2));
  // of a table the example is its lines
  if (!key.example.empty() && key.form != Form::numbers && key.form != Form::table &&
      key.form != Form::tables) {
    const Node example = document("it = " + key.example, "");
    it["examples"] = Json::array({json_literal(*example.find("it"))});
  }
  return it;
}

Json object(const std::string& owner) {
  Json properties = Json::object(), required = Json::array();
  for (const Key* each : keys_of(owner)) {
    properties[std::string(each->last())] = property(*each);
    if (each->required) required.push_back(each->last());
  }
  Json it = {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
  if (!required.empty()) it["required"] = std::move(required);
  return it;
}

}  // namespace

std::string json_schema() {
  Json top = {
      {"$schema", "http://json-schema.org/draft-07/schema#"},
      {"title", "A scene of obscura"},
      {"description", "What happens in a room, what it looks like and how it is filmed. See docs/scene.md."}};
  top.update(object(""));
  return top.dump(1) + '\n';
}

}  // namespace obscura::scene
