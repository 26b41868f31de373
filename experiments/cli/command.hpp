// SPDX-License-Identifier: GPL-3.0-or-later
// What the subcommands share: common options, output and exit codes.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "experiments/figures/select_runs.hpp"
#include "experiments/manifest/expand.hpp"
#include "experiments/runner/measure.hpp"
#include "experiments/runner/terminal.hpp"
#include "provenance/store.hpp"

namespace shearcell::cli {

enum ExitCode : int {
  kDone = 0,
  kOtherError = 1,  ///< the machine failed: disk full, store locked, out of memory
  kUsageError = 2,  ///< usage or manifest
  kRunFailed = 3,   ///< a run failed numerically or does not fit into memory
  kStoreDamaged = 4,
  kInterrupted = 85,  ///< resumable
};

/// Common options, and the exit code.
struct Context {
  std::string store = "shearcell-store";
  bool json = false;
  int exit_code = kDone;
  std::vector<std::string> warnings = {};  ///< of warn()
};

/// Prints a warning to standard error, and keeps it for the command's JSON.
void warn(Context& context, const std::string& warning);

/// Sets the exit code, unless a more serious one is set. Most serious first: 4, 3, 2, 1, 85.
void fail(Context& context, ExitCode code);

/// Opens the store for reading; nothing if there is no store yet.
std::optional<Store> open_if_there(const std::string& folder);

/// Prints the problems of measuring, each checkpoint after the words `left_out`. Damage sets the
/// exit code.
void print_problems(const MeasureOutcome& outcome, const char* left_out, Context& context);

// Each adds a subcommand to the parser; add_run also adds `resume`.
using AddCommand = void(CLI::App& app, Context& context);
AddCommand add_plan, add_run, add_status, add_log, add_show, add_verify, add_rebuild, add_prune,
    add_regenerate, add_submit, add_merge, add_table, add_figures, add_report, add_export,
    add_bench, add_new, add_doctor, add_manual;

struct Freed {
  std::size_t measured = 0;  ///< checkpoints
  std::uint64_t bytes = 0;
};

/// keep_measures(), then deletes the files of these checkpoints. Names those that cannot be
/// measured, whose files are kept, and removes them from `records`; the exit code is then 4 for a
/// damaged file, 1 if measures cannot be cached. Several threads may call it at once.
Freed free_files(Store& store, std::vector<CheckpointRecord>& records,
                 const MeasureOptions& options, bool last_too, Context& context);

/// Why nothing can be written to the path: it is empty, or among the checkpoint files of a store;
/// "" if neither.
std::string unfit_output(const std::string& path);
/// unfit_output() of a folder, which cannot be "-".
std::string unfit_folder(const std::string& path);

/// Whether --out names an open stream: "-" (standard output), a pipe, or a device such as
/// /dev/null.
bool is_stream(const std::string& out);

/// Writes to the stream, or else as write_output(). A terminal gets escaped text.
void write_result(const std::string& out, const std::string& text);

/// --json.
void add_json_option(CLI::App& command, Context& context);

/// Adds a subcommand that calls run(options, context). Its options live as long as the parser.
template <class Options>
auto add_command(CLI::App& app, Context& context, const char* name, const char* about,
                 void (*run)(Options&, Context&)) {
  const auto options = std::make_shared<std::remove_const_t<Options>>();
  CLI::App* command = app.add_subcommand(name, about);
  command->callback([options, run, &context] { run(*options, context); });
  return std::pair(command, options.get());
}

/// --store DIR and --json, and the text below all options.
void add_common_options(CLI::App& command, Context& context, const std::string& footer);

/// --scale, --cycles, --seeds, --variant and --seed, which select runs of a manifest.
void add_expand_options(CLI::App& command, ExpandOptions& options);

/// Reads and expands each manifest once. A manifest whose `start` names a run of another manifest
/// comes after that one. warn() gets the warnings, also about runs of the store and about two
/// different manifests of one `experiment`. With `brief`, many warnings of one manifest become one.
std::vector<Plan> load_plans(const std::vector<std::string>& paths, const ExpandOptions& options,
                             Context& context, bool brief = true);

/// --experiment, --scale, --variant and --seed, and with `states` --state; all can be repeated.
void add_selection_options(CLI::App& command, RunSelection& selection, bool states = false);

/// A stage with its selected places.
struct PlacedRun {
  Stage stage;
  std::vector<Membership> places;
};

/// The stages of the runs, each once, in the order of their first places.
std::vector<PlacedRun> by_run(const std::vector<Run>& selected);

/// An error message if the text is not a decimal number from `low` to `high`; else "". A double may
/// have a fraction and an exponent; a std::uint64_t must not have leading zeros.
template <class Number>
std::string unfit(const std::string& text, Number low, Number high);

template <class Value>
using NumberOf = std::conditional_t<std::is_floating_point_v<Value>, double, std::uint64_t>;

/// Adds an option that takes a number from `low` to `high`.
template <class Value>
CLI::Option* add_number(CLI::App& command, const std::string& names, Value& value,
                        const std::string& help, const std::string& type_name = "N",
                        NumberOf<Value> low = 0,
                        NumberOf<Value> high = std::numeric_limits<NumberOf<Value>>::max()) {
  const auto check = [low, high](const std::string& text) { return unfit(text, low, high); };
  return command.add_option(names, value, help)->check(check)->type_name(type_name);
}

/// Allows the names of an enumeration.
template <class Enum>
CLI::IsMember one_of() {
  return CLI::IsMember(std::vector<std::string>(kNames<Enum>.begin(), kNames<Enum>.end()));
}

/// --threads T.
void add_threads_option(CLI::App& command, std::size_t& threads, const std::string& help);

/// --engine NAME.
void add_engine_option(CLI::App& command, ExpandOptions& options);

/// The folder of the store, or the nearest existing folder above it.
std::filesystem::path existing_folder(const std::string& store);

/// Prints one JSON value, indented by two.
void print_json(const nlohmann::json& facts);

/// facts(item) for each item.
auto list_of(const auto& items, const auto& facts) {
  std::vector<std::decay_t<decltype(facts(*std::begin(items)))>> list;
  for (const auto& item : items) list.push_back(facts(item));
  return list;
}

/// One value of a result: a key of its JSON and, with a heading, a cell of its table or a line.
struct Fact {
  std::string key;  ///< "" for text alone
  nlohmann::json value;
  std::optional<std::string> heading = {};  ///< of the column or line; none for JSON alone
  std::optional<std::string> text = {};     ///< in the table or line; none: the value itself

  bool operator==(const Fact&) const = default;
};
using Facts = std::vector<Fact>;  ///< of one row, or of one thing

/// The facts as one JSON object.
nlohmann::json to_json(const Facts& facts);
nlohmann::json to_json(const std::vector<Facts>& rows);

/// Prints rows under their headings, which all of them have; each column as wide as its longest
/// cell, numbers right-aligned. On a terminal, long words are cut with ~ at the end so that the
/// table fits, and states have colours.
void print_table(const std::vector<Facts>& rows);

/// Prints "HEADING  text" for each fact that has a heading. Further lines of the text stand below
/// the first one; an empty text has no line.
void print_lines(const Facts& facts);

/// Prints {"NAME": [...]} or a table.
void print_list(const char* name, const std::vector<Facts>& rows, const Context& context);

/// "12.3 kB".
std::string format_bytes(double bytes);

}  // namespace shearcell::cli
