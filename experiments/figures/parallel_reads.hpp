// SPDX-License-Identifier: GPL-3.0-or-later
// Work on many checkpoints at once, some of which may be unreadable.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace shearcell {

/// Called after each item that succeeded, by one thread at a time; may be empty.
using ReadProgress = std::function<void(std::size_t done, std::size_t total)>;

/// A message for each checkpoint that is damaged, or whose file was pruned; sorted.
struct UnreadCheckpoints {
  std::vector<std::string> damaged;
  std::vector<std::string> pruned;
};

/// Calls work(0) .. work(count - 1), at most `workers` at once. StoreDamaged and CheckpointPruned
/// become messages; the first other exception ends the work and is rethrown.
UnreadCheckpoints read_in_parallel(std::size_t count, std::size_t workers,
                                   const std::function<void(std::size_t)>& work,
                                   const ReadProgress& progress);

}  // namespace shearcell
