// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/suggest.hpp"

#include <fmt/ranges.h>

#include <boost/algorithm/string/case_conv.hpp>
#include <cctype>
#include <sstream>

#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/tried_names.hpp"

namespace shearcell {
namespace {

using std::string_view;

constexpr std::size_t kLongestGuess = 300;

// The name in lower case, with `_` before, between and after its words: "_time_step_".
std::string as_words(string_view name) {
  std::string words = fmt::format("_{}_", lower(name));
  std::ranges::replace_if(
      words, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return words;
}

// Least number of edits from `a` to `b`. A swap of two adjacent characters counts as one edit.
std::size_t edit_distance(string_view a, string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + change});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string lower(string_view text) {
  return boost::algorithm::to_lower_copy(std::string(text));
}

string_view trimmed(string_view text) {
  constexpr string_view blanks = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

const Tried* find_tried(string_view name, std::span<const string_view> candidates) {
  if (name.size() > kLongestGuess) return nullptr;
  const std::string words = as_words(name);
  const Tried* found = nullptr;
  for (const Tried& one : tried_names) {
    std::istringstream names{std::string(one.names)};
    const bool fits = std::any_of(std::istream_iterator<std::string>(names), {}, [&](auto& tried) {
      const std::string tried_words = as_words(tried);
      return one.remark.empty() ? words == tried_words : words.find(tried_words) != words.npos;
    });
    if (fits && std::ranges::count(candidates, one.instead) > 0) return &one;
    if (fits && found == nullptr && !one.remark.empty()) found = &one;
  }
  return found;
}

std::string suggest_name(string_view unknown, std::span<const string_view> candidates) {
  if (unknown.empty() || unknown.size() > kLongestGuess) return {};
  const std::string written = lower(unknown);
  for (const string_view candidate : candidates) {
    const Field* field = find_field(candidate);
    if (field != nullptr && field->symbol == unknown) return std::string(candidate);
    // `mass` is a short form of mass_kg. A parameter without a unit has no short form.
    const bool can_be_short = field == nullptr || has_unit(*field);
    if (can_be_short && lower(candidate).starts_with(written + "_")) return std::string(candidate);
  }
  const Tried* tried = find_tried(unknown, candidates);
  if (tried != nullptr && std::ranges::count(candidates, tried->instead) > 0) {
    return std::string(tried->instead);
  }

  const std::size_t allowed = std::max<std::size_t>(2, written.size() / 3);
  std::size_t nearest = allowed + 1;
  std::string best;
  for (const string_view candidate : candidates) {
    const std::size_t distance = edit_distance(written, lower(candidate));
    // A name that differs in every letter is not suggested.
    if (distance < nearest && distance < candidate.size()) {
      nearest = distance;
      best = candidate;
    }
  }
  return best;
}

std::string with_nearest(const std::string& problem, string_view unknown,
                         std::span<const string_view> candidates) {
  const std::string near = suggest_name(unknown, candidates);
  return near.empty() ? problem : problem + ", the nearest is " + near;
}

std::string did_you_mean(string_view unknown, std::span<const string_view> known) {
  const std::string near = suggest_name(unknown, known);
  return near.empty() ? fmt::format("known are {}", fmt::join(known, ", "))
                      : fmt::format("did you mean {}?", near);
}

}  // namespace shearcell
