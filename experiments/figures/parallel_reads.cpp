// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/parallel_reads.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>

#include "core/threads.hpp"
#include "provenance/errors.hpp"

namespace shearcell {

UnreadCheckpoints read_in_parallel(std::size_t count, std::size_t workers,
                                   const std::function<void(std::size_t)>& work,
                                   const ReadProgress& progress) {
  UnreadCheckpoints unread;
  std::exception_ptr error;
  std::size_t done = 0;
  std::mutex mutex;  // guards the three above
  std::atomic<std::size_t> next{0};
  const auto work_on_some = [&](std::size_t) {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i);
        const std::lock_guard lock(mutex);
        ++done;
        if (progress) progress(done, count);
      } catch (const StoreDamaged& damage) {
        const std::lock_guard lock(mutex);
        unread.damaged.emplace_back(damage.what());
      } catch (const CheckpointPruned& pruned) {
        const std::lock_guard lock(mutex);
        unread.pruned.emplace_back(pruned.what());
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!error) error = std::current_exception();
        next = count;
      }
    }
  };
  {
    const auto threads = start_threads(std::min(workers, count), work_on_some);
    work_on_some(0);
  }
  if (error) std::rethrow_exception(error);
  std::sort(unread.damaged.begin(), unread.damaged.end());
  std::sort(unread.pruned.begin(), unread.pruned.end());
  return unread;
}

}  // namespace shearcell
