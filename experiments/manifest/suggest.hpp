// SPDX-License-Identifier: GPL-3.0-or-later
// Names in messages: suggests the known name that is nearest to an unknown name, and lists names.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace shearcell {

/// Names that users try, and what to write instead.
struct Tried {
  std::string_view names;    ///< separated by blanks; `_` separates the words of a name
  std::string_view instead;  ///< this program's name for the quantity; "" if it is not modelled
  std::string_view remark;   ///< what to write, in whole sentences; may be empty
};

/// Finds `name` in the table of names that users try. An entry with a remark also matches if `name`
/// contains one of the entry's names (`coefficient_of_friction` contains `friction`). Returns the
/// first matching entry whose `instead` is one of `candidates`; if there is none, the first
/// matching entry with a remark; otherwise null.
const Tried* find_tried(std::string_view name, std::span<const std::string_view> candidates);

/// The candidate that `unknown` probably means: found by a parameter's symbol (`N`), by its name
/// without the unit (`mass`), in the table of names that users try, or as the nearest spelling
/// (up to about a third of the letters may differ). "" if no candidate is near.
std::string suggest_name(std::string_view unknown, std::span<const std::string_view> candidates);

/// The text in lower case; only A to Z change.
std::string lower(std::string_view text);

/// The text without spaces, tabs and line ends at its beginning and end.
std::string_view trimmed(std::string_view text);

/// "PROBLEM, the nearest is NAME", or "PROBLEM" if no name is near.
std::string with_nearest(const std::string& problem, std::string_view unknown,
                         std::span<const std::string_view> candidates);

/// "did you mean NAME?", or "known are A, B, C" if no name is near.
std::string did_you_mean(std::string_view unknown, std::span<const std::string_view> known);

/// The first names of a list, and the number of the rest: "fluid=still, fluid=cell and 3 more".
std::string some_of(const auto& names, std::size_t most = 3) {
  const auto last =
      std::next(names.begin(), static_cast<std::ptrdiff_t>(std::min(most, names.size())));
  const std::string first = fmt::format("{}", fmt::join(names.begin(), last, ", "));
  return names.size() > most ? fmt::format("{} and {} more", first, names.size() - most) : first;
}

std::vector<std::string_view> names_of(auto&& list) {
  std::vector<std::string_view> names;
  for (const auto& one : list) names.emplace_back(one.name);
  return names;
}

}  // namespace shearcell
