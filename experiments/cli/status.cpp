// SPDX-License-Identifier: GPL-3.0-or-later
// `status`: every run with its state, progress and speed.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <thread>

#include "experiments/cli/command.hpp"
#include "experiments/cluster/queue_view.hpp"
#include "experiments/runner/cost.hpp"
#include "experiments/runner/progress.hpp"
#include "experiments/runner/registered.hpp"
#include "experiments/runner/run_end.hpp"
#include "experiments/runner/stop.hpp"
#include "experiments/runner/terminal.hpp"
#include "provenance/io/clock.hpp"

namespace shearcell::cli {
namespace {

double rate(const RunRecord& run) {
  return run.wall_seconds > 0 ? run.particle_steps / run.wall_seconds : 0;
}

// By run.
std::map<std::string, Lease> holders(const Store& store) {
  std::map<std::string, Lease> found;
  for (Lease& lease : store.leases()) found.emplace(lease.run, std::move(lease));
  return found;
}

nlohmann::json facts(const Lease& lease) {
  return {{"host", lease.holder.host},
          {"pid", lease.holder.pid},
          {"attempt", lease.attempt},
          {"seconds_since_renewal",
           1e-3 * (static_cast<double>(now_ms()) - static_cast<double>(lease.renewed_at_ms))}};
}

nlohmann::json facts(const SelectedRun& selected, const VariantNames& names) {
  const RunRecord& run = selected.run;
  const Membership& first = selected.membership;
  return {{"id", run.id},
          {"kind", run.kind},
          {"parent", run.parent},
          {"experiment", first.experiment},
          {"scale", first.scale},
          {"variant", first.variant},
          {"name", names.of(first)},
          {"seed", first.seed},
          {"state", name_of(run.state)},
          {"cycle", run.cycle},
          {"target_cycles", run.target_cycles},
          {"N", run.grains},
          {"step", run.step},
          {"attempts", run.attempts},
          {"wall_seconds", run.wall_seconds},
          {"particle_steps_per_second", rate(run)},
          {"state_hash", run.state_hash},
          {"error", run.error},
          {"updated_at", run.updated_at}};
}

nlohmann::json facts(const QueuedRun& run) {
  nlohmann::json said = {
      {"job", run.job}, {"state", run.state}, {"reason", run.reason}, {"node", run.node}};
  said["reported_state"] =
      run.reported ? nlohmann::json(name_of(run.reported->state)) : nlohmann::json();
  said["reported_cycle"] = run.reported ? nlohmann::json(run.reported->cycle) : nlohmann::json();
  return said;
}

/// What is shown of one run: as the store has it, or further, as the task that computes it reports.
struct Shown {
  const RunRecord& run;
  const Membership& membership;
  bool held = false;
  const QueuedRun* queued = nullptr;

  bool ahead() const {
    return queued != nullptr && queued->reported && run.state != RunState::completed &&
           queued->reported->cycle >= run.cycle;
  }
  RunState state() const { return ahead() ? queued->reported->state : run.state; }
  double cycle() const { return ahead() ? queued->reported->cycle : run.cycle; }
  std::string queue() const {
    if (queued == nullptr || run.state == RunState::completed) return "";
    const std::string& more = queued->state == "pending" ? queued->reason : queued->node;
    return fmt::format("{} {}{}{}", queued->job, queued->state, more.empty() ? "" : " ", more);
  }
};

std::vector<std::string> row(const Shown& shown, const VariantNames& names) {
  const RunRecord& run = shown.run;
  return {run.id.substr(0, 8),
          names.of(shown.membership),
          std::to_string(shown.membership.seed),
          std::to_string(run.grains),
          fmt::format("{}{}", name_of(shown.state()), shown.held ? " *" : ""),
          run.kind == "prepare" ? "" : fmt::format("{:.4g}/{}", shown.cycle(), run.target_cycles),
          fmt::format("{:.1f}", rate(run) * 1e-6),
          format_duration(run.wall_seconds)};
}

/// The work that is left, and when it will be done at the present pace.
struct Estimate {
  RemainingWork work;
  std::size_t at_a_time = 1;  ///< stages
  bool running = false;       ///< else on all cores of this machine, once resumed
  bool at_most = false;       ///< `until` may end runs earlier

