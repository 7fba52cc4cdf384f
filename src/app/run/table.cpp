#include "app/run/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include "media/error.h"
#include "scene/input.h"

namespace obscura::app {

namespace {

constexpr double kInstant = 5e-7;  // s

std::string_view trimmed_cell(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '"'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> cells(std::string_view line) {
  std::vector<std::string_view> all;
  for (;;) {
    const std::size_t comma = line.find(',');
    all.push_back(trimmed_cell(line.substr(0, comma)));
    if (comma == std::string_view::npos) return all;
    line.remove_prefix(comma + 1);
  }
}

// "run.csv:17:42": the place where a cell begins, from 1
std::string place(const std::string& file, int line, const std::string& text, std::string_view cell) {
  return fmt::format("{}:{}:{}", file, line, cell.data() - text.data() + 1);
}

std::optional<double> number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double x = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return x;
}

}  // namespace

std::optional<std::size_t> Table::column(const std::string& name) const {
  const auto found = std::find(columns.begin(), columns.end(), name);
  if (found == columns.end()) return {};
  return std::size_t(found - columns.begin());
}

namespace {

Table table_in(const std::string& file) {
  scene::Input in(file);
  Table table;
  table.file = file;
  std::vector<bool> numeric;
  std::string line;
  for (int at = 1; std::getline(in, line); ++at) {
    if (at == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    const std::string_view text = trimmed_cell(line);
    if (text.empty() || text.front() == '#') continue;
    if (numeric.empty() && text.front() == '{')
      return table_of_json(file, line + "\n" + std::string(std::istreambuf_iterator<char>(in), {}));
    const auto row = cells(line);
    if (numeric.empty()) {
      for (const std::string_view name : row) {
        numeric.push_back(name != "hash");
        if (!numeric.back()) {
          table.unread.emplace_back(name);
          continue;
        }
        if (table.column(std::string(name)))
          throw media::Error(
              fmt::format("{}: two columns are called '{}'", place(file, at, line, name), name));
        table.columns.emplace_back(name);
        table.cells.push_back(numeric.size() - 1);
      }
      const auto time = table.column("time");
      if (!time)
        throw media::Error(
            fmt::format("{}:{}: no column is called 'time'; the first line names the columns, "
                        "as `obscura states --format csv` writes them",
                        file, at));
      table.time_column = *time, table.head = at;
      continue;
    }
    if (row.size() != numeric.size())
      throw media::Error(
          fmt::format("{}:{}: {} cells under {} columns", file, at, row.size(), numeric.size()));
    std::vector<double> numbers;
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (!numeric[i]) continue;
      const auto x = number(row[i]);
      if (!x)
        throw media::Error(fmt::format("{}: '{}' under {} is no number", place(file, at, line, row[i]),
                                       row[i], table.columns[numbers.size()]));
      numbers.push_back(*x);
    }
    const double time = numbers[table.time_column];
    if (!add_row(std::move(numbers), at, table))
      throw media::Error(fmt::format("{}: times must increase from row to row, got {}",
                                     place(file, at, line, row[table.cells[table.time_column]]), time));
  }
  if (table.rows.empty()) throw media::Error(file + ": has no rows of numbers");
  return table;
}

}  // namespace

Table read_table(const std::string& file) {
  try {
    return table_in(file);
  } catch (const media::Error&) {
    scene::stop_if_asked();
    throw;
  } catch (const std::system_error& error) {
    throw media::Error(fmt::format("{}: cannot be read: {}", file, error.code().message()));
  }
}

bool add_row(std::vector<double> numbers, int line, Table& table) {
  const double time = numbers[table.time_column];
  if (!std::isfinite(time) || (!table.rows.empty() && time <= table.time(table.rows.size() - 1)))
    return false;
  table.rows.push_back(std::move(numbers));
  table.lines.push_back(line);
  return true;
}

std::string place(const Table& table, int line, std::size_t column) {
  if (table.json) return fmt::format("{}, state {}", table.file, line);
  std::error_code none;
  std::ifstream in;
  // a pipe has nothing left, and would be waited for
  if (std::filesystem::is_regular_file(table.file, none)) in.open(table.file, std::ios::binary);
  std::string text;
  for (int at = 0; at < line; ++at)
    if (!std::getline(in, text)) return fmt::format("{}:{}", table.file, line);
  const auto all = cells(text);
  const std::size_t cell = table.cells[column];
  if (cell >= all.size()) return fmt::format("{}:{}", table.file, line);
  return place(table.file, line, text, all[cell]);
}

bool same_time(double a, double b) { return std::abs(a - b) <= kInstant; }

}  // namespace obscura::app
