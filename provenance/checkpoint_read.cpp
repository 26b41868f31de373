// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a checkpoint from untrusted bytes.
#include <algorithm>
#include <cmath>

#include "provenance/checkpoint.hpp"
#include "provenance/errors.hpp"
#include "provenance/hdf5_read.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

using hdf5::Object;

[[noreturn]] void fail(const std::string& where, const std::string& why) {
  throw StoreDamaged("checkpoint: " + where + ": " + why);
}

Eigen::Matrix3Xd vectors(const Object& group, const std::string& where, const std::string& name) {
  const std::vector<double> data = group.numbers(name, 3);
  if (!std::all_of(data.begin(), data.end(), [](double x) { return std::isfinite(x); })) {
    fail(where + "/" + name, "holds a number that is not finite");
  }
  return Eigen::Map<const Eigen::Matrix3Xd>(data.data(), 3,
                                            static_cast<Eigen::Index>(data.size() / 3));
}

void require_frame(std::span<const std::byte> image) {
  if (image.size() <= hdf5::kFrameSize) fail("file", "it is truncated");
  const std::string_view frame(reinterpret_cast<const char*>(image.data()), hdf5::kFrameSize);
  if (!frame.starts_with(hdf5::kFrameTitle)) {
    fail("file", "it is not a checkpoint of a known version");
  }
  std::string expected = hdf5::frame_text(sha256_hex(image.subspan(hdf5::kFrameSize)));
  expected.resize(hdf5::kFrameSize, '\0');
  if (frame != expected) fail("file", "it is truncated or changed: its SHA-256 does not match");
}

Cell read_cell(const Object& group) {
  Cell cell;
  cell.width = group.number("width");
  cell.depth = group.number("depth");
  cell.bottom = group.number("bottom");
  cell.top = group.number("top");
  const std::uint64_t moving = group.count("moving");
  if (moving > 1) fail("/restart/cell/moving", "is not a wall");
  cell.moving = static_cast<MovingWall>(moving);
  const auto side = group.bytes("wall_grain_side");
  const Eigen::Matrix3Xd position = vectors(group, "/restart/cell", "wall_grain_position");
  if (static_cast<std::size_t>(position.cols()) != side.size()) {
    fail("/restart/cell/wall_grain_position", "does not have the length of wall_grain_side");
  }
  for (std::size_t i = 0; i < side.size(); ++i) {
    if (side[i] > 3) fail("/restart/cell/wall_grain_side", "is not a wall");
    cell.wall_grains.push_back(
        {static_cast<WallSide>(side[i]), position.col(static_cast<Eigen::Index>(i))});
  }
  return cell;
}

void read_restart(const Object& restart, Checkpoint& checkpoint) {
  if (restart.count("format") != hdf5::kRestartFormat) {
    fail("/restart/format", "unknown format; use the program version that wrote it");
  }
  checkpoint.run = restart.text("run");
  checkpoint.time_s = restart.number("time_s");
  checkpoint.cycle = restart.number("cycle");
  checkpoint.theta = restart.number("theta");
  checkpoint.units.diameter_m = restart.number("diameter_m");
  checkpoint.units.mass_kg = restart.number("mass_kg");
  checkpoint.state.step = restart.count("step");
  checkpoint.state.wall_height = restart.number("wall_height");
  checkpoint.state.wall_velocity = restart.number("wall_velocity");
  checkpoint.state.position = vectors(restart, "/restart", "position");
  checkpoint.state.velocity = vectors(restart, "/restart", "velocity");
  if (checkpoint.state.position.cols() != checkpoint.state.velocity.cols()) {
    fail("/restart/velocity", "does not have the length of position");
  }
  checkpoint.cell = read_cell(restart.child("cell"));
}

}  // namespace

Checkpoint decode_checkpoint(std::span<const std::byte> image) {
  require_frame(image);
  const Object top = Object::root(image.subspan(hdf5::kFrameSize), hdf5::kFrameSize);
  Checkpoint checkpoint;
  read_restart(top.child("restart"), checkpoint);
  const Object observables = top.child("observables");
  for (const std::string& name : observables.names()) {
    const std::vector<double> value = observables.child(name).numbers("value", 0);
    if (value.size() != 1 || !std::isfinite(value[0])) {
      fail("/observables/" + name + "/value", "is not one finite number");
    }
    checkpoint.observables[name] = value[0];
  }
  return checkpoint;
}

void require_plausible(const Checkpoint& checkpoint) {
  constexpr double kFarthest = 1e9;  // [d]; grains may drift along the period
  constexpr double kSteepest = 1.5;  // [rad]
  const Cell& cell = checkpoint.cell;
  if (!(cell.width > 0 && cell.depth > 0)) fail("/restart/cell", "has no width or no depth");
  for (const double length :
       {cell.width, cell.depth, cell.bottom, cell.top, checkpoint.state.wall_height}) {
    if (std::abs(length) > kFarthest) fail("/restart/cell", "is larger than any cell");
  }
  if (std::abs(checkpoint.theta) > kSteepest) fail("/restart/theta", "is not a tilt of a cell");
  if (!(checkpoint.state.position.array().abs() <= kFarthest).all()) {
    fail("/restart/position", "has a grain far outside of any cell");
  }
  for (const WallGrain& grain : cell.wall_grains) {
    if (grain.position.cwiseAbs().maxCoeff() > kFarthest) {
      fail("/restart/cell/wall_grain_position", "has a grain far outside of any cell");
    }
  }
}

}  // namespace shearcell
