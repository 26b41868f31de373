// SPDX-License-Identifier: GPL-3.0-or-later
// Elapsed wall-clock time.
#pragma once

#include <chrono>

namespace shearcell {

/// Measures the time since it was made or restarted, with the steady clock.
class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  void restart() { start_ = std::chrono::steady_clock::now(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace shearcell
