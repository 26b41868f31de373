// SPDX-License-Identifier: GPL-3.0-or-later
// The fates of a crystallite in the clones of a recorded state: grown, gone or merged.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/crystal.hpp"

namespace shearcell {

/// Fewest grains of a descendant. A state whose crystallites all have fewer grains is a control.
/// [choice]
inline constexpr std::int32_t least_descendant = 3;
/// Grains of a descendant from which on the followed crystallite has grown. [choice]
inline constexpr std::int32_t grown_size = 60;
/// A crystallite is gone after this many cycles in a row without a descendant. [choice]
inline constexpr std::size_t cycles_gone = 2;
/// Size bins of the followed crystallites: 3 and 4 grains, 5 to 7, 8 to 12, 13 to 20. In each state
/// at most one crystallite of each bin is followed. [choice]
inline constexpr std::int32_t followed_bins[] = {3, 5, 8, 13, 21};
/// The grains of a descendant are remembered for this many cycles. [choice]
inline constexpr std::size_t remembered_cycles = 3;

/// Labels of the crystallites to follow: in each size bin, the one with the lowest grain id.
std::vector<std::int32_t> followed_in(const CrystalliteMap& start);

/// A crystallite in one clone.
struct Followed {
  /// Grains of its largest descendant, one number for each cycle after the start; 0 in a cycle
  /// without a descendant.
  std::vector<std::int32_t> sizes = {};
  /// Another crystallite swallowed it in the cycle after the last of `sizes`, where following ends.
  bool merged = false;
};

/// Follows crystallite `label` of the first map through the other maps, one for each cycle.
///
/// The remembered grains are the grains of all descendants in the last three cycles that had a
/// descendant. A later crystallite of at least `least_descendant` grains is a descendant if it has
/// a remembered grain, unless it shares more grains with a crystallite of the previous cycle that
/// was no descendant: then it continues that crystallite. The followed crystallite is swallowed if
/// there is no descendant and a continued crystallite has at least half of the last descendants'
/// grains.
Followed followed(std::span<const CrystalliteMap* const> maps, std::int32_t label);

/// `undecided`: the clone ends before the fate is known.
enum class Fate { undecided, grown, gone, merged };

struct Ending {
  Fate fate = Fate::undecided;
  bool revived = false;  ///< a descendant appeared and grew after the crystallite was gone
};

/// The first of these events decides: a descendant has `grown_size` grains (grown), or there has
/// been no descendant for `cycles_without` cycles in a row (gone).
Ending ending(const Followed& crystallite, std::size_t cycles_without);

}  // namespace shearcell
