#pragma once

#include <map>
#include <string>
#include <vector>

namespace obscura::app::slurm {

// Queries of Slurm, by its own commands.

/// The largest number that a task of an array may have. Throws media::Error where there is no Slurm, or it
/// does not answer.
int last_task();

/// Hands a script in: `options` go before its name. Returns the job's number. Throws media::Error with what
/// sbatch says.
std::string submit(const std::string& script, const std::vector<std::string>& options);

/// A job's state as Slurm reports it: "RUNNING", and the reason why it waits, as "launch failed requeued
/// held"; "None" if it does not wait.
struct State {
  std::string name, reason;
};

/// The states of jobs, under "12", or "12_3" for task 3 of an array. Jobs that Slurm has forgotten are
/// absent. False: Slurm does not answer now.
bool states(const std::vector<std::string>& jobs, std::map<std::string, State>& found);

/// Ends jobs.
void cancel(const std::vector<std::string>& jobs);

/// Whether such a job may still do something.
bool lives(const State& state);

/// Whether it is held until a user releases it.
bool held(const State& state);

}  // namespace obscura::app::slurm
