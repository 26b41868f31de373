// SPDX-License-Identifier: GPL-3.0-or-later
// Arithmetic of named numbers, as plots and claims of a manifest state it: "1/period_s". The text
// is not trusted.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace shearcell {

/// Whether the text is more than a name: it has an operator or a number.
bool is_expression(std::string_view text);

/// The names in an expression, each once, in order. Of a name alone, that name.
std::vector<std::string> names_in(std::string_view text);

/// What an expression may contain, for messages.
std::string expression_syntax();

/// What is wrong with the expression, whatever its names mean, such as "is not an expression:
/// ..."; "" if it can be evaluated. Wrong is anything outside expression_syntax() and a text of
/// more than 200 bytes.
std::string wrong_in_expression(const std::string& text);

/// The value of a name.
using ValueOf = std::function<double(const std::string& name)>;

/// Evaluates a sound expression, also of a name alone. Not a number where the result, or a value
/// that it takes, is not finite. The locale has no effect. One thread at a time may call it.
using Evaluate = std::function<double(const ValueOf& value_of)>;
Evaluate evaluator_of(const std::string& text);

}  // namespace shearcell
