// SPDX-License-Identifier: GPL-3.0-or-later
// A figure turns measured runs into tables and verdicts. The same runs give the same bytes.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/chart.hpp"
#include "analysis/frame.hpp"
#include "analysis/verdict.hpp"
#include "provenance/records.hpp"

namespace shearcell {

/// The panels of a figure in order, and the verdicts on its claims.
struct FigureResult {
  std::vector<Table> tables;
  std::vector<Verdict> verdicts;
};

/// `table`: takes the runs of all experiments, each with its last checkpoint, without measures.
/// `curves`: takes runs of one experiment, one curve for each variant. `groups`: takes runs of one
/// experiment and averages over variants with the same values of Figure::keys.
enum class FigureForm { table, curves, groups };

/// A figure of the supplement, or of plots and claims in a manifest.
struct Figure {
  std::string name;
  std::string title;
  std::function<FigureResult(const Frame& frame)> make;
  FigureForm form = FigureForm::curves;
  std::vector<std::string> keys = {};    ///< parameters that its curves compare
  std::vector<std::string> claims = {};  ///< ids of its claims, without the part after '@'
  /// Names of the providers (measures.hpp) that it needs besides scalars_provider.
  std::vector<std::string> needs = {};
  /// First and last cycle whose checkpoints the figure takes, also those at phases of a cycle.
  /// Without it the figure takes whole cycles only.
  std::optional<std::array<std::uint64_t, 2>> within = {};
  /// First and last cycle for which simulated measures are needed; default: all cycles.
  std::optional<std::array<std::uint64_t, 2>> simulated = {};
  /// The experiments whose runs the figure takes; empty: its own experiment.
  std::vector<std::string> of = {};
  /// Whether the figure uses the run, whose checkpoints are not read yet; empty: it uses all runs.
  std::function<bool(const FrameRun& run)> uses = {};
};

/// The figures with an analysis of their own (analysis/figures/), in the order of the supplement.
/// Manifests state the others (experiments/manifest/shipped.hpp).
std::span<const Figure> computed_figures();

}  // namespace shearcell
