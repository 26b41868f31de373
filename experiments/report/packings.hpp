// SPDX-License-Identifier: GPL-3.0-or-later
// Selects the checkpoints that a report shows in 3D, and encodes each coordinate and each measure
// of a grain in 8 or 16 bits.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "analysis/measures.hpp"
#include "experiments/figures/select_runs.hpp"
#include "experiments/runner/measure.hpp"
#include "provenance/checkpoint.hpp"
#include "provenance/store.hpp"

namespace shearcell {

struct PackingChoice {
  std::vector<std::string> runs;        ///< ids; empty: the last run of each variant
  std::size_t runs_per_experiment = 6;  ///< largest number of runs if `runs` is empty
  std::size_t frames = 40;              ///< largest number of checkpoints shown per run
  std::size_t budget = 9'000'000;       ///< largest total size of the packings in the page [bytes]
};

struct Packings : MeasureOutcome {
  /// [{id, label, experiment, grains, wall_grains, frames: [{name, sha256, facts, cell, fields,
  /// profiles, origin, step, data}]}], read by the front end (web/src/viewer.js).
  nlohmann::json runs = nlohmann::json::array();
  std::size_t frames = 0;
  double largest_step = 0;         ///< largest rounding step of a coordinate [d]
  std::vector<std::string> notes;  ///< messages about runs that were left out
};

/// Encodes checkpoints of the experiments, in the order of `experiments`. If the checkpoints exceed
/// the budget, each run shows fewer checkpoints, chosen by evenly(). If the total exceeds the
/// budget even with one checkpoint per run, runs at the end of the list are left out. The same
/// store gives the same result.
Packings collect_packings(const Store& store, const std::vector<std::string>& experiments,
                          const RunSelection& selection, const PackingChoice& choice,
                          std::size_t workers, const ReadProgress& report);

/// Returns `count` evenly spaced indices from 0 to size - 1, including the first and the last. If
/// `count` is 1, returns the last index.
std::vector<std::size_t> evenly(std::size_t size, std::size_t count);

/// `bytes` holds the numbers of N grains and M wall grains, one array after the other:
///
///     x, y, z       N + M words each: coordinate = origin + step * word [d]; z within the period
///     each field    N words for phi_local, q6 and crystallite; N bytes for any other measure
///
/// Words are little-endian and have 16 bits. A word is 65534 phi_local, 65534 q6 or the number of
/// the crystallite (0 outside crystallites). A byte is the class or 254 (value - low) / (high -
/// low). On a logarithmic scale, the logarithms of value, low and high are used. The largest word
/// or byte means that the value is unknown.
struct EncodedFrame {
  Eigen::Vector3d origin;
  Eigen::Vector3d step;  ///< the error of a coordinate is at most step / 2 [d]
  std::vector<std::byte> bytes;
};

/// A measure by which the page can colour the grains. The colours range from `low` to `high`. In
/// the field of `structure`, 4 is added to the class of interior grains.
struct GrainField {
  const Measure* measure = nullptr;
  double low = 0, high = 0;
  std::vector<double> value = {};  ///< of each grain
};

EncodedFrame encode_frame(const Checkpoint& checkpoint, const WallPose& pose,
                          std::span<const GrainField> fields);

/// Size of an encoded frame in the page, in base64 [bytes]. `bytes_per_grain`: of all fields.
std::size_t frame_size_in_page(std::size_t grains, std::size_t wall_grains,
                               std::size_t bytes_per_grain);

}  // namespace shearcell
