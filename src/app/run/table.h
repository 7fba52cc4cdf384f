#pragma once

#include <optional>
#include <string>
#include <vector>

namespace obscura::app {

/// A run as a table: a row an instant, a column a quantity, as `obscura states --format csv` writes it or
/// another program does: "time", "ball.position.x", ...
struct Table {
  std::string file;
  std::vector<std::string> columns;  // without "hash", which is no number
  std::vector<std::vector<double>> rows;
  std::vector<int> lines;          // of the file, from 1, one a row
  int head = 1;                    // the line of names
  std::vector<std::size_t> cells;  // which of a line's cells each column is

  /// The index of a column; empty if there is no such column.
  std::optional<std::size_t> column(const std::string& name) const;
  double time(std::size_t row) const { return rows[row][time_column]; }
  std::size_t time_column = 0;
  bool json = false;                // `lines` are the numbers of its states, from 1
  std::vector<std::string> unread;  // what else it has, in words: "hash", "bodies.at_rest"
};

/// Reads a run as `obscura states` writes it, as CSV or as JSON; in CSV numbers separated by commas under one
/// line of names; lines that begin with # and empty ones are skipped. Times must increase. Throws
/// media::Error with the place where something is no number or missing.
Table read_table(const std::string& file);

/// The same of JSON.
Table table_of_json(const std::string& file, const std::string& text);

/// Adds a row. False, and nothing is added, where its time is not finite or not after the last one's.
bool add_row(std::vector<double> numbers, int line, Table& table);

/// The place of a column's cell in a line of the file: "run.csv:17:42". For a file that cannot be read again,
/// as from a pipe, "run.csv:17"; for JSON "run.json, state 3".
std::string place(const Table& table, int line, std::size_t column);

/// Two times, s, that are one: within half a microsecond.
bool same_time(double a, double b);

}  // namespace obscura::app
