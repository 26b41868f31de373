// SPDX-License-Identifier: GPL-3.0-or-later
// Properties: RapidCheck draws inputs and shrinks one that fails to a small one.
//
// Every run draws the same inputs. For others, and ten times as many:
//   RC_PARAMS="seed=7 max_success=1000" build/release/tests/core/test_core
// A max_success of 100, RapidCheck's default, is the number that the property states.
#pragma once

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace shearcell::test {

/// Tests `property`, which draws its input and uses RC_ASSERT, with this many inputs.
inline void check_property(int cases, void (*property)()) {
  setenv("RC_PARAMS", "seed=2020", 0);  // NOLINT(concurrency-mt-unsafe): before any thread
  const ::testing::TestInfo& test = *::testing::UnitTest::GetInstance()->current_test_info();
  rc::detail::TestMetadata metadata;
  metadata.id = metadata.description = std::string(test.test_suite_name()) + "." + test.name();
  rc::detail::TestParams params = rc::detail::configuration().testParams;
  params.maxSuccess = std::max(1, cases * params.maxSuccess / 100);
  const auto result = rc::detail::checkTestable(property, metadata, params);
  if (result.is<rc::detail::SuccessResult>()) return;
  std::ostringstream message;
  rc::detail::printResultMessage(result, message);
  FAIL() << message.str() << "\nAgain: RC_PARAMS=\"seed=" << params.seed << "\"";
}

}  // namespace shearcell::test

/// A test whose body is a property: PROPERTY(Suite, Name, cases) { ... }
#define PROPERTY(suite, name, cases)                                      \
  static void suite##_##name##_property();                                \
  TEST(suite, name) {                                                     \
    ::shearcell::test::check_property(cases, &suite##_##name##_property); \
  }                                                                       \
  static void suite##_##name##_property()
