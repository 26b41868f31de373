// SPDX-License-Identifier: GPL-3.0-or-later
// Asked before something large is allocated, so that a wrong number ends in a message and not in
// the machine's hunt for memory.
#pragma once

#include <unistd.h>

namespace shearcell {

/// Of the whole machine [bytes].
inline double machine_memory() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace shearcell
