// obscura docs: the reference that the program itself knows, as files of docs/ are made from.

#include <memory>

#include <fmt/format.h>

#include "app/console/command.h"
#include "app/console/commands.h"
#include "app/console/exit.h"
#include "scene/keys.h"

namespace obscura::app {

OBSCURA_COMMAND(130, docs) {
  const Command command(program, exit, "docs", "Print the reference of scene keys, or their JSON Schema");
  auto what = std::make_shared<std::string>();
  command.option("WHAT", *what, "keys (a page in Markdown) or schema (for editors)")
      .required()
      .one_of({"keys", "schema"});
  command.footer("Examples:\n  obscura docs keys\n  obscura docs schema > scene.schema.json");
  command.run([what] {
    fmt::print("{}", *what == "keys" ? scene::keys_page() : scene::json_schema());
    return kDone;
  });
}

}  // namespace obscura::app
