// A builder's keys become TOML, which is read as any other scene: one language, one check. A key stands on a
// line of its own, so that the line of a fault says which key it is.

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <set>
#include <system_error>

#include "obscura/inside.h"
#include "scene/complaints.h"
#include "scene/keys.h"
#include "scene/table.h"

namespace obscura {

namespace {

constexpr int kDeepest = 60;

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += '\\', out += c;
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
      out += fmt::format("\\u{:04X}", static_cast<unsigned char>(c));
    else
      out += c;
  }
  return out + '"';
}

bool bare(const std::string& key) {
  return !key.empty() && std::all_of(key.begin(), key.end(),
                                     [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; });
}

std::string key_text(const std::string& key) { return bare(key) ? key : quoted(key); }

std::string number(double x) {
  if (std::isnan(x)) return "nan";
  if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
  std::string text = fmt::format("{}", x);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string literal_of(const Value& value, int depth);

std::string inline_table(const Table& table, int depth) {
  std::string text = "{";
  for (const auto& [key, value] : table)
    text += (text.size() > 1 ? ", " : " ") + key_text(key) + " = " + literal_of(value, depth + 1);
  return text + " }";
}

std::string literal_of(const Value& value, int depth) {
  if (depth > kDeepest) throw UsageError("lists and tables are nested too deep");
  struct Visitor {
    int depth;
    std::string operator()(std::int64_t x) const { return fmt::format("{}", x); }
    std::string operator()(double x) const { return number(x); }
    std::string operator()(bool x) const { return x ? "true" : "false"; }
    std::string operator()(const std::string& text) const { return quoted(text); }
    std::string operator()(const Value::List& list) const {
      std::string text = "[";
      for (const Value& each : list) text += (text.size() > 1 ? ", " : "") + literal_of(each, depth + 1);
      return text + "]";
    }
    std::string operator()(const Table& table) const { return inline_table(table, depth); }
  };
  return std::visit(Visitor{depth}, value.is);
}

bool is_table(const Value& value) { return std::holds_alternative<Table>(value.is); }

bool is_tables(const Value& value) {
  const auto* list = std::get_if<Value::List>(&value.is);
  return list && !list->empty() && std::all_of(list->begin(), list->end(), is_table);
}

// the text of a scene, and which key each line of it is
struct Written {
  std::string text;
  std::vector<std::string> keys;

  void line(const std::string& words, std::string key) {
    text += words + '\n';
    keys.push_back(std::move(key));
  }
};

void write_keys(const Table& table, const std::string& owner, Written& out) {
  for (const auto& [key, value] : table)
    out.line(key_text(key) + " = " + literal_of(value, 0), owner.empty() ? key : owner + "." + key);
}

Written written(const Table& keys) {
  Written out;
  Table plain;
  for (const auto& entry : keys)
    if (!is_table(entry.second) && !is_tables(entry.second)) plain.push_back(entry);
  write_keys(plain, "", out);
  for (const auto& [key, value] : keys) {
    if (is_table(value)) {
      out.line("[" + key_text(key) + "]", key);
      write_keys(std::get<Table>(value.is), key, out);
    } else if (is_tables(value)) {
      int number = 0;
      for (const Value& each : std::get<Value::List>(value.is)) {
        const std::string owner = fmt::format("{}[{}]", key, number++);
        out.line("[[" + key_text(key) + "]]", owner);
        write_keys(std::get<Table>(each.is), owner, out);
      }
    }
  }
  return out;
}

std::vector<std::string> parts(std::string_view path) {
  std::vector<std::string> all;
  for (std::size_t at = 0; at <= path.size();) {
    const std::size_t dot = std::min(path.find('.', at), path.size());
    all.emplace_back(path.substr(at, dot - at));
    at = dot + 1;
  }
  return all;
}

// refuses a key that the language does not have; under free tables any name goes
void known(const std::string& path) {
  if (scene::key(path)) return;
  const std::size_t dot = path.rfind('.');
  const std::string owner = dot == std::string::npos ? "" : path.substr(0, dot);
  if (!owner.empty()) {
    known(owner);
    if (scene::keys_of(owner).empty()) return;
  }
  std::vector<std::string_view> words;
  for (const scene::Key* each : scene::keys_of(owner)) words.push_back(each->last());
  const std::string last = path.substr(owner.empty() ? 0 : owner.size() + 1);
  throw SceneError({{"scene", 0, 0, path, "unknown key '" + last + "'" + scene::did_you_mean(last, words)}});
}

// the keys of a table, each once, and those of tables within
void known(const std::string& owner, const Table& table) {
  std::set<std::string_view> seen;
  for (const auto& [key, value] : table) {
    const std::string path = owner.empty() ? key : owner + "." + key;
    known(path);
    if (!seen.insert(key).second) throw SceneError({{"scene", 0, 0, path, "'" + key + "' is given twice"}});
    if (scene::keys_of(path).empty()) continue;
    if (is_table(value)) known(path, std::get<Table>(value.is));
    if (is_tables(value))
      for (const Value& each : std::get<Value::List>(value.is)) known(path, std::get<Table>(each.is));
  }
}

Value* find(Table& table, const std::string& key) {
  for (auto& [name, value] : table)
    if (name == key) return &value;
  return nullptr;
}

// the value under a path, made where there is none
Value& place(Table& keys, const std::vector<std::string>& path) {
  Table* table = &keys;
  for (std::size_t i = 0;; ++i) {
    Value* value = find(*table, path[i]);
    if (!value) value = &table->emplace_back(path[i], Value(Table{})).second;
    if (i + 1 == path.size()) return *value;
    if (!is_table(*value)) throw UsageError(path[i] + " is no table: its keys are given where it is added");
    table = &std::get<Table>(value->is);
  }
}

}  // namespace

