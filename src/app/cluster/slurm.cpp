#include "app/cluster/slurm.h"

#include <sys/wait.h>

#include <array>
#include <charconv>
#include <cstdio>
#include <sstream>

#include <fmt/format.h>

#include "app/console/scripts.h"
#include "media/error.h"

namespace obscura::app::slurm {

namespace {

struct Reply {
  int exit = 127;
  std::string text;
};

// a command's output, errors too
Reply ask(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += shell_word(word) + " ";
  Reply said;
  std::FILE* pipe = ::popen((line + "2>&1").c_str(), "r");
  if (!pipe) return said;
  std::array<char, 65536> buffer{};
  for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    said.text.append(buffer.data(), n);
  const int status = ::pclose(pipe);
  if (WIFEXITED(status)) said.exit = WEXITSTATUS(status);
  return said;
}

// a complaint on one line
std::string line_of(const std::string& text) {
  std::string line;
  for (const char c : text) line += c == '\n' ? ' ' : c;
  while (!line.empty() && line.back() == ' ') line.pop_back();
  return line;
}

std::string config() {
  const Reply said = ask({"scontrol", "show", "config"});
  if (said.exit == 127)
    throw media::Error(
        "scontrol: there is no Slurm here; --dry-run shows the scripts, docs/shards.md shows how to do "
        "without");
  if (said.exit != 0) throw media::Error("Slurm does not answer: " + line_of(said.text));
  return said.text;
}

}  // namespace

int last_task() {
  const std::string all = config();
  const std::size_t at = all.find("MaxArraySize");
  const std::size_t digit = at == all.npos ? all.npos : all.find_first_of("0123456789", at);
  int size = 1001;  // Slurm's default
  if (digit != all.npos) std::from_chars(all.data() + digit, all.data() + all.size(), size);
  return size - 1;
}

std::string submit(const std::string& script, const std::vector<std::string>& options) {
  std::vector<std::string> words{"sbatch", "--parsable"};
  words.insert(words.end(), options.begin(), options.end());
  words.push_back(script);
  const Reply said = ask(words);
  // "12", "12;cluster", behind whatever a site's own filters say
  const std::size_t last = said.text.find_last_not_of('\n');
  const std::size_t begin = said.text.rfind('\n', last) + 1;
  const std::string job = said.text.substr(begin, said.text.find_first_not_of("0123456789", begin) - begin);
  if (said.exit != 0 || job.empty())
    throw media::Error(fmt::format("{}: sbatch refuses it: {}", script, line_of(said.text)));
  return job;
}

bool states(const std::vector<std::string>& jobs, std::map<std::string, State>& found) {
  for (const std::string& job : jobs) {
    const Reply said =
        ask({"squeue", "--noheader", "--array", "--states=all", "--jobs=" + job, "--format=%i %T %r"});
    if (said.exit != 0) {
      // a job that ended long ago is forgotten
      if (said.text.find("Invalid job id") != said.text.npos) continue;
      return false;
    }
    std::istringstream lines(said.text);
    std::string name;
    for (State state; lines >> name >> state.name && std::getline(lines >> std::ws, state.reason);)
      found[name] = state;
  }
  return true;
}

void cancel(const std::vector<std::string>& jobs) {
  for (const std::string& job : jobs) (void)ask({"scancel", job});
}

bool lives(const State& job) {
  const std::string& state = job.name;
  return state == "PENDING" || state == "RUNNING" || state == "CONFIGURING" || state == "COMPLETING" ||
         state == "SUSPENDED" || state == "STOPPED" || state == "SIGNALING" || state == "STAGE_OUT" ||
         state == "RESIZING" || state.starts_with("REQUEUE") || state == "SPECIAL_EXIT";
}

bool held(const State& state) {
  // "JobHeldUser", "JobHeldAdmin", "job requeued in held state", "launch failed requeued held"
  return state.name == "PENDING" &&
         (state.reason.find("held") != state.reason.npos || state.reason.find("Held") != state.reason.npos);
}

}  // namespace obscura::app::slurm
