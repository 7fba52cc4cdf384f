#pragma once

#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "where.h"

// every test that comes to its end comes to it by itself: this one ends what hangs, and not what is slow
#define OBSCURA_NOT_FOR_EVER "timeout -s KILL 1500 "

namespace obscura::app {

struct Outcome {
  int exit = -1;
  std::string out;  // what it wrote to standard output
  std::string err;  // and to standard error
};

inline std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The cells of a table in CSV without quotes, line by line.
inline std::vector<std::vector<std::string>> cells(const std::string& table) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream row(line + ",");
    for (std::string cell; std::getline(row, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

/// A folder of its own for each test, and the program run in it through a shell.
class Program : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("obscura_" + std::string(test->name()) + "_" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Any shell command, run in the folder.
  Outcome shell(const std::string& command) const {
    Outcome outcome;
    const std::string err = path(".stderr");
    const std::string line = "cd '" + folder_.string() + "' && { " + command + " ; } 2> '" + err + "'";
    std::FILE* pipe = ::popen(line.c_str(), "r");
    char buffer[65536];
    for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) outcome.out.append(buffer, n);
    const int status = ::pclose(pipe);
    outcome.exit = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    outcome.err = contents(err);
    return outcome;
  }
  Outcome obscura(const std::string& arguments) const { return shell(OBSCURA_BINARY " " + arguments); }

  /// The program, with a fault or a signal at the n-th of its calls that change what lies in out/: what
  /// `with`, `calls` and the rest are, tests/faults/preload/faults.cpp says. The call that met it is told in
  /// the file met.
  std::string meeting(const std::string& with, long n, const std::string& calls = "",
                      const std::string& more = "") const {
    std::filesystem::remove(path("met"));
    return "env --default-signal=INT,TERM,HUP FAULTS_UNDER='" + path("out") + "' FAULTS_LOG='" + path("met") +
           "' FAULTS_WITH=" + with + " FAULTS_NTH=" + std::to_string(n) +
           (calls.empty() ? "" : " FAULTS_CALLS=" + calls) + (more.empty() ? "" : " " + more) +
           " ASAN_OPTIONS=verify_asan_link_order=0:detect_leaks=0 LD_PRELOAD=" OBSCURA_FAULTS
           " " OBSCURA_BINARY " ";
  }
  /// Shell words that wait until something is so of the process of this number, or it has ended.
  static std::string until(const std::string& pid, const std::string& condition) {
    return "until grep -q '^State:[[:space:]]*Z' /proc/" + pid + "/status || " + condition +
           "; do sleep 0.01; done; ";
  }
  /// Until STOP has stopped it. The file met is there a moment earlier, and a CONT in between would be lost.
  static std::string until_stopped(const std::string& pid) {
    return until(pid, "grep -q '^State:[[:space:]]*T' /proc/" + pid + "/status");
  }
  /// Until it heeds SIGTERM, the 15th bit of the signals that it catches.
  static std::string until_heeding(const std::string& pid) {
    return until(pid,
                 "[ $(( 0x$(sed -n 's/^SigCgt:[[:space:]]*//p' /proc/" + pid + "/status) >> 14 & 1 )) = 1 ]");
  }
  bool met() const { return std::filesystem::exists(path("met")); }

  /// Writes a scene of `text` and returns its name.
  std::string scene(const std::string& text, const std::string& name = "scene.toml") const {
    std::ofstream(path(name), std::ios::binary) << text;
    return name;
  }

  std::filesystem::path folder_;
};

/// A room where everything of the language's first version moves.
inline const char* const kRoom = R"(
title    = "A room"
subtitle = "everything moves"
duration = 10
[room]
size     = [8, 4.5]
[[particle]]
name     = "ball"
position = [1, 3]
velocity = [1.2, 0]
radius   = 0.1
elasticity = 0.9
[[box]]
name     = "crate"
size     = [1.0, 0.5]
position = [5, 2]
angle    = 30
spin     = 90
elasticity = 0.7
[[spring]]
between = ["ball", [2, 4.4]]
stiffness = 20
rest_length = 1
[[mouse]]
path = [[1.0, 4, 3], [2.0, 5.5, 3.8], [3.0, 7, 3.5]]
stiffness = 60
[look]
trails = 0.5
arrows = ["velocity"]
)";

/// A second of a crate on a spring and a ball: short, for what is filmed many times.
inline const char* const kCrateAndBall = R"(duration = 1
[room]
size = [4, 2.25]
[[box]]
name = "crate"
size = [0.8, 0.5]
position = [1, 1]
velocity = [1, 1]
spin = 90
mass = 1.5
color = "green"
[[ball]]
name = "ball"
radius = 0.2
position = [3, 1]
velocity = [-1, 0]
[[spring]]
between = ["crate", [1, 2.2]]
stiffness = 20
)";

/// A spring far too stiff for Runge-Kutta at this rate: it tears itself apart.
inline const char* const kTorn = R"(
duration = 5
[physics]
rate = 60
[[particle]]
name = "ball"
position = [4, 2]
mass = 1
[[spring]]
between = ["ball", [4, 4]]
stiffness = 40000
rest_length = 1.9
)";

}  // namespace obscura::app
