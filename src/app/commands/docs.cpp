// obscura docs: the reference that the program itself knows, as files of docs/ are made from, its manual
// pages and what shells complete its lines by.

#include <memory>

#include <fmt/format.h>

#include "app/console/command.h"
#include "app/console/commands.h"
#include "app/console/completion.h"
#include "app/console/exit.h"
#include "app/console/manual.h"
#include "scene/keys.h"

namespace obscura::app {

namespace {

std::string page(const std::string& what, const std::string& of, const CommandTables& tables) {
  if (what != "man" && !of.empty()) throw UsageError("docs " + what + ": COMMAND is for man");
  if (what == "keys") return scene::keys_page();
  if (what == "schema") return scene::json_schema();
  if (what == "man") return manual(tables, of);
  if (what == "bash") return bash_completion(tables);
  if (what == "zsh") return zsh_completion(tables);
  return fish_completion(tables);
}

}  // namespace

OBSCURA_COMMAND(130, docs) {
  const Command command(
      program, exit, "docs",
      "Print the reference of scene keys, their JSON Schema, manual pages or completion for shells");
  auto what = std::make_shared<std::string>();
  auto of = std::make_shared<std::string>();
  command
      .option("WHAT", *what,
              "keys (a page in Markdown), schema (for editors), man (a manual page), or what completes lines "
              "in bash, "
              "zsh or fish")
      .required()
      .one_of({"keys", "schema", "man", "bash", "zsh", "fish"});
  command.option("COMMAND", *of, "With man: the command that the page is about [the program]");
  command.footer(
      "Examples:\n"
      "  obscura docs keys\n"
      "  obscura docs schema > scene.schema.json\n"
      "  obscura docs man render | man -l -\n"
      "  source <(obscura docs bash)");
  command.run([what, of, command] {
    fmt::print("{}", page(*what, *of, command.tables()));
    return kDone;
  });
}

}  // namespace obscura::app