  double seconds() const {
    return std::max(work.longest_seconds, work.core_seconds / static_cast<double>(at_a_time));
  }
};

std::optional<Estimate> estimate(const Store& store, const std::vector<SelectedRun>& runs,
                                 const std::map<std::string, Lease>& by_run,
                                 const QueueView& queue) {
  std::vector<RunRecord> records;
  std::size_t running = 0;
  Estimate made;
  for (const SelectedRun& selected : runs) {
    const RunRecord& run = records.emplace_back(selected.run);
    const auto queued = queue.runs.find(run.id);
    const bool in_task = queued != queue.runs.end() && queued->second.state == "running";
    running += by_run.contains(run.id) || in_task ? 1 : 0;
    if (run.state == RunState::completed) continue;
    made.at_most = made.at_most ||
                   std::ranges::any_of(asks_of(store, run.id),
                                       [](const RunAsk& ask) { return ask.until.has_value(); });
  }
  try {
    made.work = remaining_work(records, store.runs());
  } catch (const std::runtime_error&) {
    return std::nullopt;  // a record that this version cannot read; `verify` names it
  }
  if (made.work.stages == 0) return std::nullopt;
  made.running = running > 0;
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  made.at_a_time = std::min(made.running ? running : cores, made.work.stages);
  return made;
}

std::string local_time(double seconds_from_now) {
  const auto then =
      static_cast<std::time_t>(static_cast<double>(now_ms()) * 1e-3 + seconds_from_now);
  std::tm local{};
  localtime_r(&then, &local);
  char text[64];
  return {text, std::strftime(text, sizeof text, "%F %R %Z", &local)};
}

nlohmann::json facts(const std::optional<Estimate>& estimate) {
  if (!estimate) return nullptr;
  return {{"stages_left", estimate->work.stages},
          {"particle_steps_left", estimate->work.particle_steps},
          {"seconds_left", estimate->seconds()},
          {"at_a_time", estimate->at_a_time},
          {"running", estimate->running},
          {"at_most", estimate->at_most},
          {"rate_measured", estimate->work.measured}};
}

void print(const Estimate& left) {
  tell("left: {} stages, {:.3g} particle-steps, {} {} with {} at a time{}\n", left.work.stages,
       left.work.particle_steps, left.at_most ? "at most" : "about",
       format_duration(left.seconds()), left.at_a_time,
       left.running ? ": until " + local_time(left.seconds()) : "; no program computes them now");
}

/// A table for each experiment, each run under the first that declared it, and what is to be said
/// of single runs below them.
void print(const Store& store, const std::vector<SelectedRun>& runs,
           const std::map<std::string, Lease>& by_run, const QueueView& queue) {
  std::vector<std::string> experiments;
  std::map<std::string, std::vector<std::vector<std::string>>> tables;
  std::map<RunState, std::size_t> count;
  const VariantNames names(store);
  for (const auto& [run, first] : runs) {
    const std::string name = first.experiment + " at scale " + first.scale;
    if (!tables.contains(name)) experiments.push_back(name);
    const auto queued = queue.runs.find(run.id);
    const Shown shown{run, first, by_run.contains(run.id),
                      queued == queue.runs.end() ? nullptr : &queued->second};
    tables[name].push_back(row(shown, names));
    if (!queue.runs.empty()) tables[name].back().push_back(shown.queue());
    ++count[shown.state()];
  }
  for (const std::string& name : experiments) {
    tell("{}\n", name);
    std::vector<std::string> header = {"run",   "variant", "seed", "N",
                                       "state", "cycle",   "M/s",  "time"};
    if (!queue.runs.empty()) header.emplace_back("queue");
    print_table(header, tables[name]);
    tell("\n");
  }
  std::string all;
  for (const auto& [state, runs_in_it] : count) {
    all += fmt::format("{}{} {}", all.empty() ? "" : ", ", runs_in_it, name_of(state));
  }
  tell("{} stages{}{}\n", runs.size(), all.empty() ? "" : ": ", all);
  if (const auto left = estimate(store, runs, by_run, queue)) print(*left);
  for (const auto& [run, lease] : by_run) {
    tell("* {} is held by {}\n", run.substr(0, 8), describe(lease.holder));
  }
  for (const OpenSubmission& submission : queue.submissions) {
    if (queue.problem.empty()) tell("{}\n", describe(submission));
  }
  if (!queue.problem.empty()) tell("The queue is not known: {}\n", queue.problem);
  for (const auto& [run, membership] : runs) {
    if (!run.error.empty()) tell("{}: {}\n", run.id.substr(0, 8), run.error);
    if (const nlohmann::json ended = end_of(store, run); !ended.is_null()) {
      tell("{}: ended at cycle {:g}: {}\n", run.id.substr(0, 8), run.cycle, describe_end(ended));
    }
  }
}

void print_facts(const Store& store, const std::vector<SelectedRun>& runs,
                 const std::map<std::string, Lease>& by_run, const QueueView& queue) {
  nlohmann::json list = nlohmann::json::array();
  const VariantNames names(store);
  for (const SelectedRun& selected : runs) {
    const RunRecord& run = selected.run;
    list.push_back(facts(selected, names));
    list.back()["ended"] = end_of(store, run);
    const auto held = by_run.find(run.id);
    list.back()["holder"] = held == by_run.end() ? nlohmann::json() : facts(held->second);
    const auto queued = queue.runs.find(run.id);
    list.back()["queue"] = queued == queue.runs.end() ? nlohmann::json() : facts(queued->second);
  }
  nlohmann::json submissions = nlohmann::json::array();
  for (const OpenSubmission& open : queue.submissions) {
    submissions.push_back({{"id", open.submission.id},
                           {"job", open.submission.job},
                           {"fold_job", open.submission.fold_job},
                           {"tasks", open.submission.tasks.size()},
                           {"in_queue", open.queue.size()}});
  }
  print_json({{"runs", list},
              {"estimate", facts(estimate(store, runs, by_run, queue))},
              {"submissions", submissions},
              {"queue_problem",
               queue.problem.empty() ? nlohmann::json() : nlohmann::json(queue.problem)}});
}

/// Each run once, in the first experiment of those that are selected.
std::vector<SelectedRun> shown_runs(const Store& store, const RunSelection& selection) {
  std::vector<SelectedRun> runs = select_runs(store, selection);
  std::set<std::string> seen;
  std::erase_if(runs, [&](const SelectedRun& s) { return !seen.insert(s.run.id).second; });
  return runs;
}

void status(const RunSelection& selection, Context& context) {
  const Store store(context.store, Access::read);
  const std::vector<SelectedRun> runs = shown_runs(store, selection);
  if (context.json) {
    print_facts(store, runs, holders(store), look_at_queue(store));
  } else {
    print(store, runs, holders(store), look_at_queue(store));
  }
}

// Stages are begun within milliseconds of the end of those before them, so a campaign has ended
// when nobody has held a stage for so long.
constexpr std::chrono::seconds kIdle{10};

bool stages_remain(const std::vector<SelectedRun>& runs) {
  return std::ranges::any_of(runs, [](const SelectedRun& selected) {
    return selected.run.state != RunState::completed && selected.run.state != RunState::failed;
  });
}

/// Sleeps, in short naps. Returns whether a signal ended it.
bool sleep_or_stop(double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!stop_requested() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return stop_requested();
}

/// Prints the status every `interval` seconds until the campaign has ended or a signal comes.
void watch(const RunSelection& selection, Context& context, double interval) {
  catch_stop_signals();
  const bool terminal = terminal_columns(stdout).has_value();
  auto busy_at = std::chrono::steady_clock::now();
  while (true) {
    const Store store(context.store, Access::read);
    const std::vector<SelectedRun> runs = shown_runs(store, selection);
    const std::map<std::string, Lease> by_run = holders(store);
    if (terminal) fmt::print("\x1b[H\x1b[2J");
    const QueueView queue = look_at_queue(store);
    print(store, runs, by_run, queue);
    std::fflush(stdout);
    const auto now = std::chrono::steady_clock::now();
    if (!by_run.empty() || queue.busy()) {
      busy_at = now;
    } else if (!stages_remain(runs) || now - busy_at > kIdle) {
      return;
    }
    // A cluster's queue serves many, and is not asked so often.
    if (sleep_or_stop(queue.submissions.empty() ? interval : std::max(interval, 10.0))) return;
  }
}

/// Seconds of `--watch`, from 0.1 to 86400; nothing when the text is no such number.
std::optional<double> read_interval(const std::string& text) {
  double seconds = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, seconds);
  const bool valid = error == std::errc() && stop == end && seconds >= 0.1 && seconds <= 86400;
  return valid ? std::optional(seconds) : std::nullopt;
}

std::string unfit_interval(const std::string& text) {
  if (text.empty() || read_interval(text)) return "";
  return fmt::format("'{}' is not a number of seconds from 0.1 to 86400", text);
}

}  // namespace

void add_status(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand("status", "List the runs of the store");
  add_common_options(*command, context, true);
  auto selection = std::make_shared<RunSelection>();
  add_selection_options(*command, *selection, true);
  auto interval = std::make_shared<std::string>();
  CLI::Option* watched = command->add_option("--watch", *interval, "Repeat every so many seconds")
                             ->type_name("SECONDS=2")
                             ->expected(0, 1)
                             ->check(unfit_interval)
                             ->excludes("--json");
  command->footer(
      "M/s is million particle-steps per second over all recorded work. A run that is `running` "
      "but\n"
      "that no program holds was killed; `resume` continues it. --watch ends when no stage is "
      "left, or\n"
      "when no program has worked for 10 s and nothing is queued. Runs on a cluster show their "
      "place\n"
      "in its queue and the progress of their tasks. The time left is estimated from the speed so "
      "far.\n"
      "Examples:\n  shearcell status\n  shearcell status --watch\n  shearcell status --json\n"
      "  shearcell status --experiment drag --state failed");
  command->callback([watched, interval, selection, &context] {
    if (watched->count() == 0) return status(*selection, context);
    watch(*selection, context, read_interval(*interval).value_or(2));
  });
}

}  // namespace shearcell::cli
