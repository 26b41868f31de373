// SPDX-License-Identifier: GPL-3.0-or-later
// `run` and `resume`: compute what is not done yet.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>

#include "core/machine.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/runner/lammps/lammps_run.hpp"
#include "experiments/runner/stop.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

struct RunOptions {
  std::vector<std::string> inputs;  ///< manifests, or runs of `resume`
  ExpandOptions expand;
  std::size_t jobs = 0;
  Parallel parallel;
  bool quiet = false;
};

void require_lammps_for_ranks(const RunOptions& options, bool lammps) {
  if (options.parallel.ranks == 1 || lammps) return;
  throw CLI::ValidationError("--mpi",
                             "has no effect: LAMMPS computes none of these runs. Leave it out");
}

// Number of runs at a time, so that their threads or processes fill the cores.
std::size_t workers(const RunOptions& options) {
  if (options.jobs > 0) return options.jobs;
  const std::size_t each = std::max(options.parallel.threads, options.parallel.ranks);
  return std::max<std::size_t>(1, usable_cores() / each);
}

void compute(Store& store, const std::vector<StageJob>& jobs, const RunOptions& options,
             Context& context) {
  catch_stop_signals();
  Progress progress(jobs.size(), options.quiet);
  print_result(run_campaign(store, jobs, workers(options), progress, options.parallel), context);
}

void run(const RunOptions& options, Context& context) {
  // Reads all manifests before it writes anything.
  const auto [manifests, plans] = load_manifests(options.inputs, options.expand, context);
  const bool lammps = std::ranges::any_of(plans, asks_for_lammps);
  require_lammps_for_ranks(options, lammps);
  if (lammps) find_lammps(options.parallel.ranks);  // throws if it is not installed
  Store store(context.store, Access::create);
  std::vector<StageJob> jobs;
  std::set<std::string> known;
  for (std::size_t m = 0; m < manifests.size(); ++m) {
    for (StageJob& job : declare(store, manifests[m], plans[m])) {
      if (known.insert(job.id).second) jobs.push_back(std::move(job));
    }
  }
  compute(store, jobs, options, context);
}

void add_worker_options(CLI::App& command, RunOptions& options) {
  add_number(command, "--jobs,-j", options.jobs, "Runs at a time (default: one per core)", "J", 1,
             1024);
  add_threads_option(command, options.parallel.threads, "Threads inside each run, for large cells");
  add_number(command, "--mpi", options.parallel.ranks,
             "Processes of each run in LAMMPS, by mpirun; it changes the last digits", "N", 1,
             65536);
  command.add_flag("--quiet,-q", options.quiet, "Show no progress");
}

}  // namespace

void print_result(const CampaignResult& result, Context& context) {
  const bool interrupted = result.interrupted > 0 || stop_requested();
  context.exit_code = result.damaged > 0   ? kStoreDamaged
                      : result.failed > 0  ? kRunFailed
                      : interrupted        ? kInterrupted
                      : result.blocked > 0 ? kOtherError
                                           : kDone;
  if (context.json) {
    print_json({{"completed", result.completed},
                {"already_done", result.already},
                {"done_elsewhere", result.elsewhere},
                {"failed", result.failed},
                {"interrupted", result.interrupted},
                {"not_begun", result.blocked},
                {"damaged", result.damaged},
                {"messages", result.messages},
                {"warnings", context.warnings}});
  } else if (result.completed + result.already + result.elsewhere + result.failed +
                 result.interrupted + result.blocked + result.damaged ==
             0) {
    fmt::print("nothing is left to compute\n");
  } else {
    fmt::print("{} computed, {} done already, {} failed, {} interrupted, {} not started\n",
               counted(result.completed, "stage"), result.already, result.failed,
               result.interrupted, result.blocked);
    if (result.elsewhere > 0) {
      fmt::print("{} computed by other programs meanwhile\n", counted(result.elsewhere, "stage"));
    }
    if (result.damaged > 0) {
      fmt::print("{} found damaged files in the store\n", counted(result.damaged, "stage"));
    }
  }
  if (context.exit_code == kInterrupted) {
    print_stderr("Interrupted. Continue with: shearcell resume --store {}\n",
                 shell_word(context.store));
  }
}

void add_run(CLI::App& app, Context& context) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "Compute the runs of manifests");
  command->add_option("manifest", options->inputs, "YAML manifests")->required();
  add_expand_options(*command, options->expand);
  add_engine_option(*command, options->expand);
  add_worker_options(*command, *options);
  add_common_options(*command, context);
  command->footer(
      R"(Examples:
  shearcell run experiments/drag.yaml --scale smoke
  shearcell run experiments/drag.yaml --scale desk --cycles 100   # extend
  shearcell run experiments/critical_size.yaml --scale paper --variant amplitude_rad=0.1
  shearcell run experiments/drag.yaml --scale desk --seed 4-6     # this machine's part of the seeds
  shearcell run experiments/drag.yaml --scale smoke --engine lammps --mpi 2

Computes only what the store does not hold. Press Ctrl-C to write checkpoints and end with
code 85; `run` again, or `resume`, continues bit for bit. Start several programs on one
machine and one store to share the work. On several machines, give each its --variant or --seed
and merge their stores.)");
  command->callback([options, &context] { run(*options, context); });

  auto resume_options = std::make_shared<RunOptions>();
  CLI::App* resume = app.add_subcommand("resume", "Continue unfinished runs");
  resume->add_option("run", resume_options->inputs,
                     "Run ids, or unique beginnings of them (default: all)");
  add_worker_options(*resume, *resume_options);
  add_common_options(*resume, context);
  resume->footer("Examples:\n  shearcell resume\n  shearcell resume 3f9a");
  resume->callback([resume_options, &context] {
    Store store(context.store, Access::write);
    const std::vector<StageJob> jobs = stages_to_resume(store, resume_options->inputs);
    const auto by_lammps = [&](const StageJob& job) {
      return engine_of(store.run(job.id).resolved) == EngineKind::lammps;
    };
    require_lammps_for_ranks(*resume_options, jobs.empty() || std::ranges::any_of(jobs, by_lammps));
    compute(store, jobs, *resume_options, context);
  });
}

}  // namespace shearcell::cli
