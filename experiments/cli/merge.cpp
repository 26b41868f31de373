// SPDX-License-Identifier: GPL-3.0-or-later
// `merge`: merges other stores into this one.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "experiments/cli/command.hpp"
#include "experiments/runner/audit.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

using Runs = std::set<std::string>;  // ids

/// The runs of one experiment at one scale.
struct Shown {
  std::map<std::string, Runs> versions;  // of the manifest, with the runs that figures show
  Runs left_out;
};
using ShownAt = std::map<std::pair<std::string, std::string>, Shown>;  // by experiment and scale

/// What figures and tables show of a store.
ShownAt shown_of(const Store& store) {
  ShownAt shown;
  const std::vector<Run> all = select_runs(store, {});
  const auto at = [&](const Run& one) -> Shown& {
    return shown[{one.ask.experiment, one.ask.scale}];
  };
  for (const Run& one : all) at(one).left_out.insert(one.stage.id);
  for (const Run& one : newest_runs(all).runs) {
    at(one).left_out.erase(one.stage.id);
    at(one).versions[one.ask.manifest].insert(one.stage.id);
  }
  return shown;
}

ShownAt shown_of_source(const std::string& source) {
  try {
    return shown_of(Store(source, Access::read));
  } catch (const std::exception&) {
    return {};  // the merge reports what is wrong
  }
}

/// Warns of runs that figures showed before the merge, of this store or of a source, and do not
/// show after it, since another version of the manifest was registered later.
void warn_of_left_out(const ShownAt& own, const std::vector<ShownAt>& sources,
                      const ShownAt& merged, Context& context) {
  for (const auto& [where, now] : merged) {
    Runs old;  // that this store left out before
    std::map<std::string, Runs> versions;
    const auto take = [&, &where = where](const ShownAt& store) {
      const auto here = store.find(where);
      if (here == store.end()) return;
      for (const auto& [version, runs] : here->second.versions) {
        versions[version].insert(runs.begin(), runs.end());
      }
    };
    take(own);
    for (const ShownAt& source : sources) take(source);
    if (const auto here = own.find(where); here != own.end()) old = here->second.left_out;
    for (const auto& [version, runs] : versions) {
      const auto lost = std::ranges::count_if(runs, [&, &now = now](const std::string& run) {
        return now.left_out.contains(run) && !old.contains(run);
      });
      if (lost == 0 || now.versions.empty()) continue;
      const auto& [newest, shown] = *now.versions.begin();
      warn(context,
           fmt::format("experiment {} at scale {}: the merged stores have two versions of its "
                       "manifest. Figures now show the version registered last, {:.8}, with {}, "
                       "and leave out {} of the {} of version {:.8}. To show all, `shearcell run` "
                       "one manifest that states the runs of both: it computes nothing new.",
                       where.first, scale_name(where.second), newest, counted(shown.size(), "run"),
                       lost, counted(runs.size(), "run"), version));
    }
  }
}

void merge(const std::vector<std::string>& sources, Context& context) {
  for (const std::string& source : sources) {  // before a store is created
    if (!source.empty() && std::filesystem::exists(std::filesystem::path(source) / "store.sqlite"))
      continue;
    throw NotFound(fmt::format("'{}': there is no store here to merge", source));
  }
  Store store(context.store, Access::create);
  const ShownAt before = shown_of(store);
  std::vector<ShownAt> shown;
  for (const std::string& source : sources) shown.push_back(shown_of_source(source));
  std::vector<Finding> refused;
  const auto reports = merge_stores(store, {sources.begin(), sources.end()}, {}, &refused);
  for (const Finding& finding : refused) {
    print_stderr("no measures were copied from {}: {}\n", finding.subject, finding.message);
  }
  warn_of_left_out(before, shown, shown_of(store), context);
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
  auto sources = std::make_shared<std::vector<std::string>>();
  CLI::App* command = app.add_subcommand("merge", "Merge other stores into this one");
  command->add_option("source", *sources, "Folders of the stores to merge")
      ->required()
      ->type_name("STORE");
  add_common_options(*command, context);
  command->footer(
      R"(Checks the chain of each source and every file to copy before anything changes. Refuses two
stores that record different states of one run at one step. The sources stay unchanged, and
merging twice changes nothing. If the stores have different versions of a manifest, figures show
the one registered last; the command then names the runs that they leave out. To show all, run one
manifest that states the runs of both: it computes nothing new. Cached measures are copied if three
recomputed ones are right.
Examples:
  shearcell merge task-1 task-2 --store all)");
  command->callback([sources, &context] { merge(*sources, context); });
}

}  // namespace shearcell::cli
