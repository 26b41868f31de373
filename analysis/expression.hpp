// SPDX-License-Identifier: GPL-3.0-or-later
// Arithmetic expressions of named numbers, such as "1/period_s" in the plots and claims of a
// manifest. The text of an expression is not trusted.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace shearcell {

/// Whether the text has an operator or a bracket, or begins with a digit. Otherwise it is a name.
bool is_expression(std::string_view text);

/// The names in the text except functions and pi, each once, in the order in which they appear.
std::vector<std::string> names_in(std::string_view text);

/// Describes for error messages what an expression may contain.
std::string expression_syntax();

/// Returns why the text cannot be evaluated, such as "is not an expression: ..."; "" if it can be
/// evaluated. The text must follow expression_syntax() and have at most 200 bytes. Whether the
/// names exist is not checked.
std::string wrong_in_expression(const std::string& text);

using ValueOf = std::function<double(const std::string& name)>;

/// Computes the value of a name or an expression. Returns NaN if the computed value, or the value
/// of a name in the expression, is not finite. The locale has no effect. Only one thread at a time
/// may call an evaluator.
using Evaluate = std::function<double(const ValueOf& value_of)>;
/// Makes the evaluator of an expression. wrong_in_expression(text) must return "".
Evaluate evaluator_of(const std::string& text);

}  // namespace shearcell
