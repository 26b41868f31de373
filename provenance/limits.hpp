// SPDX-License-Identifier: GPL-3.0-or-later
// The limits of a store's content, which is untrusted.
#pragma once

#include <cstddef>
#include <cstdint>

namespace shearcell {

/// Limits of a store, its checkpoints, and the files made from them.
struct StoreLimits {
  static constexpr std::uint64_t grains = 100'000'000;  ///< of a checkpoint, and of its walls
  static constexpr std::size_t observables = 1'000;     ///< of a checkpoint
  static constexpr std::uint64_t cycles = 1'000'000;    ///< of a run, and between checkpoints
  static constexpr std::size_t text = 4'096;            ///< [bytes] a run's id, a name
  static constexpr std::size_t value_bytes = 64 << 20;  ///< one value of the database: a payload
  static constexpr std::size_t json_depth = 64;         ///< of a payload or a kept measure
  static constexpr std::uint64_t published_bytes = 1 << 30;  ///< a file given to `show`
};

}  // namespace shearcell
