// SPDX-License-Identifier: GPL-3.0-or-later
// Threads, as many as the system lends.
#pragma once

#include <cstddef>
#include <system_error>
#include <thread>
#include <vector>

namespace shearcell {

/// Starts `count` threads, of which the k-th, from 0, calls work(k); fewer, or none, where a limit
/// of the system is reached: the caller does a part itself, and no result depends on how many there
/// are. `work` must not throw. The threads are joined when the list goes.
template <class Work>
std::vector<std::jthread> start_threads(std::size_t count, const Work& work) {
  std::vector<std::jthread> threads;
  threads.reserve(count);
  try {
    while (threads.size() < count) threads.emplace_back(work, threads.size());
  } catch (const std::system_error&) {
    // Those that were lent do it.
  }
  return threads;
}

}  // namespace shearcell
