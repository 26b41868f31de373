// SPDX-License-Identifier: GPL-3.0-or-later
// `submit`: queues the rest of a campaign on a cluster as an array job.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>

#include "experiments/cli/command.hpp"
#include "experiments/cluster/proposal.hpp"
#include "experiments/cluster/submission.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/file.hpp"
#include "provenance/sha256.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

namespace fs = std::filesystem;

// Slurm's default limit.
constexpr std::size_t kMostTasks = 1000;
// Slurm checks twice a minute, so its warning may come this much earlier [s].
constexpr double kWarningResolution = 30;

struct SubmitOptions {
  std::vector<std::string> manifests;
  ExpandOptions expand;
  JobOptions job;
  std::size_t array_size = kMostTasks;
  bool dry_run = false;
};

/// Prints the proposal and `more` as JSON.
void print_json_of(const Proposal& proposal, const Context& context, const nlohmann::json& more) {
  const auto task = [&](const Share& share) -> nlohmann::json {
    return {{"runs", share.runs},
            {"packings", share.packings.size()},
            {"particle_steps", share.particle_steps},
            {"seconds", seconds_of(share, proposal)}};
  };
  nlohmann::json all = {{"tasks", json_list(proposal.shares, task)},
                        {"cpus_per_task", proposal.job.cpus},
                        {"left_out", proposal.left_out},
                        {"warnings", context.warnings}};
  all.update(more);
  print_json(all);
}

void print_shares(const Proposal& proposal) {
  std::size_t runs = 0;
  for (const Share& share : proposal.shares) runs += share.runs.size();
  fmt::print("{} in {}; cores of each: {}\n\n", counted(runs, "run"),
             counted(proposal.shares.size(), "task"), proposal.job.cpus);
  std::size_t task = 0;
  print_table({"task", "runs", "packings", "particle-steps", "about"}, proposal.shares,
              [&](const Share& share) -> Row {
                return {std::to_string(++task), std::to_string(share.runs.size()),
                        std::to_string(share.packings.size()),
                        fmt::format("{:.3g}", share.particle_steps),
                        format_duration(seconds_of(share, proposal))};
              });
}

void print_nothing(const Proposal& proposal, Context& context) {
  if (context.json) return print_json_of(proposal, context, {{"submission", nullptr}});
  if (proposal.left_out == 0) {
    fmt::print("Nothing to do: the store holds every run at its length\n");
  } else {
    fmt::print(
        "Nothing to submit: {} queued or being computed already, or waiting for a packing that is; "
        "see `shearcell status`\n",
        counted(proposal.left_out, "run"));
  }
}

/// The store's absolute path, which is valid in every task.
fs::path whole_path(const std::string& store) {
  return fs::weakly_canonical(fs::absolute(store));
}

JobPlaces places_of(const fs::path& store, const fs::path& folder) {
  JobPlaces places{fs::read_symlink("/proc/self/exe"), store, folder};
  for (const fs::path& path : {places.program, places.folder}) {
    if (const std::string why = unfit_path(path); !why.empty()) throw std::runtime_error(why);
  }
  return places;
}

std::vector<std::string> output_option(const fs::path& folder, std::string_view file) {
  return {"--output=" + output_pattern(folder, file)};
}

void dry_run(const Proposal& proposal, Context& context) {
  const fs::path store = whole_path(context.store);
  const JobPlaces places = places_of(store, store / "submissions" / "SUBMISSION");
  const std::string script = array_script(proposal.job, places, proposal.shares.size());
  const std::string merging = merge_script(proposal.job, places, proposal.shares.size());
  if (context.json) {
    return print_json_of(proposal, context, {{"script", script}, {"fold_script", merging}});
  }
  print_shares(proposal);
  fmt::print("\nNothing was submitted. The array job:\n\n{}\nand, when all of it has ended:\n\n{}",
             script, merging);
}

/// Queues the array. Deletes the submission's folder if that fails.
std::string queue_array(const Submission& submission, const Proposal& proposal,
                        const fs::path& store) {
  const fs::path folder = submission.folder(store);
  const std::size_t tasks = proposal.shares.size();
  try {
    const JobPlaces places = places_of(store, folder);
    write_output(folder / "job.sh", array_script(proposal.job, places, tasks));
    write_output(folder / "fold.sh", merge_script(proposal.job, places, tasks));
    return queue_job(folder, "job.sh", submission.name(), output_option(folder, "task-%a.log"));
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    throw;
  }
}

