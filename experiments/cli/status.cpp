// SPDX-License-Identifier: GPL-3.0-or-later
// `status`: lists every run with its state, progress and speed.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/machine.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/cluster/submission.hpp"
#include "experiments/manifest/parameters.hpp"
#include "experiments/runner/outlook.hpp"
#include "experiments/runner/registered.hpp"
#include "provenance/io/clock.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

/// The selected runs, the processes that compute runs now, and the runs in the queue of a cluster.
struct View {
  Store store;
  std::vector<PlacedRun> runs;
  std::map<std::string, Lease> holders;  // run id -> lease, for runs that are being computed
  QueueView queue;
  VariantNames names;

  View(const RunSelection& selection, const Context& context)
      : store(context.store, Access::read),
        runs(by_run(select_runs(store, selection))),
        queue(view_queue(store)),
        names(store) {
    for (Lease& lease : store.leases()) holders.emplace(lease.run, std::move(lease));
  }

  const QueuedRun* queued(const Stage& stage) const {
    const auto found = queue.runs.find(stage.id);
    return found == queue.runs.end() ? nullptr : &found->second;
  }
};

nlohmann::json facts(const Lease& lease) {
  return {{"host", lease.holder.host},
          {"pid", lease.holder.pid},
          {"attempt", lease.attempt},
          {"seconds_since_renewal",
           1e-3 * (static_cast<double>(now_ms()) - static_cast<double>(lease.renewed_at_ms))}};
}

nlohmann::json facts(const QueuedRun& run) {
  const auto& [task, reported] = run;
  return {{"job", task.job},
          {"state", task.state},
          {"reason", task.reason},
          {"node", task.node},
          {"reported_state", reported ? nlohmann::json(name_of(reported->state)) : nullptr},
          {"reported_cycle", reported ? nlohmann::json(reported->cycle) : nullptr}};
}

std::string describe(const QueuedTask& task) {
  const std::string& more = task.state == "pending" ? task.reason : task.node;
  return fmt::format("{} {}{}{}", task.job, task.state, more.empty() ? "" : " ", more);
}

/// Returns state and cycle of the run: those that its cluster task reports, or the stored ones if
/// they are newer. A stored state `running` becomes `interrupted` if the process that computed the
/// run was killed.
std::pair<StageState, double> progress_of(const Stage& stage, const View& view) {
  const QueuedRun* queued = view.queued(stage);
  const bool reported =
      queued != nullptr && queued->reported && stage.state != StageState::completed;
  if (reported && queued->reported->cycle >= stage.cycle) {
    return {queued->reported->state, queued->reported->cycle};
  }
  const bool killed = stage.state == StageState::running && !view.holders.contains(stage.id);
  return {killed ? StageState::interrupted : stage.state, stage.cycle};
}

/// "5/9": the cycle and the number of cycles that the experiment asks for. "2/9 (until)" if `until`
/// ended the run before cycle 9.
std::string describe_cycles(const Store& store, const Stage& stage, const Ask& ask, double cycle) {
  if (stage.kind == name_of(StageKind::prepare)) return "";
  const auto asked = static_cast<double>(ask.target_cycles);
  double end = asked;
  if (!ask.until.is_null()) {
    Stage of_ask = stage;
    of_ask.memberships = {{{}, ask}};
    if (const Outlook look = look_at(store, of_ask); look.unreadable.empty()) end = look.end;
  }
  return fmt::format("{:.4g}/{}{}", std::min(cycle, end), ask.target_cycles,
                     end < asked && cycle >= end ? " (until)" : "");
}

