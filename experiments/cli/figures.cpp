// SPDX-License-Identifier: GPL-3.0-or-later
// `figures`: draws figures from stored checkpoints.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "core/machine.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/figures/draw.hpp"
#include "experiments/manifest/shipped.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/file.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

struct FigureArguments {
  std::vector<std::string> names;
  bool all = false;
  FigureOptions how;
};

nlohmann::json facts(const ComputedFigure& result) {
  return {{"figure", result.name},
          {"experiment", result.experiment},
          {"scale", scale_name(result.scale)},
          {"runs", result.runs},
          {"checkpoints", result.checkpoints},
          {"measured", result.measured.size()},
          {"files", list_of(result.files, [](const auto& file) { return file.string(); })},
          {"notes", result.notes},
          {"empty", result.empty},
          {"undrawn", result.undrawn},
          {"damage", result.damage},
          {"pruned", result.pruned},
          {"verdict", to_json(result.verdicts)},
          {"results", list_of(result.verdicts, result_of)}};
}

void print_verdicts(const ComputedFigure& result) {
  if (result.verdicts.empty()) return;
  print_text("  verdict: {}\n", headline_of(rulings_of(result.verdicts)));
  for (const Verdict& verdict : result.verdicts) {
    const bool named = verdict.id.empty() || verdict.text.starts_with(verdict.id);
    print_text("    {}: {}{}\n      {}\n", name_of(verdict.ruling), named ? "" : verdict.id + ": ",
               verdict.text, result_of(verdict));
  }
}

/// Prints the files and verdicts of the figure, unless --json is given. Messages about missing data
/// go to standard error and are added to `told`. Messages that are already in `told` are skipped.
void print(const ComputedFigure& result, const std::string& path, std::set<std::string>& told,
           Context& context) {
  const auto is_told = [&](const std::string& line) { return !told.insert(line).second; };
  for (const std::string& note : result.notes) {
    if (!is_told(note)) print_stderr("{}\n", note);
  }
  MeasureOutcome problems = result;
  std::erase_if(problems.damage, is_told);
  std::erase_if(problems.pruned, is_told);
  print_problems(problems, "left out", context);
  if (!result.why_empty.empty()) {
    print_stderr("warning: figure {}: {}\n", path, result.why_empty);
  }
  for (const std::string& why : result.undrawn) print_stderr("no plot: {}: {}\n", path, why);
  if (!result.undrawn.empty()) fail(context, kOtherError);
  if (context.json) return;
  print_text("{}{}: {}, {}, {} of them newly measured\n", path, at_scale(result.scale),
             counted(result.runs, "run"), counted(result.checkpoints, "checkpoint"),
             result.measured.size());
  for (const auto& file : result.files) print_text("  {}\n", file.string());
  print_verdicts(result);
}

/// Opens the store; read-only if this user cannot write to the store (for example, an archive).
Store open_store(const std::string& folder, FigureOptions& how) {
  try {
    return Store(folder, Access::write);
  } catch (const MachineError& why) {
    print_stderr("figures are drawn, but not recorded in the store: {}\n", why.what());
  }
  how.recorded = false;
  return Store(folder, Access::read);
}

