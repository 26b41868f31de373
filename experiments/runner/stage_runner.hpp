// SPDX-License-Identifier: GPL-3.0-or-later
// Computes one stage of a run from its records in the store, and records the result.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "experiments/runner/stage.hpp"

namespace shearcell {

/// How a stage ended in this process. `already`: it was completed and nothing was left to compute.
/// `held`: another program holds it; nothing was started. `lost`: another program took its lease,
/// completed it or recorded a later state meanwhile.
enum class StageOutcome : std::uint8_t { completed, already, interrupted, failed, held, lost };

/// The progress of a running stage.
struct StageStatus {
  double cycle = 0;
  double target_cycles = 0;  ///< 0 for a stage without cycles
  double steps_per_second = 0;
  std::size_t grains = 0;
  std::uint64_t step = 0;
  double seconds_left = 0;  ///< negative when it is not known
};

struct StageOptions {
  Parallel parallel = {};
  std::function<void(const std::string&)> damaged;  ///< called for each skipped checkpoint
  std::function<void()> begun;                      ///< called when an attempt has been recorded
  std::function<void(const StageStatus&)> report;   ///< called a few times a second
};

/// Computes the stage `id` until its target, then the checkpoints that it lacks. Starts as
/// continue_stage() does. Between chunks of steps of about 50 ms it checks stop_requested() and
/// whether the store still holds the run. Throws StoreDamaged when the parent's last state cannot
/// be read, GeometryError for a cell that cannot be filled, and ProgramError when the stage's
/// engine is not installed, all before an attempt is recorded. A stage that is interrupted while
/// its cell is filled records nothing.
StageOutcome run_stage(Store& store, const std::string& id, const StageOptions& options);

/// Whether the stage is done and its last state can be read.
bool is_done(const Store& store, const Stage& stage);

}  // namespace shearcell