/// The row of a run for one experiment. In the table, state and cycle come from the cluster task if
/// it reports them. In JSON, they come from the store.
Facts facts(const PlacedRun& listed, const Membership& shown, const View& view) {
  const Stage& stage = listed.stage;
  const auto held = view.holders.find(stage.id);
  const bool is_held = held != view.holders.end();
  const QueuedRun* queued = view.queued(stage);
  const bool in_queue = queued != nullptr && stage.state != StageState::completed;
  const auto [state, cycle] = progress_of(stage, view);
  const double rate = stage.wall_seconds > 0 ? stage.particle_steps / stage.wall_seconds : 0;
  const Place& place = shown.place;
  const std::string name = view.names.of(stage, place);
  const auto place_facts = [&](const Membership& m) -> nlohmann::json {
    return {{"experiment", m.place.experiment},
            {"scale", scale_name(m.place.scale)},
            {"variant", m.place.variant},
            {"name", view.names.of(stage, m.place)},
            {"seed", m.place.seed},
            {"newest", m.newest},
            {"target_cycles", m.ask.target_cycles},
            {"manifest", m.place.manifest}};
  };
  Facts all = {
      {"id", stage.id, "run", stage.id.substr(0, 8)},
      {"name", name, "variant",
       shown.newest ? name : fmt::format("{} (older version {:.8})", name, place.manifest)},
      {"seed", place.seed, "seed"},
      {"N", stage.grains, "N"},
      {"state", name_of(stage.state), "state",
       fmt::format("{}{}", name_of(state), is_held ? " *" : "")},
      {"cycle", stage.cycle, "cycle", describe_cycles(view.store, stage, shown.ask, cycle)},
      {"particle_steps_per_second", rate, "M/s", fmt::format("{:.1f}", rate * 1e-6)},
      {"wall_seconds", stage.wall_seconds, "time", format_duration(stage.wall_seconds)},
      {"queue", queued == nullptr ? nlohmann::json() : facts(*queued)},
      {"experiment", place.experiment},
      {"scale", scale_name(place.scale)},
      {"variant", place.variant},
      {"kind", stage.kind},
      {"parent", stage.parent},
      {"places", list_of(listed.places, place_facts)},
      {"target_cycles", stage.target_cycles},
      {"step", stage.step},
      {"attempts", stage.attempts},
      {"state_hash", stage.state_hash},
      {"error", stage.error},
      {"updated_at", stage.updated_at},
      {"ended", end_of(stage)},
      {"holder", is_held ? facts(held->second) : nlohmann::json()}};
  if (!view.queue.runs.empty()) {
    all.push_back({"", nullptr, "queue", in_queue ? describe(queued->task) : ""});
  }
  return all;
}

/// The remaining work, and the time that this work will take at the mean speed so far. Stages that
/// failed or cannot start are left out.
struct Estimate {
  std::string problem;  ///< why a run cannot be read, else ""; if set, `work` is incomplete
  Work work;
  /// Number of stages computed at the same time. If none is computed now: one per usable core.
  std::size_t at_a_time = 1;
  bool running = false;  ///< whether a stage is computed now
  bool at_most = false;  ///< the time is an upper limit: `until` may end runs early

  bool any() const { return problem.empty() && work.stages > 0; }
  double seconds() const { return work.seconds(at_a_time); }
};

Estimate estimate(const View& view) {
  const Rates rates(view.store.stages());
  std::size_t running = 0;
  Estimate made;
  for (const auto& [stage, places] : view.runs) {
    const QueuedRun* queued = view.queued(stage);
    const bool in_task = queued != nullptr && queued->task.state == "running";
    running += view.holders.contains(stage.id) || in_task ? 1 : 0;
    if (has_failed(view.store, stage)) continue;
    const Outlook look = look_at(view.store, stage);
    if (look.done) continue;
    if (!look.unreadable.empty()) {
      made.problem = fmt::format("run {:.8}: {}; `shearcell verify` checks the store", stage.id,
                                 look.unreadable);
      return made;
    }
    made.at_most = made.at_most || look.may_end_early;
    made.work.add(stage, look, rates);
  }
  made.running = running > 0;
  made.at_a_time = std::min(made.running ? running : usable_cores(), made.work.stages);
  return made;
}

std::string local_time(double seconds_from_now) {
  const double then = static_cast<double>(now_ms()) * 1e-3 + seconds_from_now;
  return fmt::format("{:%F %R %Z}", fmt::localtime(static_cast<std::time_t>(then)));
}

nlohmann::json facts(const Estimate& left) {
  if (!left.any()) return nullptr;
  return {{"stages_left", left.work.stages},
          {"particle_steps_left", left.work.particle_steps},
          {"seconds_left", left.seconds()},
          {"at_a_time", left.at_a_time},
          {"running", left.running},
          {"at_most", left.at_most},
          {"rate_measured", left.work.measured}};
}

/// The text, or null if it is empty.
nlohmann::json text_or_null(const std::string& text) {
  return text.empty() ? nlohmann::json() : nlohmann::json(text);
}

