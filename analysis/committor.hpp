// SPDX-License-Identifier: GPL-3.0-or-later
// The fates of a crystallite in the clones of a recorded state: grown, gone or merged.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/crystal.hpp"

namespace shearcell {

/// A crystallite with fewer grains is not a descendant, and a state without crystallites of so many
/// grains is a control. [choice]
inline constexpr std::int32_t least_descendant = 3;
/// A crystallite with a descendant of so many grains has grown. [choice]
inline constexpr std::int32_t grown_size = 60;
/// Cycles without a descendant after which a crystallite is gone. [choice]
inline constexpr std::size_t cycles_gone = 2;
/// Sizes of the crystallites that are followed, in these bins: 3 and 4 grains, 5 to 7, 8 to 12, 13
/// to 20. Of each state at most one of each bin is followed. [choice]
inline constexpr std::int32_t followed_bins[] = {3, 5, 8, 13, 21};
/// Cycles that the grains of a crystallite are remembered. [choice]
inline constexpr std::size_t remembered_cycles = 3;

/// The labels of the crystallites that are followed: of each bin the one with the lowest grain id.
std::vector<std::int32_t> followed_in(const CrystalliteMap& start);

/// A crystallite in one clone.
struct Followed {
  /// Grains of its largest descendant one cycle after the start, two cycles after it, ...; 0 where
  /// it has none.
  std::vector<std::int32_t> sizes = {};
  /// It was swallowed in the cycle after the last one of `sizes`. It is not followed further.
  bool merged = false;
};

/// Follows crystallite `label` of the first map through the other maps, one for each cycle.
///
/// Its grains are those of its descendants in the last three cycles that had any. A crystallite of
/// at least `least_descendant` grains that has one of these grains is a descendant, unless it has
/// more grains of another crystallite of the cycle before, one that was no descendant: then it
/// continues that one. The crystallite is swallowed if it has no descendant, and a crystallite that
/// continues another one has at least half of the grains that its descendants had last.
Followed followed(std::span<const CrystalliteMap* const> maps, std::int32_t label);

/// `undecided`: the clone ends before.
enum class Fate { undecided, grown, gone, merged };

struct Ending {
  Fate fate = Fate::undecided;
  bool revived = false;  ///< it was gone, and grew all the same
};

/// grown: a descendant has `grown_size` grains. gone: it has had no descendant for so many cycles
/// in a row. Whatever is first.
Ending ending(const Followed& crystallite, std::size_t cycles_without);

}  // namespace shearcell
