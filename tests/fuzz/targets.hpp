// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzz targets: one function for each kind of untrusted input.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "provenance/event_log.hpp"

namespace shearcell::fuzz {

using Input = std::span<const std::uint8_t>;

struct Target {
  const char* name;
  /// Takes any bytes. It catches the exceptions that such an input may end in, those with a message
  /// for people; any other exception is a fault, as are crashes, leaks and undefined behaviour.
  void (*run)(Input);
  /// Sound inputs, small ones, to start from, made by the program's own code.
  std::vector<std::string> (*seeds)();
};

/// For GoogleTest.
inline void PrintTo(const Target& target, std::ostream* out) {
  *out << target.name;
}

extern const std::array<Target, 7> all_targets;

std::vector<std::string> manifest_seeds();
std::vector<std::string> event_seeds();
std::vector<std::string> checkpoint_seeds();
std::vector<std::string> store_seeds();
std::vector<std::string> published_seeds();
std::vector<std::string> measure_seeds();
std::vector<std::string> packing_seeds();

/// Lines of "TYPE<tab>STREAM<tab>SCHEMA<tab>PAYLOAD" as events, numbered on from those of
/// make_store. A line with fewer fields is left out.
std::vector<Event> forged_events(std::string_view lines);

/// A store with a manifest, two runs, three checkpoints and a figure; returns its folder.
std::filesystem::path make_store(const std::filesystem::path& folder);

}  // namespace shearcell::fuzz