void print(const Estimate& left) {
  if (!left.problem.empty()) print_text("The remaining work is unknown: {}\n", left.problem);
  if (!left.any()) return;
  print_text("left: {}, {:.3g} particle-steps, {} {}, computing {} at a time{}\n",
             counted(left.work.stages, "stage"), left.work.particle_steps,
             left.at_most ? "at most" : "about", format_duration(left.seconds()), left.at_a_time,
             left.running ? ", until " + local_time(left.seconds())
                          : "; no process is computing them now");
}

void print_tables(const View& view) {
  nlohmann::ordered_map<std::string, std::vector<Facts>> tables;
  std::map<StageState, std::size_t> count;
  for (const PlacedRun& listed : view.runs) {
    ++count[progress_of(listed.stage, view).first];
    for (const Membership& shown : listed.places) {
      const std::string name = shown.place.experiment + at_scale(shown.place.scale);
      tables[name].push_back(facts(listed, shown, view));
    }
  }
  for (const auto& [name, rows] : tables) {
    print_text("{}\n", name);
    print_table(rows);
    print_text("\n");
  }
  std::string all;
  for (const auto& [state, runs_in_it] : count) {
    all += fmt::format("{}{} {}", all.empty() ? ": " : ", ", runs_in_it, name_of(state));
  }
  print_text("{}{}\n", counted(view.runs.size(), "stage"), all);
}

void print(const View& view) {
  print_tables(view);
  print(estimate(view));
  const auto waiting = std::ranges::count_if(view.runs, [&](const PlacedRun& one) {
    return one.stage.state != StageState::failed && has_failed(view.store, one.stage);
  });
  if (waiting > 0) {
    print_text("{} cannot start, because a required stage has failed\n",
               counted(static_cast<std::size_t>(waiting), "stage"));
  }
  for (const auto& [run, lease] : view.holders) {
    print_text("* {} is computed by {}\n", run.substr(0, 8), describe(lease.holder));
  }
  const std::string& problem = view.queue.problem;
  for (const Submission& submission : view.queue.submissions) {
    if (problem.empty()) print_text("{}\n", describe(submission));
  }
  if (!problem.empty()) print_text("The queue of the cluster cannot be read: {}\n", problem);
  for (const auto& [stage, places] : view.runs) {
    if (!stage.error.empty()) print_text("{}: {}\n", stage.id.substr(0, 8), stage.error);
    if (const std::string why = describe_end(end_of(stage)); !why.empty()) {
      print_text("{}: ended at cycle {:g}: {}\n", stage.id.substr(0, 8), stage.cycle, why);
    }
  }
}

void status(const RunSelection& selection, Context& context) {
  const View view(selection, context);
  if (!context.json) return print(view);
  const Estimate left = estimate(view);
  print_json({{"runs", list_of(view.runs,
                               [&](const PlacedRun& run) {
                                 return to_json(facts(run, run.places.front(), view));
                               })},
              {"estimate", facts(left)},
              {"estimate_problem", text_or_null(left.problem)},
              {"submissions", list_of(view.queue.submissions,
                                      [](const Submission& open) -> nlohmann::json {
                                        return {{"id", open.id},
                                                {"job", open.job},
                                                {"fold_job", open.merge_job},
                                                {"tasks", open.tasks.size()},
                                                {"in_queue", open.queue.size()}};
                                      })},
              {"queue_problem", text_or_null(view.queue.problem)}});
}

}  // namespace

void add_status(CLI::App& app, Context& context) {
  const auto [command, selection] =
      add_command(app, context, "status", "List the runs of the store", status);
  selection->packings = true;
  add_selection_options(*command, *selection, true);
  add_common_options(
      *command, context,
      R"(M/s is million particle-steps per second, averaged over all recorded work. The cycle 2/9 (until)
means that the experiment asks for 9 cycles and that `until` ended the run at cycle 2. A run whose
program was killed is shown as interrupted (with --json as `running` without a `holder`). `resume`
continues this run. For runs on a cluster, the state in the queue and the progress of the task are
shown. The remaining time is estimated from the speed so far.
Examples:
  shearcell status
  watch -n 10 shearcell status
  shearcell status --json
  shearcell status --experiment drag --state failed)");
}

}  // namespace shearcell::cli
