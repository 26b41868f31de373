// SPDX-License-Identifier: GPL-3.0-or-later
// The tables that events give, derived in memory from a log that may be damaged or forged.
#pragma once

#include <string>

#include "provenance/event_log.hpp"
#include "provenance/sqlite.hpp"

namespace shearcell {

/// Empty tables in memory; errors name them `name`.
sqlite::Database empty_projections(const std::string& name);

/// Applies one event and checks the digest of a manifest. Returns why the event cannot be applied,
/// or "".
std::string try_apply(sqlite::Database& tables, const Event& event);

}  // namespace shearcell
