// SPDX-License-Identifier: GPL-3.0-or-later
// The time of day, and elapsed time.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <string>

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

/// A time [ms since 1970] as ISO 8601 with milliseconds, UTC: "2026-11-22T09:55:45.123Z".
inline std::string utc_text(std::int64_t ms) {
  const std::int64_t within = (ms % 1000 + 1000) % 1000;  // also before 1970
  const auto seconds = static_cast<std::time_t>((ms - within) / 1000);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  const std::size_t length = std::strftime(text, sizeof text, "%FT%T", &utc);
  std::snprintf(text + length, sizeof text - length, ".%03uZ", static_cast<unsigned>(within));
  return text;
}

}  // namespace shearcell
