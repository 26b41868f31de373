// SPDX-License-Identifier: GPL-3.0-or-later
// Starts threads, up to the limit of the system.
#pragma once

#include <cstddef>
#include <system_error>
#include <thread>
#include <vector>

namespace shearcell {

/// Starts (`workers` - 1) threads. Thread k = 1, 2, ... calls work(k); the caller must call
/// work(0). If the system reaches a limit, fewer threads are started, so no result may depend on
/// the number of threads. `work` must not throw. The destructor of the returned vector joins the
/// threads.
template <class Work>
std::vector<std::jthread> start_threads(std::size_t workers, const Work& work) {
  std::vector<std::jthread> threads;
  threads.reserve(workers);
  try {
    while (threads.size() + 1 < workers) threads.emplace_back(work, threads.size() + 1);
  } catch (const std::system_error&) {
    // Continue with the threads that were started.
  }
  return threads;
}

}  // namespace shearcell
