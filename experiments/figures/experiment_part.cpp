// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/experiment_part.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include "experiments/manifest/identity.hpp"
#include "experiments/runner/run_end.hpp"

namespace shearcell {

std::vector<std::uint64_t> asked_steps(const RunRecord& run, const RunAsk& ask, double first,
                                       double last) {
  const std::optional<Drive> motion = shear_drive(run);
  if (!motion) return {};
  return checkpoint_steps(ask, *motion, first, last);
}

std::vector<CheckpointRecord> checkpoints_for(const Store& store, const RunRecord& run,
                                              std::span<const RunAsk> asks, double first,
                                              double last) {
  std::vector<CheckpointRecord> found = store.checkpoints(run.id, Listed::and_pruned);
  const double end = found.empty() ? 0 : std::min(last, found.back().cycle);
  std::set<std::uint64_t> phases;
  for (const RunAsk& ask : asks) {
    if (ask.phases.empty()) continue;
    for (const std::uint64_t step : asked_steps(run, ask, first, end)) phases.insert(step);
  }
  const bool every = asks.empty() || run.kind != name_of(Stage::shear);
  const auto asked = [&](double cycle) {
    if (cycle != std::floor(cycle)) return false;
    return every || std::ranges::any_of(asks, [&](const RunAsk& ask) {
             return std::fmod(cycle, static_cast<double>(ask.checkpoint_every)) == 0 ||
                    cycle == static_cast<double>(ask.target_cycles);
           });
  };
  std::erase_if(found, [&](const CheckpointRecord& record) {
    return record.cycle < first || record.cycle > last ||
           !(asked(record.cycle) || phases.contains(record.step));
  });
  return found;
}

std::vector<CheckpointRecord> checkpoints_for(const Store& store, const RunRecord& run,
                                              const Membership& membership,
                                              const MeasureOptions& options) {
  const RunAsk ask = ask_of(store, run.id, membership);
  return checkpoints_for(store, run, {&ask, 1}, 0, end_for(store, run, ask, options));
}

}  // namespace shearcell
