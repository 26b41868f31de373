// SPDX-License-Identifier: GPL-3.0-or-later
// A figure turns measured runs into tables and verdicts. The same runs give the same bytes.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/chart.hpp"
#include "analysis/frame.hpp"
#include "analysis/verdict.hpp"

namespace shearcell {

/// The panels of a figure in order, and the verdicts on its claims.
struct FigureResult {
  std::vector<Table> tables;
  std::vector<Verdict> verdicts;
};

/// `table`: uses the last checkpoint of each run of all experiments, and only measures that come
/// from the log (ComputedFrom::record). `curves`: uses the runs of one experiment, with one curve
/// for each variant. `groups`: uses the runs of one experiment and averages over variants with
/// equal values of Figure::keys.
enum class FigureForm { table, curves, groups };

/// A figure that is computed in C++, or that consists of the plots and claims of a manifest.
struct Figure {
  std::string name;
  std::string title;
  std::function<FigureResult(const Frame& frame)> make;
  FigureForm form = FigureForm::curves;
  std::vector<std::string> keys = {};    ///< parameters in which the curves differ
  std::vector<std::string> claims = {};  ///< ids of the figure's claims, without '@...'
  /// Names of the providers (measures.hpp) that the figure needs besides scalars_provider.
  std::vector<std::string> needs = {};
  /// First and last cycle that the figure uses. It uses all checkpoints within these cycles. If
  /// empty, the figure uses all cycles, but only the checkpoints at whole cycles.
  std::optional<std::array<std::uint64_t, 2>> within = {};
  /// First and last cycle at which the figure needs the measures that a simulation computes
  /// (ComputedFrom::simulation). Empty: all cycles.
  std::optional<std::array<std::uint64_t, 2>> simulated = {};
  /// The experiments whose runs the figure uses; empty: the experiment of its manifest.
  std::vector<std::string> of = {};
  /// Whether the figure uses a run. Called before checkpoints are read. Empty: uses all runs.
  std::function<bool(const FrameRun& run)> uses = {};
};

/// The figures that are computed in analysis/figures/, in the order of the supplement. All other
/// figures are plots and claims of manifests (experiments/manifest/shipped.hpp).
std::span<const Figure> computed_figures();

}  // namespace shearcell
