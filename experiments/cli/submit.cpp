// SPDX-License-Identifier: GPL-3.0-or-later
// `submit`: queues the unfinished runs of a campaign on a cluster as an array job.
#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <stdexcept>

#include "experiments/cli/command.hpp"
#include "experiments/cluster/submission.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/runner/campaign.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/sha256.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Slurm's default limit on the number of tasks of a job.
constexpr std::size_t kMostTasks = 1000;
// Slurm's warning can be early by up to this time [s]: Slurm checks time limits only every 30 s,
// and warns at the last check before the warning is due.
constexpr double kWarningResolution = 30;

struct SubmitOptions {
  std::vector<std::string> manifests;
  ExpandOptions expand;
  JobOptions job;
  std::size_t array_size = kMostTasks;
  bool dry_run = false;
};

/// Result of the command. `facts` are printed only as JSON, and `text` only without --json.
struct Result {
  Proposal proposal;
  json facts = {{"submission", nullptr}};
  std::string text = {};
};

void print(const Result& result, const Context& context) {
  const Proposal& proposal = result.proposal;
  std::size_t runs = 0, task = 0;
  const std::vector<Facts> tasks = list_of(proposal.shares, [&](const Share& share) -> Facts {
    runs += share.runs.size();
    const double seconds = proposal.seconds(share);
    return {{"", ++task, "task"},
            {"runs", share.runs, "runs", std::to_string(share.runs.size())},
            {"packings", share.packings.size(), "packings"},
            {"particle_steps", share.particle_steps, "particle-steps",
             fmt::format("{:.3g}", share.particle_steps)},
            {"seconds", seconds, "about", format_duration(seconds)}};
  });
  if (context.json) {
    json all = {{"tasks", to_json(tasks)},
                {"cpus_per_task", proposal.job.cpus},
                {"left_out", proposal.left_out},
                {"warnings", context.warnings}};
    all.update(result.facts);
    return print_json(all);
  }
  if (!tasks.empty()) {
    fmt::print("{} in {}; cores per task: {}\n\n", counted(runs, "run"),
               counted(tasks.size(), "task"), proposal.job.cpus);
    print_table(tasks);
    fmt::print("\n");
  }
  fmt::print("{}", result.text);
  if (proposal.left_out > 0) {
    fmt::print(
        "left out: {}, because a queued or running task works on the same packing; see `shearcell "
        "status`\n",
        counted(proposal.left_out, "run"));
  } else if (proposal.shares.empty()) {
    fmt::print("Nothing to do: all runs are done\n");
  }
}

void show_jobs(const fs::path& store, Result& result) {
  Submission submission;
  submission.id = "SUBMISSION";
  submission.tasks.resize(result.proposal.shares.size());
  const Job array = array_job(submission, store, result.proposal.job);
  const Job merging = merge_job(submission, store, result.proposal.job, "JOB");
  result.facts = {{"script", array.script},
                  {"fold_script", merging.script},
                  {"command", array.command},
                  {"fold_command", merging.command}};
  const auto shown = [](const Job& job) {
    std::string line;
    for (const std::string& word : job.command) line += shell_word(word) + " ";
    return fmt::format("{}\n\n{}", line, job.script);
  };
  result.text = fmt::format(
      "Nothing was submitted. The array job:\n\n{}\nThe job that merges the stores:\n\n{}",
      shown(array), shown(merging));
}

/// Queues the array job and the job that merges its stores. If the second job cannot be queued,
/// warns that the stores must be merged by hand.
void queue_jobs(Store& store, const Submission& submission, Result& result, Context& context) {
  const JobOptions& options = result.proposal.job;
  const fs::path folder = submission.folder(store.folder());
  std::string job, merging;
  try {
    job = queue_job(array_job(submission, store.folder(), options), folder);
  } catch (const MachineError&) {
    throw;  // keeps the folder: it is unknown whether the job is queued
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    throw;
  }
  try {
    merging = queue_job(merge_job(submission, store.folder(), options, job), folder);
  } catch (const std::runtime_error& error) {
    warn(context, fmt::format("{}\nThe stores of the tasks are not merged automatically. When the "
                              "job has ended, run `shearcell submit` again, or `shearcell merge`",
                              error.what()));
    fail(context, kOtherError);
  }
  store.record(kSubmissions,
               {"JobQueued", {{"submission", submission.id}, {"job", job}, {"fold_job", merging}}});
  result.facts = {{"submission", submission.id},
                  {"job", job},
                  {"fold_job", merging},
                  {"folder", folder.string()}};
  result.text = fmt::format("Submitted as job {}; {}. Logs: {}\n", job,
                            merging.empty() ? "its stores are not merged automatically"
                                            : "job " + merging + " merges its stores",
                            folder.string());
}

/// Merges results of earlier submissions that no job has merged, for example after `scancel`. Then
/// declares the runs of the plans.
void prepare(Store& store, const std::vector<Submission>& open, const std::vector<Plan>& plans) {
  for (const Submission& submission : open) {
    if (!submission.queue.empty()) continue;
    if (const std::uint64_t checkpoints = merge_tasks(store, submission); checkpoints > 0) {
      print_stderr("merged {} of submission {}, whose jobs have ended\n",
                   counted(checkpoints, "checkpoint"), submission.id);
    }
  }
  for (const Plan& plan : plans) declare(store, plan);
}

void check_time(const JobOptions& job) {
  const double needed = static_cast<double>(job.warn_seconds) + kWarningResolution;
  for (const std::string& option : job.sbatch) {
    const double limit =
        option.starts_with("--time=") ? slurm_seconds(option.substr(7)) : needed + 1;
    if (limit > needed) continue;
    throw CLI::ValidationError(
        "--time", fmt::format("a limit of {} s leaves no time to compute, because Slurm can warn "
                              "a task as early as {} s before the limit; increase --time or reduce "
                              "--warn",
                              limit, needed));
  }
}

