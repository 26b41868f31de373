// SPDX-License-Identifier: GPL-3.0-or-later
// Selects by values named on the command line.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace shearcell {

/// Passes a value that, for each kind of wanted values, fits at least one; passes all values if
/// none are wanted. Remembers the values that it has seen.
class Filter {
 public:
  using Fits = bool (*)(const std::string& wanted, const std::string& value);
  using Kind = std::string (*)(const std::string& wanted);

  explicit Filter(
      std::vector<std::string> wanted,
      Fits fits = [](const std::string& one, const std::string& value) { return one == value; },
      Kind kind = [](const std::string&) { return std::string(); })
      : wanted_(std::move(wanted)), fits_(fits), kind_(kind) {}

  bool passes(const std::string& value) {
    if (wanted_.empty()) return true;
    if (known_.insert(value).second) seen_.push_back(value);
    std::map<std::string, bool> fits;  // by kind
    for (const std::string& one : wanted_) fits[kind_(one)] |= fits_(one, value);
    return std::ranges::all_of(fits, [](const auto& kind) { return kind.second; });
  }

  /// The first wanted value that no seen value fitted, or null.
  const std::string* unfound() const {
    const auto found = [&](const std::string& one) {
      return std::ranges::any_of(seen_, [&](const auto& value) { return fits_(one, value); });
    };
    const auto missing = std::ranges::find_if_not(wanted_, found);
    return missing == wanted_.end() ? nullptr : &*missing;
  }

  /// The values seen, each once, in order.
  const std::vector<std::string>& seen() const { return seen_; }

 private:
  std::vector<std::string> wanted_;
  Fits fits_;
  Kind kind_;
  std::vector<std::string> seen_;
  std::set<std::string> known_;  ///< those of seen_
};

/// Numbers as a Filter takes them.
inline std::vector<std::string> texts_of(const std::vector<std::uint64_t>& numbers) {
  std::vector<std::string> texts;
  for (const std::uint64_t number : numbers) texts.push_back(std::to_string(number));
  return texts;
}

}  // namespace shearcell
