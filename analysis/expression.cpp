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
#include <regex>

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

/// Splits a text into numbers, names and, for the rest, single characters. Spaces are dropped. A
/// text that is too long is truncated, because std::regex recurses for each character.
std::vector<std::string> tokens_of(std::string_view text) {
  text = text.substr(0, longest_expression + 1);
  static const std::regex token("[0-9.][0-9.]*(?:[eE][-+]?[0-9]*)?|[A-Za-z_][A-Za-z_0-9]*|[^ ]");
  return {std::cregex_token_iterator(text.data(), text.data() + text.size(), token), {}};
}

/// Whether token k is the name of a function: a bracket follows it.
bool is_called(const std::vector<std::string>& tokens, std::size_t k) {
  return k + 1 < tokens.size() && tokens[k + 1] == "(";
}

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
  const std::vector<std::string> tokens = tokens_of(text);
  for (std::size_t k = 0; k < tokens.size(); ++k) {
    const bool is_name = begins_name(tokens[k][0]) && tokens[k] != "pi" && !is_called(tokens, k);
    if (is_name && std::ranges::count(names, tokens[k]) == 0) names.push_back(tokens[k]);
  }
  return names;
}

std::string expression_syntax() {
  return fmt::format(
      "An expression may contain numbers, names, + - * / ^ ( ), pi, and the functions {} and {}.",
      fmt::join(expression_functions.begin(), expression_functions.end() - 1, ", "),
      expression_functions.back());
}

std::string wrong_in_expression(const std::string& text) {
  if (text.size() > longest_expression)
    return fmt::format("is longer than {} bytes", longest_expression);
  const std::vector<std::string> tokens = tokens_of(text);
  for (std::size_t k = 0; k < tokens.size(); ++k) {
    const std::string& token = tokens[k];
    if (is_digit(token[0]) || token[0] == '.') continue;
    if (!begins_name(token[0])) {
      if (std::string_view("+-*/^(),").find(token[0]) != std::string_view::npos) continue;
      return "is neither a name nor an expression";
    }
    if (is_called(tokens, k) && std::ranges::count(expression_functions, token) == 0) {
      return fmt::format("uses the unknown function {}", token);
    }
  }
  try {
    Parser checked(text);
    checked.parser.Eval();
    if (checked.parser.GetNumResults() > 1)
      return "gives several numbers, but an expression must give one number";
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
