// SPDX-License-Identifier: GPL-3.0-or-later
// What must hold for any input: RapidCheck draws inputs, and shrinks one that fails to a small one.
//
// Every run draws the same inputs, so that a commit either passes or does not. Others, and more:
//   RC_PARAMS="seed=7 max_success=1000" build/release/tests/core/test_core
// draws from seed 7, and ten times as many, since RapidCheck's own 100 stands for what a property
// asks for.
#pragma once

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace shearcell::test {

/// Tests `property`, which draws its input and asserts by RC_ASSERT, over this many inputs.
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
