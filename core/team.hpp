// SPDX-License-Identifier: GPL-3.0-or-later
// Threads that share the loops of one simulation.
//
// Each thread computes one contiguous range of a loop. No result depends on these ranges, so the
// bits do not depend on the number of threads. `run` returns when all threads have finished. The
// caller then sees everything that the threads have written.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <type_traits>
#include <vector>

namespace shearcell {

class Team {
 public:
  /// `threads` includes the calling thread, so Team(1) starts no thread. The team is smaller if the
  /// system cannot start all threads.
  explicit Team(std::size_t threads);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  std::size_t size() const { return workers_.size() + 1; }

  /// Divides [0, count) among the threads. Each thread calls work(thread, first, last) once for its
  /// range. `work` must not throw.
  template <class Work>
  void run(std::size_t count, Work&& work) {
    if (workers_.empty()) {
      work(std::size_t{0}, std::size_t{0}, count);
      return;
    }
    call_ = [](void* w, std::size_t thread, std::size_t first, std::size_t last) {
      (*static_cast<std::remove_reference_t<Work>*>(w))(thread, first, last);
    };
    argument_ = &work;
    count_ = count;
    start_workers();
    run_part(0);
    wait_for_workers();
  }

  /// Divides [0, count) among the threads, which call work(first, last). Returns the largest
  /// result.
  template <class Work>
  double largest(std::size_t count, Work&& work) {
    run(count, [&](std::size_t thread, std::size_t first, std::size_t last) {
      most_[thread] = work(first, last);
    });
    return *std::max_element(most_.begin(), most_.end());
  }

 private:
  void start_workers();
  void wait_for_workers();
  void run_part(std::size_t thread);
  void work_until_stopped(std::size_t thread);

  void (*call_)(void*, std::size_t, std::size_t, std::size_t) = nullptr;
  void* argument_ = nullptr;
  std::size_t count_ = 0;
  bool stop_ = false;
  int spins_;  // number of spins before a waiting thread sleeps
  // Number of the current round, and number of workers that have finished this round.
  alignas(64) std::atomic<std::uint32_t> round_{0};
  alignas(64) std::atomic<std::uint32_t> done_{0};
  std::vector<double> most_;           // result of each thread in largest()
  std::vector<std::jthread> workers_;  // declared last, because the threads use the members above
};

}  // namespace shearcell
