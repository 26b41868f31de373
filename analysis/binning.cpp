// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/binning.hpp"

#include <cmath>
#include <cstdint>
#include <map>

#include "analysis/statistics.hpp"

namespace shearcell {

std::vector<PhiMean> means_over_phi(const FrameRun& run, const NumberColumn& column) {
  std::map<std::int64_t, std::pair<std::vector<double>, std::vector<double>>> bins;
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    const double phi = checkpoint.measures.number("phi");
    if (!std::isfinite(phi)) continue;
    auto& [phis, values] = bins[static_cast<std::int64_t>(std::floor(phi / phi_bin))];
    phis.push_back(phi);
    values.push_back(column(run, &checkpoint));
  }
  std::vector<PhiMean> means;
  for (const auto& [bin, members] : bins) {
    const auto value = over_runs(members.second).mean;
    if (value) means.push_back({over_runs(members.first).mean.value(), *value});
  }
  return means;
}

}  // namespace shearcell
