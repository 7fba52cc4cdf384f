// A run as `obscura states` prints it by itself, as JSON: the same table as its CSV.

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <string_view>

#include <nlohmann/json.hpp>

#include "app/run/table.h"
#include "media/error.h"

namespace obscura::app {

namespace {

using Cells = std::vector<std::pair<std::string, double>>;

// a number, or several under x, y, z, w
void add(const std::string& name, const nlohmann::json& value, Cells& cells) {
  constexpr const char* kAxes[] = {"x", "y", "z", "w"};
  if (!value.is_array()) {
    cells.emplace_back(name, value.get<double>());
    return;
  }
  for (std::size_t k = 0; k < value.size() && k < std::size(kAxes); ++k)
    cells.emplace_back(name + "." + kAxes[k], value[k].get<double>());
}

// the keys of an object that are none of `read`, as "joints.broken", each once
void add_unread(const std::string& of, const nlohmann::json& object,
                std::initializer_list<std::string_view> read, std::vector<std::string>& unread) {
  for (const auto& [key, value] : object.items()) {
    const std::string name = of.empty() ? key : of + "." + key;
    if (std::find(read.begin(), read.end(), key) == read.end() &&
        std::find(unread.begin(), unread.end(), name) == unread.end())
      unread.push_back(name);
  }
}

// what a state has that is no column
void add_unread_of_state(const nlohmann::json& state, std::vector<std::string>& unread) {
  add_unread("", state,
             {"time", "step", "energy", "momentum", "angular_momentum", "contacts", "bodies", "joints"},
             unread);
  const auto all_of = [&](const char* list, std::initializer_list<std::string_view> read) {
    for (const nlohmann::json& each : state.value(list, nlohmann::json::array()))
      if (each.is_object()) add_unread(list, each, read, unread);
  };
  if (constexpr const char* contacts = "contacts but for their number";
      !state.value("contacts", nlohmann::json::array()).empty() &&
      std::find(unread.begin(), unread.end(), contacts) == unread.end())
    unread.push_back(contacts);
  all_of("bodies", {"name", "position", "orientation", "angle", "velocity", "spin"});
  all_of("joints", {"name", "force"});
}

// the columns that CSV has for an instant too
Cells cells_of(const nlohmann::json& state) {
  Cells cells;
  for (const char* name : {"time", "step"})
    if (state.contains(name)) add(name, state[name], cells);
  if (state.contains("energy"))
    for (const auto& [kind, value] : state["energy"].items()) add("energy." + kind, value, cells);
  for (const char* name : {"momentum", "angular_momentum"})
    if (state.contains(name)) add(name, state[name], cells);
  if (state.contains("contacts")) cells.emplace_back("contacts", double(state["contacts"].size()));
  for (const nlohmann::json& body : state.value("bodies", nlohmann::json::array()))
    for (const char* quantity : {"position", "orientation", "angle", "velocity", "spin"})
      if (body.contains(quantity))
        add(body.at("name").get<std::string>() + "." + quantity, body[quantity], cells);
  for (const nlohmann::json& joint : state.value("joints", nlohmann::json::array()))
    if (joint.contains("force")) add(joint.at("name").get<std::string>() + ".force", joint["force"], cells);
  return cells;
}

}  // namespace

Table table_of_json(const std::string& file, const std::string& text) {
  Table table;
  table.file = file, table.json = true;
  try {
    const nlohmann::json top = nlohmann::json::parse(text);
    for (const nlohmann::json& state : top.at("states")) {
      const int number = int(table.rows.size()) + 1;
      const Cells cells = cells_of(state);
      add_unread_of_state(state, table.unread);
      if (table.rows.empty()) {
        for (const auto& [name, value] : cells) {
          if (table.column(name)) throw media::Error(fmt::format("{}: there are two of '{}'", file, name));
          table.cells.push_back(table.columns.size());
          table.columns.push_back(name);
        }
        const auto time = table.column("time");
        if (!time) throw media::Error(fmt::format("{}: its states have no time", file));
        table.time_column = *time;
      }
      std::vector<double> numbers;
      for (std::size_t i = 0; i < cells.size() && i < table.columns.size(); ++i)
        if (cells[i].first == table.columns[i]) numbers.push_back(cells[i].second);
      if (cells.size() != table.columns.size() || numbers.size() != cells.size())
        throw media::Error(
            fmt::format("{}, state {}: does not have the same numbers as the first", file, number));
      if (!add_row(std::move(numbers), number, table))
        throw media::Error(fmt::format("{}, state {}: times must increase", file, number));
    }
  } catch (const nlohmann::json::exception& error) {
    throw media::Error(fmt::format("{}: is not as `obscura states` writes it: {}", file, error.what()));
  }
  if (table.rows.empty()) throw media::Error(file + ": has no states");
  return table;
}

}  // namespace obscura::app
