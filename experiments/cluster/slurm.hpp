// SPDX-License-Identifier: GPL-3.0-or-later
// Calls Slurm's own programs, with argument vectors.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace shearcell {

/// Slurm is missing, does not answer, or refuses. The message holds its answer and the remedy.
class ClusterError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One line of the queue.
struct QueuedTask {
  std::string name;                   ///< of the job
  std::string job;                    ///< number of the job, or of the whole array
  std::optional<std::uint64_t> task;  ///< place in the array
  std::string state;                  ///< "PENDING", "RUNNING", "COMPLETING", ...
  std::string reason;                 ///< why it waits, as "Priority"
  std::string node;                   ///< where it runs
};

/// Throws ClusterError when `sbatch` is not installed.
void require_slurm();

/// Queues the script `folder/script` as a job of this name and returns its number. Throws
/// ClusterError.
std::string queue_job(const std::filesystem::path& folder, const std::string& script,
                      const std::string& name, const std::vector<std::string>& options);

/// The jobs of these names that wait, run or are about to end. Throws ClusterError.
std::vector<QueuedTask> ask_queue(const std::vector<std::string>& names);

/// What `squeue` printed, line by line; other lines are skipped.
std::vector<QueuedTask> read_queue(const std::string& output);

}  // namespace shearcell
