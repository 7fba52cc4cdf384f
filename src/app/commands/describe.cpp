// obscura describe: what happens in a scene, in sentences.

#include <memory>

#include "app/console/command.h"
#include "app/console/commands.h"
#include "app/console/exit.h"
#include "app/console/memory.h"
#include "app/console/options.h"
#include "app/console/say.h"
#include "app/run/description.h"
#include "app/run/run_marks.h"
#include "app/run/trouble.h"
#include "scene/scene.h"

namespace obscura::app {

namespace {

struct DescribeFlags {
  std::string scene;
  std::vector<std::string> sets;
};

int describe(const DescribeFlags& flags) {
  const scene::Scene scene = with_run_marks(scene::read(flags.scene, flags.sets));
  warn_of_steps(scene);
  const Story told = story(scene);
  for (const std::string& sentence : told.sentences) say(stdout, "{}\n", sentence);
  if (told.trouble) throw TroubleError(scene.file, *told.trouble, "");
  return kDone;
}

}  // namespace

OBSCURA_COMMAND(65, describe) {
  const Command command(program, exit, "describe", "Say what happens in a scene, in sentences, from its run");
  auto flags = std::make_shared<DescribeFlags>();
  add_scene(command, flags->scene);
  add_sets(command, flags->sets);
  add_memory_limit(command);
  command.footer(
      "For those who do not see the film, and as a text to start from. All "
      "numbers are the run's.\n\n"
      "Examples:\n"
      "  obscura describe scenes/room.toml\n"
      "  obscura describe scenes/slope.toml --set block.friction=0.7");
  command.run([flags] { return describe(*flags); });
}

}  // namespace obscura::app
