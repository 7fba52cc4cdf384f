#pragma once

#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/console/table.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace obscura::app {

/// One option of a command's line. CLI11, which is long to compile, is included only where a line is read,
/// and not in every command.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  /// The placeholder for its value in --help, as in SECONDS.
  Option type(const char* name) const;
  Option required() const;
  /// One of these words, else a usage error.
  Option one_of(std::vector<std::string> words) const;
  /// From `least` to `most`, both allowed, else a usage error.
  Option range(double least, double most) const;
  /// May be given again, with one value each time.
  Option repeated() const;

 private:
  CLI::Option* option_;
};

/// A command of the program: its line, and what it does.
class Command {
 public:
  /// `program` keeps it; `exit` is where its exit code goes.
  Command(CLI::App& program, int& exit, const char* name, const char* about);

  /// An option with a value, as in "-o,--output", or what stands at a place, as in SCENE. `value` is written
  /// when the line is read, and has to live until then.
  Option option(const char* names, std::string& value, const std::string& about) const;
  Option option(const char* names, std::vector<std::string>& value, const std::string& about) const;
  Option option(const char* names, std::optional<std::string>& value, const std::string& about) const;
  Option option(const char* names, int& value, const std::string& about) const;
  Option option(const char* names, std::optional<int>& value, const std::string& about) const;
  Option option(const char* names, double& value, const std::string& about) const;
  Option option(const char* names, std::optional<double>& value, const std::string& about) const;
  /// An option with an action that runs as soon as its value is parsed.
  Option option(const char* names, std::function<void(const std::string&)> with,
                const std::string& about) const;
  /// true where it is given.
  Option flag(const char* names, bool& value, const std::string& about) const;

  /// One of the named values.
  template <class T>
  Option choice(const char* names, T& value, std::initializer_list<std::pair<const char*, T>> words,
                const std::string& about) const {
    std::vector<std::pair<std::string, int>> numbered;
    for (const auto& [word, meant] : words) numbered.emplace_back(word, int(meant));
    return choose(
        names, std::move(numbered), [&value](int chosen) { value = T(chosen); }, about);
  }

  /// The end of --help.
  void footer(const std::string& text) const;
  /// Runs the command; returns its exit code.
  void run(std::function<int()> what) const;
  /// The program's own name, as it was called.
  std::string program() const;
  /// What --help of the program and of all its commands is made of.
  CommandTables tables() const;

 private:
  Option choose(const char* names, std::vector<std::pair<std::string, int>> words,
                std::function<void(int)> with, const std::string& about) const;

  CLI::App* app_;
  int* exit_;
};

}  // namespace obscura::app
