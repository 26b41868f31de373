// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

namespace shearcell::test {

/// Whether the text has the part; a failed expectation prints both.
inline ::testing::AssertionResult has(std::string_view text, std::string_view part) {
  const bool found = text.find(part) != std::string_view::npos;
  return (found ? ::testing::AssertionSuccess() : ::testing::AssertionFailure())
         << "'" << part << (found ? "' is in:\n" : "' is not in:\n") << text.substr(0, 5000);
}

/// The text as an SQL string literal.
inline std::string sql_text(std::string_view text) {
  std::string quoted = "'";
  for (const char c : text) quoted.append(c == '\'' ? 2 : 1, c);
  return quoted + "'";
}

/// The message of the exception that the statement throws; "" if it throws none.
template <typename Exception, typename Statement>
std::string message_of(Statement&& statement) {
  try {
    statement();
  } catch (const Exception& e) {
    return e.what();
  }
  return "";
}

/// The statement throws an exception whose message holds each of the parts.
template <typename Exception, typename Statement>
void expect_refused(Statement&& statement, const std::vector<std::string>& parts) {
  const std::string message = message_of<Exception>(statement);
  EXPECT_NE(message, "") << "the expected exception was not thrown";
  for (const std::string& part : parts) EXPECT_TRUE(has(message, part));
}

}  // namespace shearcell::test