/// Queues both jobs. If the second fails, the stores can be merged by hand.
void queue(const Submission& submission, const Proposal& proposal, Store& store, Context& context) {
  const fs::path folder = submission.folder(store.folder());
  const std::string job = queue_array(submission, proposal, store.folder());
  std::string merge_job;
  try {
    std::vector<std::string> words = output_option(folder, "fold.log");
    words.push_back("--dependency=afterany:" + job);
    merge_job = queue_job(folder, "fold.sh", submission.merge_name(), words);
  } catch (const ProgramError& error) {
    warn(context, fmt::format("{}\nThe stores of the tasks are not merged by themselves: "
                              "`shearcell submit` again, or `merge` them, when the job has ended",
                              error.what()));
  }
  store.record_submission("JobQueued",
                          {{"submission", submission.id}, {"job", job}, {"fold_job", merge_job}});
  if (context.json) {
    return print_json_of(proposal, context,
                         {{"submission", submission.id},
                          {"job", job},
                          {"fold_job", merge_job},
                          {"folder", folder.string()}});
  }
  print_shares(proposal);
  fmt::print("\nSubmitted as job {}; {}. Logs: {}\n", job,
             merge_job.empty() ? "its stores are not merged automatically"
                               : "job " + merge_job + " merges its stores",
             folder.string());
  if (proposal.left_out > 0) {
    fmt::print("left out: {} queued or being computed already\n",
               counted(proposal.left_out, "run"));
  }
}

/// Merges what earlier submissions computed and no job merged, as after `scancel`.
void merge_leftovers(Store& store, const std::vector<Submission>& open) {
  for (const Submission& submission : open) {
    if (!submission.queue.empty()) continue;
    std::uint64_t checkpoints = 0;
    for (const MergeReport& report : merge_tasks(store, submission)) {
      checkpoints += report.checkpoints;
    }
    if (checkpoints == 0) continue;
    print_stderr("merged {} checkpoints of submission {}, whose jobs have ended\n", checkpoints,
                 submission.id);
  }
}

nlohmann::json event_facts(const JobOptions& job, const LoadedManifests& loaded) {
  const auto sha = [](const Manifest& manifest) { return sha256_hex(manifest.text); };
  return {{"scheduler", "slurm"},
          {"manifests", json_list(loaded.manifests, sha)},
          {"scales", json_list(loaded.plans, [](const Plan& plan) { return plan.scale; })},
          {"options",
           {{"partition", job.partition},
            {"account", job.account},
            {"time", job.time},
            {"cpus_per_task", job.cpus},
            {"threads", job.threads},
            {"warn_seconds", job.warn_seconds},
            {"scratch", job.scratch},
            {"sbatch", job.sbatch}}}};
}

void submit_really(const SubmitOptions& options, const LoadedManifests& loaded, Context& context) {
  require_slurm();
  const fs::path folder = whole_path(context.store);
  places_of(folder, folder);  // throws if a path is unfit
  Store store(folder, Access::create);
  const std::size_t seen = store.events(kSubmissions).size();
  std::vector<Submission> open = unfinished_submissions(store);
  ask_queue(open);
  merge_leftovers(store, open);
  for (std::size_t m = 0; m < loaded.manifests.size(); ++m) {
    declare(store, loaded.manifests[m], loaded.plans[m]);
  }
  const Proposal proposal =
      propose(loaded.plans, &store, busy_runs(store, open), options.array_size, options.job);
  if (proposal.shares.empty()) return print_nothing(proposal, context);
  const Submission made =
      prepare_submission(store, proposal.shares, event_facts(proposal.job, loaded), seen);
  queue(made, proposal, store, context);
}

