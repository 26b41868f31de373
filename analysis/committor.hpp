// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a crystallite grows, disappears or merges in each clone of a recorded state.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/crystal.hpp"

namespace shearcell {

/// A descendant has at least this many grains. A control state is a state that has only smaller
/// crystallites. [choice]
inline constexpr std::int32_t least_descendant = 3;
/// The followed crystallite has grown if a descendant has at least this many grains. [choice]
inline constexpr std::int32_t grown_size = 60;
/// A crystallite is gone after this number of consecutive cycles without a descendant. [choice]
inline constexpr std::size_t cycles_gone = 2;
/// Limits of the size bins of followed crystallites: 3 to 4, 5 to 7, 8 to 12 and 13 to 20 grains.
/// The last number is above the last bin. In each state at most one crystallite of each bin is
/// followed. [choice]
inline constexpr std::int32_t followed_bins[] = {3, 5, 8, 13, 21};
/// A grain of a descendant is remembered for this number of cycles. followed() defines
/// "descendant" and "remembered". [choice]
inline constexpr std::size_t remembered_cycles = 3;

/// Labels of the crystallites to follow: in each size bin, the one that has the lowest grain id.
std::vector<std::int32_t> followed_in(const CrystalliteMap& start);

/// What happens to the followed crystallite in one clone.
struct Followed {
  /// Grains in the largest descendant, for each cycle after the start; 0: no descendant.
  std::vector<std::int32_t> sizes = {};
  /// True if, after the last cycle in `sizes`, another crystallite absorbed the followed one.
  bool merged = false;
};

/// Follows crystallite `label` of maps[0] through the later maps. There is one map for each cycle.
///
/// The first descendant is the crystallite itself. A grain is remembered if it belonged to a
/// descendant in one of the last `remembered_cycles` cycles; cycles without a descendant are not
/// counted. A foreign crystallite is a crystallite of the previous cycle that is not a descendant.
/// A crystallite C of the current cycle continues a foreign crystallite X if C has more grains from
/// X than remembered grains. A remembered grain does not count as a grain from X. C is a
/// descendant if it has at least `least_descendant` grains, has a remembered grain, and continues
/// no foreign crystallite. Let G be the grains of all descendants in the latest cycle that had any.
/// The followed crystallite has merged if the current cycle has no descendant, and if a crystallite
/// that continues a foreign crystallite contains at least half of G.
Followed followed(std::span<const CrystalliteMap* const> maps, std::int32_t label);

/// Outcome for a followed crystallite. `undecided`: the clone ends before the outcome is known.
enum class Fate { grown, gone, merged, undecided };

struct Ending {
  Fate fate = Fate::undecided;
  bool revived = false;  ///< a descendant reached `grown_size` after the crystallite was gone
};

/// Grown if a descendant has `grown_size` grains, gone if `cycles_without` consecutive cycles have
/// no descendant. The earlier of the two decides. If neither occurs, Followed::merged decides.
Ending ending(const Followed& crystallite, std::size_t cycles_without);

}  // namespace shearcell
