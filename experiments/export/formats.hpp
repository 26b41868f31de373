// SPDX-License-Identifier: GPL-3.0-or-later
// Writers of file formats. A writer is called for one frame after the other; its files are complete
// after the last frame. All files have the same particles, numbered from 1, and state the run and
// its parameters. Numbers in text have 17 digits, enough to read back the same double.
#pragma once

#include <filesystem>
#include <functional>

#include "experiments/export/exported_state.hpp"
#include "experiments/manifest/packing_file.hpp"

namespace shearcell {

/// Writes a frame, or throws std::runtime_error.
using FrameWriter = std::function<void(const ExportedState&)>;

/// H5MD 1.1 in one file. `particles/all` holds box, position, velocity, id, species
/// (ExportedState::type), mass, radius and the measures of each grain. `observables` holds every
/// scalar. Attributes of the group `parameters` give the run and its parameters. Lengths are in nm,
/// because MDAnalysis does not support metres. `frames`: number of frames that will be written.
FrameWriter h5md_writer(const std::filesystem::path& file, std::size_t frames);

/// Extended XYZ in one file. The comment line of each frame has the run, its parameters and the
/// scalars. Readers require chemical symbols: species H is a grain, He a wall grain. The column
/// `wall_side` is ExportedState::type; OVITO would read a column `type` as a second species. A text
/// that ASE or OVITO would read as a number or a logical value gets single quotes: 'T' for an
/// experiment named T. `unit`: metres or grain diameters d. OVITO and ASE expect lengths of order
/// 1, such as lengths in d. The key `d_m` gives d in metres.
FrameWriter extxyz_writer(const std::filesystem::path& file, LengthUnit unit);

/// A folder with frames.pvd, which lists all frames, and two files for each frame: grains_CYCLE.vtp
/// (points with their data; scalars as field data) and cell_CYCLE.vtp (the six faces of the cell).
/// SI units. `frames`: number of frames; frames.pvd is complete after the last one.
FrameWriter vtk_writer(const std::filesystem::path& folder, std::size_t frames);

/// A folder with frame_CYCLE.data for each frame, in SI units and without measures (lammps_data()).
/// The title line of each .data file gives the planes of the cell. If ExportedState::continued is
/// set, the folder also gets in.frame_CYCLE (lammps_script()), which continues the run in LAMMPS.
FrameWriter lammps_writer(const std::filesystem::path& folder);

/// A folder with contacts_CYCLE.csv for each frame, with a row for each contact. Particles are
/// numbered as in the other formats; `other` is 0 for the plane of a wall. `wall_side` is the side
/// of the wall as in ExportedState::type, and 0 for a contact between grains. The force on `grain`
/// is force_N along the normal; the force on `other` is opposite.
FrameWriter contacts_writer(const std::filesystem::path& folder);

/// Writes FOLDER/run.json for formats that are folders: {"run", ..., "parameters": {...}, "frames":
/// [{"cycle", "checkpoint", scalars}]}. `frames`: number of frames; run.json is written after the
/// last one.
FrameWriter facts_writer(const std::filesystem::path& folder, std::size_t frames);

}  // namespace shearcell
