// SPDX-License-Identifier: GPL-3.0-or-later
// The variants of an experiment at one scale (`base`, scale and sweep combined), and their names.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/parameters.hpp"

namespace shearcell {

/// The value of a parameter at this scale; can be "auto". The scale must not sweep the parameter.
nlohmann::json value_at(const Scale& scale, std::string_view key);

/// A combination of swept values, with the parameters that result from it.
struct Variant {
  std::string name = {};                            ///< "fluid=cell"; "base" if nothing is swept
  nlohmann::json swept = nlohmann::json::object();  ///< values by key, without `cycles` and `seeds`
  Parameters parameters = {};
  Parameters packing = {};  ///< `parameters`, overridden by the values of `settle`
  /// Number of seeds: the variant has only the first `seeds` seeds of the scale. Default: all.
  std::uint64_t seeds = std::numeric_limits<std::uint64_t>::max();
};

/// Removes the spaces around the key and the value of "key=value". Replaces a symbol by the name of
/// the parameter and drops the unit after the value: "P=954 Pa" gives "pressure_Pa=954".
std::string same_spelling(std::string_view part);

/// Selects variants, experiments or seeds by texts from the command line. A variant such as
/// "fluid=cell,amplitude_rad=0.1" has the parts "fluid=cell" and "amplitude_rad=0.1". The variant
/// fits a text if it has all parts of the text, in any order. Numbers may be written in any
/// notation, with or without a unit.
class Filter {
 public:
  explicit Filter(const auto& wanted) {
    for (const auto& one : wanted) add(fmt::format("{}", one));
  }

  /// Whether the texts select `value`. A part of a text may be a part of `value` or of `name`, the
  /// display name of `value`. Texts with different keys must all fit. Of the texts with the same
  /// keys, at least one must fit: "a=1", "a=2" and "b=3" select values that have b=3, and a=1 or
  /// a=2. Without texts, every value is selected.
  bool passes(const std::string& value, const std::string& name = "");
  /// The first of the given texts that selects none of the values in seen(), or null.
  const std::string* unfound() const;
  /// The values that passes() was called with, each once, in the order of the calls. A
  /// display name is an entry after its value, unless the value has all parts of the name.
  const std::vector<std::string>& seen() const { return seen_; }

 private:
  struct Wanted {
    std::string text, keys;
    std::set<std::pair<std::string, nlohmann::json>> parts;  ///< keys and values
    bool found = false;
  };
  void add(const std::string& text);

  std::vector<Wanted> wanted_;
  std::vector<std::string> seen_;
  std::set<std::string> known_;  ///< the values in seen_
};

/// Whether the label applies to the variant, an object of swept keys and values. is_within()
/// compares the values.
bool selects(const VariantLabel& label, const nlohmann::json& variant);
/// Whether the variant (an object of swept keys and values) has each value that `where` requires.
/// is_within() compares the values.
bool has_values(const nlohmann::json& variant, const nlohmann::json& where);

/// Variant::swept of each variant.
std::vector<nlohmann::json> swept_in(std::span<const Variant> variants);

/// Returns the display name of each variant. A variant is an object of swept keys and values; some
/// variants in the list may be equal. The name begins with the labels that apply to the variant
/// (see selects()), the label with the most keys first. A label replaces the keys in its `where`.
/// Other keys follow if they distinguish the variants: "fluid at rest, A=0.05 rad". Without a
/// sweep, the name is "no sweep". (Ids and CSV use Variant::name.)
std::map<nlohmann::json, std::string> variant_names(const std::vector<nlohmann::json>& variants,
                                                    std::span<const VariantLabel> labels);

/// The swept axis with this key, or nullptr.
const SweepAxis* find_axis(const Sweep& sweep, std::string_view key);

/// The number of variants, or ManifestLimits::runs + 1 if there are more.
std::uint64_t variant_count(const Sweep& sweep);

/// The variants in the order of the manifest: the first grid axis varies slowest, the rows of the
/// zip fastest. `scale` must be complete (see Scale) and must not have more variants than
/// ManifestLimits::runs.
std::vector<Variant> variants_of(const Scale& scale);

}  // namespace shearcell
