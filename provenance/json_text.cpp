// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/json_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "provenance/event_log.hpp"
#include "provenance/limits.hpp"

namespace shearcell {

namespace {

using nlohmann::json;

/// SAX handler that stops the parser at the first value nested deeper than the limit.
class Depth : public json::json_sax_t {
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
  bool end_object() override { return depth_-- > 0; }
  bool end_array() override { return depth_-- > 0; }
  bool parse_error(std::size_t, const std::string&, const json::exception&) override {
    return false;
  }

 private:
  std::size_t depth_ = 0;
};

/// Whether the input is valid and not nested too deeply.
bool is_shallow(auto first, auto last, json::input_format_t format) {
  Depth depth;
  return json::sax_parse(first, last, &depth, format);
}

}  // namespace

json parse_json(std::string_view text) {
  if (!is_shallow(text.begin(), text.end(), json::input_format_t::json)) {
    return json::value_t::discarded;
  }
  return json::parse(text, nullptr, false);
}

json parse_cbor(std::span<const std::byte> bytes) {
  const auto* first = reinterpret_cast<const std::uint8_t*>(bytes.data());
  const auto* last = first + bytes.size();
  if (!is_shallow(first, last, json::input_format_t::cbor)) return json::value_t::discarded;
  return json::from_cbor(first, last, true, false);
}

std::uint64_t count_at(const json& object, const char* key) {
  const json& value = object.at(key);
  if (value.is_number_unsigned()) return value.get<std::uint64_t>();
  throw json::type_error::create(
      302, std::string(key) + " must be a whole number, but is " + value.type_name(), &value);
}

StoreDamaged damaged_payload(const Event& event, const json::exception& problem) {
  return StoreDamaged(fmt::format("event {} ({} of {}): its payload is invalid: {}", event.seq,
                                  event.type, event.stream, problem.what()));
}

json rounded(double value, int significant) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.{}g}", value, significant).c_str(), nullptr);
}

std::string value_text(const json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.is_number_float() ? fmt::format("{}", value.get<double>()) : value.dump();
}

std::string short_text(const json& value) {
  return value.is_number_float() ? fmt::format("{:.6g}", value.get<double>()) : value_text(value);
}

json member_of(const json& object, const char* key) {
  return object.is_object() ? object.value(key, json()) : json();
}

std::string text_at(const json& object, const char* key) {
  const json found = member_of(object, key);
  return found.is_null() ? "unknown" : short_text(found);
}

}  // namespace shearcell
