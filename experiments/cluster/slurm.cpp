// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cluster/slurm.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <limits>
#include <regex>
#include <sstream>

#include "experiments/manifest/document.hpp"
#include "experiments/manifest/suggest.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/file.hpp"
#include "provenance/io/read_number.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;

// Environment variables that are removed for Slurm's programs and for the jobs. They hide lines of
// the queue, name another cluster, contradict options of sbatch that this program sets, or describe
// the job in which `submit` itself runs. All other variables are kept, for example SLURM_CONF,
// SBATCH_ACCOUNT, SBATCH_PARTITION, SBATCH_QOS, SBATCH_CONSTRAINT and SBATCH_MEM_PER_CPU.
const std::vector<std::string> kRemoved = {
    "SQUEUE_*",           "SLURM_CLUSTERS",      "SBATCH_CLUSTERS",
    "SBATCH_ARRAY_INX",   "SBATCH_CPUS_PER_GPU", "SBATCH_ERROR",
    "SBATCH_EXPORT",      "SBATCH_GET_USER_ENV", "SBATCH_INPUT",
    "SBATCH_JOB_NAME",    "SBATCH_NO_KILL",      "SBATCH_NO_REQUEUE",
    "SBATCH_OPEN_MODE",   "SBATCH_OUTPUT",       "SBATCH_OVERCOMMIT",
    "SBATCH_REQUEUE",     "SBATCH_SIGNAL",       "SBATCH_TIMELIMIT",
    "SBATCH_WAIT",        "SLURM_ARRAY_*",       "SLURM_MEM_PER_*",
    "SLURM_NTASKS_PER_*", "SLURM_RESTART_COUNT", "SLURM_TRES_PER_TASK"};

// Slurm's programs wait up to 10 s for Slurm's controller, so shearcell waits longer for them.
constexpr double kAnswerSeconds = 15;

// Longest text given to Slurm. Some texts are checked with std::regex, which recurses for each
// character, so a very long text would overflow the stack.
constexpr std::size_t kLongest = 1000;  // [bytes]

const std::string kVariable = R"(\$(?:([A-Za-z_]\w*)|\{([A-Za-z_]\w*)\}))";

std::string ask(const std::vector<std::string>& words) {
  const auto outcome = run_program(words, "/", kRemoved, kAnswerSeconds);
  if (!outcome) {
    throw ProgramError(fmt::format(
        "{} is not installed here (Debian package slurm-client); submit from a machine of the "
        "cluster, or use --dry-run to see what would be submitted",
        words.front()));
  }
  if (outcome->code == 0) return outcome->output;
  throw ProgramError(fmt::format("{} failed: {}", words.front(), trimmed(outcome->messages)));
}

}  // namespace

std::string unfit_path(const fs::path& path) {
  const std::string text = path.string();
  const bool fit =
      std::ranges::none_of(text, [](unsigned char c) { return c == '\\' || std::iscntrl(c) != 0; });
  if (fit && text.size() <= kLongest) return "";
  return fmt::format(
      "{}: Slurm accepts paths of at most {} bytes, without backslashes, line feeds and other "
      "control characters; choose another folder",
      printable(text), kLongest);
}

std::string unfit_scratch(const std::string& text) {
  static const std::regex fit("(/|" + kVariable + ")([^$`]|" + kVariable + ")*");
  if (const std::string why = unfit_path(text); !why.empty()) return why;
  if (std::regex_match(text, fit)) return "";
  return fmt::format(
      "'{}' does not name a folder on a node's own disk: write an absolute path, such as "
      "'/scratch', '$TMPDIR' or '/scratch/${{USER}}/x'. It may contain variables of the node, but "
      "no commands, no ~ and nothing else that a shell would expand",
      text);
}

