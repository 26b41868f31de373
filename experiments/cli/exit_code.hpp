// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <exception>

namespace shearcell::cli {

enum ExitCode : int {
  kDone = 0,
  kOtherError = 1,  ///< the machine failed: disk full, store locked, out of memory
  kUsageError = 2,  ///< usage or manifest
  kRunFailed = 3,   ///< a run failed numerically
  kStoreDamaged = 4,
  kInterrupted = 85,  ///< resumable
};

/// The exit code of a program that ends with this error.
ExitCode exit_code_of(const std::exception& error);

}  // namespace shearcell::cli
