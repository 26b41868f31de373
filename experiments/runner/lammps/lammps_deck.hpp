// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a state and what acts on it as a data file and an input deck for LAMMPS, and reads the
// frames of LAMMPS. README.md lists how each part of the scene is written, and why every mass is
// raised by b dt/2.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/cell.hpp"
#include "core/scene.hpp"
#include "core/state.hpp"
#include "experiments/runner/particles.hpp"

namespace shearcell {

struct LammpsTask {
  Cell cell;
  Scene scene;
  Drive drive;
  State state;                      ///< at the start
  std::uint64_t end = 0;            ///< step at which it ends
  std::uint64_t stride = 1;         ///< steps between frames; the last step has a frame too
  std::uint64_t check_every = 100;  ///< steps between two checks for a file `stop`, which ends it
  bool added_mass = true;           ///< false: LAMMPS's explicit drag, wrong by order dt
  Units units = {1, 1};             ///< of lengths and masses in deck and data file
};

/// A data file (atom_style sphere): ids from 1, grains first; type 1 is a grain, 2 to 5 are the
/// wall grains of the left, right, bottom and top wall. LAMMPS drops atoms outside the box, so the
/// box, which is upright, includes the wall grains and the planes. `title` is its first line.
std::string lammps_data(const Particles& particles, std::string_view title);

/// The input deck. It runs in a folder with the task's particles as `scene.data` and writes each
/// frame there as `frame.STEP`, renamed to that when complete. If a file `stop` appears, it writes
/// one more frame and ends.
std::string lammps_deck(const LammpsTask& task);

/// An input script for users, with comments. The script continues from the file `data`, in the
/// task's units, which must be SI. It runs a cycle, or as many steps as its variable `steps` says,
/// and writes NAME.lammpstrj and NAME_end.dump. The task's `end`, `stride` and `check_every` have
/// no effect.
std::string lammps_script(const LammpsTask& task, std::string_view data, std::string_view name);

/// Limit for files that LAMMPS writes [bytes], far above their sizes.
inline constexpr std::size_t kLargestFile = std::size_t{1} << 40;

/// Reads a frame, which has the ids of the data file; the id after the last grain is the
/// moving wall. Throws ProgramError, with the file's name, unless it is a complete state of this
/// number of grains.
State read_lammps_frame(const std::filesystem::path& file, std::size_t grains);

}  // namespace shearcell