void submit(const SubmitOptions& options, Context& context) {
  check_time(options.job);
  const std::vector<Plan> plans = load_plans(options.manifests, options.expand, context);
  const fs::path folder =
      fs::weakly_canonical(fs::absolute(context.store));  // same path in all tasks
  if (const std::string why = unfit_path(folder); !why.empty()) throw UsageError(why);
  if (!options.dry_run) require_slurm();
  std::optional<Store> store = options.dry_run
                                   ? open_if_there(context.store)
                                   : std::optional<Store>(std::in_place, folder, Access::create);
  const std::size_t seen = store ? store->events(kSubmissions).size() : 0;
  const QueueView queue = store ? view_queue(*store) : QueueView();
  if (!queue.problem.empty()) {
    if (!options.dry_run) throw ProgramError(queue.problem);
    warn(context, "the proposed jobs may include runs that are already queued: " + queue.problem);
  }
  if (!options.dry_run) prepare(*store, queue.submissions, plans);
  const auto busy = store ? busy_runs(*store, queue.submissions) : std::set<std::string>();
  Result result{propose(plans, store ? &*store : nullptr, busy, options.array_size, options.job)};
  if (options.dry_run && !result.proposal.shares.empty()) {
    show_jobs(folder, result);
  } else if (!result.proposal.shares.empty()) {
    const auto sha = [](const Plan& plan) { return sha256_hex(plan.manifest.text); };
    const json event = {{"scheduler", "slurm"},
                        {"manifests", list_of(plans, sha)},
                        {"scales", list_of(plans, [](const Plan& plan) { return plan.scale; })}};
    const Submission made = prepare_submission(*store, result.proposal, event, seen);
    queue_jobs(*store, made, result, context);
  }
  print(result, context);
}

std::string check_sbatch(const std::string& text) {
  if (!text.starts_with("--") || text.size() == 2) {
    return fmt::format("'{}' is no option of the form --NAME. Example: --sbatch=--qos=long",
                       printable(text));
  }
  const std::string option = text.substr(0, text.find('='));
  for (const std::string taken : {"--array", "--clusters", "--test-only", "--wait", "--wrap"}) {
    if (!taken.starts_with(option)) continue;  // sbatch accepts abbreviated options
    return fmt::format(
        "'{}': remove {}. With this option, `submit` cannot queue its jobs or cannot follow their "
        "progress. To limit the number of tasks, use --array-size. To use another cluster, run "
        "`submit` there.",
        printable(text), taken);
  }
  return "";
}

void add_job_options(CLI::App& command, SubmitOptions& options) {
  JobOptions& job = options.job;
  // The options are read in this order, and sbatch uses the last of equal options.
  command.add_option("--sbatch", job.sbatch, "Further option of sbatch, such as --sbatch=--mem=2G")
      ->check(check_sbatch)
      ->allow_extra_args(false)  // the next argument may be a manifest
      ->type_name("OPTION");
  const auto pass_on = [&](const char* names, const char* option, const char* help) {
    const auto add = [&job, option](const std::string& value) {
      job.sbatch.push_back(option + value);
    };
    return command.add_option_function<std::string>(names, add, help);
  };
  pass_on("--partition,-p", "--partition=", "Partition");
  pass_on("--account,-A", "--account=", "Account");
  pass_on("--time",
          "--time=", "Time limit of a task; an unfinished task is restarted after the limit")
      ->type_name("HH:MM:SS");
  add_number(command, "--array-size", options.array_size,
             "Largest number of tasks (default: one per packing)", "K", 1, 100000);
  add_number(command, "--cpus-per-task,-c", job.cpus,
             "Cores of each task; more cores compute more runs at a time (default: one core per "
             "run, at most 16)",
             "C", 1, 1024);
  add_threads_option(command, job.threads, "Threads inside each run");
  command
      .add_option("--scratch", job.scratch,
                  "Working folder of the tasks, on each node's own disk, such as /scratch or "
                  "'$TMPDIR'. The "
                  "results are copied to the task's store every five minutes")
      ->check(unfit_scratch)
      ->type_name("DIR");
  add_number(
      command, "--warn", job.warn_seconds,
      "A task writes checkpoints and queues itself again this many seconds before its time limit",
      "S", 10, 3600)
      ->capture_default_str();
  command.add_flag("--dry-run", options.dry_run,
                   "Show the jobs and tasks without submitting; needs no Slurm and writes nothing");
}

}  // namespace

void add_submit(CLI::App& app, Context& context) {
  const auto [command, options] = add_command(
      app, context, "submit", "Queue the runs of manifests on a cluster as an array job", submit);
  add_manifest_options(*command, options->manifests, options->expand, false);
  add_job_options(*command, *options);
  add_common_options(
      *command, context,
      R"(Each task computes the runs of some packings in a separate store under STORE/submissions. A second
job then merges these stores into STORE. Near its time limit, a task writes checkpoints and queues
itself again. Runs that are done or queued are left out, so you can submit again at any time. STORE
must be on a disk that all nodes can access. Variables such as $TMPDIR or ${USER} in --scratch are
expanded on the node. Environment variables such as SBATCH_ACCOUNT, SBATCH_PARTITION and
SBATCH_QOS are respected, except those that contradict `submit` (experiments/cluster/README.md).
Examples:
  shearcell submit experiments/drag.yaml --scale paper --partition long --time 24:00:00
  shearcell submit experiments/*.yaml --scale desk --scratch '$TMPDIR' --sbatch=--mem=4G
  shearcell submit experiments/drag.yaml --dry-run)");
}

}  // namespace shearcell::cli
