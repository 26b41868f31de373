// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/team.hpp"

#include "core/threads.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace shearcell {
namespace {

// A step of a large cell takes about 100 us and its parts end within a few of each other: spinning
// for that time costs less than sleeping. During longer gaps (a checkpoint) the workers sleep.
constexpr int kSpins = 4000;

void relax() {
#if defined(__x86_64__)
  _mm_pause();
#endif
}

}  // namespace

Team::Team(std::size_t threads)
    : workers_(start_threads(threads, [this](std::size_t k) { work_until_stopped(k); })) {}

Team::~Team() {
  stop_ = true;
  start_workers();
  for (std::jthread& worker : workers_) worker.join();
}

void Team::run_part(std::size_t thread) {
  const std::size_t threads = size();
  call_(argument_, thread, count_ * thread / threads, count_ * (thread + 1) / threads);
}

void Team::start_workers() {
  done_.store(0, std::memory_order_relaxed);
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
}

void Team::wait_for_workers() {
  const auto all = static_cast<std::uint32_t>(workers_.size());
  for (int spin = 0;; ++spin) {
    const std::uint32_t done = done_.load(std::memory_order_acquire);
    if (done == all) return;
    if (spin < kSpins) {
      relax();
    } else {
      done_.wait(done, std::memory_order_acquire);
    }
  }
}

void Team::work_until_stopped(std::size_t thread) {
  std::uint32_t seen = 0;
  for (;;) {
    for (int spin = 0; round_.load(std::memory_order_acquire) == seen; ++spin) {
      if (spin < kSpins) {
        relax();
      } else {
        round_.wait(seen, std::memory_order_acquire);
      }
    }
    ++seen;
    if (stop_) return;
    run_part(thread);
    done_.fetch_add(1, std::memory_order_release);
    done_.notify_one();
  }
}

}  // namespace shearcell
