// SPDX-License-Identifier: GPL-3.0-or-later
// What the machine has: memory, to refuse a run that needs more before anything is allocated, and
// cores.
#pragma once

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <thread>

namespace shearcell {

/// Physical memory [bytes].
inline double machine_memory() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// Cores that this process may use; fewer than the machine's under taskset, a batch system or in a
/// container.
inline std::size_t usable_cores() {
  cpu_set_t set;
  const bool known = sched_getaffinity(0, sizeof set, &set) == 0;  // fails beyond 1024 cores
  const auto cores =
      known ? static_cast<unsigned>(CPU_COUNT(&set)) : std::thread::hardware_concurrency();
  return std::max(1U, cores);
}

}  // namespace shearcell
