// SPDX-License-Identifier: GPL-3.0-or-later
// The memory and the cores that this process may use. A run that needs more memory is refused
// before anything is allocated.
#pragma once

#include <cstddef>

namespace shearcell {

/// Memory [bytes] of the machine, or the limit of this process's container or batch job.
double machine_memory();

/// Cores of the machine, or fewer under taskset, in a batch job or in a container.
std::size_t usable_cores();

}  // namespace shearcell
