// SPDX-License-Identifier: GPL-3.0-or-later
// JSON that nobody vouches for. The library reads it without recursion, and then writes, copies
// and compares it with recursion: nested deeply enough, it would end the program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "provenance/errors.hpp"

namespace shearcell {

struct Event;

/// A discarded value when the text is no JSON or is nested deeper than StoreLimits::json_depth.
nlohmann::json parse_json(std::string_view text);
/// The same of CBOR, which the library reads with recursion too.
nlohmann::json parse_cbor(std::span<const std::byte> bytes);

/// For an event whose payload lacks what its type needs.
StoreDamaged damaged_payload(const Event& event, const nlohmann::json::exception& problem);

/// A whole number from 0 to 2^64 - 1 of an object. Throws nlohmann::json::exception when it is
/// missing or something else; the library's own `get` would cast 1e300 to it.
std::uint64_t count_at(const nlohmann::json& object, const char* key);

}  // namespace shearcell
