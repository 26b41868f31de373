// SPDX-License-Identifier: GPL-3.0-or-later
// How much of anything is taken in, in one place: every input is untrusted, and none may cost more
// than its limit. experiments/README.md has them as a table, with what comes of more.
#pragma once

#include <cstddef>
#include <cstdint>

namespace shearcell {

/// Of the text of a manifest and of what it expands to. The ranges of its parameters (N, cycles,
/// ...) are in the schema.
struct ManifestLimits {
  static constexpr std::size_t bytes = 1 << 20;
  static constexpr std::size_t nodes = 100'000;
  static constexpr std::size_t depth = 16;
  static constexpr std::size_t values_per_list = 1'000;
  static constexpr std::size_t scales = 16;
  static constexpr std::uint64_t runs = 10'000;  ///< of all scales together
};

/// Of a store, its checkpoints, and the files made from them.
struct StoreLimits {
  static constexpr std::uint64_t grains = 100'000'000;  ///< of a checkpoint, and of its walls
  static constexpr std::size_t observables = 1'000;     ///< of a checkpoint
  static constexpr std::size_t text = 4'096;            ///< [bytes] a run's id, a name
  static constexpr std::size_t value_bytes = 64 << 20;  ///< one value of the database, so a payload
  static constexpr std::size_t json_depth = 64;         ///< of a payload or a kept measure
  static constexpr std::uint64_t published_bytes = 1 << 30;  ///< a file given to `show`
};

}  // namespace shearcell
