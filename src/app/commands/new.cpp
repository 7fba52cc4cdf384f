// obscura new: a short commented scene to start from.

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "app/compare/report.h"
#include "app/console/command.h"
#include "app/console/commands.h"
#include "app/console/exit.h"
#include "app/console/say.h"
#include "media/error.h"
#include "media/file.h"
#include "scene/keys.h"
#include "scene/utf8.h"

namespace obscura::app {

namespace {

int make(const std::string& name, const std::string& program) {
  namespace fs = std::filesystem;
  fs::path path(name);
  if (path.extension() == ".toml") path.replace_extension();
  if (path.filename().empty()) throw UsageError("new needs a name, as in ball or lectures/pendulum");
  if (!scene::is_path_name(path.filename().string()))
    throw UsageError(fmt::format("new {}: expected {}", name, scene::kPathName));
  path += ".toml";
  if (fs::exists(path)) throw media::Error(fmt::format("{}: is there already", path.string()));
  media::make_folder_of(path.string());
  write_text(path.string(), scene::new_scene(path.stem().string()));
  const std::string name_in_shell =
      path.string().find(' ') == std::string::npos ? path.string() : "'" + path.string() + "'";
  say(stdout, "{} is written. Film it: {} render {}\n", path.string(), program, name_in_shell);
  return kDone;
}

}  // namespace

OBSCURA_COMMAND(40, new) {
  const Command command(program, exit, "new", "Write a short commented scene to start from");
  auto name = std::make_shared<std::string>();
  command.option("NAME", *name, "The scene's name: writes NAME.toml, never over an existing file").required();
  command.footer("Examples:\n  obscura new ball\n  obscura new lectures/pendulum.toml");
  command.run([name, command] { return make(*name, command.program()); });
}

}  // namespace obscura::app
