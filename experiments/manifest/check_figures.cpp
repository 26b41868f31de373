// SPDX-License-Identifier: GPL-3.0-or-later
// Checks whether the figures, plots and claims of a manifest can be made from its variants.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "analysis/figure.hpp"
#include "analysis/onset.hpp"
#include "analysis/own_figure.hpp"
#include "analysis/statistics.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/variants.hpp"

namespace shearcell {
namespace {

void check_last(std::uint64_t cycle, const std::vector<Variant>& variants,
                std::vector<std::string>& found) {
  std::uint64_t longest = 0;
  for (const Variant& variant : variants) {
    longest = std::max(longest, target_cycles(variant.parameters));
  }
  if (cycle <= longest) return;
  found.push_back(fmt::format("it asks for cycle {}, and the runs have {}.", cycle, longest));
}

std::size_t count_of(const nlohmann::json& where, const std::vector<Variant>& variants) {
  return static_cast<std::size_t>(std::ranges::count_if(variants, [&](const Variant& variant) {
    return std::ranges::all_of(where.items(), [&](const auto& item) {
      return get_value(*find_field(item.key()), variant.parameters) == item.value();
    });
  }));
}

/// A swept key over which curves of these parameters' values would average; or "". Other names
/// than those of parameters are ignored.
std::string averaged_over(const std::vector<std::string>& keys,
                          const std::vector<Variant>& variants) {
  std::vector<std::pair<std::vector<nlohmann::json>, nlohmann::json>> values;
  for (const Variant& variant : variants) {
    std::vector<nlohmann::json> curve;
    for (const std::string& key : keys) {
      const Field* field = find_field(key);
      if (field != nullptr) curve.push_back(get_value(*field, variant.parameters));
    }
    values.emplace_back(std::move(curve), variant.labels());
  }
  return averaged_key(values);
}

std::vector<std::string> problems_of(const PlotSpec& plot, const Scale& scale,
                                     const std::vector<Variant>& variants) {
  std::vector<std::string> found;
  const std::string key = plot.by.empty() ? "" : averaged_over({plot.by, plot.x}, variants);
  if (!key.empty()) {
    found.push_back(
        fmt::format("it would average over the values of {}. Leave out `by` for a curve "
                    "of each variant.",
                    key));
  }
  if (plot.x == "shear_strain" && (!plot.cycles || scale.checkpoints->phases.empty())) {
    found.emplace_back(
        "shear_strain is 0 at whole cycles. State `cycles`, and `phases` of `checkpoints`.");
  }
  const bool every_cycle = draws_every_cycle(plot);
  if (plot.cycle && find_run_measure(plot.y) != nullptr) {
    found.push_back(
        fmt::format("at_cycle has no effect on {}, one number of a run. Leave it out.", plot.y));
  } else if (plot.cycle && every_cycle) {
    found.emplace_back("at_cycle has no effect, since it draws every cycle. Leave it out.");
  }
  const std::uint64_t last = plot.cycles ? plot.cycles->at(1) : plot.cycle.value_or(0);
  if (!(plot.cycle && every_cycle)) check_last(last, variants, found);
  return found;
}

std::vector<std::string> problems_of(const ClaimSpec& claim, const std::vector<Variant>& variants,
                                     std::size_t seeds) {
  std::vector<std::string> found;
  if (claim.between[0] == claim.between[1]) {
    found.emplace_back("both sides of `between` are the same. Name two variants.");
  }
  for (const nlohmann::json& side : claim.between) {
    const std::size_t count = count_of(side, variants);
    if (count == 1) continue;
    found.push_back(fmt::format("{} variants have {}; `between` must name one on each side.", count,
                                words_of(side)));
  }
  check_last(claim.last, variants, found);
  if (seeds < least_runs) {
    found.push_back(fmt::format("a verdict takes at least {} seeds, not {}.", least_runs, seeds));
  }
  return found;
}

}  // namespace

std::vector<std::string> figure_warnings(const Manifest& manifest, const Scale& scale,
                                         const std::vector<Variant>& variants, std::size_t seeds) {
  std::vector<std::string> warnings;
  for (const std::string& name : manifest.figures) {
    const Figure& figure = *find_figure(name);
    if (figure.form != FigureForm::groups) continue;
    const std::string key = averaged_over(figure.keys, variants);
    if (key.empty()) continue;
    warnings.push_back(
        fmt::format("{}: figure {} would average over the values of {}. Give each an experiment of "
                    "its own, or state a plot (`plots`).",
                    manifest.file, name, key));
  }
  const auto add = [&](const char* kind, const auto& own, const std::vector<std::string>& found) {
    for (const std::string& problem : found) {
      warnings.push_back(fmt::format("{}:{}:{}: {} {}: {}", manifest.file, own.at.line,
                                     own.at.column, kind, own.name, problem));
    }
  };
  for (const auto& plot : manifest.plots) add("plot", plot, problems_of(plot, scale, variants));
  for (const auto& claim : manifest.claims) {
    add("claim", claim, problems_of(claim, variants, seeds));
  }
  return warnings;
}

}  // namespace shearcell
