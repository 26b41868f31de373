// SPDX-License-Identifier: GPL-3.0-or-later
// Reads numbers from untrusted text, independently of the locale.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace shearcell {

/// The value of `text` if it is exactly one decimal number in the range of Number; else nothing.
template <class Number>
std::optional<Number> read_number(std::string_view text) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end ? std::optional(value) : std::nullopt;
}

}  // namespace shearcell
