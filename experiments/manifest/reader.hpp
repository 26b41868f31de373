// SPDX-License-Identifier: GPL-3.0-or-later
// From the tree of a YAML document to a Manifest: every key known, every value of its type and in
// its range.
#pragma once

#include <string_view>

#include "experiments/manifest/document.hpp"
#include "experiments/manifest/manifest.hpp"

namespace shearcell {

/// Throws ManifestError with everything that is wrong. `Manifest::text` is left empty.
Manifest read_manifest(const Node& root, std::string_view file);

}  // namespace shearcell
