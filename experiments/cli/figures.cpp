// SPDX-License-Identifier: GPL-3.0-or-later
// `figures`: draws figures from stored checkpoints.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "experiments/cli/command.hpp"
#include "experiments/figures/collect.hpp"
#include "experiments/figures/draw.hpp"
#include "experiments/runner/terminal.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/plain_file.hpp"

namespace shearcell::cli {
namespace {

struct FigureArguments {
  std::vector<std::string> names;
  bool all = false;
  bool fresh = false;
  std::string out = "shearcell-figures";
  std::optional<std::string> scale;
};

void complain(const FigureSummary& result) {
  for (const std::string& line : result.damage)
    fmt::print(stderr, "left out: {}\n", for_terminal(line));
  for (const std::string& line : result.pruned)
    fmt::print(stderr, "left out: {}\n", for_terminal(line));
  for (const std::string& sha256 : result.changed) {
    fmt::print(stderr, "checkpoint {:.12}: the kept measures were different; replaced\n", sha256);
  }
  if (!result.cache_trouble.empty()) {
    fmt::print(stderr, "measures cannot be kept: {}\n", for_terminal(result.cache_trouble));
  }
  if (!result.plot_error.empty())
    fmt::print(stderr, "no plot: {}\n", for_terminal(result.plot_error));
}

nlohmann::json facts(const FigureSummary& result) {
  nlohmann::json files = nlohmann::json::array();
  for (const auto& file : result.files) files.push_back(file.string());
  return {{"figure", result.name},       {"scale", result.scale},
          {"runs", result.runs},         {"checkpoints", result.checkpoints},
          {"measured", result.measured}, {"files", files},
          {"damage", result.damage},     {"pruned", result.pruned},
          {"changed", result.changed},   {"verdict", to_json(result.verdicts)}};
}

void print_verdicts(const FigureSummary& result) {
  if (const auto ruling = overall(result.verdicts)) tell("  verdict: {}\n", name_of(*ruling));
  for (const Verdict& verdict : result.verdicts) {
    tell("    {}: {}\n      {}: {}{}{}\n", name_of(verdict.ruling), verdict.claim, verdict.quantity,
         numbers_of(verdict), verdict.note.empty() ? "" : "; ", verdict.note);
  }
}

/// Prints one figure's summary or adds it to the list.
void take(const FigureSummary& result, nlohmann::json& list, Context& context) {
  complain(result);
  if (!result.damage.empty()) context.exit_code = kStoreDamaged;
  const bool incomplete = !result.plot_error.empty() || !result.pruned.empty();
  if (incomplete && context.exit_code == kDone) context.exit_code = kOtherError;
  list.push_back(facts(result));
  if (context.json) return;
  tell("{} ({} scale): {} runs, {} checkpoints, {} of them measured now\n", result.name,
       result.scale.empty() ? "base" : result.scale, result.runs, result.checkpoints,
       result.measured);
  for (const auto& file : result.files) tell("  {}\n", file.string());
  print_verdicts(result);
}

void figures(const FigureArguments& options, Context& context) {
  Store store(context.store, Access::write);
  WantedFigures wanted;
  if (options.all || options.names.empty()) {
    wanted = figures_of_store(store);
    if (wanted.figures.empty()) fmt::print(stderr, "No manifest of this store lists a figure.\n");
  } else {
    for (const std::string& name : options.names) wanted.figures.push_back(&figure_called(name));
  }
  for (const std::string& problem : wanted.unknown) {  // the other figures are made all the same
    fmt::print(stderr, "shearcell: {}\n", for_terminal(problem));
    context.exit_code = kUsageError;
  }
  FigureOptions how;
  how.folder = options.out;
  how.scale = options.scale;
  how.fresh = options.fresh;
  how.workers = std::max(1U, std::thread::hardware_concurrency());
  if (isatty(STDERR_FILENO) != 0) {
    how.report = [](std::size_t done, std::size_t total) {
      fmt::print(stderr, "\rmeasuring checkpoint {} of {}{}", done, total,
                 done == total ? "\n" : "");
    };
  }
  nlohmann::json list = nlohmann::json::array();
  for (const Figure* figure : in_order_of_needs(std::move(wanted.figures))) {
    try {
      const FigureSummary result = draw_figure(store, *figure, how);
      take(result, list, context);
    } catch (const NotFound& missing) {  // the other figures are made all the same
      fmt::print(stderr, "shearcell: {}\n", for_terminal(missing.what()));
      context.exit_code = kUsageError;
    } catch (const NotOurs& refused) {
      fmt::print(stderr, "shearcell: {}\n", for_terminal(refused.what()));
      context.exit_code = kUsageError;
    }
  }
  if (context.json) print_json({{"figures", list}});
}

}  // namespace

void add_figures(CLI::App& app, Context& context) {
  auto options = std::make_shared<FigureArguments>();
  CLI::App* command = app.add_subcommand("figures", "Draw figures from the store alone");
  command->add_option("figure", options->names, "Figures, as S2 (default: all)");
  command->add_flag("--all", options->all, "All that the store's manifests ask for");
  command->add_option("--out", options->out, "Folder to write to")
      ->capture_default_str()
      ->type_name("DIR");
  command->add_option("--scale", options->scale, "Scale of the runs (default: declared last)");
  command->add_flag("--fresh", options->fresh,
                    "Measure every checkpoint again and compare with what is kept");
  add_common_options(*command, context, true);
  command->footer(
      "Writes CSV, SVG and PDF of each panel, NAME.verdict.json (the verdicts on the supplement's\n"
      "claims) and NAME.lineage.json (the checkpoints that they come from).\n"
      "Measures of checkpoints are kept in the store's derived.sqlite, which may be deleted at "
      "any\n"
      "time.\n"
      "Examples:\n  shearcell figures S2 --out figures\n  shearcell figures --all");
  command->callback([options, &context] { figures(*options, context); });
}

}  // namespace shearcell::cli
