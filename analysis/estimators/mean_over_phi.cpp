// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/estimators.hpp"

namespace shearcell {
namespace {

/// For each bin of phi, in ascending order: the mean of phi and the mean of the column, over the
/// run's checkpoints in this bin. Checkpoints without a finite phi and bins without a finite value
/// are left out.
std::vector<std::pair<double, double>> means_over_phi(const FrameRun& run,
                                                      const NumberColumn& column) {
  std::map<double, std::pair<std::vector<double>, std::vector<double>>> bins;
  for (const CheckpointMeasures& checkpoint : run.checkpoints) {
    const double phi = checkpoint.measures.number("phi");
    if (!std::isfinite(phi)) continue;
    auto& [phis, values] = bins[std::floor(phi / phi_bin)];
    phis.push_back(phi);
    values.push_back(column(run, &checkpoint));
  }
  std::vector<std::pair<double, double>> means;
  for (const auto& [bin, members] : bins) {
    const auto value = over_runs(members.second).mean;
    if (value) means.emplace_back(over_runs(members.first).mean.value(), *value);
  }
  return means;
}

/// The means_over_phi() of a run, joined by straight lines, form a curve. The value of the run is
/// the mean of this curve over the range ClaimSpec::phi.
Scalar over_phi(const ClaimSpec& claim) {
  const auto [low, high] = *claim.phi;
  const auto of = [low = low, high = high,
                   number = NumberColumn(claim.compare)](const FrameRun& run) -> RunValue {
    const auto bins = means_over_phi(run, number);
    if (bins.empty()) return {0, Missing::too_short};
    if (bins.front().first > low) return {0, Missing::too_late};
    if (bins.back().first < high) return {0, Missing::too_short};
    double area = 0;
    for (std::size_t k = 1; k < bins.size(); ++k) {
      const auto& [x0, y0] = bins[k - 1];
      const auto& [x1, y1] = bins[k];
      const double begin = std::max(x0, low), end = std::min(x1, high);
      if (begin >= end) continue;
      const double middle = ((begin + end) / 2 - x0) / (x1 - x0);
      area += (end - begin) * std::lerp(y0, y1, middle);
    }
    return measured(area / (high - low));
  };
  return {fmt::format("{}, mean over phi from {} to {}", words_of_column(claim.compare), low, high),
          fmt::format("phi from {} to {}", low, high), of};
}

}  // namespace

const Estimator mean_over_phi = {.name = "mean_over_phi",
                                 .meaning = "mean over the volume fractions in the range `phi`",
                                 .key = "phi",
                                 .scalar = over_phi};

}  // namespace shearcell
