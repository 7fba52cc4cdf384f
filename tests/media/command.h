#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

namespace obscura::media {

/// What a shell command prints on standard output.
inline std::string output_of(const std::string& command) {
  std::string text;
  std::FILE* pipe = popen(command.c_str(), "r");
  char buffer[4096];
  while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) text.append(buffer, n);
  EXPECT_EQ(pclose(pipe), 0) << command;
  return text;
}

/// The values ffprobe gives for `entries` of the first stream or its packets, a line each.
inline std::vector<std::string> probe(const std::string& path, const std::string& entries) {
  std::istringstream lines(output_of("ffprobe -v error -select_streams v:0 -show_entries " + entries +
                                     " -of default=noprint_wrappers=1:nokey=1 '" + path + "'"));
  std::vector<std::string> values;
  for (std::string line; std::getline(lines, line);) values.push_back(line);
  return values;
}

}  // namespace obscura::media
