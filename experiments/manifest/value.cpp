// SPDX-License-Identifier: GPL-3.0-or-later
// Single values: from text to a typed JSON value, and whether a value may be used.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>

#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/suggest.hpp"

namespace shearcell {
namespace {

using nlohmann::json;
using std::string_view;

struct Real {
  std::optional<double> value;  // none when the text is no number, or too large or small for one
  bool beyond_double = false;
};

Real parse_real(string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (stop != end || text.starts_with('+')) return {};
  if (error == std::errc::result_out_of_range) return {.value = {}, .beyond_double = true};
  if (error != std::errc()) return {};
  return {.value = value};
}

// Something like .inf, -.Inf, .nan, inf or NaN.
bool names_no_number(string_view text) {
  std::string lower;
  for (const char c : text) {
    if (c != '.' && c != '+' && c != '-') lower += static_cast<char>(c | 0x20);
  }
  return lower == "inf" || lower == "infinity" || lower == "nan";
}

std::string takes(const Field& field) {
  return fmt::format("It takes {}.", expected_values(field));
}

std::variant<json, ValueProblem> read_integer(const Field& field, string_view text) {
  std::uint64_t value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  const bool leading_zero = text.size() > 1 && text.front() == '0';
  if (error == std::errc() && stop == end && !leading_zero) return json(value);
  const Real real = parse_real(text);
  const double number = real.value.value_or(0.5);
  if (real.beyond_double || (real.value && (number < field.min || number > field.max))) {
    return ValueProblem{"is out of range", takes(field)};
  }
  if (number == std::floor(number)) {
    return ValueProblem{"is not written as a plain whole number",
                        fmt::format("Write {:.0f}.", number)};
  }
  return ValueProblem{"is not a whole number", takes(field)};
}

}  // namespace

std::string expected_values(const Field& field) {
  if (const auto* member = std::get_if<ChoiceMember>(&field.member)) {
    if (member->names.size() == 1) return fmt::format("{}", member->names.front());
    return fmt::format("one of {}", fmt::join(member->names, ", "));
  }
  if (std::holds_alternative<std::uint64_t Parameters::*>(field.member)) {
    return fmt::format("an integer from {:.0f} to {:.0f}", field.min, field.max);
  }
  return fmt::format("a number {} {:g} and <= {:g}{}", field.min_excluded ? ">" : ">=", field.min,
                     field.max, field.unit == "1" ? "" : fmt::format(" [{}]", field.unit));
}

std::variant<json, ValueProblem> read_value(const Field& field, string_view text, bool quoted) {
  if (std::holds_alternative<ChoiceMember>(field.member)) return json(text);
  if (quoted) return ValueProblem{"is a quoted text where a number belongs", "Remove the quotes."};
  if (names_no_number(text)) return ValueProblem{"is not finite", takes(field)};
  if (std::holds_alternative<std::uint64_t Parameters::*>(field.member)) {
    return read_integer(field, text);
  }
  const Real real = parse_real(text);
  if (real.beyond_double) return ValueProblem{"is out of range", takes(field)};
  if (!real.value) return ValueProblem{"is not a number", takes(field)};
  return json(*real.value);
}

std::optional<ValueProblem> check_value(const Field& field, const json& value) {
  if (const auto* member = std::get_if<ChoiceMember>(&field.member)) {
    if (!value.is_string()) return ValueProblem{"is not a name", takes(field)};
    const auto& name = value.get_ref<const std::string&>();
    for (const string_view known : member->names) {
      if (known == name) return std::nullopt;
    }
    const Suggestion near = suggest_name(name, member->names);
    return ValueProblem{
        near.name.empty() ? "is unknown" : fmt::format("is unknown, the nearest is {}", near.name),
        takes(field)};
  }
  const bool whole = std::holds_alternative<std::uint64_t Parameters::*>(field.member);
  // JSON written by others may hold a real number without a fraction as an integer.
  if (whole ? !value.is_number_integer() : !value.is_number()) {
    return ValueProblem{whole ? "is not a whole number" : "is not a number", takes(field)};
  }
  const double number = value.get<double>();
  if (!std::isfinite(number)) return ValueProblem{"is not finite", takes(field)};
  if (number < field.min || number > field.max || (field.min_excluded && number == field.min)) {
    return ValueProblem{"is out of range", takes(field)};
  }
  return std::nullopt;
}

}  // namespace shearcell
