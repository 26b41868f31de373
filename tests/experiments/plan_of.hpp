// SPDX-License-Identifier: GPL-3.0-or-later
// Short manifests for tests.
#pragma once

#include <functional>
#include <string>

#include "experiments/manifest/expand.hpp"

namespace shearcell::test {

/// Of a manifest with this `base` on line 2 and `rest` below.
inline Plan plan_of(const std::string& base, const std::string& rest = "",
                    const ExpandOptions& options = {}) {
  return expand(parse_manifest("experiment: a\nbase: {" + base + "}\n" + rest, "test.yaml"),
                options);
}

/// The message of the ManifestError that it throws; "" when it throws none.
inline std::string manifest_error(const std::function<void()>& read) {
  try {
    read();
  } catch (const ManifestError& error) {
    return error.what();
  }
  return "";
}

}  // namespace shearcell::test
