// SPDX-License-Identifier: GPL-3.0-or-later
// Which lines of a manifest define a run, and which values the command line replaced.
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
  std::string text;  ///< the line, without surrounding blanks, fit for a message
};

/// Where a manifest states its experiment, the scale, the value of each swept key in `labels`, and
/// the seeds that the scale uses. Empty when the text is not a manifest that this program reads.
std::vector<ManifestLine> manifest_lines(std::string_view text, std::string_view scale,
                                         const nlohmann::json& labels);

/// How a run of the manifest that shears differs from what its text asks for, since the command
/// line gave --cycles, --seeds or --engine: {"cycles", "seed" or "engine": {"run", "manifest"}}, of
/// "seed" with the list of the manifest's seeds. Null where nothing differs, or like
/// manifest_lines().
nlohmann::json overrides(std::string_view text, const Membership& membership);

}  // namespace shearcell
