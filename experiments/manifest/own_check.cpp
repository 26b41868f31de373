// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/own_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>

#include "analysis/measures.hpp"
#include "analysis/own_figure.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/variants.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

/// What the variants of a scale have that a plot or claim may ask for.
struct Variants {
  std::vector<Parameters> parameters;
  std::vector<json> labels;
  std::uint64_t longest = 0;  ///< cycles
};

Variants variants_of(const Scale& scale) {
  Variants all;
  for_each_variant(scale, [&](const Variant& variant) {
    all.parameters.push_back(variant.parameters);
    all.labels.push_back(variant.labels());
    all.longest = std::max(all.longest, target_cycles(variant.parameters));
  });
  return all;
}

std::size_t count_of(const json& where, const Variants& variants) {
  return static_cast<std::size_t>(std::ranges::count_if(variants.parameters, [&](const auto& p) {
    return std::ranges::all_of(where.items(), [&](const auto& item) {
      return get_value(*find_field(item.key()), p) == item.value();
    });
  }));
}

/// A swept key over which the plot would average: two variants have the same curve and x.
std::string averaged_over(const PlotSpec& plot, const Variants& variants) {
  if (plot.by.empty()) return "";
  std::map<std::array<json, 2>, json> curves;  // swept values of the first variant
  for (std::size_t k = 0; k < variants.labels.size(); ++k) {
    const auto value = [&](const std::string& key) {
      const Field* field = find_field(key);
      return field == nullptr ? json() : get_value(*field, variants.parameters[k]);
    };
    const auto [known, first] =
        curves.try_emplace({value(plot.by), value(plot.x)}, variants.labels[k]);
    for (const auto& [key, swept] : variants.labels[k].items()) {
      if (known->second.at(key) != swept) return key;
    }
  }
  return "";
}

std::vector<std::string> problems_of(const PlotSpec& plot, const Variants& variants) {
  std::vector<std::string> found;
  if (const std::string key = averaged_over(plot, variants); !key.empty()) {
    found.push_back(
        fmt::format("it would average over the values of {}. Leave out `by` for a curve "
                    "of each variant.",
                    key));
  }
  const bool every_cycle =
      find_curve_measure(plot.y) == nullptr && (plot.x == "cycle" || is_measure(plot.x));
  if (plot.cycle && every_cycle) {
    found.emplace_back("at_cycle has no effect, since it draws every cycle. Leave it out.");
  }
  const std::uint64_t last = plot.cycles ? plot.cycles->at(1) : plot.cycle.value_or(0);
  if (last > variants.longest && !(plot.cycle && every_cycle)) {
    found.push_back(
        fmt::format("it asks for cycle {}, and the runs have {}.", last, variants.longest));
  }
  return found;
}

std::vector<std::string> problems_of(const ClaimSpec& claim, const Variants& variants) {
  std::vector<std::string> found;
  for (const json& side : claim.between) {
    const std::size_t count = count_of(side, variants);
    if (count == 1) continue;
    found.push_back(fmt::format("{} variants have {}; `between` must name one on each side.", count,
                                words_of(side)));
  }
  if (claim.last > variants.longest) {
    found.push_back(
        fmt::format("it asks for cycle {}, and the runs have {}.", claim.last, variants.longest));
  }
  return found;
}

}  // namespace

std::vector<std::string> own_warnings(const Manifest& manifest, const Scale& scale) {
  std::vector<std::string> warnings;
  if (manifest.plots.empty() && manifest.claims.empty()) return warnings;
  const Variants variants = variants_of(scale);
  const auto add = [&](const char* kind, const auto& list) {
    for (const auto& own : list) {
      for (const std::string& problem : problems_of(own, variants)) {
        warnings.push_back(
            fmt::format("{}: {} {}: {}", manifest.experiment, kind, own.name, problem));
      }
    }
  };
  add("plot", manifest.plots);
  add("claim", manifest.claims);
  return warnings;
}

}  // namespace shearcell
