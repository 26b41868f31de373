// SPDX-License-Identifier: GPL-3.0-or-later
// Short manifests for tests.
#pragma once

#include <string>

#include "experiments/manifest/expand.hpp"

namespace shearcell::test {

/// The plan of a manifest with this `base` on line 2 and `rest` below.
inline Plan plan_of(const std::string& base, const std::string& rest = "",
                    const ExpandOptions& options = {}) {
  return expand(parse_manifest("experiment: a\nbase: {" + base + "}\n" + rest, "test.yaml"),
                options);
}

}  // namespace shearcell::test
