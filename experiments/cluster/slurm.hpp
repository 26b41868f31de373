// SPDX-License-Identifier: GPL-3.0-or-later
// Calls Slurm's programs and makes the texts that they read. The programs are called without a
// shell, and without environment variables that would contradict the arguments.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace shearcell {

/// Why a path cannot be passed to Slurm (a backslash or control character); "" when it can.
std::string unfit_path(const std::filesystem::path& path);

/// Why the text cannot be the value of an option of sbatch; "" when it can.
std::string unfit_value(std::string_view text);

/// Why the text cannot name a folder on each node's own disk; "" when it can. It is absolute and
/// may have variables of the node, as "$TMPDIR/x" or "/scratch/${USER}"; nothing else that a shell
/// would expand.
std::string unfit_scratch(const std::string& text);

/// The folder on this node that the text names. Throws UsageError when a variable is not set here,
/// or when the folder is not absolute.
std::filesystem::path scratch_here(const std::string& text);

/// Seconds of a time limit: "MM", "MM:SS", "HH:MM:SS", "D-HH", "D-HH:MM" or "D-HH:MM:SS". Infinity
/// where Slurm sets no limit: "UNLIMITED", "INFINITE" and 0. Nothing for anything else.
std::optional<double> slurm_seconds(const std::string& time);

/// Value of `--output`: patterns in `file` are kept, those in the folder's name are escaped.
std::string output_pattern(const std::filesystem::path& folder, std::string_view file);

struct Job {
  std::string name;                  ///< by which the queue is asked for it
  std::string file;                  ///< of its script
  std::string script;                ///< what the file holds
  std::vector<std::string> command;  ///< `sbatch`, its options, `file`, the script's arguments
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

/// Throws ProgramError when `sbatch` is not installed.
void require_slurm();

/// Writes the job's script into the folder, queues the job from there and returns its number.
/// Throws ProgramError when sbatch refused the job, which is then not in the queue, and
/// MachineError when the job may or may not be queued.
std::string queue_job(const Job& job, const std::filesystem::path& folder);

/// Jobs with these names that wait, run or are about to end, of all users and partitions. Asks
/// Slurm only if there are names. Throws ProgramError.
std::vector<QueuedTask> ask_queue(const std::vector<std::string>& names);

}  // namespace shearcell
