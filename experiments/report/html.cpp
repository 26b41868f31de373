// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/html.hpp"

#include <fmt/format.h>

#include <cstdint>

namespace shearcell {
namespace {

constexpr std::string_view replacement = "\xEF\xBF\xBD";  // U+FFFD

/// Any bytes as valid UTF-8, by JSON's writer.
std::string valid_utf8(std::string_view text) {
  const std::string dumped =
      nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return nlohmann::json::parse(dumped).get<std::string>();
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string result;
  for (const char c : valid_utf8(text)) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default: {
        const bool control = static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
        if (control && c != '\t' && c != '\n') {
          result += replacement;
        } else {
          result += c;
        }
      }
    }
  }
  return result;
}

std::string text_html(const Text& text) {
  std::string html;
  for (const TextRun& run : text.runs) {
    const std::string plain = escape_html(run.text);
    html += run.style.empty() ? plain : "<" + run.style + ">" + plain + "</" + run.style + ">";
  }
  return html;
}

std::string card_label(std::string_view head) {
  return head.empty()
             ? ""
             : fmt::format("<span class=\"card-label\" aria-hidden=\"true\">{}</span>", head);
}

std::string html_table(const HtmlRow& head, const std::vector<HtmlRow>& rows,
                       std::string_view css_class) {
  const auto add = [&](std::string& html, const HtmlRow& row, const char* tag) {
    html += "<tr>";
    for (std::size_t k = 0; k < row.size(); ++k) {
      const bool number = head[k].starts_with('#');
      const std::string_view name = std::string_view(head[k]).substr(number ? 1 : 0);
      html += fmt::format("<{0}{1}>{2}</{0}>", tag, number ? " class=\"number\"" : "",
                          &row == &head ? std::string(name) : card_label(name) + row[k]);
    }
    html += "</tr>\n";
  };
  std::string html = fmt::format("<table class=\"cards {}\"><thead>", css_class);
  add(html, head, "th");
  html += "</thead><tbody>\n";
  for (const HtmlRow& row : rows) add(html, row, "td");
  return html + "</tbody></table>";
}

std::string scroll_box(std::string_view label, const std::string& html,
                       std::string_view css_class) {
  return fmt::format(
      "<div class=\"{}\" tabindex=\"0\" role=\"region\" aria-label=\"{}\">{}</div>\n", css_class,
      escape_html(label), html);
}

std::string script_json(const nlohmann::json& value) {
  std::string result;
  for (const char c : value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)) {
    // JSON has these only within strings, where an escape means the same.
    switch (c) {
      case '<':
        result += "\\u003c";
        break;
      case '>':
        result += "\\u003e";
        break;
      case '&':
        result += "\\u0026";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string base64(std::span<const std::byte> bytes) {
  static constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string result;
  result.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      word =
          word << 8 | (at + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[at + k]) : 0);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const bool padding = at + k > bytes.size();
      result += padding ? '=' : digits[word >> (18 - 6 * k) & 63U];
    }
  }
  return result;
}

}  // namespace shearcell
