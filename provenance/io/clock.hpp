// SPDX-License-Identifier: GPL-3.0-or-later
// The time of day, and elapsed time.
#pragma once

#include <chrono>
#include <cstdint>

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

/// Milliseconds since 1970, UTC.
inline std::uint64_t now_ms() {
  using namespace std::chrono;
  return static_cast<std::uint64_t>(
      duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count());
}

}  // namespace shearcell
