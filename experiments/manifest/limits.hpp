// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

namespace shearcell {

/// Limits of a manifest's text and of its expansion; experiments/README.md lists all limits of the
/// program. The ranges of the parameters (N, cycles, ...) are in the schema.
struct ManifestLimits {
  static constexpr std::size_t bytes = 1 << 20;
  static constexpr std::size_t nodes = 100'000;
  static constexpr std::size_t depth = 16;
  static constexpr std::size_t values_per_list = 1'000;
  static constexpr std::size_t scales = 16;
  static constexpr std::uint64_t runs = 10'000;  ///< of all scales together
};

}  // namespace shearcell
