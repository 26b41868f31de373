// SPDX-License-Identifier: GPL-3.0-or-later
// Threads, as many as the system lends.
#pragma once

#include <cstddef>
#include <system_error>
#include <thread>
#include <vector>

namespace shearcell {

/// Starts threads beside the calling one, so that `workers` are at work in all: the k-th, from 1,
/// calls work(k), and the caller does a part itself. Fewer, or none, where a limit of the system is
/// reached; no result depends on how many there are. `work` must not throw. The threads are joined
/// when the list goes.
template <class Work>
std::vector<std::jthread> start_threads(std::size_t workers, const Work& work) {
  std::vector<std::jthread> threads;
  threads.reserve(workers);
  try {
    while (threads.size() + 1 < workers) threads.emplace_back(work, threads.size() + 1);
  } catch (const std::system_error&) {
    // Those that were lent do it.
  }
  return threads;
}

}  // namespace shearcell
