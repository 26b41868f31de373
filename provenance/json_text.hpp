// SPDX-License-Identifier: GPL-3.0-or-later
// JSON values as text, and untrusted JSON. The library copies, compares and writes values
// recursively, so deeply nested input would overflow the stack; these functions limit the depth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "provenance/errors.hpp"

namespace shearcell {

struct Event;

/// A discarded value when the text is not JSON or is nested deeper than StoreLimits::json_depth.
nlohmann::json parse_json(std::string_view text);
/// parse_json() for CBOR.
nlohmann::json parse_cbor(std::span<const std::byte> bytes);

/// The error of an event whose payload lacks a required value.
StoreDamaged damaged_payload(const Event& event, const nlohmann::json::exception& problem);

/// A whole number from 0 to 2^64 - 1. Throws nlohmann::json::exception when the value is missing or
/// something else; the library's `get` would convert 1e300.
std::uint64_t count_at(const nlohmann::json& object, const char* key);

/// The number rounded to `significant` digits; null if it is not finite.
nlohmann::json rounded(double value, int significant);

/// A value as a manifest or a CSV file writes it: "still", "0.1".
std::string value_text(const nlohmann::json& value);
/// For messages: a text without quotes, a fraction with six significant digits, else as JSON.
std::string short_text(const nlohmann::json& value);

/// Null when `object` has no such member or is not an object.
nlohmann::json member_of(const nlohmann::json& object, const char* key);
/// short_text() of the member `key`; "unknown" for null.
std::string text_at(const nlohmann::json& object, const char* key);

}  // namespace shearcell
