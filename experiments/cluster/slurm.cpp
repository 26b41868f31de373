// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cluster/slurm.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "experiments/manifest/suggest.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/read_number.hpp"

namespace shearcell {
namespace {

// Slurm sends USR1 some time before the limit (to the shell alone: B) and TERM to all processes
// when a job is cancelled or preempted. Both make the program record its states and end with 85.
// After USR1 the task is queued again by its own number, because the number of its job may be that
// of the whole array. A program that was killed (out of memory) is started again here.
constexpr std::string_view kTaskBody = R"sh(
again= stopped= signalled= program= leave=${SLURM_RESTART_COUNT:+--leave-failed}
pass_on() {
  signalled=$1
  [ -n "$program" ] || return 0
  # More than once: one that is just beginning is still a copy of this shell, which ignores it.
  for pause in 1 2 4; do kill -"$1" "$program" 2>/dev/null || break; sleep "$pause"; done
}
trap 'again=yes; pass_on USR1' USR1
trap 'again= stopped=yes; pass_on TERM' TERM
for start in 1 2 3 4; do
  program=
  "$shearcell" work --store "$store" --jobs @JOBS@ --threads @THREADS@@SCRATCH@ $leave &
  program=$!
  [ -z "$signalled" ] || pass_on "$signalled"  # it came before the number was known
  wait "$program"; code=$?
  while [ -n "$signalled" ]; do signalled=; wait "$program"; code=$?; done
  [ "$code" -gt 128 ] && [ -z "$again$stopped" ] || break
  echo "The program was killed (code $code), start $start."
  leave=--leave-failed
done
if [ -n "$again" ] && [ "$code" -ge 85 ]; then
  echo "The time is over; the task is queued again."
  scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
fi
exit "$code"
)sh";

constexpr std::string_view kMergeBody = R"sh(
code=0
for task in $(seq @TASKS@); do
  "$shearcell" merge "$tasks$task" --store "$store" || code=$?
done
exit "$code"
)sh";

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  text.replace(text.find(what), what.size(), by);
  return text;
}

std::string directives(const JobOptions& options, const std::vector<std::string>& own) {
  std::string text;
  // The user's options come first: of two equal options Slurm takes the last.
  for (const std::string& option : options.sbatch) text += "#SBATCH " + option + "\n";
  if (!options.partition.empty()) text += "#SBATCH --partition=" + options.partition + "\n";
  if (!options.account.empty()) text += "#SBATCH --account=" + options.account + "\n";
  if (!options.time.empty()) text += "#SBATCH --time=" + options.time + "\n";
  for (const std::string& option : own) text += "#SBATCH " + option + "\n";
  return text +
         "#SBATCH --nodes=1\n#SBATCH --ntasks=1\n#SBATCH --requeue\n"
         "#SBATCH --open-mode=append\n";
}

// Slurm waits 10 s for an answer of its controller.
constexpr double kAnswerSeconds = 15;

// Only queries may have a time limit: sbatch may queue a job and not answer in time.
std::string ask(const std::vector<std::string>& words, const std::filesystem::path& folder,
                std::optional<double> seconds = std::nullopt) {
  const auto outcome = run_program(words, folder, {}, seconds);
  if (!outcome) {
    throw ProgramError(fmt::format(
        "{} is not installed here (Debian package slurm-client); submit from a machine of the "
        "cluster, or see what would be submitted with --dry-run",
        words.front()));
  }
  if (outcome->code != 0) {
    throw ProgramError(fmt::format("{} failed: {}", words.front(), trimmed(outcome->messages)));
  }
  return outcome->output;
}

}  // namespace

std::string unfit_path(const std::filesystem::path& path) {
  const std::string text = path.string();
  const bool fit =
      std::ranges::none_of(text, [](unsigned char c) { return c == '\\' || std::iscntrl(c) != 0; });
  if (fit) return "";
  return fmt::format(
      "{}: Slurm cannot be given a path with a backslash, a line feed or another control "
      "character; name another folder",
      text);
}

std::string unfit_value(std::string_view text) {
  constexpr std::string_view kSafe =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+.,:;/=@%*()[]|&!";
  if (!text.empty() && text.find_first_not_of(kSafe) == text.npos) return "";
  return fmt::format("'{}' is not a value for Slurm; give one word without spaces or quotes", text);
}

