// SPDX-License-Identifier: GPL-3.0-or-later
// The lineage of a run as PROV-JSON (W3C Member Submission of 24 April 2013).
#pragma once

#include <nlohmann/json.hpp>

#include "provenance/ro_crate.hpp"

namespace shearcell {

/// Checkpoints, manifests and parameters are entities, attempts activities, builds of the program
/// agents. Of a checkpoint that several attempts recorded, the last one generated it: in PROV an
/// entity comes into being once.
nlohmann::json prov_json(const CrateFacts& facts);

}  // namespace shearcell
