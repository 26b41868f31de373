// SPDX-License-Identifier: GPL-3.0-or-later
// Guesses the name that a writer of a manifest meant.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace shearcell {

struct Suggestion {
  std::string name;           ///< empty when nothing is near
  bool missing_unit = false;  ///< the name was written without the unit that belongs to it
};

/// The nearest of `candidates`: by the symbol of a parameter (`N`), by a name whose unit was left
/// out (`mass`), or by spelling (up to about a third of the letters wrong).
Suggestion suggest_name(std::string_view unknown, std::span<const std::string_view> candidates);

/// "PROBLEM, the nearest is NAME"; only the problem when nothing is near.
std::string with_nearest(std::string problem, std::string_view unknown,
                         std::span<const std::string_view> candidates);

/// "did you mean NEAREST?"; "known are A, B, C" when nothing is near.
std::string did_you_mean(std::string_view unknown, std::span<const std::string_view> known);

/// The member `name` of each.
std::vector<std::string_view> names_of(const auto& list) {
  std::vector<std::string_view> names;
  for (const auto& one : list) names.emplace_back(one.name);
  return names;
}

}  // namespace shearcell
