#pragma once

#include <map>
#include <string>
#include <vector>

namespace obscura::app::slurm {

// What is asked of Slurm, by its own commands.

/// The largest number that a task of an array may have. Throws media::Error where there is no Slurm, or it
/// does not answer.
int last_task();

/// Hands a script in: `options` go before its name. Returns the job's number. Throws media::Error with what
/// sbatch says.
std::string submit(const std::string& script, const std::vector<std::string>& options);

/// The states of jobs, as "RUNNING", under "12", or "12_3" for task 3 of an array. What Slurm has forgotten
/// is not there. False: Slurm does not answer now.
bool states(const std::vector<std::string>& jobs, std::map<std::string, std::string>& found);

/// Ends jobs.
void cancel(const std::vector<std::string>& jobs);

/// Whether such a job may still do something.
bool lives(const std::string& state);

}  // namespace obscura::app::slurm
