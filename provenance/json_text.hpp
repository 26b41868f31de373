// SPDX-License-Identifier: GPL-3.0-or-later
// Writes JSON values as text and parses untrusted JSON. The parsers limit the depth, because the
// library handles values recursively, and deeply nested input would overflow the stack.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "provenance/errors.hpp"

namespace shearcell {

struct Event;

/// If the text is not JSON or exceeds StoreLimits::json_depth, the result is a discarded value.
nlohmann::json parse_json(std::string_view text);
/// Like parse_json(), but parses CBOR.
nlohmann::json parse_cbor(std::span<const std::byte> bytes);

/// The exception for an event in whose payload a required value is missing or has a wrong type.
StoreDamaged damaged_payload(const Event& event, const nlohmann::json::exception& problem);

/// The member `key`, a whole number from 0 to 2^64 - 1. Throws nlohmann::json::exception when the
/// member is missing or has any other value. (The library's `get` would convert even 1e300.)
std::uint64_t count_at(const nlohmann::json& object, const char* key);

/// `value` rounded to `significant` digits; null if `value` is not finite.
nlohmann::json rounded(double value, int significant);

/// The value as in a manifest or a CSV file: a string without quotes, a number with all digits.
std::string value_text(const nlohmann::json& value);
/// The value for messages: a string without quotes, a floating-point number with six significant
/// digits, any other value as JSON.
std::string short_text(const nlohmann::json& value);

/// `facts(item)` of each item, in order: a JSON array, if `facts` returns JSON.
auto list_of(const auto& items, const auto& facts) {
  std::vector<std::decay_t<decltype(facts(*std::begin(items)))>> list;
  for (const auto& item : items) list.push_back(facts(item));
  return list;
}

/// The member `key`; null when `object` has no such member or is not an object.
nlohmann::json member_of(const nlohmann::json& object, const char* key);
/// short_text() of the member `key`; "unknown" when the member is missing or null.
std::string text_at(const nlohmann::json& object, const char* key);

}  // namespace shearcell
