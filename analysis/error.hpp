// SPDX-License-Identifier: GPL-3.0-or-later
// The error that analysis throws when its input is not a packing that it can measure.
#pragma once

#include <stdexcept>

namespace shearcell {

/// Says which grain, figure or file is at fault, and why.
class AnalysisError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace shearcell