void submit(const SubmitOptions& options, Context& context) {
  const LoadedManifests loaded = load_manifests(options.manifests, options.expand, context);
  if (!options.dry_run) return submit_really(options, loaded, context);
  const std::optional<Store> store = open_if_there(context.store);
  std::set<std::string> busy;
  if (store) {
    std::vector<Submission> open = unfinished_submissions(*store);
    try {
      ask_queue(open);
    } catch (const ProgramError& error) {
      warn(context, fmt::format("runs that are queued already are not left out: {}", error.what()));
    }
    busy = busy_runs(*store, open);
  }
  const Proposal proposal =
      propose(loaded.plans, store ? &*store : nullptr, busy, options.array_size, options.job);
  proposal.shares.empty() ? print_nothing(proposal, context) : dry_run(proposal, context);
}

std::string check_sbatch(const std::string& text) {
  if (text.starts_with("--") && text.size() > 2) return unfit_value(text);
  return fmt::format("'{}' is not a long option of sbatch; write --sbatch=--qos=long", text);
}

void check_time(const JobOptions& job) {
  if (job.time.empty()) return;
  const double needed = static_cast<double>(job.warn_seconds) + kWarningResolution;
  const auto limit = slurm_seconds(job.time);
  if (!limit) {
    throw CLI::ValidationError("--time", "'" + job.time +
                                             "' is not a time limit of Slurm: write MINUTES, "
                                             "HH:MM:SS or DAYS-HH:MM:SS");
  }
  if (*limit <= needed) {
    throw CLI::ValidationError(
        "--time", fmt::format("{} s leave no time to compute: the warning comes up to {} s before "
                              "the end; ask for more, or a smaller --warn",
                              *limit, needed));
  }
}

void add_job_options(CLI::App& command, SubmitOptions& options) {
  JobOptions& job = options.job;
  command.add_option("--partition,-p", job.partition, "Partition")->check(unfit_value);
  command.add_option("--account,-A", job.account, "Account")->check(unfit_value);
  command
      .add_option("--time", job.time,
                  "Time limit of one start of a task; it restarts until it is done")
      ->check(unfit_value)
      ->type_name("HH:MM:SS");
  add_number(command, "--array-size", options.array_size,
             "Largest number of tasks (default: one per packing)", "K", 1, 100000);
  add_number(command, "--cpus-per-task,-c", job.cpus,
             "Cores, and so runs at a time, of a task (default: one per run, at most 16)", "C", 1,
             1024);
  add_threads_option(command, job.threads, "Threads inside each run, for large cells");
  command
      .add_option("--scratch", job.scratch,
                  "Folder on each node's own disk to work in; the stores are saved every five "
                  "minutes")
      ->check(unfit_path)
      ->type_name("DIR");
  add_number(command, "--warn", job.warn_seconds,
             "Seconds before the time limit at which tasks write checkpoints and queue themselves "
             "again",
             "S", 10, 3600)
      ->capture_default_str();
  command.add_option("--sbatch", job.sbatch, "Further option of sbatch, as --sbatch=--mem=2G")
      ->check(check_sbatch)
      ->allow_extra_args(false)  // the next argument may be a manifest
      ->type_name("OPTION");
  command.add_flag("--dry-run", options.dry_run,
                   "Show the scripts and who would do what; needs no Slurm, writes nothing");
}

}  // namespace

void add_submit(CLI::App& app, Context& context) {
  auto options = std::make_shared<SubmitOptions>();
  CLI::App* command =
      app.add_subcommand("submit", "Queue the runs of manifests on a cluster as an array job");
  command->add_option("manifest", options->manifests, "YAML manifests")->required();
  add_expand_options(*command, options->expand);
  add_job_options(*command, *options);
  add_common_options(*command, context);
  command->footer(
      R"(Each task computes the runs of some packings in its own store under STORE/submissions; a job
after the array merges these stores into STORE. Near its time limit a task writes checkpoints
and queues itself again. Runs that are done or queued are left out, so you can submit again at
any time. Put STORE on a disk that all nodes see.
Examples:
  shearcell submit experiments/drag.yaml --scale paper --partition long --time 24:00:00
  shearcell submit experiments/*.yaml --scale desk --scratch /scratch --sbatch=--mem=4G
  shearcell submit experiments/drag.yaml --dry-run)");
  command->callback([options, &context] {
    check_time(options->job);
    submit(*options, context);
  });
}

}  // namespace shearcell::cli
