// SPDX-License-Identifier: GPL-3.0-or-later
// `merge`: merges other stores into this one.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "experiments/cli/command.hpp"
#include "experiments/runner/audit.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

using Version = std::tuple<std::string, std::string, std::string>;  // experiment, scale, manifest
using Shown = std::map<Version, std::set<std::string>>;             // ids of runs

/// Adds the runs that figures and tables show of a store: none of older versions of a manifest.
void add_shown(const Store& store, Shown& shown) {
  for (const Run& run : select_runs(store, {})) {
    if (!run.newest) continue;
    shown[{run.experiment, run.scale, run.manifest}].insert(run.stage.id);
  }
}

/// Warns of runs that figures showed before the merge, of this store or of a source, and do not
/// show after it, since another version of the manifest was registered later.
void warn_of_left_out(const Shown& before, const Shown& now, Context& context) {
  for (const auto& [version, runs] : before) {
    const auto& [experiment, scale, manifest] = version;
    // The version that is shown now.
    const auto newest = now.lower_bound({experiment, scale, ""});
    if (newest == now.end() || now.contains(version)) continue;
    const auto& [its_experiment, its_scale, its_manifest] = newest->first;
    if (its_experiment != experiment || its_scale != scale) continue;
    const auto lost = std::ranges::count_if(
        runs, [&](const std::string& run) { return !newest->second.contains(run); });
    if (lost == 0) continue;
    warn(context,
         fmt::format("experiment {} at scale {}: the merged stores have two versions of its "
                     "manifest. Figures now show the version registered last, {:.8}, with {}, "
                     "and leave out {} of the {} of version {:.8}. To show all, `shearcell run` "
                     "one manifest that states the runs of both: it computes nothing new.",
                     experiment, scale_name(scale), its_manifest,
                     counted(newest->second.size(), "run"), lost, counted(runs.size(), "run"),
                     manifest));
  }
}

void merge(const std::vector<std::string>& sources, Context& context) {
  for (const std::string& source : sources) {  // before a store is created
    if (!source.empty() && std::filesystem::exists(std::filesystem::path(source) / "store.sqlite"))
      continue;
    throw NotFound(fmt::format("'{}': there is no store here to merge", source));
  }
  Store store(context.store, Access::create);
  Shown before, now;
  add_shown(store, before);
  for (const std::string& source : sources) {
    try {
      add_shown(Store(source, Access::read), before);
    } catch (const std::exception&) {
      // The merge reports what is wrong.
    }
  }
  std::vector<Finding> refused;
  const auto reports = merge_stores(store, {sources.begin(), sources.end()}, {}, &refused);
  for (const Finding& finding : refused) {
    print_stderr("no measures were copied from {}: {}\n", finding.subject, finding.message);
  }
  add_shown(store, now);
  // A source that was merged before says nothing new.
  const bool changed =
      std::ranges::any_of(reports, [](const MergeReport& report) { return report.events > 0; });
  if (changed) warn_of_left_out(before, now, context);
  if (context.json) {
    const auto facts = [](const MergeReport& report) -> nlohmann::json {
      return {{"source", report.source},
              {"head", {{"seq", report.head.seq}, {"hash", report.head.hash}}},
              {"events", report.events},
              {"checkpoints", report.checkpoints},
              {"bytes", report.bytes}};
    };
    return print_json({{"merged", json_list(reports, facts)}, {"warnings", context.warnings}});
  }
  for (const MergeReport& report : reports) {
    print_text("{}: {} of {} events and {} checkpoints ({}) were new\n", report.source,
               report.events, report.head.seq, report.checkpoints,
               format_bytes(static_cast<double>(report.bytes)));
  }
}

}  // namespace

void add_merge(CLI::App& app, Context& context) {
  const auto [command, sources] =
      add_command(app, context, "merge", "Merge other stores into this one", merge);
  command->add_option("source", *sources, "Folders of the stores to merge")
      ->required()
      ->type_name("STORE");
  add_common_options(
      *command, context,
      R"(Checks the chain of each source and every file to copy before anything changes. Refuses two
stores that record different states of one run at one step. The sources stay unchanged, and
merging twice changes nothing. If the stores have different versions of a manifest, figures show
the one registered last; the command then names the runs that they leave out. To show all, run one
manifest that states the runs of both: it computes nothing new. Cached measures are copied if three
recomputed ones are right.
Examples:
  shearcell merge task-1 task-2 --store all)");
}

}  // namespace shearcell::cli
