// SPDX-License-Identifier: GPL-3.0-or-later
// Writers of file formats. A writer takes frames in turn; its file is complete after the last one.
// All files hold the same particles, numbered from 1, and name their run and parameters. Text has
// 17 digits, enough to read back the same double.
#pragma once

#include <filesystem>
#include <functional>

#include "experiments/export/exported_state.hpp"
#include "experiments/manifest/packing_file.hpp"

namespace shearcell {

/// Writes a frame. Throws std::runtime_error if it cannot be written.
using FrameWriter = std::function<void(const ExportedState&)>;

/// H5MD 1.1 in one file: particles/all with box, position, velocity, id, species (as
/// ExportedState::type), mass, radius and the measures of each grain; observables with every
/// scalar; the run and its parameters as attributes of the group parameters. Lengths are in nm,
/// since MDAnalysis does not know metres. `frames`: the number of frames that will be written.
FrameWriter h5md_writer(const std::filesystem::path& file, std::size_t frames);

/// Extended XYZ in one file; the comment line of each frame holds the run, its parameters and the
/// scalars. Readers require chemical symbols: species H is a grain, He a wall grain. The column
/// `wall_side` is ExportedState::type, which OVITO would take for a second species if it were
/// called `type`. A text that ASE or OVITO would read as a number or a logical value is in single
/// quotes: the experiment T is 'T'. Lengths in metres, or in grain diameters, since OVITO and ASE
/// expect numbers of order 1 (the radius is 0.5); d_m is then d in metres.
FrameWriter extxyz_writer(const std::filesystem::path& file, LengthUnit unit);

/// A folder with grains_CYCLE.vtp (points with their data; scalars as field data) and
/// cell_CYCLE.vtp (the six faces of the cell) for each frame, and frames.pvd over all of them. SI.
/// `frames`: the number of frames that will be written; the last one completes frames.pvd.
FrameWriter vtk_writer(const std::filesystem::path& folder, std::size_t frames);

/// A folder with frame_CYCLE.data for each frame (lammps_data, SI; the title has the planes of the
/// cell; no measures). Unless the run is a stiffening, also in.frame_CYCLE, the script with which
/// LAMMPS continues the frame (lammps_script).
FrameWriter lammps_writer(const std::filesystem::path& folder);

/// A folder with contacts_CYCLE.csv for each frame, a row for each contact. The particles are
/// numbered as in the other formats; `other` is 0 for a wall's plane. `wall_side` is the side of a
/// wall contact, as ExportedState::type, and 0 between grains. The force on `grain` is force_N
/// along the normal; the force on `other` is opposite.
FrameWriter contacts_writer(const std::filesystem::path& folder);

/// FOLDER/run.json: {"run", ..., "parameters": {...}, "frames": [{"cycle", "checkpoint",
/// scalars}]}, beside the files of the formats that are folders. `frames`: as in vtk_writer();
/// the last frame writes the file.
FrameWriter facts_writer(const std::filesystem::path& folder, std::size_t frames);

}  // namespace shearcell
