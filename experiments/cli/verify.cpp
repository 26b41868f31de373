// SPDX-License-Identifier: GPL-3.0-or-later
// `verify`: whether the store still is what was written.
#include <fmt/format.h>

#include "experiments/cli/command.hpp"

namespace shearcell::cli {
namespace {

const char* name_of_severity(const Finding& finding) {
  return finding.severity == Finding::Severity::error ? "error" : "note";
}

void verify(Context& context) {
  const Store store(context.store, Access::read);
  const VerifyReport report = store.verify();
  if (!report.ok()) context.exit_code = kStoreDamaged;
  if (context.json) {
    nlohmann::json findings = nlohmann::json::array();
    for (const Finding& finding : report.findings) {
      findings.push_back({{"severity", name_of_severity(finding)},
                          {"subject", finding.subject},
                          {"run", finding.run},
                          {"message", finding.message}});
    }
    print_json({{"ok", report.ok()},
                {"events", report.events},
                {"checkpoints", report.checkpoints},
                {"bytes", report.bytes},
                {"orphans", report.orphans},
                {"head", {{"seq", report.head.seq}, {"hash", report.head.hash}}},
                {"findings", findings}});
    return;
  }
  for (const Finding& finding : report.findings) {
    fmt::print("{}: {}: {}\n", name_of_severity(finding), finding.subject, finding.message);
  }
  fmt::print("{} events, {} checkpoints ({}), {} orphans: {}\nhead {} {}\n", report.events,
             report.checkpoints, format_bytes(static_cast<double>(report.bytes)), report.orphans,
             report.ok() ? "all as it was written" : "DAMAGED", report.head.seq, report.head.hash);
}

}  // namespace

void add_verify(CLI::App& app, Context& context) {
  CLI::App* command =
      app.add_subcommand("verify", "Check the event chain, every file's hash and the projections");
  add_common_options(*command, context, true);
  command->footer("Examples:\n  shearcell verify\n  shearcell verify --json");
  command->callback([&context] { verify(context); });
}

}  // namespace shearcell::cli
