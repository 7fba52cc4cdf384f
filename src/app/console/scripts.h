#pragma once

#include <string>
#include <vector>

namespace obscura::app {

/// Text as one word of a shell's command line.
std::string shell_word(const std::string& text);

/// A job split into commands for a shell; each writes its exit code into a file of `folder`: prepare.exit,
/// shard-3.exit, join.exit.
struct Errand {
  std::string made;                  // "room.mp4": what it all comes to
  std::string folder;                // "room.mp4.slurm": scripts, logs, exit codes
  std::string where;                 // the folder in which the commands run, absolute
  int tasks = 1, at_once = 0;        // shards; of them side by side, 0: as many as there is room for
  std::string prepare;               // before all shards; empty: nothing is to be done
  std::string shard;                 // of shard "$shard", on $cores cores
  std::vector<int> good{0};          // exit codes of a shard that is whole
  std::string join;                  // after all of them
  std::vector<std::string> options;  // of sbatch, each as one line of #SBATCH
};

/// The plain sbatch scripts of an errand, for a person to read and to change.
std::string prepare_script(const Errand& errand);
std::string shards_script(const Errand& errand);
std::string join_script(const Errand& errand);

/// "1-3,7": numbers, increasing, as --array takes them.
std::string ranges(const std::vector<int>& numbers);

}  // namespace obscura::app
