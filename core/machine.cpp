// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/machine.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <thread>

namespace shearcell {
namespace {

/// Returns the smallest limit that is set for the cgroup (version 2) of this process or for a
/// parent of this cgroup. In a container, the topmost parent is the cgroup of the container.
/// read(file) returns the limit in a file, or NaN if the file contains no number.
template <class Read>
double smallest_limit(const char* name, const Read& read) {
  std::filesystem::path group = "/";
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    if (line.starts_with("0::/")) group = line.substr(3);
  }
  double smallest = std::numeric_limits<double>::infinity();
  for (;; group = group.parent_path()) {
    std::ifstream file("/sys/fs/cgroup" / group.relative_path() / name);
    if (const double limit = read(file); limit < smallest) smallest = limit;
    if (!group.has_relative_path()) return smallest;
  }
}

/// Reads a number. Returns NaN for the word "max".
double number_in(std::istream& file) {
  double number = 0;
  return file >> number ? number : std::nan("");
}

/// Limit on the number of cores, as set by `docker run --cpus`: the processor time allowed in each
/// period, divided by the length of the period.
double cores_in(std::istream& file) {
  const double time = number_in(file), period = number_in(file);
  return time / period;
}

}  // namespace

double machine_memory() {
  return std::min(
      smallest_limit("memory.max", number_in),
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE)));
}

std::size_t usable_cores() {
  cpu_set_t set;
  const bool known = sched_getaffinity(0, sizeof set, &set) == 0;  // fails with over 1024 cores
  const auto cores =
      known ? static_cast<unsigned>(CPU_COUNT(&set)) : std::thread::hardware_concurrency();
  return static_cast<std::size_t>(std::clamp(std::ceil(smallest_limit("cpu.max", cores_in)), 1.0,
                                             std::max(1.0, static_cast<double>(cores))));
}

}  // namespace shearcell
