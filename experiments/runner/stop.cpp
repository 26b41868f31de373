// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/stop.hpp"

#include <atomic>
#include <csignal>

namespace shearcell {
namespace {

std::atomic<bool> stop_wish{false};
static_assert(std::atomic<bool>::is_always_lock_free, "signal handlers need a lock-free flag");

extern "C" void on_stop_signal(int number) {
  stop_wish.store(true);
  std::signal(number, SIG_DFL);
}

extern "C" void on_batch_signal(int) {
  stop_wish.store(true);
}

}  // namespace

void catch_stop_signals() {
  std::signal(SIGINT, on_stop_signal);
  std::signal(SIGTERM, on_stop_signal);
  if (std::signal(SIGHUP, on_stop_signal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

void catch_batch_signals() {
  std::signal(SIGPIPE, SIG_IGN);
  for (const int number : {SIGINT, SIGTERM, SIGUSR1}) std::signal(number, on_batch_signal);
}

bool stop_requested() {
  return stop_wish.load();
}

void give_up_if_requested() {
  if (stop_requested()) throw Interrupted();
}

void request_stop(bool stop) {
  stop_wish.store(stop);
}

}  // namespace shearcell
