// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/html.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <kainjow/mustache.hpp>
#include <stdexcept>

#include "experiments/manifest/document.hpp"

namespace shearcell {
namespace {

kainjow::mustache::data template_value(const nlohmann::json& value) {
  using kainjow::mustache::data;
  if (value.is_object()) {
    data object;
    for (const auto& [key, member] : value.items()) object[key] = template_value(member);
    return object;
  }
  if (value.is_array()) {
    data list(data::type::list);
    for (const nlohmann::json& item : value) list << template_value(item);
    return list;
  }
  if (value.is_number()) return value.dump();
  if (value.is_boolean()) return value.get<bool>();
  const auto* text = value.get_ptr<const std::string*>();
  return text == nullptr || text->empty() ? data(false) : data(*text);
}

}  // namespace

std::string escape_html(std::string_view text) {
  return kainjow::mustache::html_escape(for_terminal(text));
}

std::string text_html(const Text& text) {
  std::string html;
  for (const TextPart& part : text.parts) {
    const std::string plain = escape_html(part.text);
    html += part.style.empty() ? plain : "<" + part.style + ">" + plain + "</" + part.style + ">";
  }
  return html;
}

std::string filled(const std::string& page, const nlohmann::json& values) {
  kainjow::mustache::mustache parsed(page);
  parsed.set_custom_escape([](const std::string& text) { return escape_html(text); });
  kainjow::mustache::data data = template_value(values);
  data["brief"] = kainjow::mustache::lambda2(
      [](const std::string& text, const auto& render) { return render(text).substr(0, 12); });
  std::string html = parsed.render(data);
  if (!parsed.is_valid()) throw std::logic_error("page.html: " + parsed.error_message());
  return html;
}

std::string script_json(const nlohmann::json& value) {
  std::string text;
  // In JSON these characters occur only in strings, where an escape has the same meaning.
  for (const char c : value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)) {
    text += c == '<' || c == '>' || c == '&' ? fmt::format("\\u{:04x}", c) : std::string(1, c);
  }
  return text;
}

std::string base64(std::span<const std::byte> bytes) {
  std::string text((bytes.size() + 2) / 3 * 4, '=');
  EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                  reinterpret_cast<const unsigned char*>(bytes.data()),
                  static_cast<int>(bytes.size()));
  return text;
}

}  // namespace shearcell