void figures(FigureArguments& options, Context& context) {
  Store store = open_store(context.store, options.how);
  if (options.all) options.names.clear();
  WantedFigures wanted = wanted_figures(store, options.names, options.how.runs.experiments);
  if (wanted.figures.empty() && !options.names.empty()) {
    throw NotFound(fmt::format("no experiment lists {}; to draw it anyway, add --experiment",
                               fmt::join(options.names, " or ")));
  }
  if (wanted.figures.empty()) {
    print_stderr("{} lists a figure.\n", options.how.runs.experiments.empty()
                                             ? "No manifest of this store"
                                             : "None of these experiments");
  }
  if (options.names.empty()) {
    const std::string others = leave_out_unselected(store, options.how.runs, wanted.figures);
    if (!others.empty()) print_stderr("{}\n", others);
  }
  std::set<std::string> told;  // messages that are already printed
  const auto complain_of = [&](const std::string& problem) {
    if (told.insert(problem).second) print_stderr("shearcell: {}\n", problem);
    fail(context, kUsageError);
  };
  for (const std::string& problem : wanted.unknown) complain_of(problem);
  FigureOptions& how = options.how;
  how.workers = usable_cores();
  how.report = terminal_counter("measuring checkpoint");
  nlohmann::json list = nlohmann::json::array();
  for (const WantedFigure& figure : wanted.figures) {
    try {
      const ComputedFigure result = draw_figure(store, figure, how);
      list.push_back(facts(result));
      print(result, figure.path(), told, context);
    } catch (const UsageError& problem) {
      complain_of(problem.what());
    } catch (const AnalysisError& problem) {
      complain_of(figure.path() + ": " + problem.what());
    } catch (const NotOurs& refused) {
      complain_of(refused.what());
    }
  }
  if (!list.empty() && !find_program("rsvg-convert")) {
    print_stderr("no PDF: rsvg-convert is not installed (Debian package librsvg2-bin)\n");
  }
  if (context.json) print_json({{"figures", list}});
}

std::string about_figures() {
  std::string text =
      R"(Draws the figures, plots and claims of the store's manifests, once for each experiment that lists
them. Writes into DIR/EXPERIMENT/SCALE the CSV, SVG, PDF and gnuplot script of each panel,
NAME.caption.txt, NAME.verdict.json (verdicts on claims) and NAME.lineage.json (the checkpoints
that the figure uses). SCALE is `base` for a manifest without scales. Figures that combine all
experiments are written into DIR/SCALE. Without names, table1 is drawn if a manifest lists any of
the figures below, and summary is drawn if the store has two of the experiments that it combines.
If the number of runs in a mean changes along a curve, the key of the drawing shows the smallest
and largest number. If all curves have the same numbers, the caption shows them.
Measures are cached in the store's derived.sqlite. If you delete this file, all measures are
computed again, except those of pruned checkpoints (see `regenerate`). From a store that cannot be
written to, such as an archive, figures are drawn but not recorded, and new measures are not cached.
Figures and the keys that they compare (some also have one curve for each value of other keys):)";
  for (const Figure& figure : all_figures()) {
    text += fmt::format("\n  {:<10} {}", figure.name, figure.title);
    if (!figure.keys.empty()) {
      text += fmt::format("\n             varies {}", fmt::join(figure.keys, ", "));
    }
  }
  return text;
}

}  // namespace

void add_figures(CLI::App& app, Context& context) {
  const auto [command, options] =
      add_command(app, context, "figures", "Draw figures from stored checkpoints", figures);
  FigureOptions& how = options->how;
  how.folder = "shearcell-figures";
  command->add_option("figure", options->names, "Names of figures, such as S2 (default: all)");
  command->add_flag("--all", options->all,
                    "Draw all figures of the store's manifests (the default)");
  command
      ->add_option("--out", how.folder, "Folder to write to (DIR/EXPERIMENT/SCALE/NAME.csv, ...)")
      ->capture_default_str()
      ->check(unfit_folder)
      ->type_name("DIR");
  add_selection_options(*command, how.runs);
  command->get_option("--experiment")
      ->description(
          "Draw figures with runs of this experiment only. Figures given by name are drawn even if "
          "the experiment's manifest does not list them");
  command->get_option("--scale")->expected(1)->description(
      "Scale of the runs (default: for each experiment, the scale of the run that was added last)");
  command
      ->add_option_function<std::string>(
          "--width", [&how](const std::string& width) { how.wide = width == "double"; },
          "Width of the drawings: one column of a journal (8.6 cm) or two (17.8 cm)")
      ->check(CLI::IsMember({"single", "double"}))
      ->default_str("single");
  add_common_options(*command, context,
                     "Examples:\n  shearcell figures S2 --out figures\n"
                     "  shearcell figures S2 --experiment drag\n  shearcell figures --all");
  command->footer(about_figures);  // computed on demand, since it reads the shipped manifests
}

}  // namespace shearcell::cli
