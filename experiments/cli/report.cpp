// SPDX-License-Identifier: GPL-3.0-or-later
// `report`: writes the whole store as one HTML file.
#include <fmt/format.h>

#include "core/machine.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/report/page.hpp"
#include "provenance/io/file.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

struct ReportCommand {
  std::string out = "report.html";
  double megabytes = 9;
  ReportOptions report;
};

// Whether a file that begins with this text is a report (see experiments/report/page.cpp).
bool is_report(std::string_view beginning) {
  return beginning.starts_with("<!doctype html>") &&
         beginning.find(
             "<meta name=\"color-scheme\" content=\"light dark\">\n"
             "<meta http-equiv=\"Content-Security-Policy\"") != beginning.npos;
}

void report(ReportCommand& command, Context& context) {
  if (!is_stream(command.out)) require_ours(command.out, is_report);
  const Store store(context.store, Access::read);
  ReportOptions& options = command.report;
  options.packings.budget = static_cast<std::size_t>(command.megabytes * 1e6);
  for (std::string& run : options.packings.runs) run = store.find_stage(run).id;
  options.workers = usable_cores();
  options.report = terminal_counter("measuring checkpoint");
  options.encoded = terminal_counter("reading checkpoint");
  const Report made = make_report(store, options);
  write_result(command.out, made.html);
  print_problems(made, "left out", context);
  if (!made.undrawn.empty()) fail(context, kOtherError);
  for (const std::string& line : made.undrawn) print_stderr("no drawing: {}\n", line);
  if (!made.problems.empty()) fail(context, kUsageError);
  for (const std::string& line : made.problems) print_stderr("shearcell: {}\n", line);
  for (const std::string& line : made.notes) print_stderr("{}\n", line);
  if (!has_front_end() && options.interactive) {
    print_stderr(
        "Packings are left out and figures are static drawings, because this program was built "
        "without Node.\n");
  }
  if (is_stream(command.out)) return;
  if (context.json) {
    return print_json({{"file", command.out},
                       {"bytes", made.html.size()},
                       {"interactive", made.interactive},
                       {"experiments", made.experiments},
                       {"figures", made.figures},
                       {"stages", made.stages},
                       {"packings", made.packings},
                       {"checkpoints", made.checkpoints},
                       {"damage", made.damage},
                       {"pruned", made.pruned},
                       {"undrawn", made.undrawn},
                       {"problems", made.problems},
                       {"notes", made.notes}});
  }
  print_text("{}: {}; {}, {}, {}", command.out, format_bytes(made.html.size()),
             counted(made.experiments, "experiment"), counted(made.figures, "figure"),
             counted(made.stages, "stage"));
  if (made.interactive) {
    fmt::print(", {} of {} in 3D", counted(made.checkpoints, "checkpoint"),
               counted(made.packings, "run"));
  }
  fmt::print("\n");
}

}  // namespace

void add_report(CLI::App& app, Context& context) {
  const auto [sub, command] =
      add_command(app, context, "report", "Write the whole store as one HTML file", report);
  ReportOptions& options = command->report;
  PackingChoice& packings = options.packings;
  sub->add_option("--out", command->out, "File to write; - is standard output")
      ->capture_default_str()
      ->check(unfit_output)
      ->type_name("FILE");
  add_selection_options(*sub, options.runs);
  sub->get_option("--scale")->expected(1)->description(
      "Only runs of this scale. Default: runs of all scales. A figure shows runs of one scale: "
      "the scale of its most recently added run");
  sub->add_option("--run", packings.runs,
                  "Show these runs in 3D instead of the last run of each variant")
      ->type_name("RUN");
  add_number(*sub, "--runs-per-experiment", packings.runs_per_experiment,
             "Largest number of runs shown in 3D for each experiment")
      ->capture_default_str();
  add_number(*sub, "--frames", packings.frames,
             "Largest number of checkpoints, evenly spaced, shown in 3D for each run", "N", 1,
             100000)
      ->capture_default_str();
  add_number(*sub, "--packings-mb", command->megabytes,
             "Largest total size of the 3D packings in the file. If not all fit, fewer are shown",
             "MB", 0, 1000)
      ->capture_default_str();
  sub->add_flag_callback(
         "--drawings", [&options] { options.interactive = false; },
         "Show static figures drawn by gnuplot, and no packings; the page has no JavaScript")
      ->excludes("--run");
  add_common_options(
      *sub, context,
      R"(The file works without a network. It shows verdicts, runs, lineage, figures that can be zoomed,
and packings in 3D with positions rounded to 16 bits per axis. The store does not change, except
for its cache of measures.
Examples:
  shearcell report --out report.html
  shearcell report --run 3f9a --frames 200 --out one-run.html
  shearcell report --experiment drag --scale desk --out desk.html)");
}

}  // namespace shearcell::cli
