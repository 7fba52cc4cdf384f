// obscura docs: the reference that the program itself knows, as files of docs/ are made from.

#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "app/commands.h"
#include "app/exit.h"
#include "scene/keys.h"

namespace obscura::app {

void add_docs(CLI::App& program, int& exit) {
  CLI::App* command =
      program.add_subcommand("docs", "Print the reference of scene keys, or their JSON Schema");
  auto what = std::make_shared<std::string>();
  command->add_option("WHAT", *what, "keys (a page in Markdown) or schema (for editors)")
      ->required()
      ->check(CLI::IsMember({"keys", "schema"}));
  command->footer("Examples:\n  obscura docs keys\n  obscura docs schema > scene.schema.json");
  command->callback([what, &exit] {
    fmt::print("{}", *what == "keys" ? scene::keys_page() : scene::json_schema());
    exit = kDone;
  });
}

}  // namespace obscura::app
