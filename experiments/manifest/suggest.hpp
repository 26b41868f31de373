// SPDX-License-Identifier: GPL-3.0-or-later
// Names in messages: the known name that is nearest to an unknown one, and lists of names.
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

/// Names that people try, and what they mean.
struct Tried {
  std::string_view names;    ///< separated by blanks; `_` separates the words of a name
  std::string_view instead;  ///< our name; "" if the model has no such thing
  std::string_view remark;   ///< what to write, in whole sentences; may be empty
};

/// The entry of the table of tried names that fits `name`. An entry with a remark also fits names
/// that contain its words: `friction` fits `coefficient_of_friction`. If several fit, the first
/// whose `instead` is among `candidates`, else the first with a remark. Null if none fits.
const Tried* find_tried(std::string_view name, std::span<const std::string_view> candidates);

/// The nearest of `candidates`: by a parameter's symbol (`N`), by its name without the unit
/// (`mass`), by the table of tried names, or by spelling, with up to about a third of the letters
/// wrong. "" if no name is near.
std::string suggest_name(std::string_view unknown, std::span<const std::string_view> candidates);

/// The text with small letters for A to Z.
std::string lower(std::string_view text);

/// The text without spaces, tabs and line ends at its beginning and end.
std::string_view trimmed(std::string_view text);

/// "PROBLEM, the nearest is NAME", or "PROBLEM" if no name is near.
std::string with_nearest(const std::string& problem, std::string_view unknown,
                         std::span<const std::string_view> candidates);

/// "did you mean NAME?"; "known are A, B, C" if no name is near.
std::string did_you_mean(std::string_view unknown, std::span<const std::string_view> known);

/// The first of the names: "fluid=still, fluid=cell, fluid=none and 3 more".
std::string some_of(const auto& names, std::size_t most = 3) {
  const auto last =
      std::next(names.begin(), static_cast<std::ptrdiff_t>(std::min(most, names.size())));
  const std::string first = fmt::format("{}", fmt::join(names.begin(), last, ", "));
  return names.size() > most ? fmt::format("{} and {} more", first, names.size() - most) : first;
}

/// The member `name` of each item.
std::vector<std::string_view> names_of(auto&& list) {
  std::vector<std::string_view> names;
  for (const auto& one : list) names.emplace_back(one.name);
  return names;
}

}  // namespace shearcell
