// SPDX-License-Identifier: GPL-3.0-or-later
// Upper limits for the content of a store, its checkpoints, and the files that are made from them.
// The content of a store is untrusted input.
#pragma once

#include <cstddef>
#include <cstdint>

namespace shearcell {

struct StoreLimits {
  static constexpr std::uint64_t grains = 100'000'000;  ///< grains (and wall grains) per checkpoint
  static constexpr std::size_t observables = 1'000;     ///< observables of a checkpoint
  static constexpr std::uint64_t cycles = 1'000'000;    ///< cycles in a run or checkpoint interval
  static constexpr std::size_t text = 4'096;            ///< length of a run id or a name [bytes]
  static constexpr std::size_t value_bytes = 64 << 20;  ///< size of one value in the database
  static constexpr std::size_t json_depth = 64;  ///< nesting depth of a payload or stored measure
  /// Largest size of a figure file that `show` reads [bytes].
  static constexpr std::uint64_t published_bytes = 1 << 30;
};

}  // namespace shearcell
