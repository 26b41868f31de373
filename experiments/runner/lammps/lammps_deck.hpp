// SPDX-License-Identifier: GPL-3.0-or-later
// A stage of shear as LAMMPS reads it: a data file and an input deck, and the frames that come
// back. README.md lists how each part of the scene is written, and why every mass is raised by
// b dt/2.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/cell.hpp"
#include "core/scene.hpp"
#include "core/state.hpp"

namespace shearcell {

struct LammpsTask {
  Cell cell;
  Scene scene;
  Drive drive;
  State state;                      ///< at the start
  std::uint64_t end = 0;            ///< step at which it ends
  std::uint64_t stride = 1;         ///< a frame at every multiple of it, and at the end
  std::uint64_t check_every = 100;  ///< steps between two checks for a file `stop`, which ends it
  bool added_mass = true;           ///< false: the drag as LAMMPS users take it, wrong by order dt
};

/// The file `scene.data`: grains (ids 1 .. N), an atom for the moving wall (N + 1), wall grains.
/// Lengths in d, masses in m, times in s.
std::string lammps_data(const LammpsTask& task);

/// The input deck. It runs in a folder with `scene.data` and writes each frame there as
/// `frame.STEP`, renamed to that when complete. If a file `stop` appears, it writes one more frame
/// and ends.
std::string lammps_deck(const LammpsTask& task);

/// Limit for files that LAMMPS writes [bytes]; none comes near it.
inline constexpr std::size_t kLargestFile = std::size_t{1} << 40;

/// Reads a frame. Throws ProgramError, with the file's name, unless it is a complete state of this
/// number of grains.
State read_lammps_frame(const std::filesystem::path& file, std::size_t grains);

}  // namespace shearcell
