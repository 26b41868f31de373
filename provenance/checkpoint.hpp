// SPDX-License-Identifier: GPL-3.0-or-later
// One checkpoint is one immutable HDF5 file (H5MD 1.1 plus /restart; layout in README.md).
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/cell.hpp"
#include "core/scene.hpp"
#include "core/state.hpp"

namespace shearcell {

/// The content of a checkpoint file: enough to continue the run and to analyse it without the log.
struct Checkpoint {
  std::string run;    ///< id of the run (stage)
  double time_s = 0;  ///< simulated time since the stage began [s]
  double cycle = 0;   ///< cycles since the stage began; an integer at the end of a cycle
  double theta = 0;   ///< tilt of the side walls [rad]
  Units units;
  Cell cell;
  State state;
  std::map<std::string, double> observables;  ///< name with unit -> value
};

/// Positions of the walls at the time of the checkpoint.
inline WallPose pose_of(const Checkpoint& checkpoint) {
  return wall_pose(checkpoint.cell, checkpoint.theta, checkpoint.state.wall_height);
}

/// The bytes of the checkpoint file; equal checkpoints give equal bytes. Throws
/// std::invalid_argument for a checkpoint that could not be read again (NaN, bad names, too many
/// observables).
std::vector<std::byte> encode_checkpoint(const Checkpoint& checkpoint);

/// Decodes a checkpoint file, whose SHA-256 the caller has checked (ObjectStore::get). Throws
/// StoreDamaged unless it is complete and consistent.
Checkpoint decode_checkpoint(std::span<const std::byte> image);

/// Throws StoreDamaged with the HDF5 path when a length, position or tilt is implausibly large or
/// small. With such a value, a run or an analysis could overflow or never end.
void require_plausible(const Checkpoint& checkpoint);

/// SHA-256 (hex) of the exact state and cell. Two runs continue identically if and only if their
/// state hashes are equal.
std::string state_hash(const Checkpoint& checkpoint);

}  // namespace shearcell
