// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/expression.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <muParser.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

namespace shearcell {
namespace {

constexpr std::size_t longest_expression = 200;  // [bytes]

constexpr std::array<std::string_view, 13> expression_functions = {
    "abs", "acos", "asin", "atan", "cos", "exp", "ln", "log10", "max", "min", "sin", "sqrt", "tan"};

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool begins_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

bool continues_name(char c) {
  return begins_name(c) || is_digit(c);
}

/// Removes a number, name or single character from the beginning of the text.
std::string_view take_token(std::string_view& text) {
  std::size_t end = 1;
  const auto skip = [&](auto passes) {
    while (end < text.size() && passes(text[end])) ++end;
  };
  if (begins_name(text[0])) {
    skip(continues_name);
  } else if (is_digit(text[0]) || text[0] == '.') {
    skip([](char c) { return is_digit(c) || c == '.'; });
    if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
      const bool sign = end + 1 < text.size() && (text[end + 1] == '-' || text[end + 1] == '+');
      end += sign ? 2 : 1;
      skip(is_digit);
    }
  }
  const std::string_view token = text.substr(0, end);
  text.remove_prefix(end);
  return token;
}

/// A parser that knows the names, and pi.
struct Parser {
  mu::Parser parser;
  std::vector<std::string> names;
  std::vector<double> values;

  explicit Parser(const std::string& text) : names(names_in(text)), values(names.size(), 1) {
    parser.DefineConst("pi", std::numbers::pi);
    for (std::size_t k = 0; k < names.size(); ++k) parser.DefineVar(names[k], &values[k]);
    parser.SetExpr(text);
  }
};

}  // namespace

bool is_expression(std::string_view text) {
  return text.find_first_of("+-*/^()") != text.npos || (!text.empty() && is_digit(text[0]));
}

std::vector<std::string> names_in(std::string_view text) {
  std::vector<std::string> names;
  while (!text.empty()) {
    const std::string name(take_token(text));
    if (!begins_name(name[0]) || name == "pi" || std::ranges::count(names, name) > 0) continue;
    const std::size_t next = text.find_first_not_of(' ');
    if (next == text.npos || text[next] != '(') names.push_back(name);
  }
  return names;
}

std::string expression_syntax() {
  return fmt::format(
      "An expression takes numbers, names, + - * / ^ ( ), pi, and the functions {} and {}.",
      fmt::join(expression_functions.begin(), expression_functions.end() - 1, ", "),
      expression_functions.back());
}

std::string wrong_in_expression(const std::string& text) {
  if (text.size() > longest_expression)
    return fmt::format("is longer than {} bytes", longest_expression);
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view token = take_token(rest);
    if (is_digit(token[0]) || token[0] == '.') continue;
    if (!begins_name(token[0])) {
      if (std::string_view("+-*/^(), ").find(token[0]) != std::string_view::npos) continue;
      return "is neither a name nor an expression";
    }
    const std::size_t next = rest.find_first_not_of(' ');
    if (next == rest.npos || rest[next] != '(') continue;
    if (std::ranges::find(expression_functions, token) == expression_functions.end()) {
      return fmt::format("uses the unknown function {}", token);
    }
  }
  try {
    Parser checked(text);
    checked.parser.Eval();
    if (checked.parser.GetNumResults() > 1) return "is not an expression: it gives several numbers";
  } catch (const mu::ParserError& error) {
    return fmt::format("is not an expression: {}", error.GetMsg());
  }
  return "";
}

Evaluate evaluator_of(const std::string& text) {
  return [parser = std::make_shared<Parser>(text)](const ValueOf& value_of) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t k = 0; k < parser->names.size(); ++k) {
      parser->values[k] = value_of(parser->names[k]);
      if (!std::isfinite(parser->values[k])) return none;
    }
    const double value = parser->parser.Eval();
    return std::isfinite(value) ? value : none;
  };
}

}  // namespace shearcell
