// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/team.hpp"

#include "core/machine.hpp"
#include "core/threads.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace shearcell {
namespace {

// All threads finish a step within microseconds of each other, so a waiting thread spins for a
// short time before it sleeps. With fewer cores than threads the spin is shorter, because another
// thread may need the core.
constexpr int kSpins = 1000, kSpinsWithFewCores = 100;

void relax() {
#if defined(__x86_64__)
  _mm_pause();
#endif
}

// Waits until `number` differs from `seen`.
void wait_for_change(const std::atomic<std::uint32_t>& number, std::uint32_t seen, int spins) {
  while (number.load(std::memory_order_acquire) == seen) {
    if (spins-- > 0) {
      relax();
    } else {
      number.wait(seen, std::memory_order_acquire);
    }
  }
}

}  // namespace

Team::Team(std::size_t threads)
    : spins_(threads <= usable_cores() ? kSpins : kSpinsWithFewCores),
      workers_(start_threads(threads, [this](std::size_t k) { work_until_stopped(k); })) {
  most_.resize(size());
}

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
  while (true) {
    const std::uint32_t done = done_.load(std::memory_order_acquire);
    if (done == all) return;
    wait_for_change(done_, done, spins_);
  }
}

void Team::work_until_stopped(std::size_t thread) {
  for (std::uint32_t seen = 0;; ++seen) {
    wait_for_change(round_, seen, spins_);
    if (stop_) return;
    run_part(thread);
    const bool last = done_.fetch_add(1, std::memory_order_release) + 1 == workers_.size();
    if (last) done_.notify_one();
  }
}

}  // namespace shearcell
