// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/json_text.hpp"

#include <fmt/format.h>

#include "provenance/event_log.hpp"
#include "provenance/limits.hpp"

namespace shearcell {

namespace {

bool is_too_deep(std::string_view text) {
  std::size_t depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      in_string = !in_string;
    } else if (in_string) {
      if (c == '\\') ++i;
    } else if (c == '{' || c == '[') {
      if (++depth > StoreLimits::json_depth) return true;
    } else if (c == '}' || c == ']') {
      if (depth > 0) --depth;
    }
  }
  return false;
}

/// Stops at the first value that is nested too deeply.
class Depth : public nlohmann::json::json_sax_t {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool key(string_t&) override { return true; }
  bool start_object(std::size_t) override { return ++depth_ <= StoreLimits::json_depth; }
  bool start_array(std::size_t) override { return ++depth_ <= StoreLimits::json_depth; }
  bool end_object() override { return leave(); }
  bool end_array() override { return leave(); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception&) override {
    return false;
  }

 private:
  bool leave() {
    --depth_;
    return true;
  }

  std::size_t depth_ = 0;
};

}  // namespace

nlohmann::json parse_json(std::string_view text) {
  if (is_too_deep(text)) return nlohmann::json::value_t::discarded;
  return nlohmann::json::parse(text, nullptr, false);
}

nlohmann::json parse_cbor(std::span<const std::byte> bytes) {
  using nlohmann::json;
  const auto* first = reinterpret_cast<const std::uint8_t*>(bytes.data());
  const auto* last = first + bytes.size();
  Depth depth;
  if (!json::sax_parse(first, last, &depth, json::input_format_t::cbor)) {
    return json::value_t::discarded;
  }
  return json::from_cbor(first, last, true, false);
}

std::uint64_t count_at(const nlohmann::json& object, const char* key) {
  const nlohmann::json& value = object.at(key);
  if (value.is_number_unsigned()) return value.get<std::uint64_t>();
  throw nlohmann::json::type_error::create(
      302, std::string(key) + " must be a whole number, but is " + value.type_name(), &value);
}

StoreDamaged damaged_payload(const Event& event, const nlohmann::json::exception& problem) {
  return StoreDamaged(fmt::format("event {} ({} of {}): its payload is invalid: {}", event.seq,
                                  event.type, event.stream, problem.what()));
}

}  // namespace shearcell
