// SPDX-License-Identifier: GPL-3.0-or-later
// The Slurm interface: the scripts that it runs (an array of tasks, and the merge job that merges
// their stores), and calls of its programs, with argument vectors instead of a shell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace shearcell {

/// Options for Slurm. Empty texts leave the choice to the cluster.
struct JobOptions {
  std::string partition;
  std::string account;
  std::string time;                 ///< limit of one start of a task, in Slurm's own form
  std::size_t cpus = 0;             ///< of a task; 0 if not chosen yet
  std::size_t threads = 1;          ///< inside each run
  std::size_t warn_seconds = 120;   ///< before the limit
  std::vector<std::string> sbatch;  ///< further options, as "--qos=long"
  std::string scratch;              ///< folder on a node's own disk
};

struct JobPlaces {
  std::filesystem::path program;  ///< this program
  std::filesystem::path store;    ///< main store, into which the stores of the tasks are merged
  std::filesystem::path folder;   ///< of the submission; holds task-1, task-2, ...
};

/// Why a path cannot be passed to Slurm (a backslash or control character); "" when it can.
std::string unfit_path(const std::filesystem::path& path);

/// Why the text cannot be an option's value in a script; "" when it can.
std::string unfit_value(std::string_view text);

/// Seconds of a time limit: "MM", "MM:SS", "HH:MM:SS", "D-HH", "D-HH:MM" or "D-HH:MM:SS". Nothing
/// for anything else.
std::optional<double> slurm_seconds(std::string_view time);

/// Script of the array job: task n works on FOLDER/task-n. It ends with the program's exit code,
/// and is queued again when its time is over.
std::string array_script(const JobOptions& options, const JobPlaces& places, std::size_t tasks);

/// Script of the merge job: merges the store of every task into STORE, one after the other. It
/// ends with the last exit code that was not 0.
std::string merge_script(const JobOptions& options, const JobPlaces& places, std::size_t tasks);

/// Value of `--output`: patterns in `file` are kept, those in the folder's name are escaped.
std::string output_pattern(const std::filesystem::path& folder, std::string_view file);

/// One line of the queue.
struct QueuedTask {
  std::string name;                   ///< of the job
  std::string job;                    ///< number of the job, or of the whole array
  std::optional<std::uint64_t> task;  ///< place in the array
  std::string state;                  ///< "PENDING", "RUNNING", "COMPLETING", ...
  std::string reason;                 ///< why it waits, as "Priority"
  std::string node;                   ///< where it runs
};

/// Throws ProgramError when `sbatch` is not installed.
void require_slurm();

/// Queues the script `folder/script` as a job of this name and returns its number. Throws
/// ProgramError, with Slurm's answer, when it refuses.
std::string queue_job(const std::filesystem::path& folder, const std::string& script,
                      const std::string& name, const std::vector<std::string>& options);

/// The jobs of these names that wait, run or are about to end. Throws ProgramError.
std::vector<QueuedTask> ask_queue(const std::vector<std::string>& names);

/// What `squeue` printed, line by line; other lines are skipped.
std::vector<QueuedTask> read_queue(const std::string& output);

}  // namespace shearcell
