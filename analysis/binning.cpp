// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/binning.hpp"

#include <cmath>
#include <cstdint>
#include <map>

namespace shearcell {

std::vector<PhiBin> binned_by_phi(RunGroup runs, const std::string& measure, double least) {
  struct Members {
    std::vector<const FigureRun*> runs;  // one for each number
    std::vector<double> phi;
    std::vector<double> value;
  };
  std::map<std::int64_t, Members> bins;
  for (const FigureRun* run : runs) {
    std::map<std::int64_t, Members> own;
    for (const CheckpointMeasures& checkpoint : run->checkpoints) {
      const double phi = checkpoint.measures.number("phi");
      if (!std::isfinite(phi)) continue;
      Members& bin = own[static_cast<std::int64_t>(std::floor(phi / phi_bin))];
      bin.phi.push_back(phi);
      const double value = checkpoint.measures.number(measure);
      bin.value.push_back(value < least ? least : value);
    }
    for (const auto& [bin, checkpoints] : own) {
      const RunStatistics value = over_runs(checkpoints.value);
      if (!value.mean) continue;
      bins[bin].runs.push_back(run);
      bins[bin].phi.push_back(over_runs(checkpoints.phi).mean.value());
      bins[bin].value.push_back(*value.mean);
    }
  }
  std::vector<PhiBin> result;
  for (const auto& [bin, found] : bins) {
    const auto low = static_cast<double>(bin);
    result.push_back({low * phi_bin, (low + 1) * phi_bin,
                      over_runs(over_packings(found.runs, found.phi)),
                      over_runs(over_packings(found.runs, found.value))});
  }
  return result;
}

}  // namespace shearcell
