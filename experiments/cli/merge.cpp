// SPDX-License-Identifier: GPL-3.0-or-later
// `merge`: merges other stores into this one.
#include <fmt/format.h>

#include <memory>

#include "experiments/cli/command.hpp"
#include "experiments/runner/audit.hpp"

namespace shearcell::cli {
namespace {

void merge(const std::vector<std::string>& sources, Context& context) {
  for (const std::string& source : sources) {  // before a store is created
    if (!source.empty() && std::filesystem::exists(std::filesystem::path(source) / "store.sqlite"))
      continue;
    throw NotFound(fmt::format("'{}': there is no store here to merge", source));
  }
  Store store(context.store, Access::create);
  std::vector<Finding> refused;
  const auto reports = merge_stores(store, {sources.begin(), sources.end()}, {}, &refused);
  for (const Finding& finding : refused) {
    print_stderr("no measures were copied from {}: {}\n", finding.subject, finding.message);
  }
  if (context.json) {
    const auto facts = [](const MergeReport& report) -> nlohmann::json {
      return {{"source", report.source},
              {"head", {{"seq", report.head.seq}, {"hash", report.head.hash}}},
              {"events", report.events},
              {"checkpoints", report.checkpoints},
              {"bytes", report.bytes}};
    };
    return print_json({{"merged", json_list(reports, facts)}});
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
merging twice changes nothing. Cached measures are copied if three recomputed ones are right.
Examples:
  shearcell merge task-1 task-2 --store all)");
  command->callback([sources, &context] { merge(*sources, context); });
}

}  // namespace shearcell::cli
