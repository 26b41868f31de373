// SPDX-License-Identifier: GPL-3.0-or-later
// Draws figures of a small experiment in a temporary store.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "experiments/figures/draw.hpp"
#include "experiments/manifest/shipped.hpp"
#include "tests/experiments/temporary_store.hpp"

namespace shearcell::test {

struct Measured : MeasureOutcome {
  std::vector<CheckpointMeasures> checkpoints;
};

/// The records with their measures, as of an experiment with a checkpoint every cycle.
inline Measured measured(const Store& store, const std::vector<CheckpointRecord>& records,
                         const std::vector<std::string>& providers, const MeasureOptions& options) {
  std::vector<CheckpointMeasures> checkpoints;
  for (const CheckpointRecord& record : records) checkpoints.push_back({record});
  std::vector<ToMeasure> todo;
  for (CheckpointMeasures& one : checkpoints) todo.push_back({&one});
  return {measure_checkpoints(store, todo, providers, options), std::move(checkpoints)};
}

class DrawingTest : public StoreTest {
 protected:
  /// Draws a figure into that folder beside the store; S2 of the experiment if none is named.
  ComputedFigure draw(const std::string& folder, const WantedFigure& wanted = kS2,
                      FigureOptions options = {}) {
    options.folder = folder_.path() / folder;
    return draw_figure(store_, wanted, options);
  }
  ComputedFigure draw(const std::string& folder, const WantedFigure& wanted,
                      const RunSelection& runs) {
    FigureOptions options;
    options.runs = runs;
    return draw(folder, wanted, options);
  }
  ComputedFigure draw(const std::string& folder, const std::string& name) {
    return draw(folder, wanted_figures(store_, {name}).figures.at(0));
  }

  /// File name -> bytes, of the figures of one scale.
  std::map<std::string, std::string> contents(const std::string& folder) const {
    std::map<std::string, std::string> files;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(folder_.path() / folder / "tiny")) {
      if (entry.is_directory()) continue;
      files[entry.path().filename().string()] = read_bytes(entry.path());
    }
    return files;
  }

  static inline const WantedFigure kS2{*find_figure("S2"), "tiny"};
};

}  // namespace shearcell::test
