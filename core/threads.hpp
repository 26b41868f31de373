// SPDX-License-Identifier: GPL-3.0-or-later
// Starting as many threads as the system allows.
#pragma once

#include <cstddef>
#include <system_error>
#include <thread>
#include <vector>

namespace shearcell {

/// Starts up to workers - 1 threads. Thread k, counted from 1, calls work(k); the caller does part
/// 0 itself. Fewer threads are started if a limit of the system is reached, so no result may depend
/// on their number. `work` must not throw. The threads are joined when the list is destroyed.
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
