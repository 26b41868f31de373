// SPDX-License-Identifier: GPL-3.0-or-later
// What is fuzzed: one function for each kind of input that the program takes from strangers.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace shearcell::fuzz {

using Input = std::span<const std::uint8_t>;

struct Target {
  const char* name;
  /// Takes any bytes. It catches the exceptions that such an input may end in, those with a message
  /// for people; whatever else leaves it is a fault, as are crashes, leaks and undefined behaviour.
  void (*run)(Input);
  /// Sound inputs, small ones, to start from.
  std::vector<std::string> (*seeds)();
};

extern const Target manifest_target;    ///< text of a manifest: read, check, expand
extern const Target events_target;      ///< lines of events: upcast, fold, query
extern const Target checkpoint_target;  ///< bytes of a checkpoint file, as they are and reframed
extern const Target store_target;       ///< a store with changed bytes or with forged events
extern const Target
    published_target;  ///< a CSV and the lineage beside it, as `show FILE` reads them
extern const Target measures_target;  ///< what derived.sqlite keeps of a checkpoint

inline const std::array<const Target*, 6> all_targets = {&manifest_target,   &events_target,
                                                         &checkpoint_target, &store_target,
                                                         &published_target,  &measures_target};

inline std::string_view text_of(Input input) {
  return {reinterpret_cast<const char*>(input.data()), input.size()};
}

/// For what must hold whatever the input is.
void require(bool fact, const char* what);

}  // namespace shearcell::fuzz
