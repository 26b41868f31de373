// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the lines of a manifest that define a run, and the values that the command line replaced.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "provenance/records.hpp"

namespace shearcell {

struct ManifestLine {
  std::string key;   ///< "experiment", "scales.desk", "sweep.grid.fluid", "seeds"
  int line = 0;      ///< counted from 1
  std::string text;  ///< the line, without surrounding blanks, safe to print
  NLOHMANN_DEFINE_TYPE_INTRUSIVE(ManifestLine, key, line, text)
};

/// The lines that define a run and its figure: experiment, scale, the value of each key in `swept`,
/// cycles, `settle`, seeds, `checkpoints`, `until`, the label of the variant, and the plots and
/// claims of `figure`. Empty if this program cannot read the manifest.
std::vector<ManifestLine> manifest_lines(std::string_view text, std::string_view scale,
                                         const nlohmann::json& swept, std::string_view figure);

/// How a shear run differs from its manifest because of --cycles, --seeds or --engine. The
/// object has a key "cycles", "seed" or "engine" for each of these that differs, with the value
/// {"run": VALUE, "manifest": VALUE}. Under "seed", the VALUE of the manifest is the list of its
/// seeds. Returns null if nothing differs or the manifest cannot be read.
nlohmann::json overrides(std::string_view text, const Place& place, const Ask& ask);

}  // namespace shearcell
