// SPDX-License-Identifier: GPL-3.0-or-later
// Calls a function periodically in the background.
#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

namespace shearcell {

/// Calls `action` in a separate thread after every interval, until this object is destroyed. If
/// `action` throws, calls `failed`, and tries again after the next interval.
class Repeated {
 public:
  Repeated(std::chrono::duration<double> interval, std::function<void()> action,
           std::function<void(const std::exception&)> failed)
      : thread_([this, interval, action = std::move(action),
                 failed = std::move(failed)](const std::stop_token& stop) {
          std::unique_lock lock(mutex_);
          while (!wake_.wait_for(lock, stop, interval, [&stop] { return stop.stop_requested(); })) {
            try {
              action();
            } catch (const std::exception& problem) {
              failed(problem);
            }
          }
        }) {}

 private:
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;  // last member: ends before the other members are destroyed
};

}  // namespace shearcell
