// SPDX-License-Identifier: GPL-3.0-or-later
// `merge`: merges other stores into this one.
#include <fmt/format.h>

#include "experiments/cli/command.hpp"
#include "experiments/runner/audit.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

void merge(const std::vector<std::string>& sources, Context& context) {
  for (const std::string& source : sources) {  // checks all sources before a store is created
    if (!source.empty() && std::filesystem::exists(std::filesystem::path(source) / "store.sqlite"))
      continue;
    throw NotFound(fmt::format("'{}': this folder contains no store", source));
  }
  Store store(context.store, Access::create);
  const auto reports = merge_stores(store, {sources.begin(), sources.end()});
  MeasureOutcome not_copied;
  for (const MergeReport& report : reports) {
    for (const Finding& finding : report.refused) {
      const std::string what = report.source + ": " + finding.message;
      if (finding.severity == Finding::Severity::error) {
        not_copied.damage.insert(what);
      } else {
        print_stderr("measures cannot be cached: {}\n", what);
        fail(context, kOtherError);
      }
    }
  }
  print_problems(not_copied, "measures not copied", context);
  for (const MergeReport& report : reports) {
    if (report.absent == 0) continue;
    warn(context,
         fmt::format("{}: {} of pruned checkpoints {} missing", report.source,
                     counted(report.absent, "measure"), report.absent == 1 ? "is" : "are"));
  }
  if (context.json) {
    const auto facts = [](const MergeReport& report) -> nlohmann::json {
      return {{"source", report.source},
              {"head", {{"seq", report.head.seq}, {"hash", report.head.hash}}},
              {"events", report.events},
              {"checkpoints", report.checkpoints},
              {"bytes", report.bytes}};
    };
    return print_json({{"merged", list_of(reports, facts)}, {"warnings", context.warnings}});
  }
  for (const MergeReport& report : reports) {
    print_text("{}: merged {} new events (of {}) and {} new checkpoints ({})\n", report.source,
               report.events, report.head.seq, report.checkpoints, format_bytes(report.bytes));
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
      R"(Before anything changes, checks the event chain of each source and every file to copy. Stops if
two stores record different states of one run at the same step. The sources do not change, and
merging a source again has no effect. If the stores have different versions of a manifest, figures
show the version that was registered last, and `figures` names the runs that it leaves out. To show
all runs, run one manifest that lists all of them; only missing runs are computed.
Cached measures of a source are copied if recomputing three sampled checkpoints gives the same
values. Measures of pruned checkpoints that differ from their digests in the log are left out. Lost
or pruned files of this store are not restored: copy them, or use `regenerate`.
Examples:
  shearcell merge task-1 task-2 --store all)");
}

}  // namespace shearcell::cli
