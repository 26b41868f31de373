// SPDX-License-Identifier: GPL-3.0-or-later
// `table`: writes runs and their measures as a table for pandas, gnuplot and spreadsheets.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/machine.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/figures/run_table.hpp"
#include "provenance/io/file.hpp"

namespace shearcell::cli {
namespace {

struct TableOptions {
  RunSelection selection;
  std::string per = std::string(name_of(RowPer::checkpoint));
  std::string format = "csv";
  std::string curve;
  std::string out = "-";
  std::vector<std::string> simulated;
};

void table(const TableOptions& options, Context& context) {
  const Store store(context.store, Access::read);
  if (!is_stream(options.out)) require_ours(options.out, is_table);
  const MeasureOptions how{.workers = usable_cores(),
                           .report = terminal_counter("measuring checkpoint")};
  const Measure* curve = find_measure(options.curve, MeasureKind::curve);
  const RunTable made =
      curve != nullptr ? curve_table(store, options.selection, *curve, how)
                       : run_table(store, options.selection, value_of<RowPer>(options.per).value(),
                                   how, options.simulated);
  const std::string text = context.json               ? to_json(made, true)
                           : options.format == "json" ? to_json(made)
                                                      : to_csv(made.table, Digits::all);
  write_result(options.out, text);
  if (!is_stream(options.out)) {
    print_stderr("{} rows of {} columns in {}\n", made.table.rows.size(), made.table.columns.size(),
                 options.out);
  }
  for (const std::string& note : made.notes) print_stderr("{}\n", note);
  if (made.table.rows.empty()) print_stderr("no checkpoint matches all given options\n");
  print_problems(made, "not measured", context);
}

}  // namespace

void add_table(CLI::App& app, Context& context) {
  const auto [command, options] = add_command(
      app, context, "table", "Write runs and their measures as one table in CSV or JSON", table);
  add_selection_options(*command, options->selection);
  CLI::Option* per =
      command->add_option("--per", options->per, "Write one row per checkpoint or one row per run")
          ->check(one_of<RowPer>())
          ->capture_default_str();
  std::string columns_text;
  for (const TableColumn& column : table_columns()) {
    columns_text += fmt::format("  {:<37} {}\n", column.name, column.meaning);
  }
  std::vector<std::string> curves;
  std::string curves_text;
  for (const Measure* curve : all_measures(MeasureKind::curve)) {
    curves.emplace_back(curve->name);
    curves_text += fmt::format("  {:<37} {}; against {}\n", curve->name, curve->meaning, curve->x);
  }
  command
      ->add_option("--curve", options->curve,
                   "Write this curve: for each checkpoint, one row for each point of the curve")
      ->check(CLI::IsMember(curves))
      ->excludes(per);
  CLI::Option* format = command->add_option("--format", options->format, "csv or json")
                            ->check(CLI::IsMember({"csv", "json"}))
                            ->capture_default_str();
  for (const std::string& name : simulating_providers()) {
    const Provider& one = provider(name);
    std::vector<std::string_view> added;
    for (const Measure& measure : one.measures) added.push_back(measure.name);
    command
        ->add_flag_callback(
            "--" + name, [options = options, name] { options->simulated.push_back(name); },
            fmt::format("Add {} (computed by a simulation that takes {})", fmt::join(added, ", "),
                        one.cost))
        ->excludes(command->get_option("--curve"));
  }
  command->add_option("--out", options->out, "File to write; - is standard output")
      ->capture_default_str()
      ->check(unfit_output)
      ->type_name("FILE");
  add_common_options(
      *command, context,
      "Columns (swept parameters add columns after the seed; an empty field is unknown or does not "
      "apply):\n" +
          columns_text +
          "Columns whose values need a simulation are written only with an option, such as "
          "--rest.\ncritical_size and all columns listed after it are written only with --per run. "
          "With --per run, all\nother measures are measures of the run's newest checkpoint. If "
          "several experiments share a run,\neach experiment has its own rows for the run, up to "
          "the last cycle that the experiment asks for.\n\nCurves:\n" +
          curves_text +
          "Examples:\n"
          "  shearcell table --experiment drag --out drag.csv\n"
          "  shearcell table --per run --variant fluid=cell --format json\n"
          "  shearcell table --curve pair_correlation --out g_of_r.csv\n"
          "  python3 -c 'import pandas, sys; print(pandas.read_csv(sys.stdin))' < drag.csv");
  command->get_option("--json")->excludes(format)->description(
      "One JSON object: `rows` as in --format json, and `notes` on the data that are left out");
}

}  // namespace shearcell::cli
