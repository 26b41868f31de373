// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/committor.hpp"

#include <algorithm>
#include <deque>
#include <iterator>
#include <map>
#include <set>

namespace shearcell {
namespace {

using Grains = std::set<std::int32_t>;

Grains grains_of(const CrystalliteMap& map, const std::set<std::int32_t>& labels) {
  Grains grains;
  for (std::size_t k = 0; k < map.grain.size(); ++k) {
    if (labels.contains(map.label[k])) grains.insert(map.grain[k]);
  }
  return grains;
}

/// Numbers of grains in a crystallite, by the origin of the grains. The comment on followed()
/// defines "remembered", "foreign crystallite" and G.
struct Origin {
  std::size_t own = 0;   ///< remembered grains
  std::size_t last = 0;  ///< grains in G
  /// Label of a foreign crystallite -> number of grains that come from this crystallite.
  std::map<std::int32_t, std::size_t> of_other;

  bool continues_another() const {
    return std::ranges::any_of(of_other, [&](const auto& other) { return other.second > own; });
  }
};

}  // namespace

std::vector<std::int32_t> followed_in(const CrystalliteMap& start) {
  std::vector<std::int32_t> labels;
  for (std::size_t bin = 0; bin + 1 < std::size(followed_bins); ++bin) {
    const auto found = std::ranges::find_if(start.size, [&](std::int32_t size) {
      return size >= followed_bins[bin] && size < followed_bins[bin + 1];
    });
    if (found != start.size.end()) {
      labels.push_back(static_cast<std::int32_t>(found - start.size.begin()));
    }
  }
  return labels;
}

Followed followed(std::span<const CrystalliteMap* const> maps, std::int32_t label) {
  Followed found;
  std::set<std::int32_t> descendants = {label};
  std::deque<Grains> recent = {grains_of(*maps[0], descendants)};
  for (std::size_t cycle = 1; cycle < maps.size(); ++cycle) {
    const CrystalliteMap &before = *maps[cycle - 1], &now = *maps[cycle];
    Grains own;
    for (const Grains& grains : recent) own.insert(grains.begin(), grains.end());
    // Grains of foreign crystallites (see followed()): grain -> label of its crystallite.
    std::map<std::int32_t, std::int32_t> other;
    for (std::size_t k = 0; k < before.grain.size(); ++k) {
      const bool is_other =
          !descendants.contains(before.label[k]) && !own.contains(before.grain[k]);
      if (is_other) other[before.grain[k]] = before.label[k];
    }
    std::vector<Origin> origins(now.size.size());
    for (std::size_t k = 0; k < now.grain.size(); ++k) {
      Origin& origin = origins[static_cast<std::size_t>(now.label[k])];
      origin.own += own.contains(now.grain[k]) ? 1 : 0;
      origin.last += recent.back().contains(now.grain[k]) ? 1 : 0;
      if (const auto at = other.find(now.grain[k]); at != other.end())
        ++origin.of_other[at->second];
    }
    descendants.clear();
    std::int32_t largest = 0;
    bool swallowed = false;
    for (std::size_t c = 0; c < origins.size(); ++c) {
      if (origins[c].own == 0 || now.size[c] < least_descendant) continue;
      if (origins[c].continues_another()) {
        swallowed = swallowed || 2 * origins[c].last >= recent.back().size();
        continue;
      }
      descendants.insert(static_cast<std::int32_t>(c));
      largest = std::max(largest, now.size[c]);
    }
    if (descendants.empty() && swallowed) {
      found.merged = true;
      return found;
    }
    found.sizes.push_back(largest);
    if (descendants.empty()) continue;
    recent.push_back(grains_of(now, descendants));
    if (recent.size() > remembered_cycles) recent.pop_front();
  }
  return found;
}

Ending ending(const Followed& crystallite, std::size_t cycles_without) {
  Ending end;
  std::size_t missing = 0;
  for (const std::int32_t size : crystallite.sizes) {
    missing = size == 0 ? missing + 1 : 0;
    if (size >= grown_size) {
      end.revived = end.fate == Fate::gone;
      if (!end.revived) end.fate = Fate::grown;
      return end;
    }
    if (missing == cycles_without) end.fate = Fate::gone;
  }
  if (end.fate == Fate::undecided && crystallite.merged) end.fate = Fate::merged;
  return end;
}

}  // namespace shearcell
