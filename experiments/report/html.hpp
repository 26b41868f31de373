// SPDX-License-Identifier: GPL-3.0-or-later
// Foreign text, put into a page so that it stays text; and tables.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/chart.hpp"

namespace shearcell {

/// For element content and for attribute values in double or single quotes. Control characters
/// except tab and line feed become U+FFFD, as do bytes that are not UTF-8.
std::string escape_html(std::string_view text);

std::string text_html(const Text& text);

/// The heading of a cell's column (markup), for pages too narrow for a row: there the style sheet
/// shows each row as a card.
std::string card_label(std::string_view head);

/// Cells hold markup, in which foreign text is already escaped. A heading that begins with '#'
/// makes its column one of numbers, aligned to the right.
using HtmlRow = std::vector<std::string>;
std::string html_table(const HtmlRow& head, const std::vector<HtmlRow>& rows,
                       std::string_view css_class = "");

/// A part of the page that scrolls by itself.
std::string scroll_box(std::string_view label, const std::string& html,
                       std::string_view css_class = "scroll");

/// JSON for the inside of a <script> element: it contains no '<', '>' or '&', so that no text can
/// end the element or begin a comment.
std::string script_json(const nlohmann::json& value);

/// RFC 4648, padded.
std::string base64(std::span<const std::byte> bytes);

}  // namespace shearcell
