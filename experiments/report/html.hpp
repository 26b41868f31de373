// SPDX-License-Identifier: GPL-3.0-or-later
// Escapes untrusted text for HTML and JSON, and fills a template.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "analysis/chart.hpp"

namespace shearcell {

/// Escapes text for element content and quoted attribute values. Also escapes the characters that
/// for_terminal() escapes, such as control characters and bytes that are not UTF-8.
std::string escape_html(std::string_view text);

std::string text_html(const Text& text);

/// Fills the Mustache template `page` with these values. escape_html() escapes values in double
/// braces; values in triple braces are markup. A section is shown once if its value is true, a
/// number, an object or a text that is not empty. A section whose value is an array is shown for
/// each item. A name that the innermost object lacks is looked up in the objects around it. The
/// section `brief` shows its first 12 characters, such as those of an id. Throws std::logic_error
/// for a malformed template.
std::string filled(const std::string& page, const nlohmann::json& values);

/// Returns JSON for a <script> element. The JSON contains no '<', '>' or '&', so that no text can
/// end the element or begin a comment.
std::string script_json(const nlohmann::json& value);

/// Returns the bytes in base64 (RFC 4648, with padding).
std::string base64(std::span<const std::byte> bytes);

}  // namespace shearcell
