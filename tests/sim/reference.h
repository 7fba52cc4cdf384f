#pragma once

#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "where.h"

namespace obscura::sim {

// The tables of tests/reference.

inline std::ifstream open_reference(const std::string& name) {
  std::ifstream file(OBSCURA_SOURCE_DIR "/tests/reference/" + name);
  if (!file) throw std::runtime_error("no reference " + name);
  return file;
}

/// Rows of a table of numbers, its header left out.
inline std::vector<std::vector<double>> table(const std::string& name) {
  auto file = open_reference(name);
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    rows.push_back(row);
  }
  return rows;
}

/// The values of the line of closed_form.csv that contains all these words.
inline std::vector<double> closed_form(const std::vector<std::string>& words) {
  auto file = open_reference("closed_form.csv");
  for (std::string line; std::getline(file, line);) {
    bool all = true;
    for (const auto& word : words) all = all && line.find(word) != std::string::npos;
    if (!all) continue;
    // the value is what follows the last comma; within it numbers are parted by semicolons
    std::istringstream cells(line.substr(line.rfind(',') + 1));
    std::vector<double> values;
    for (std::string cell; std::getline(cells, cell, ';');) values.push_back(std::stod(cell));
    return values;
  }
  throw std::runtime_error("no closed form for " + words.front());
}

/// Error of a plain double-precision RK4 at step 1/rate, by time: rk4_double_errors.csv.
inline std::map<double, double> rk4_errors(const std::string& name, int rate) {
  auto file = open_reference("rk4_double_errors.csv");
  const std::string start = name + ",1/" + std::to_string(rate) + ",";
  std::map<double, double> errors;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind(start, 0) != 0) continue;
    std::istringstream cells(line.substr(start.size()));
    for (std::string cell; std::getline(cells, cell, ',');) {
      const auto colon = cell.find(':');
      errors[std::stod(cell.substr(0, colon))] = std::stod(cell.substr(colon + 1));
    }
  }
  if (errors.empty()) throw std::runtime_error("no errors for " + start);
  return errors;
}

}  // namespace obscura::sim
