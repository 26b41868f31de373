// SPDX-License-Identifier: GPL-3.0-or-later
// Memory of the machine, to refuse a run that needs more before anything is allocated.
#pragma once

#include <unistd.h>

namespace shearcell {

/// Physical memory [bytes].
inline double machine_memory() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace shearcell
