// SPDX-License-Identifier: GPL-3.0-or-later
// Text that others wrote, put into a page so that it stays text.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "analysis/chart.hpp"

namespace shearcell {

/// For element content and for attribute values in double or single quotes. Control characters
/// other than tab and line feed become U+FFFD, as do bytes that are no UTF-8.
std::string escape_html(std::string_view text);

std::string text_html(const Text& text);

/// JSON for the inside of a <script> element: no '<', '>' or '&' is left in it, so that no text in
/// it can end the element or begin a comment.
std::string script_json(const nlohmann::json& value);

/// RFC 4648, padded.
std::string base64(std::span<const std::byte> bytes);

}  // namespace shearcell