std::optional<double> slurm_seconds(std::string_view time) {
  std::optional<unsigned> days = 0;
  const auto dash = time.find('-');
  if (dash != std::string_view::npos) {
    days = read_number<unsigned>(time.substr(0, dash));
    time.remove_prefix(dash + 1);
  }
  std::vector<std::optional<unsigned>> parts;
  for (std::size_t from = 0, end = 0; from <= time.size(); from = end + 1) {
    end = std::min(time.find(':', from), time.size());
    parts.push_back(read_number<unsigned>(time.substr(from, end - from)));
  }
  if (!days || parts.empty() || parts.size() > 3 ||
      std::ranges::any_of(parts, [](const auto& part) { return !part; })) {
    return std::nullopt;
  }
  // After days the first number is hours; else a lone number is minutes, and two are minutes and
  // seconds.
  if (dash == std::string_view::npos && parts.size() < 3) parts.insert(parts.begin(), 0);
  parts.resize(3, 0);
  return ((*days * 24.0 + *parts[0]) * 60 + *parts[1]) * 60 + *parts[2];
}

std::string array_script(const JobOptions& options, const JobPlaces& places, std::size_t tasks) {
  const std::size_t jobs = std::max<std::size_t>(1, options.cpus / options.threads);
  std::string body = replaced(std::string(kTaskBody), "@JOBS@", fmt::to_string(jobs));
  body = replaced(std::move(body), "@THREADS@", fmt::to_string(options.threads));
  body = replaced(std::move(body), "@SCRATCH@",
                  options.scratch.empty() ? "" : " --scratch " + shell_quoted(options.scratch));
  return "#!/bin/bash\n" +
         directives(options, {fmt::format("--array=1-{}", tasks),
                              fmt::format("--cpus-per-task={}", options.cpus),
                              fmt::format("--signal=B:USR1@{}", options.warn_seconds)}) +
         fmt::format("\nshearcell={}\nstore={}$SLURM_ARRAY_TASK_ID",
                     shell_quoted(places.program.string()),
                     shell_quoted((places.folder / "task-").string())) +
         body;
}

std::string merge_script(const JobOptions& options, const JobPlaces& places, std::size_t tasks) {
  return "#!/bin/bash\n" + directives(options, {}) +
         fmt::format("\nshearcell={}\nstore={}\ntasks={}", shell_quoted(places.program.string()),
                     shell_quoted(places.store.string()),
                     shell_quoted((places.folder / "task-").string())) +
         replaced(std::string(kMergeBody), "@TASKS@", fmt::to_string(tasks));
}

std::string output_pattern(const std::filesystem::path& folder, std::string_view file) {
  std::string pattern;
  for (const char c : folder.string()) pattern += c == '%' ? "%%" : std::string(1, c);
  return pattern + "/" + std::string(file);
}

void require_slurm() {
  ask({"sbatch", "--version"}, "/", kAnswerSeconds);
}

std::string queue_job(const std::filesystem::path& folder, const std::string& script,
                      const std::string& name, const std::vector<std::string>& options) {
  std::vector<std::string> words = {"sbatch", "--parsable", "--job-name=" + name};
  words.insert(words.end(), options.begin(), options.end());
  words.push_back(script);
  const std::string answer = ask(words, folder);
  std::string job(trimmed(answer.substr(0, answer.find(';'))));  // the name of the cluster follows
  if (!read_number<std::uint64_t>(job)) {
    throw ProgramError(fmt::format("sbatch gave no job number but '{}'", trimmed(answer)));
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
    for (std::string field; std::getline(rest, field, '|');) fields.emplace_back(trimmed(field));
    fields.resize(std::max<std::size_t>(6, fields.size()));
    if (!read_number<std::uint64_t>(fields[1])) continue;
    tasks.push_back({.name = fields[0],
                     .job = fields[1],
                     .task = read_number<std::uint64_t>(fields[2]),
                     .state = fields[3],
                     .reason = fields[4] == "None" ? "" : fields[4],
                     .node = fields[5]});
  }
  return tasks;
}

}  // namespace shearcell
