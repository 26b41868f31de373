// SPDX-License-Identifier: GPL-3.0-or-later
// What the machine has: memory, to refuse a run that needs more before anything is allocated, and
// cores.
#pragma once

#include <sched.h>
#include <unistd.h>

#include <cstddef>

namespace shearcell {

/// Physical memory [bytes].
inline double machine_memory() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// Cores that this process may use; fewer than the machine's under taskset, a batch system or in a
/// container.
inline std::size_t usable_cores() {
  cpu_set_t set;
  const bool known = sched_getaffinity(0, sizeof set, &set) == 0;
  return known ? static_cast<std::size_t>(CPU_COUNT(&set)) : 1;
}

}  // namespace shearcell
