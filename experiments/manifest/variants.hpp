// SPDX-License-Identifier: GPL-3.0-or-later
// The variants of an experiment at one scale: base, scale and sweep combined, and their names.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/parameters.hpp"

namespace shearcell {

/// The value of a parameter that is not swept, or "auto".
nlohmann::json value_at(const Scale& scale, std::string_view key);

/// Whether the setting is `auto`, which variants_of() resolves.
bool is_auto(const Setting& setting);

/// Points into the scale.
struct Variant {
  /// In the order of the manifest, without the length of the run.
  std::vector<std::pair<std::string, const Setting*>> swept;
  Parameters parameters;
  Parameters packing;  ///< the same with what `settle` states
  /// How many of the seeds it has, the first ones; default: all.
  std::uint64_t seeds = std::numeric_limits<std::uint64_t>::max();

  std::string name() const;             ///< "fluid=cell", "base" when nothing is swept
  nlohmann::json swept_values() const;  ///< swept keys and values
};

/// Selects by values named on the command line. A value fits a wanted one if it has all its parts:
/// "fluid=cell" fits "fluid=cell,amplitude_rad=0.1", and so does "b=1.28e-3 kg/s".
class Filter {
 public:
  explicit Filter(const std::vector<std::string>& wanted);
  explicit Filter(const std::vector<std::uint64_t>& wanted);

  /// Whether the value fits one of the wanted values of each set of keys; true if none are wanted.
  bool passes(const std::string& value);
  /// The first wanted value that no value fitted, or null.
  const std::string* unfound() const;
  /// The values that were tried, each once, in order.
  const std::vector<std::string>& seen() const { return seen_; }

 private:
  struct Wanted {
    std::string text, keys;
    std::set<std::string> parts;
    bool found = false;
  };
  std::vector<Wanted> wanted_;
  std::vector<std::string> seen_;
  std::set<std::string> known_;  ///< those of seen_
};

/// Whether the variant (swept keys and values) has all values of the label.
bool selects(const VariantLabel& label, const nlohmann::json& variant);

/// Names for people of variants, which are objects of swept keys and values; identity and CSV files
/// use Variant::name() instead. A label replaces the keys that it states, labels with more keys
/// first. The other keys that distinguish the variants follow: "fluid at rest, A=0.05 rad". "base"
/// if nothing is swept. Variants may be repeated.
std::map<nlohmann::json, std::string> variant_names(const std::vector<nlohmann::json>& variants,
                                                    std::span<const VariantLabel> labels);

/// The swept axis of this key, or nullptr.
const SweepAxis* find_axis(const Sweep& sweep, std::string_view key);

/// The number of variants; saturates at 2^64 - 1.
std::uint64_t variant_count(const Sweep& sweep);

/// In manifest order: the first grid axis varies slowest, the rows of the zip fastest. The scale
/// must be complete, outlive the result, and have at most ManifestLimits::runs variants.
std::vector<Variant> variants_of(const Scale& scale);

}  // namespace shearcell
