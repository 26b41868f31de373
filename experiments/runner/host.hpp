// SPDX-License-Identifier: GPL-3.0-or-later
// Host and build of a computation. Recorded with every attempt; not part of any id.
#pragma once

#include <nlohmann/json.hpp>

namespace shearcell {

/// {host, system, cpu, cores, simd, build{version, commit, compiler, flags, type}, libraries{}}.
nlohmann::json host_facts();

}  // namespace shearcell
