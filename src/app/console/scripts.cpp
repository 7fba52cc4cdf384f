#include "app/console/scripts.h"

#include <algorithm>

#include <fmt/format.h>

namespace obscura::app {

namespace {

std::string heading(const Errand& errand, const std::string& what, const std::string& run,
                    const std::string& name, const std::string& log) {
  std::string text = fmt::format(
      "#!/bin/sh\n"
      "# {} of {}. Written by obscura submit and yours to change: the next submit leaves it as it is.\n"
      "#   {}\n"
      "#SBATCH --job-name={}\n"
      "#SBATCH --chdir={}\n"
      "#SBATCH --output={}/{}.log\n"
      "#SBATCH --open-mode=append\n"
      "#SBATCH --requeue\n"
      "#SBATCH --signal=B:TERM@60\n",
      what, errand.made, run, shell_word("obscura-" + name), shell_word(errand.where),
      shell_word(errand.where + "/" + errand.folder), log);
  for (const std::string& option : errand.options) text += "#SBATCH " + option + "\n";
  return text;
}

// runs a command as SIGTERM can reach it, and puts its exit code down
std::string body(const Errand& errand, const std::string& command, const std::string& name,
                 const std::string& judged) {
  return fmt::format(
      "\n"
      "cores=${{SLURM_CPUS_PER_TASK:-1}}\n"
      "{} &\n"
      "# SIGTERM (preemption, a minute before the end of the time limit) is handed on: whole parts stay\n"
      "child=$!\n"
      "trap 'kill -TERM $child' TERM\n"
      "wait $child; code=$?\n"
      "while kill -0 $child 2>/dev/null; do wait $child; code=$?; done\n"
      "# the same SIGTERM may reach what follows too\n"
      "trap '' TERM\n"
      "{}"
      "echo $code >{}/{}.exit\n"
      "# told to stop, once (130) or twice (143), and not by scancel: it queues again and goes on from "
      "there\n"
      "# (SIGNALING: it runs, and a signal is on its way)\n"
      "case $code in 130 | 143)\n"
      "  if scontrol show job -o \"$SLURM_JOB_ID\" | grep -Eq ' JobState=(RUNNING|SIGNALING) '; then\n"
      "    scontrol requeue \"$SLURM_JOB_ID\" && sleep 60\n"
      "  fi ;;\n"
      "esac\n"
      "exit $code\n",
      command, judged, shell_word(errand.folder), name);
}

}  // namespace

std::string shell_word(const std::string& text) {
  const bool plain = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '/' || c == '.' || c == '_' || c == '-' || c == '=' || c == ':' ||
           c == ',';
  });
  if (plain) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

std::string ranges(const std::vector<int>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t end = i + 1;
    while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
    text += (i ? "," : "") + (end == i + 1 ? fmt::format("{}", numbers[i])
                                           : fmt::format("{}-{}", numbers[i], numbers[end - 1]));
    i = end;
  }
  return text;
}

std::string prepare_script(const Errand& errand) {
  return heading(errand, "What comes before the shards",
                 fmt::format("sbatch {}/prepare.sbatch", errand.folder), "prepare", "prepare") +
         body(errand, errand.prepare, "prepare", "");
}

std::string shards_script(const Errand& errand) {
  std::string judged;
  for (const int code : errand.good)
    if (code != 0) judged += fmt::format("[ $code != {} ] || code=0\n", code);
  return heading(errand, fmt::format("One of the {} shards", errand.tasks),
                 fmt::format("sbatch --array=1-{} {}/shards.sbatch", errand.tasks, errand.folder), "shards",
                 "shard-%a") +
         "\nshard=$SLURM_ARRAY_TASK_ID" + body(errand, errand.shard, "shard-$shard", judged);
}

std::string join_script(const Errand& errand) {
  return heading(errand, "What comes after the shards", fmt::format("sbatch {}/join.sbatch", errand.folder),
                 "join", "join") +
         body(errand, errand.join, "join",
              fmt::format("# what it misses is looked for in all shards: those that are whole are quick\n"
                          "[ $code = 0 ] || rm -f {}/shard-*.exit\n",
                          shell_word(errand.folder)));
}

}  // namespace obscura::app
