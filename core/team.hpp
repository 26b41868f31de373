// SPDX-License-Identifier: GPL-3.0-or-later
// Threads that share the loops of one simulation.
//
// Properties: (1) each thread computes one contiguous range of a loop's items; (2) no result
// depends on the ranges, so the bits do not depend on the number of threads; (3) `run` returns when
// all ranges are done, and everything written in them is visible to the caller.
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
  /// `threads` includes the thread of the caller, so 1 starts none. The team is smaller if the
  /// system refuses to start this many threads.
  explicit Team(std::size_t threads);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  std::size_t size() const { return workers_.size() + 1; }

  /// Calls work(thread, first, last) once on each thread with its part of [0, count). `work` must
  /// not throw.
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

  /// Returns the largest result of work(first, last) over the parts of [0, count).
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
  int spins_;  // before a thread that waits goes to sleep
  // Number of the current round, and of the workers that have done it.
  alignas(64) std::atomic<std::uint32_t> round_{0};
  alignas(64) std::atomic<std::uint32_t> done_{0};
  std::vector<double> most_;           // of each thread, in largest()
  std::vector<std::jthread> workers_;  // last: they use the other members
};

}  // namespace shearcell
