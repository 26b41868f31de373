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

/// Calls `action` in a separate thread after every interval, until this object is destroyed.
/// `action` must not throw.
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
  std::jthread thread_;  // last member: ends before the other members are destroyed
};

}  // namespace shearcell
