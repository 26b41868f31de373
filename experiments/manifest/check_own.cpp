// SPDX-License-Identifier: GPL-3.0-or-later
// Checks whether the plots and claims of a manifest can be made from its variants.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>

#include "analysis/measures.hpp"
#include "analysis/onset.hpp"
#include "analysis/own_figure.hpp"
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

/// A swept key over which the plot would average, since two variants share a curve and x; or "".
std::string averaged_over(const PlotSpec& plot, const std::vector<Variant>& variants) {
  if (plot.by.empty()) return "";
  std::map<std::array<nlohmann::json, 2>, nlohmann::json> curves;  // labels of the first variant
  for (const Variant& variant : variants) {
    const auto value = [&](const std::string& key) {
      const Field* field = find_field(key);
      return field == nullptr ? nlohmann::json() : get_value(*field, variant.parameters);
    };
    const nlohmann::json labels = variant.labels();
    const auto known = curves.try_emplace({value(plot.by), value(plot.x)}, labels).first;
    for (const auto& [key, swept] : labels.items()) {
      if (known->second.at(key) != swept) return key;
    }
  }
  return "";
}

std::vector<std::string> problems_of(const PlotSpec& plot, const std::vector<Variant>& variants) {
  std::vector<std::string> found;
  if (const std::string key = averaged_over(plot, variants); !key.empty()) {
    found.push_back(
        fmt::format("it would average over the values of {}. Leave out `by` for a curve "
                    "of each variant.",
                    key));
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

std::vector<std::string> problems_of(const ClaimSpec& claim, const std::vector<Variant>& variants) {
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
  return found;
}

}  // namespace

std::vector<std::string> own_warnings(const Manifest& manifest,
                                      const std::vector<Variant>& variants) {
  std::vector<std::string> warnings;
  const auto add = [&](const char* kind, const auto& list) {
    for (const auto& own : list) {
      for (const std::string& problem : problems_of(own, variants)) {
        warnings.push_back(fmt::format("{}:{}:{}: {} {}: {}", manifest.file, own.at.line,
                                       own.at.column, kind, own.name, problem));
      }
    }
  };
  add("plot", manifest.plots);
  add("claim", manifest.claims);
  return warnings;
}

}  // namespace shearcell
