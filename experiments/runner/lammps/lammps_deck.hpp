// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a state and its scene as a data file and an input deck for LAMMPS, and reads frames from
// LAMMPS. README.md explains how each part of the scene is written, and why masses are increased.
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
  std::uint64_t end = 0;            ///< last step
  std::uint64_t stride = 1;         ///< steps between frames; the last step has a frame too
  std::uint64_t check_every = 100;  ///< steps between two checks for the file `stop`
  Units units = {1, 1};             ///< of lengths and masses in data file and deck
};

/// A data file (atom_style sphere). Ids begin at 1, grains first. Type 1 is a grain; types 2 to 5
/// are wall grains of the left, right, bottom and top wall. The box is upright and includes the
/// wall grains and the planes, because LAMMPS drops atoms outside it. `title` is the first line.
std::string lammps_data(const Particles& particles, std::string_view title);

/// The input deck. LAMMPS reads the task's particles from `scene.data` and writes each frame to a
/// temporary file, which is renamed to `frame.STEP` when it is complete. If a file `stop` appears
/// in the same folder, LAMMPS writes one more frame and ends.
std::string lammps_deck(const LammpsTask& task);

/// An input script for users, with comments. The script continues from the state in the file
/// `data`. The task's units must be SI. The script computes one cycle (one second if the cell is
/// not sheared); users can set another number of steps with `lmp -var steps`. The script writes
/// NAME.lammpstrj and NAME_end.dump. The task's `end`, `stride` and `check_every` have no effect.
std::string lammps_script(const LammpsTask& task, std::string_view data, std::string_view name);

/// Size limit [bytes] for files that LAMMPS writes, far above their usual sizes.
inline constexpr std::size_t kLargestFile = std::size_t{1} << 40;

/// Reads a frame. Ids from 1 to `grains` belong to grains; the atom with a larger id represents the
/// moving wall. Throws ProgramError, with the file's name, unless the file contains the complete
/// state of `grains` grains.
State read_lammps_frame(const std::filesystem::path& file, std::size_t grains);

}  // namespace shearcell
