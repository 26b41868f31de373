// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/at_rest.hpp"

#include <limits>
#include <map>
#include <string>
#include <utility>

#include "analysis/published.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/identity.hpp"
#include "protocols/rest.hpp"

namespace shearcell {
namespace {

constexpr double kRest = 0.1;  // [s]

DerivedMeasure scalars_at_rest() {
  DerivedMeasure measure = scalar_measures();
  measure.name = "scalars_at_rest";
  measure.parameters["rest_s"] = kRest;
  return measure;
}

}  // namespace

std::vector<double> phi_at_rest(const Store& store, std::span<const CheckpointRecord> records,
                                const MeasureOptions& options) {
  std::vector<double> phi(records.size(), std::numeric_limits<double>::quiet_NaN());
  std::vector<CheckpointRecord> early;
  std::vector<std::size_t> place;
  std::map<std::string, Scene> scenes;  // of each run; threads must not read the log
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (records[i].cycle < 1 || records[i].cycle > early_cycles) continue;
    early.push_back(records[i]);
    place.push_back(i);
    const std::string& run = records[i].run;
    if (scenes.contains(run)) continue;
    scenes[run] = shear_scene(read_stage(store.run(run).resolved).parameters);
  }
  MeasureOptions with_rest = options;
  with_rest.prepare = [&](const CheckpointRecord& record, Checkpoint& checkpoint) {
    checkpoint.state =
        rested(checkpoint.cell, scenes.at(record.run), std::move(checkpoint.state), kRest);
  };
  const DerivedMeasure measure = scalars_at_rest();
  const auto found = measure_checkpoints(store, early, std::span(&measure, 1), with_rest);
  for (std::size_t n = 0; n < early.size(); ++n) {
    const nlohmann::json& result = found.results[n].front();
    if (!result.is_null()) phi[place[n]] = read_measures(result).phi;
  }
  return phi;
}

}  // namespace shearcell
