// SPDX-License-Identifier: GPL-3.0-or-later
// Files for the field's tools. Each writer takes frames in turn; its file is complete after the
// last one. All files hold the same particles, numbered from 1, and name their run and parameters.
// Text has 17 digits, enough to read back the same double.
#pragma once

#include <filesystem>
#include <functional>

#include "experiments/export/frame.hpp"

namespace shearcell {

/// Takes one frame. Throws std::runtime_error when it cannot be written.
using FrameWriter = std::function<void(const Frame&)>;

/// H5MD 1.1 in one file: particles/all with box, position, velocity, id, species (as Frame::type),
/// mass, radius and the measures of each grain; observables with every scalar; the run and its
/// parameters as attributes of the group parameters. Lengths in nm, the nearest that MDAnalysis
/// knows. `frames` is how many there will be, as below.
FrameWriter h5md_writer(const std::filesystem::path& file, std::size_t frames);

enum class Lengths { diameters, metres };

/// Extended XYZ in one file; the comment line of each frame holds the run, its parameters and the
/// scalars. Species H is a grain and He a wall grain, because readers require chemical
/// symbols; `type` is the wall. Lengths in grain diameters (the radius of a sphere is then
/// 0.5, as OVITO and ASE expect numbers of order 1), with d in metres as d_m; or in metres.
FrameWriter extxyz_writer(const std::filesystem::path& file, Lengths lengths);

/// A folder with grains_CYCLE.vtp (points with their data; scalars as field data) and
/// cell_CYCLE.vtp (the six faces of the cell) for each frame, and frames.pvd over all of them. SI.
FrameWriter vtk_writer(const std::filesystem::path& folder, std::size_t frames);

/// A folder with frame_CYCLE.data for each frame: LAMMPS data, atom_style sphere, units si, a
/// triclinic box. Type 1 is a grain, 2 to 5 are the wall grains of the left, right, bottom and top
/// wall. LAMMPS drops atoms outside the box, so it holds the wall grains too, which are centred
/// behind their planes and, on the side walls, reach below the moving one. Measures do not fit this
/// format.
FrameWriter lammps_writer(const std::filesystem::path& folder);

/// FOLDER/run.json: {"run", ..., "parameters": {...}, "frames": [{"cycle", "checkpoint",
/// scalars}]}, beside the files of the formats that are folders.
FrameWriter facts_writer(const std::filesystem::path& folder, std::size_t frames);

}  // namespace shearcell
