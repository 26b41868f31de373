// SPDX-License-Identifier: GPL-3.0-or-later
// The error of the analysis for input that it cannot measure.
#pragma once

#include <stdexcept>

namespace shearcell {

/// The message names the grain, figure or file at fault, and the reason.
class AnalysisError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace shearcell
