// SPDX-License-Identifier: GPL-3.0-or-later
// The memory and the cores that this process may use. A run that needs more memory is refused
// before anything is allocated.
#pragma once

#include <cstddef>

namespace shearcell {

/// Memory [bytes] of the machine, or less if a container or batch job limits it.
double machine_memory();

/// Number of cores of the machine, or fewer if taskset, a batch job or a container limits them.
std::size_t usable_cores();

}  // namespace shearcell
