// SPDX-License-Identifier: GPL-3.0-or-later
// Calls Slurm's programs and writes their arguments. The programs are called without a shell and
// without environment variables that would contradict the arguments.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace shearcell {

/// Why a path cannot be passed to Slurm (too long, a backslash, a control character); "" if it can.
std::string unfit_path(const std::filesystem::path& path);

/// Why the text cannot name a folder on each node's own disk; "" if it can. The text must be an
/// absolute path. It may contain environment variables of the node, as in "$TMPDIR/x" or
/// "/scratch/${USER}", but nothing else that a shell would expand.
std::string unfit_scratch(const std::string& text);

/// Replaces the variables in the text by their values on this node. Throws UsageError if a variable
/// is not set on this node, or if the result is not an absolute path.
std::filesystem::path scratch_here(const std::string& text);

/// Converts a time limit to seconds: "MM", "MM:SS", "HH:MM:SS", "D-HH", "D-HH:MM" or "D-HH:MM:SS".
/// Infinity for 0 (no limit) and for all other texts, such as "UNLIMITED".
double slurm_seconds(const std::string& time);

struct Job {
  std::string name;                  ///< name in the queue
  std::string file;                  ///< file name of the script
  std::string script;                ///< text of the script
  std::vector<std::string> command;  ///< `sbatch`, its options, `file`, the script's arguments
};

/// A line of squeue: a task of an array job, or a job that is not an array.
struct QueuedTask {
  std::string name;                   ///< name of the job
  std::string job;                    ///< number of the job, or of the whole array
  std::optional<std::uint64_t> task;  ///< index in the array
  std::string state;                  ///< "PENDING", "RUNNING", "COMPLETING", ...
  std::string reason;                 ///< why the task waits, for example "Priority"
  std::string node;                   ///< where it runs
};

/// Throws ProgramError if `sbatch` is not installed.
void require_slurm();

/// Writes the job's script into `folder`, calls sbatch there, and returns the number of the queued
/// job. Throws ProgramError if sbatch failed and the job is not in the queue. Throws MachineError
/// if it is unknown whether the job is queued.
std::string queue_job(const Job& job, const std::filesystem::path& folder);

/// All waiting, running, suspended and ending jobs with these names, of all users and
/// partitions. Does not call Slurm if there are no names. Throws ProgramError.
std::vector<QueuedTask> ask_queue(const std::vector<std::string>& names);

}  // namespace shearcell
