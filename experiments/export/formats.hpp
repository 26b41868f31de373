// SPDX-License-Identifier: GPL-3.0-or-later
// Files for the field's tools. Each takes frames in turn and is whole when the last one was given;
// all have the same particles, numbered from 1. Numbers are in SI units and, as text, have 17
// digits: what is read is what was stored.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "experiments/export/frame.hpp"

namespace shearcell {

/// Takes one frame. Throws std::runtime_error when it cannot be written.
using FrameWriter = std::function<void(const Frame&)>;

/// H5MD 1.1 in one file: particles/all with box, position, velocity, id, species (as Frame::type),
/// mass, radius and the measures, and observables. Lengths in nm, the nearest that MDAnalysis
/// knows. `frames` is how many there will be.
FrameWriter h5md_writer(const std::filesystem::path& file, std::size_t frames);

/// Extended XYZ in one file. Species H stands for a grain and He for a wall grain, since readers
/// want chemical symbols; `type` tells which wall.
FrameWriter extxyz_writer(const std::filesystem::path& file);

/// A folder with grains_CYCLE.vtp (points with their data) and cell_CYCLE.vtp (the six faces of the
/// cell) for each frame, and frames.pvd over all of them.
FrameWriter vtk_writer(const std::filesystem::path& folder);

/// A folder with frame_CYCLE.data for each frame: LAMMPS data, atom_style sphere, units si, a
/// triclinic box. Type 1 is a grain, 2 to 5 are the wall grains of the left, right, bottom and top
/// wall. LAMMPS drops atoms outside the box, so it holds the wall grains too, which are centred
/// behind their planes and, on the side walls, reach below the moving one. Measures do not fit this
/// format.
FrameWriter lammps_writer(const std::filesystem::path& folder);

}  // namespace shearcell