std::string literal(const Value& value) { return literal_of(value, 0); }

Builder::Builder(Table keys) : keys_(std::move(keys)) { known("", keys_); }

Builder& Builder::set(std::string_view key, Value value) {
  const std::string path(key);
  known(path);
  if (is_table(value)) known(path, std::get<Table>(value.is));
  place(keys_, parts(key)) = std::move(value);
  return *this;
}

Builder& Builder::add(std::string_view kind, Table keys) {
  const std::string path(kind);
  known(path);
  known(path, keys);
  Value& all = place(keys_, parts(kind));
  if (is_table(all) && std::get<Table>(all.is).empty()) all = Value(Value::List{});
  auto* list = std::get_if<Value::List>(&all.is);
  if (!list) throw UsageError(path + " is one table: set() gives its keys");
  list->push_back(Value(std::move(keys)));
  return *this;
}

std::string Builder::text() const { return written(keys_).text; }

namespace {

// a message that names other places of the text, "name:7:1", with their keys
std::string with_keys(const std::string& message, const std::string& name, const Written& scene) {
  std::string said;
  std::size_t from = 0;
  for (std::size_t at; (at = message.find(name + ":", from)) != message.npos;) {
    const char *number = message.data() + at + name.size() + 1, *const end = message.data() + message.size();
    std::size_t line = 0;
    int column = 0;
    const auto lines = std::from_chars(number, end, line);
    const auto columns = lines.ptr < end && *lines.ptr == ':'
                             ? std::from_chars(lines.ptr + 1, end, column)
                             : std::from_chars_result{number, std::errc::invalid_argument};
    const bool place =
        lines.ec == std::errc() && columns.ec == std::errc() && line >= 1 && line <= scene.keys.size();
    said += message.substr(from, at - from) + (place ? scene.keys[line - 1] : name + ":");
    from = place ? std::size_t(columns.ptr - message.data()) : at + name.size() + 1;
  }
  return said + message.substr(from);
}

}  // namespace

Scene Builder::build(const std::string& name) const {
  const Written scene = written(keys_);
  try {
    return Scene::parse(scene.text, name);
  } catch (const SceneError& error) {
    std::vector<Fault> faults = error.faults;
    for (Fault& each : faults) {
      if (each.line >= 1 && std::size_t(each.line) <= scene.keys.size())
        each.key = scene.keys[std::size_t(each.line - 1)];
      each.message = with_keys(each.message, name, scene);
    }
    throw SceneError(std::move(faults));
  }
}

std::string schema() { return scene::json_schema(); }

}  // namespace obscura
