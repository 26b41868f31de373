// SPDX-License-Identifier: GPL-3.0-or-later
// `status`: every run with its state, how far it is and how fast it went.
#include <fmt/format.h>

#include <map>

#include "experiments/cli/command.hpp"
#include "experiments/runner/progress.hpp"

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
          {"seconds_since_renewal", static_cast<double>(now_ms() - lease.renewed_at_ms) * 1e-3}};
}

nlohmann::json facts(const RunRecord& run) {
  const Membership first = run.memberships.empty() ? Membership{} : run.memberships.front();
  return {{"id", run.id},
          {"kind", run.kind},
          {"parent", run.parent},
          {"experiment", first.experiment},
          {"scale", first.scale},
          {"variant", first.variant},
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

std::vector<std::string> row(const RunRecord& run, const std::string& holder) {
  const Membership first = run.memberships.empty() ? Membership{} : run.memberships.front();
  return {run.id.substr(0, 8),
          first.experiment,
          first.variant,
          std::to_string(first.seed),
          std::to_string(run.grains),
          name_of(run.state),
          run.kind == "prepare" ? "" : fmt::format("{:.4g}/{}", run.cycle, run.target_cycles),
          fmt::format("{:.1f}", rate(run) * 1e-6),
          format_duration(run.wall_seconds),
          holder};
}

void status(Context& context) {
  const Store store(context.store, Access::read);
  const std::vector<RunRecord> runs = store.runs();
  const std::map<std::string, Lease> by_run = holders(store);
  if (context.json) {
    nlohmann::json list = nlohmann::json::array();
    for (const RunRecord& run : runs) {
      list.push_back(facts(run));
      const auto held = by_run.find(run.id);
      list.back()["holder"] = held == by_run.end() ? nlohmann::json() : facts(held->second);
    }
    print_json({{"runs", list}});
    return;
  }
  std::vector<std::vector<std::string>> rows;
  for (const RunRecord& run : runs) {
    const auto held = by_run.find(run.id);
    rows.push_back(row(run, held == by_run.end() ? "" : describe(held->second.holder)));
  }
  print_table(
      {"run", "experiment", "variant", "seed", "N", "state", "cycle", "M/s", "time", "held by"},
      rows);
  for (const RunRecord& run : runs) {
    if (!run.error.empty()) fmt::print("{}: {}\n", run.id.substr(0, 8), run.error);
  }
}

}  // namespace

void add_status(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand("status", "List the runs of the store");
  add_common_options(*command, context, true);
  command->footer(
      "M/s is million particle-steps per second over all recorded work. A run that is running and\n"
      "held by nobody was killed; `resume` goes on with it.\n"
      "Examples:\n  shearcell status\n  shearcell status --json");
  command->callback([&context] { status(context); });
}

}  // namespace shearcell::cli
