// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cluster/slurm.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <optional>
#include <sstream>

#include "provenance/io/child_process.hpp"

namespace shearcell {
namespace {

constexpr const char* kNoSlurm =
    "{} is not installed here (Debian package slurm-client); submit from a machine of the cluster, "
    "or see what would be submitted with --dry-run";

std::string trimmed(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text;
}

// Slurm's own limit for an answer of its controller is 10 s.
constexpr double kAnswerSeconds = 15;

// `seconds` only for questions: a job may be queued although sbatch does not answer.
std::string ask(const std::vector<std::string>& words, const std::filesystem::path& folder,
                std::optional<double> seconds = std::nullopt) {
  std::optional<ProgramOutcome> outcome;
  try {
    outcome = run_program(words, folder, {}, seconds);
  } catch (const ProgramError& problem) {
    throw ClusterError(problem.what());
  }
  if (!outcome) throw ClusterError(fmt::format(fmt::runtime(kNoSlurm), words.front()));
  if (outcome->code != 0) {
    throw ClusterError(fmt::format("{} failed: {}", words.front(), trimmed(outcome->messages)));
  }
  return outcome->output;
}

bool is_number(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

void require_slurm() {
  ask({"sbatch", "--version"}, "/", kAnswerSeconds);
}

std::string queue_job(const std::filesystem::path& folder, const std::string& script,
                      const std::string& name, const std::vector<std::string>& options) {
  std::vector<std::string> words = {"sbatch", "--parsable", "--job-name=" + name};
  words.insert(words.end(), options.begin(), options.end());
  words.push_back(script);
  const std::string answer = ask(words, folder);
  std::string job = trimmed(answer.substr(0, answer.find(';')));  // then the cluster's name
  if (!is_number(job)) {
    throw ClusterError(fmt::format("sbatch gave no job number but '{}'", trimmed(answer)));
  }
  return job;
}

std::vector<QueuedTask> ask_queue(const std::vector<std::string>& names) {
  if (names.empty()) return {};
  return read_queue(ask({"squeue", "--noheader", "--array", "--format=%j|%F|%K|%T|%r|%N",
                         fmt::format("--name={}", fmt::join(names, ","))},
                        "/", kAnswerSeconds));
}

std::vector<QueuedTask> read_queue(const std::string& output) {
  std::vector<QueuedTask> tasks;
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> fields;
    std::istringstream rest(line);
    for (std::string field; std::getline(rest, field, '|');) fields.push_back(trimmed(field));
    fields.resize(std::max<std::size_t>(6, fields.size()));
    if (!is_number(fields[1])) continue;
    QueuedTask task{.name = fields[0],
                    .job = fields[1],
                    .task = {},
                    .state = fields[3],
                    .reason = fields[4] == "None" ? "" : fields[4],
                    .node = fields[5]};
    std::uint64_t number = 0;
    const char* end = fields[2].data() + fields[2].size();
    if (std::from_chars(fields[2].data(), end, number).ptr == end && is_number(fields[2])) {
      task.task = number;
    }
    tasks.push_back(std::move(task));
  }
  return tasks;
}

}  // namespace shearcell
