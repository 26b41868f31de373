// SPDX-License-Identifier: GPL-3.0-or-later
// What the subcommands share: where the store is, how to print, and how the program ends.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/cli/exit_code.hpp"
#include "experiments/figures/measure.hpp"
#include "experiments/figures/select_runs.hpp"
#include "experiments/manifest/expand.hpp"
#include "experiments/runner/campaign.hpp"
#include "experiments/runner/terminal.hpp"
#include "provenance/store.hpp"

namespace shearcell::cli {

/// Filled in by the options, read by the subcommands.
struct Context {
  std::string store = "shearcell-store";
  bool json = false;
  int exit_code = kDone;
};

/// Each subcommand lives in a file of its own and adds itself here.
void add_plan(CLI::App& app, Context& context);
void add_run(CLI::App& app, Context& context);
void add_status(CLI::App& app, Context& context);
void add_log(CLI::App& app, Context& context);
void add_show(CLI::App& app, Context& context);
void add_verify(CLI::App& app, Context& context);
void add_rebuild(CLI::App& app, Context& context);
void add_prune(CLI::App& app, Context& context);
void add_regenerate(CLI::App& app, Context& context);
void add_submit(CLI::App& app, Context& context);
void add_work(CLI::App& app, Context& context);
void add_merge(CLI::App& app, Context& context);
void add_table(CLI::App& app, Context& context);
void add_figures(CLI::App& app, Context& context);
void add_report(CLI::App& app, Context& context);
void add_export(CLI::App& app, Context& context);
void add_bench(CLI::App& app, Context& context);
void add_new(CLI::App& app, Context& context);
void add_doctor(CLI::App& app, Context& context);
void add_completion(CLI::App& app, Context& context);
void add_manual(CLI::App& app, Context& context);

/// Prints what came of a campaign and sets the exit code.
void report(const CampaignResult& result, Context& context);

/// --store DIR, and --json where the subcommand prints facts.
void add_common_options(CLI::App& command, Context& context, bool with_json);

/// --scale, --cycles and --seeds: what of a manifest is meant.
void add_expand_options(CLI::App& command, ExpandOptions& options);

/// --experiment, --scale, --variant and --seed, each as often as wanted; with `states`, --state.
void add_selection_options(CLI::App& command, RunSelection& selection, bool states = false);

/// All cores; progress on standard error if that is a terminal.
MeasureOptions measure_options();

/// What is wrong with a whole number in decimal digits from `low` to `high`; "" when nothing is.
std::string unfit_count(const std::string& text, std::uint64_t low, std::uint64_t high);

/// The same of a number from `low` to `high`, which may have a fraction and an exponent.
std::string unfit_number(const std::string& text, double low, double high);

/// An option that takes such a number.
template <class Count>
CLI::Option* add_count(CLI::App& command, const std::string& names, Count& value,
                       const std::string& help, const std::string& type_name = "N",
                       std::uint64_t low = 0, std::uint64_t high = UINT64_MAX) {
  const auto check = [low, high](const std::string& text) { return unfit_count(text, low, high); };
  return command.add_option(names, value, help)->check(check)->type_name(type_name);
}

/// An option that takes a number.
CLI::Option* add_number(CLI::App& command, const std::string& names, double& value,
                        const std::string& help, const std::string& type_name, double low,
                        double high);

/// --threads T.
void add_threads_option(CLI::App& command, std::size_t& threads, const std::string& help);

/// --engine NAME.
void add_engine_option(CLI::App& command, ExpandOptions& options);

/// Prints facts for programs: one JSON value, indented by two.
void print_json(const nlohmann::json& facts);

/// Prints rows under a header, each column as wide as its longest cell; numbers to the right. On a
/// terminal words are cut, with ~ at the end, until the table fits, and states have colours.
void print_table(const std::vector<std::string>& header,
                 const std::vector<std::vector<std::string>>& rows);

/// "12.3 kB".
std::string format_bytes(double bytes);

}  // namespace shearcell::cli
