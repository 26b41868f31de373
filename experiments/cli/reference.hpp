// SPDX-License-Identifier: GPL-3.0-or-later
// The reference of manifest keys, measures, figures and commands, from the program's own tables.
#pragma once

#include <string>
#include <vector>

#include "experiments/cli/command_tree.hpp"

namespace shearcell::cli {

/// Markdown; experiments/REFERENCE.md holds it (test docs.reference). `tree` is that of
/// command_tree().
std::string reference_markdown(const std::vector<CommandEntry>& tree);

}  // namespace shearcell::cli
