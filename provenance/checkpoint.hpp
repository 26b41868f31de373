// SPDX-License-Identifier: GPL-3.0-or-later
// One checkpoint as one immutable HDF5 file (H5MD 1.1 plus /restart).
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

/// What a checkpoint file holds: enough to continue the run and to analyse it without the log.
struct Checkpoint {
  std::string run;    ///< id of the run (stage) that made it
  double time_s = 0;  ///< simulated time since the stage began [s]
  double cycle = 0;   ///< cycles since the stage began; whole at the end of a cycle
  double theta = 0;   ///< tilt of the side walls [rad]
  Units units;
  Cell cell;
  State state;
  std::map<std::string, double> observables;  ///< name (with its unit) -> value
};

/// The bytes of the file: the same checkpoint gives the same bytes.
std::vector<std::byte> encode_checkpoint(const Checkpoint& checkpoint);

/// Reads a file image. Throws StoreDamaged when it is not a whole, consistent checkpoint.
Checkpoint decode_checkpoint(std::span<const std::byte> image);

/// SHA-256 (hex) over the exact state and cell: equal exactly when a run would go on equally.
std::string state_hash(const Checkpoint& checkpoint);

}  // namespace shearcell
