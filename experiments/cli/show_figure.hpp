// SPDX-License-Identifier: GPL-3.0-or-later
// The part of `show` for figures and their files.
#pragma once

#include <filesystem>

#include "experiments/cli/command.hpp"

namespace shearcell::cli {

/// What a figure came from, within 80 columns or as JSON.
void show_figure(const Store& store, const FigureRecord& record, Context& context);

/// Whether a file is what the store recorded, and whether its inputs still are; then the same as
/// show_figure. The exit code is kStoreDamaged when one of them is not. Throws NotFound for a file
/// that the store does not know.
void show_published(const Store& store, const std::filesystem::path& file, Context& context);

}  // namespace shearcell::cli
