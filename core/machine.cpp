// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/machine.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <thread>

namespace shearcell {
namespace {

/// The limits of a container, in the files of cgroup version 2: "max", or a number.
double limit_in(std::istream& file) {
  double limit = 0;
  return file >> limit ? limit : std::numeric_limits<double>::infinity();
}

double memory_limit() {
  std::ifstream file("/sys/fs/cgroup/memory.max");
  return limit_in(file);
}

/// Time of cores per time: `docker run --cpus`.
double core_limit() {
  std::ifstream file("/sys/fs/cgroup/cpu.max");
  const double time = limit_in(file), period = limit_in(file);
  return time / period >= 0 ? time / period : std::numeric_limits<double>::infinity();
}

}  // namespace

double machine_memory() {
  return std::min(memory_limit(), static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
                                      static_cast<double>(sysconf(_SC_PAGESIZE)));
}

std::size_t usable_cores() {
  cpu_set_t set;
  const bool known = sched_getaffinity(0, sizeof set, &set) == 0;  // fails beyond 1024 cores
  const auto cores =
      known ? static_cast<unsigned>(CPU_COUNT(&set)) : std::thread::hardware_concurrency();
  return static_cast<std::size_t>(
      std::clamp(std::ceil(core_limit()), 1.0, std::max(1.0, static_cast<double>(cores))));
}

}  // namespace shearcell
