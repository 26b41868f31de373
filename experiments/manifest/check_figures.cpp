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
#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/variants.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

std::uint64_t length_of(const Variant& variant) {
  return target_cycles(variant.parameters);
}

/// The cycles at which runs of a variant have checkpoints.
struct Cadence {
  std::uint64_t every = 1, last = 0;

  Cadence(const Variant& variant, const Scale& scale) : last(length_of(variant)) {
    if (variant.parameters.protocol != ProtocolKind::stiffen) {
      every = scale.checkpoints->every_cycles;
    }
  }
  bool has(std::uint64_t cycle) const {
    return cycle <= last && (cycle % every == 0 || cycle == last);
  }
  /// Also the one so many cycles before.
  bool has(std::uint64_t cycle, std::uint64_t back) const {
    return cycle >= back && has(cycle) && has(cycle - back);
  }
  /// One of these cycles. Whether a multiple of `every` has the other one depends on `back` alone.
  bool has_one_of(std::uint64_t first, std::uint64_t end, std::uint64_t back) const {
    const std::uint64_t begin = std::max(first, back);
    const std::uint64_t multiple = (begin + every - 1) / every * every;
    return (multiple <= end && has(multiple, back)) ||
           (begin <= last && last <= end && has(last, back));
  }
};

std::uint64_t cycles_back(std::string_view measure) {
  const ScalarMeasure* found = find_measure(measure);
  return found == nullptr ? 0 : found->cycles_back();
}

/// " with another one 1 cycle before it".
std::string words_of_earlier(std::uint64_t back) {
  return back == 0 ? "" : fmt::format(" with another one {} before it", counted(back, "cycle"));
}

/// Why no run has a value that the plot draws; "" if one may have.
std::string lack_of(const PlotSpec& plot, const Scale& scale,
                    const std::vector<Variant>& variants) {
  const auto [shortest, longest] = std::ranges::minmax(variants, {}, length_of);
  std::uint64_t first = 0, last = length_of(longest);
  std::string where;
  if (plot.cycles) {
    first = plot.cycles->at(0), last = plot.cycles->at(1);
    where = fmt::format(" in cycles {} to {}", first, last);
  } else if (!draws_every_cycle(plot) && find_run_measure(plot.y) == nullptr) {
    if (!plot.cycle && scale.until->until) return "";  // not known where the runs end
    first = last = plot.cycle.value_or(length_of(shortest));
    where = fmt::format(" at cycle {}", first);
  }
  if (last > length_of(longest)) {
    return fmt::format("it asks for cycle {}, and the runs have {}.", last, length_of(longest));
  }
  for (const std::string& measure : {plot.y, plot.x}) {
    const std::uint64_t back = cycles_back(measure);
    const bool any = std::ranges::any_of(variants, [&](const Variant& variant) {
      return Cadence(variant, scale).has_one_of(first, last, back);
    });
    if (any) continue;
    return fmt::format(
        "no run has a checkpoint{}{}, so {} has no value. Ask for more checkpoints "
        "(`every_cycles`) or cycles.",
        where, words_of_earlier(back), measure);
  }
  return "";
}

/// Why runs of the variant have no value for the claim; "" if they may have.
std::string lack_of(const ClaimSpec& claim, const Scale& scale, const Variant& variant) {
  const Cadence cadence(variant, scale);
  if (claim.last > cadence.last) {
    return fmt::format("it asks for cycle {}, and the runs have {}.", claim.last, cadence.last);
  }
  const std::uint64_t back = cycles_back(claim.compare);
  // If one of them lacks a checkpoint, so does one of the first two or the last.
  for (const std::uint64_t cycle :
       {claim.first, std::min(claim.first + 1, claim.last), claim.last}) {
    if (claim.last == 0 || cadence.has(cycle, back)) continue;
    return fmt::format(
        "it needs a checkpoint at cycle {}{}, which the runs do not have. Ask for "
        "more checkpoints (`every_cycles`).",
        cycle, words_of_earlier(back));
  }
  return "";
}

std::vector<const Variant*> variants_with(const nlohmann::json& where,
                                          const std::vector<Variant>& variants) {
  std::vector<const Variant*> found;
  for (const Variant& variant : variants) {
    const bool fits = std::ranges::all_of(where.items(), [&](const auto& item) {
      return get_value(*find_field(item.key()), variant.parameters) == item.value();
    });
    if (fits) found.push_back(&variant);
  }
  return found;
}

bool are_the_same_run(const Parameters& a, const Parameters& b) {
  return last_stage(a, 1, prepare_stage(a, 1)).id == last_stage(b, 1, prepare_stage(b, 1)).id;
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
    values.emplace_back(std::move(curve), variant.swept_values());
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
    found.push_back(fmt::format("shear_strain is 0 at whole cycles. State {}.",
                                plot.cycles ? "`phases` of `checkpoints`"
                                : scale.checkpoints->phases.empty()
                                    ? "`cycles`, and `phases` of `checkpoints`"
                                    : "`cycles`"));
  }
  const bool every_cycle = draws_every_cycle(plot);
  if (plot.cycle && find_run_measure(plot.y) != nullptr) {
    found.push_back(
        fmt::format("at_cycle has no effect on {}, one number of a run. Leave it out.", plot.y));
  } else if (plot.cycle && every_cycle) {
    found.emplace_back("at_cycle has no effect, since it draws every cycle. Leave it out.");
  }
  if (std::string lack = lack_of(plot, scale, variants); !lack.empty()) {
    found.push_back(std::move(lack));
  }
  return found;
}

std::vector<std::string> problems_of(const ClaimSpec& claim, const Scale& scale,
                                     const std::vector<Variant>& variants, std::size_t seeds) {
  std::vector<std::string> found;
  if (claim.between[0] == claim.between[1]) {
    return {"both sides of `between` are the same. Name two variants."};
  }
  std::vector<const Variant*> sides;
  for (const nlohmann::json& side : claim.between) {
    const std::vector<const Variant*> fitting = variants_with(side, variants);
    sides.insert(sides.end(), fitting.begin(), fitting.end());
    if (fitting.size() == 1) continue;
    found.push_back(fmt::format("{} variants have {}; `between` must name one on each side.",
                                fitting.size(), words_of(side)));
  }
  if (found.empty() && are_the_same_run(sides[0]->parameters, sides[1]->parameters)) {
    found.emplace_back(
        "both sides of `between` are the same runs, so their difference is exactly "
        "zero. Name two variants that differ.");
  }
  for (const Variant* side : sides) {
    std::string lack = lack_of(claim, scale, *side);
    if (lack.empty()) continue;
    found.push_back(std::move(lack));
    break;
  }
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
    add("claim", claim, problems_of(claim, scale, variants, seeds));
  }
  return warnings;
}

}  // namespace shearcell
