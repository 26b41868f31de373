// SPDX-License-Identifier: GPL-3.0-or-later
// `until` of a manifest: a measure that ends a run before `cycles`. Like `cycles`, it is not part
// of the identity of a run.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/named.hpp"

namespace shearcell {

/// Measures of a checkpoint (analysis/measures.hpp) that can end a run.
enum class StopMeasure : std::uint8_t { crystalline_percent, largest_crystallite, phi };
template <>
inline constexpr auto kNames<StopMeasure> = names_in_order<StopMeasure>("crystalline_percent",
                                                                        "largest_crystallite",
                                                                        "phi");

/// A run ends `extra_cycles` after the first checkpoint where the measure is at least `value`.
struct Until {
  StopMeasure measure = StopMeasure::crystalline_percent;
  double value = 0;
  std::uint64_t extra_cycles = 0;

  bool operator==(const Until&) const = default;
};

/// {"crystalline_percent": 10, "extra_cycles": 15}, as a manifest writes it.
nlohmann::json to_json(const Until& until);

/// The inverse. The JSON is not trusted: throws std::runtime_error.
Until until_from_json(const nlohmann::json& json);

/// "crystalline_percent >= 10 and 15 cycles more".
std::string describe(const Until& until);

}  // namespace shearcell
