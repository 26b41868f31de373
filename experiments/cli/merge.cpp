// SPDX-License-Identifier: GPL-3.0-or-later
// `merge`: merges other stores into this one.
#include <fmt/format.h>

#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "experiments/cli/command.hpp"
#include "experiments/runner/audit.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

using Runs = std::set<std::string>;                                 // ids
using Version = std::tuple<std::string, std::string, std::string>;  // experiment, scale, manifest

/// What figures and tables show of a store, and what not: runs of older versions of a manifest.
struct Shown {
  std::map<Version, Runs> shown;
  std::map<std::pair<std::string, std::string>, Runs> left_out;  // by experiment and scale
};

void add_shown(const Store& store, Shown& all) {
  for (const Run& run : select_runs(store, {})) {
    const Ask& place = run.ask;
    Runs& runs = place.newest ? all.shown[{place.experiment, place.scale, place.manifest}]
                              : all.left_out[{place.experiment, place.scale}];
    runs.insert(run.stage.id);
  }
}

/// Warns of runs that figures showed before the merge, of this store or of a source, and do not
/// show after it, since another version of the manifest was registered later. `own`: of this store
/// before the merge, `before`: also of the sources.
void warn_of_left_out(const Shown& own, const Shown& before, const Shown& now, Context& context) {
  for (const auto& [version, runs] : before.shown) {
    const auto& [experiment, scale, manifest] = version;
    // The version that is shown now.
    const auto newest = now.shown.lower_bound({experiment, scale, ""});
    if (newest == now.shown.end() || now.shown.contains(version)) continue;
    const auto& [its_experiment, its_scale, its_manifest] = newest->first;
    if (its_experiment != experiment || its_scale != scale) continue;
    const auto told = own.left_out.find({experiment, scale});
    std::size_t lost = 0;
    for (const std::string& run : runs) {
      const bool known = told != own.left_out.end() && told->second.contains(run);
      lost += newest->second.contains(run) || known ? 0 : 1;
    }
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
  Shown own;
  add_shown(store, own);
  Shown before = own, now;
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
  warn_of_left_out(own, before, now, context);
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
