#include "app/console/command.h"

#include <algorithm>
#include <sstream>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "app/console/options.h"
#include "app/console/waiting.h"
#include "scene/complaints.h"

namespace obscura::app {

namespace {

CLI::Validator known(const std::vector<std::string>& words) {
  const auto unknown = [words](const std::string& text) {
    if (std::find(words.begin(), words.end(), text) != words.end()) return std::string();
    return fmt::format("'{}' is not one of {}{}", text, fmt::join(words, ", "),
                       scene::did_you_mean(text, {words.begin(), words.end()}));
  };
  // under this name table_of() finds the words again
  return CLI::Validator(unknown, "", fmt::format("{}", fmt::join(words, ",")));
}

// of "FLOAT:in [1 - 63]" the placeholder and "1 to 63"
std::pair<std::string, std::string> value_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t end = type.find(':'), range = type.find("in ["), to = type.find(" - ");
  if (range == std::string::npos || to == std::string::npos) return {type.substr(0, end), ""};
  const std::size_t least = range + 4, most = to + 3;
  return {type.substr(0, end),
          fmt::format("{} to {}", type.substr(least, to - least), type.substr(most, type.find(']') - most))};
}

OptionRow row_of(CLI::Option& option) {
  OptionRow row;
  for (const std::string& name : option.get_snames()) row.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) row.names.push_back("--" + name);
  row.about = option.get_description();
  row.required = option.get_required();
  row.repeated = option.get_items_expected_max() > 1 ||
                 option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
  if (option.get_positional()) {
    row.value = option.get_name(true);
  } else if (option.get_items_expected_max() > 0) {
    std::tie(row.value, row.range) = value_of(option);
  }
  try {
    std::istringstream words(option.get_validator(0)->get_name());
    for (std::string word; std::getline(words, word, ',');) row.words.push_back(word);
  } catch (const CLI::OptionNotFound&) {  // takes anything
  }
  return row;
}

CommandTable table_of(CLI::App& command, const std::string& name) {
  CommandTable table{name, command.get_description(), command.get_footer(), {}};
  for (CLI::Option* option : command.get_options()) table.options.push_back(row_of(*option));
  return table;
}

}  // namespace

Option Option::type(const char* name) const { return Option(option_->type_name(name)); }
Option Option::required() const { return Option(option_->required()); }
Option Option::one_of(std::vector<std::string> words) const {
  return Option(option_->check(known(words).description(fmt::format("{{{}}}", fmt::join(words, ",")))));
}
Option Option::range(double least, double most) const {
  const auto outside = [=](std::string& text) {
    double value = 0;
    if (CLI::detail::lexical_cast(text, value) && value >= least && value <= most) return std::string();
    return fmt::format("{} is not from {} to {}", text, least, most);
  };
  return Option(option_->check(CLI::Validator(outside, fmt::format("in [{} - {}]", least, most))));
}
Option Option::repeated() const {
  // if extra arguments were allowed, it would swallow a -- behind it
  return Option(option_->expected(1)->allow_extra_args(false)->take_all());
}

Command::Command(CLI::App& program, int& exit, const char* name, const char* about)
    : app_(program.add_subcommand(name, about)), exit_(&exit) {}

Option Command::option(const char* names, std::string& value, const std::string& about) const {
  return Option(app_->add_option(names, value, about));
}
Option Command::option(const char* names, std::vector<std::string>& value, const std::string& about) const {
  return Option(app_->add_option(names, value, about));
}
Option Command::option(const char* names, std::optional<std::string>& value, const std::string& about) const {
  return Option(app_->add_option(names, value, about));
}
Option Command::option(const char* names, int& value, const std::string& about) const {
  return Option(app_->add_option(names, value, about));
}
Option Command::option(const char* names, std::optional<int>& value, const std::string& about) const {
  return Option(app_->add_option(names, value, about));
}
Option Command::option(const char* names, double& value, const std::string& about) const {
  return Option(app_->add_option(names, value, about));
}
Option Command::option(const char* names, std::optional<double>& value, const std::string& about) const {
  return Option(app_->add_option(names, value, about));
}
Option Command::option(const char* names, std::function<void(const std::string&)> with,
                       const std::string& about) const {
  return Option(app_->add_option_function<std::string>(names, std::move(with), about));
}
Option Command::flag(const char* names, bool& value, const std::string& about) const {
  return Option(app_->add_flag(names, value, about));
}

Option Command::choose(const char* names, std::vector<std::pair<std::string, int>> words,
                       std::function<void(int)> with, const std::string& about) const {
  std::vector<std::string> all;
  for (const auto& [word, meant] : words) all.push_back(word);
  const auto chosen = [words = std::move(words), with = std::move(with)](const std::string& text) {
    for (const auto& [word, meant] : words) {
      if (word == text) with(meant);
    }
  };
  return Option(app_->add_option_function<std::string>(names, chosen, about)->check(app::known(all)));
}

void Command::footer(const std::string& text) const { app_->footer(text); }
void Command::run(std::function<int()> what) const {
  if (!app_->get_option_no_throw("--memory-limit")) add_memory_limit(*this);
  app_->callback([what = std::move(what), exit = exit_, app = app_] {
    // a progress of another kind than on a terminal, or none, is asked for
    const CLI::Option* progress = app->get_option_no_throw("--progress");
    const bool shown = !progress || progress->count() == 0 || progress->results().front() == "auto";
    const Waiting waiting(shown ? app->get_name() : "");
    *exit = what();
  });
}
std::string Command::program() const { return app_->get_parent()->get_name(); }

CommandTables Command::tables() const {
  CLI::App& program = *app_->get_parent();
  CommandTables tables{table_of(program, "obscura")};
  for (CLI::App* command : program.get_subcommands({}))
    tables.push_back(table_of(*command, command->get_name()));
  return tables;
}

}  // namespace obscura::app
