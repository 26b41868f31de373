// SPDX-License-Identifier: GPL-3.0-or-later
// What the subcommands share: common options, output and exit codes.
#pragma once

#include <fmt/format.h>

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
#include "provenance/io/read_number.hpp"
#include "provenance/json_text.hpp"
#include "provenance/store.hpp"

namespace shearcell::cli {

enum ExitCode : int {
  kDone = 0,
  kOtherError = 1,  ///< the machine failed: disk full, store locked, out of memory
  kUsageError = 2,  ///< an error in the command line or in a manifest
  kRunFailed = 3,   ///< a run failed numerically or does not fit into memory
  kStoreDamaged = 4,
  kInterrupted = 85,  ///< resumable
};

/// Values of the common options, warnings so far, and the exit code.
struct Context {
  std::string store = "shearcell-store";
  bool json = false;
  int exit_code = kDone;
  std::vector<std::string> warnings = {};  ///< all texts that warn() has printed
};

/// Prints a warning to standard error and appends it to `context.warnings` for JSON output.
void warn(Context& context, const std::string& warning);

/// Sets the exit code unless a more serious code is set. Most serious first: 4, 3, 2, 1, 85.
void fail(Context& context, ExitCode code);

/// Opens the store for reading. Returns nothing if the folder does not exist or is empty.
std::optional<Store> open_if_there(const std::string& folder);

/// Prints the problems found while measuring. Each line about a checkpoint begins with
/// `left_out`. Damaged files set exit code 4.
void print_problems(const MeasureOutcome& outcome, const char* left_out, Context& context);

// Each function adds one subcommand to the parser. add_run also adds `resume`.
using AddCommand = void(CLI::App& app, Context& context);
AddCommand add_plan, add_run, add_status, add_log, add_show, add_verify, add_rebuild, add_prune,
    add_regenerate, add_submit, add_merge, add_table, add_figures, add_report, add_export,
    add_bench, add_new, add_doctor, add_manual;

struct Freed {
  std::size_t measured = 0;  ///< number of checkpoints
  std::uint64_t bytes = 0;
};

/// Measures the checkpoints with keep_measures(), then deletes their files. A checkpoint that
/// cannot be measured keeps its file, is reported on standard error, and is removed from `records`.
/// Sets exit code 4 if a file is damaged, and 1 if measures cannot be cached. Thread-safe.
Freed free_files(Store& store, std::vector<CheckpointRecord>& records,
                 const MeasureOptions& options, bool last_too, Context& context);

/// Returns an error message if `path` is empty or lies in a store's folder of checkpoint files,
/// else "".
std::string unfit_output(const std::string& path);
/// Like unfit_output(), for the path of a folder. Also rejects "-", which means standard output.
std::string unfit_folder(const std::string& path);

/// Whether `out` names a stream: "-" (standard output), a pipe made by the shell, or a device such
/// as /dev/null.
bool is_stream(const std::string& out);

/// Writes `text` to `out`, a stream or the path of a file (see write_output()). If `out` is a
/// terminal, control characters are escaped.
void write_result(const std::string& out, const std::string& text);
void add_json_option(CLI::App& command, Context& context);

/// Adds a subcommand that calls run(options, context). The options exist until the parser is
/// destroyed.
template <class Options>
auto add_command(CLI::App& app, Context& context, const char* name, const char* about,
                 void (*run)(Options&, Context&)) {
  const auto options = std::make_shared<std::remove_const_t<Options>>();
  CLI::App* command = app.add_subcommand(name, about);
  command->callback([options, run, &context] { run(*options, context); });
  return std::pair(command, options.get());
}

/// Adds --store DIR and --json. `footer` is the help text printed below the options.
void add_common_options(CLI::App& command, Context& context, const std::string& footer);

/// Adds the manifests, and --scale, --cycles, --seeds, --variant and --seed, which select their
/// runs. If `engines` is true, also adds --engine.
void add_manifest_options(CLI::App& command, std::vector<std::string>& manifests,
                          ExpandOptions& options, bool engines);

/// Reads and expands each manifest once. If the runs of manifest B start from runs of manifest A, A
/// comes before B in the result. Passes all warnings to warn(). Also warns if a plan lacks runs
/// that the store or an earlier plan has from another version of the same manifest: figures
/// will omit these runs. If `brief` is true and a manifest has more than three warnings, prints the
/// first warning and counts the others.
std::vector<Plan> load_plans(const std::vector<std::string>& paths, const ExpandOptions& options,
                             Context& context, bool brief = true);

/// Adds --experiment, --scale, --variant and --seed, and if `states` is true, --state. Each option
/// can be repeated.
void add_selection_options(CLI::App& command, RunSelection& selection, bool states = false);

/// A stage and its selected places (experiments, variants and seeds that need the stage).
struct PlacedRun {
  Stage stage;
  std::vector<Membership> places;
};

/// Groups the runs by stage, in the order of first occurrence.
std::vector<PlacedRun> by_run(const std::vector<Run>& selected);

/// Returns an error message if the text is not a decimal number from `low` to `high`, else "". A
/// double may have a fraction and an exponent. A std::uint64_t must not have leading zeros.
template <class Number>
std::string unfit(const std::string& text, Number low, Number high) {
  constexpr bool whole = std::is_integral_v<Number>;
  const auto value = read_number<Number>(text);
  const bool plain = value && (!whole || text[0] != '0' || text.size() == 1);
  if (plain && *value >= low && *value <= high) return "";
  const bool open = high == std::numeric_limits<Number>::max();
  return fmt::format(
      "must be a {}number {}, in decimal digits (got '{}')", whole ? "whole " : "",
      open ? fmt::format("of at least {}", low) : fmt::format("from {} to {}", low, high), text);
}

template <class Value>
using NumberOf = std::conditional_t<std::is_floating_point_v<Value>, double, std::uint64_t>;

template <class Value>
CLI::Option* add_number(CLI::App& command, const std::string& names, Value& value,
                        const std::string& help, const std::string& type_name = "N",
                        NumberOf<Value> low = 0,
                        NumberOf<Value> high = std::numeric_limits<NumberOf<Value>>::max()) {
  const auto check = [low, high](const std::string& text) { return unfit(text, low, high); };
  return command.add_option(names, value, help)->check(check)->type_name(type_name);
}

/// Returns a check that accepts only the names of the enumeration.
template <class Enum>
CLI::IsMember one_of() {
  return CLI::IsMember(std::vector<std::string>(kNames<Enum>.begin(), kNames<Enum>.end()));
}

/// Adds --threads. `what`: the beginning of its help text.
void add_threads_option(CLI::App& command, std::size_t& threads, const std::string& what);

/// Returns the folder of the store if it exists, else its nearest parent folder that exists.
std::filesystem::path existing_folder(const std::string& store);

void print_json(const nlohmann::json& facts);

/// One value of a result. JSON output has it under `key`. A value with a heading is also printed
/// as a table cell or a line of text.
struct Fact {
  std::string key;  ///< "" if JSON output omits the value
  nlohmann::json value;
  std::optional<std::string> heading = {};  ///< heading of the column or line
  std::optional<std::string> text = {};     ///< text to print instead of the value

  bool operator==(const Fact&) const = default;
};
using Facts = std::vector<Fact>;  ///< all values of one table row or one object

nlohmann::json to_json(const Facts& facts);
nlohmann::json to_json(const std::vector<Facts>& rows);

/// Prints a table; all rows must have the same headings. Columns are as wide as their longest cell,
/// and numbers are right-aligned. On a terminal, states are coloured, and the widest text columns
/// are narrowed to fit; a text that was cut ends with ~.
void print_table(const std::vector<Facts>& rows);

/// Prints "HEADING  text" for each fact that has a heading. Further lines of a text are indented
/// like its first line. Facts with an empty text are skipped.
void print_lines(const Facts& facts);

/// Prints the rows as JSON, {"NAME": [...]}, or as a table.
void print_list(const char* name, const std::vector<Facts>& rows, const Context& context);

/// Formats a size with its unit, such as "12.3 kB".
std::string format_bytes(double bytes);
inline std::string format_bytes(std::uint64_t bytes) {
  return format_bytes(static_cast<double>(bytes));
}

}  // namespace shearcell::cli