fs::path scratch_here(const std::string& text) {
  static const std::regex variable(kVariable);
  if (text.size() > kLongest) throw UsageError(unfit_scratch(text));
  std::string folder;
  auto rest = text.begin();
  for (std::sregex_iterator found(text.begin(), text.end(), variable), end; found != end; ++found) {
    const std::string name = (*found)[1].str() + (*found)[2].str();
    const char* value = std::getenv(name.c_str());
    if (value == nullptr || *value == '\0') {
      throw UsageError(fmt::format(
          "--scratch {}: the variable {} is not set on this node; call `submit` again with another "
          "--scratch",
          text, name));
    }
    folder.append(rest, (*found)[0].first).append(value);
    rest = (*found)[0].second;
  }
  folder.append(rest, text.end());
  if (fs::path(folder).is_absolute()) return folder;
  throw UsageError(fmt::format("--scratch {}: '{}' is not an absolute path", text, folder));
}

double slurm_seconds(const std::string& time) {
  static const std::regex form(R"((?:(\d+)-)?(\d+)(?::(\d+))?(?::(\d+))?)");
  std::smatch found;
  constexpr double no_limit = std::numeric_limits<double>::infinity();
  if (time.size() > kLongest || !std::regex_match(time, found, form)) return no_limit;
  // D-H, D-H:M and D-H:M:S have hours after the days. H:M:S begins with hours, but M and M:S begin
  // with minutes.
  double sum = 0, unit = found[1].matched || found[4].matched ? 3600 : 60;
  for (std::size_t part = 1; part <= 4; ++part) {
    if (!found[part].matched) continue;
    const double number = read_number<double>(found.str(part)).value_or(no_limit);
    sum += number * (part == 1 ? 86400 : unit);
    if (part > 1) unit /= 60;
  }
  return sum == 0 ? no_limit : sum;
}

void require_slurm() {
  ask({"sbatch", "--version"});
}

std::string queue_job(const Job& job, const fs::path& folder) {
  static const std::regex number(R"(\s*(\d+)(;\S+)?\s*)");  // the cluster's name may follow
  write_output(folder / job.file, job.script);
  // No time limit: if a slow sbatch were killed, it could already have queued the job.
  const ProgramOutcome sbatch = run_program(job.command, folder, kRemoved).value();
  std::vector<std::string> numbers;
  std::istringstream lines(sbatch.output);
  std::smatch found;
  for (std::string line; std::getline(lines, line);) {
    if (line.size() <= kLongest && std::regex_match(line, found, number)) {
      numbers.push_back(found[1]);
    }
  }
  if (sbatch.code == 0 && numbers.size() == 1) return numbers.front();
  // Either sbatch failed (perhaps after it queued the job), or it printed more than the job number.
  const std::string failure =
      fmt::format("sbatch failed for job {}: {}", job.name, trimmed(sbatch.messages));
  std::string queue;
  try {
    const std::vector<QueuedTask> tasks = ask_queue({job.name});
    if (!tasks.empty()) return tasks.front().job;
  } catch (const ProgramError& error) {
    queue = error.what();
  }
  if (queue.empty() && sbatch.code != 0) throw ProgramError(failure + "\nThe job is not queued");
  if (sbatch.code == 0 && !numbers.empty()) return numbers.back();
  throw MachineError(fmt::format(
      "{}, and {}. So it is not known whether the job {} is queued. The next `submit` looks for "
      "this job before it queues anything. To see or cancel the job: squeue --name={} or scancel "
      "--name={}",
      sbatch.code != 0 ? failure
                       : fmt::format("sbatch printed '{}' instead of a job number",
                                     printable(trimmed(sbatch.output))),
      queue.empty() ? "no job of this name is in the queue" : queue, job.name, job.name, job.name));
}

std::vector<QueuedTask> ask_queue(const std::vector<std::string>& names) {
  std::vector<QueuedTask> tasks;
  if (names.empty()) return tasks;
  std::istringstream lines(ask(
      {"squeue", "--noheader", "--array", "--all", "--states=PENDING,RUNNING,SUSPENDED,COMPLETING",
       "--format=%j|%F|%K|%T|%r|%N", fmt::format("--name={}", fmt::join(names, ","))}));
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> fields;
    std::istringstream rest(line);
    for (std::string field; std::getline(rest, field, '|');) fields.emplace_back(trimmed(field));
    fields.resize(std::max<std::size_t>(6, fields.size()));
    if (!std::ranges::count(names, fields[0]) || !read_number<std::uint64_t>(fields[1])) continue;
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
