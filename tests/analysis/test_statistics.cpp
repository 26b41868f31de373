// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "analysis/statistics.hpp"

namespace shearcell {
namespace {

TEST(OverRuns, MeanAndStandardError) {
  const RunStatistics s = over_runs(std::vector<double>{1, 2, 3, 6});
  EXPECT_EQ(s.runs, 4U);
  EXPECT_DOUBLE_EQ(s.mean.value(), 3);
  EXPECT_DOUBLE_EQ(s.standard_error.value(), std::sqrt(14.0 / 12));
}

TEST(OverRuns, OneRunHasNoError) {
  const RunStatistics s = over_runs(std::vector<double>{0.64});
  EXPECT_EQ(s.mean.value(), 0.64);
  EXPECT_FALSE(s.standard_error.has_value());
}

TEST(OverRuns, NothingMeasured) {
  const RunStatistics s = over_runs(std::vector<double>{std::nan("")});
  EXPECT_EQ(s.runs, 0U);
  EXPECT_FALSE(s.mean.has_value());
}

}  // namespace
}  // namespace shearcell
