// SPDX-License-Identifier: GPL-3.0-or-later
// Calls a function periodically in the background.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

namespace shearcell {

/// Calls `action`, which must not throw, at every interval in its own thread, until it is
/// destroyed.
class Repeated {
 public:
  Repeated(std::chrono::duration<double> interval, std::function<void()> action)
      : thread_([this, interval, action = std::move(action)](const std::stop_token& stop) {
          std::unique_lock lock(mutex_);
          while (!wake_.wait_for(lock, stop, interval, [&stop] { return stop.stop_requested(); })) {
            action();
          }
        }) {}

 private:
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;  // last: it ends before the members that it uses are destroyed
};

}  // namespace shearcell
