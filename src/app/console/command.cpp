#include "app/console/command.h"

#include <algorithm>

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
  return CLI::Validator(unknown, "");
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

}  // namespace obscura::app
