// SPDX-License-Identifier: GPL-3.0-or-later
// Speed against error: what `bench accuracy` measures, as tables with a figure each.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "analysis/figure.hpp"

namespace shearcell::accuracy {

struct Options {
  bool quick = false;    ///< seconds instead of minutes: fewer of everything, the same tables
  std::size_t jobs = 1;  ///< runs computed at once, where a section has many
  std::function<void(const std::string&)> report;  ///< what is being done now; may be empty
};

/// One table, the figure it makes, the same in short for people, and what follows from it.
struct Section {
  std::string title;
  FigureTable table;  ///< without a plot where there is nothing to draw
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> summary;
  std::vector<std::string> findings;
};

/// All sections, Table I's grains throughout. Times are of this machine and this moment; everything
/// else is the same everywhere but for the last digits.
std::vector<Section> measure_accuracy(const Options& options);

/// The sections one by one. The engine's rate is in million particle-steps/s with one thread, in
/// the sheared cell of 600 grains.
std::vector<Section> small_scene_sections(const Options& options, double engine_rate);
Section dispersion_section(const Options& options);
Section drift_section(const Options& options);
Section separation_section(const Options& options);
Section seeds_section(const Options& options, double engine_rate);
Section softness_section(const Options& options, double engine_rate);
Section order_section(const Options& options);

}  // namespace shearcell::accuracy
