// SPDX-License-Identifier: GPL-3.0-or-later
// What this process may use of the machine: memory, to refuse a run that needs more before anything
// is allocated, and cores.
#pragma once

#include <cstddef>

namespace shearcell {

/// Memory that this process may use [bytes]: the machine's, or the limit of its container or batch
/// job.
double machine_memory();

/// Cores that this process may use; fewer than the machine's under taskset, a batch system or in a
/// container.
std::size_t usable_cores();

}  // namespace shearcell
