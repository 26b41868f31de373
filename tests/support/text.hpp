// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace shearcell::test {

/// Whether the text has the part; a failed expectation prints both.
inline testing::AssertionResult has(std::string_view text, std::string_view part) {
  const bool found = text.find(part) != std::string_view::npos;
  return (found ? testing::AssertionSuccess() : testing::AssertionFailure())
         << "'" << part << (found ? "' is in:\n" : "' is not in:\n") << text;
}

}  // namespace shearcell::test
