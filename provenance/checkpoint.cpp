// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/checkpoint.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <stdexcept>

#include "provenance/hdf5_read.hpp"
#include "provenance/hdf5_write.hpp"
#include "provenance/limits.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

using hdf5::creation_list;
using hdf5::Handle;
using hdf5::make_group;
using hdf5::Object;
using hdf5::put_attribute;
using hdf5::put_dataset;
using hdf5::refuse;
using hdf5::require;
using hdf5::Shape;

/// Calls field(name, value) for each number in the group /restart, in the order of the file.
/// cell_numbers() does the same for /restart/cell.
void restart_numbers(auto& checkpoint, auto field) {
  field("time_s", checkpoint.time_s);
  field("cycle", checkpoint.cycle);
  field("theta", checkpoint.theta);
  field("wall_height", checkpoint.state.wall_height);
  field("wall_velocity", checkpoint.state.wall_velocity);
  field("diameter_m", checkpoint.units.diameter_m);
  field("mass_kg", checkpoint.units.mass_kg);
}

void cell_numbers(auto& cell, auto field) {
  field("width", cell.width);
  field("depth", cell.depth);
  field("bottom", cell.bottom);
  field("top", cell.top);
}

/// Writes an H5MD element with one time step: a group with the datasets step, time and value.
void put_element(const Handle& parent, const std::string& name, const Checkpoint& checkpoint,
                 const double* value, const Shape& shape, const std::string& unit) {
  const Handle group = make_group(parent, name);
  put_dataset(group, "step", H5T_STD_U64LE, &checkpoint.state.step, {1});
  put_dataset(group, "time", H5T_IEEE_F64LE, &checkpoint.time_s, {1}, "s");
  put_dataset(group, "value", H5T_IEEE_F64LE, value, shape, unit);
}

/// Writes the grains, then the wall grains at their current positions, in SI units.
void put_particles(const Handle& file, const Checkpoint& checkpoint) {
  const Handle particles = make_group(file, "particles");
  const Handle all = make_group(particles, "all");
  const WallPose pose = pose_of(checkpoint);
  const double d = checkpoint.units.diameter_m;
  const double edges[3] = {checkpoint.cell.width * d, (pose.top - pose.bottom) * d,
                           checkpoint.cell.depth * d};
  put_dataset(hdf5::put_h5md_box(all), "edges", H5T_IEEE_F64LE, edges, {3}, "m");

  const Eigen::Index grains = checkpoint.state.position.cols();
  const auto walls = static_cast<Eigen::Index>(checkpoint.cell.wall_grains.size());
  Eigen::Matrix3Xd position(3, grains + walls);
  position.leftCols(grains) = checkpoint.state.position * d;
  position.rightCols(walls) = wall_grain_positions(checkpoint.cell, pose) * d;
  Eigen::Matrix3Xd velocity = Eigen::Matrix3Xd::Zero(3, grains + walls);
  velocity.leftCols(grains) = checkpoint.state.velocity * d;

  const auto total = static_cast<hsize_t>(position.cols());
  put_element(all, "position", checkpoint, position.data(), {1, total, 3}, "m");
  put_element(all, "velocity", checkpoint, velocity.data(), {1, total, 3}, "m s-1");
  std::vector<std::uint64_t> id(total);
  std::iota(id.begin(), id.end(), std::uint64_t{0});
  put_dataset(all, "id", H5T_STD_U64LE, id.data(), {total});
  std::vector<std::uint8_t> species(total, 0);
  for (std::size_t i = 0; i < checkpoint.cell.wall_grains.size(); ++i) {
    species[static_cast<std::size_t>(grains) + i] =
        static_cast<std::uint8_t>(1 + static_cast<int>(checkpoint.cell.wall_grains[i].side));
  }
  put_dataset(all, "species", H5T_STD_U8LE, species.data(), {total});
  const std::vector<double> mass(total, checkpoint.units.mass_kg);
  put_dataset(all, "mass", H5T_IEEE_F64LE, mass.data(), {total}, "kg");
  const std::vector<double> radius(total, 0.5 * d);
  put_dataset(all, "radius", H5T_IEEE_F64LE, radius.data(), {total}, "m");
}

void put_observables(const Handle& file, const Checkpoint& checkpoint) {
  const Handle group = make_group(file, "observables", checkpoint.observables.size());
  for (const auto& [name, value] : checkpoint.observables) {
    put_element(group, name, checkpoint, &value, {1}, "");
  }
}

void put_cell(const Handle& restart, const Cell& cell) {
  const Handle group = make_group(restart, "cell");
  cell_numbers(cell, [&](const char* name, double value) { put_attribute(group, name, value); });
  put_attribute(group, "moving", static_cast<std::uint64_t>(cell.moving));
  std::vector<std::uint8_t> side;
  std::vector<double> position;
  for (const WallGrain& grain : cell.wall_grains) {
    side.push_back(static_cast<std::uint8_t>(grain.side));
    position.insert(position.end(), grain.position.begin(), grain.position.end());
  }
  put_dataset(group, "wall_grain_side", H5T_STD_U8LE, side.data(), {side.size()});
  put_dataset(group, "wall_grain_position", H5T_IEEE_F64LE, position.data(), {side.size(), 3});
}

/// Writes the exact state in the engine's units. A run continues from this state.
void put_restart(const Handle& file, const Checkpoint& checkpoint) {
  const Handle restart = make_group(file, "restart");
  const State& state = checkpoint.state;
  put_attribute(restart, "format", hdf5::kRestartFormat);
  put_attribute(restart, "run", checkpoint.run);
  put_attribute(restart, "step", state.step);
  restart_numbers(checkpoint,
                  [&](const char* name, double value) { put_attribute(restart, name, value); });
  const auto grains = static_cast<hsize_t>(state.position.cols());
  put_dataset(restart, "position", H5T_IEEE_F64LE, state.position.data(), {grains, 3});
  put_dataset(restart, "velocity", H5T_IEEE_F64LE, state.velocity.data(), {grains, 3});
  put_cell(restart, checkpoint.cell);
}

void require_sound(const Checkpoint& c) {
  const auto reject = [](const std::string& why) {
    throw std::invalid_argument("a checkpoint cannot be written: " + why);
  };
  if (c.state.position.cols() != c.state.velocity.cols()) {
    reject("the numbers of velocities and positions differ");
  }
  if (!c.state.position.allFinite() || !c.state.velocity.allFinite()) {
    reject("a position or velocity is not finite");
  }
  for (const WallGrain& grain : c.cell.wall_grains) {
    if (!grain.position.allFinite()) reject("the position of a wall grain is not finite");
  }
  const auto require_finite = [&](const std::string& name, double value) {
    if (!std::isfinite(value)) reject(name + " is not finite");
  };
  restart_numbers(c, require_finite);
  cell_numbers(c.cell, require_finite);
  if (c.observables.size() > StoreLimits::observables) reject("there are too many observables");
  for (const auto& [name, value] : c.observables) {
    if (name.empty() || name.size() > StoreLimits::text || name == "." ||
        name.find_first_of(std::string("/\0", 2)) != name.npos) {
      reject("'" + name + "' is not a valid name of an observable");
    }
    require_finite("observable " + name, value);
  }
}

/// The bytes of the file, with zeros in place of the frame (hdf5::kFrameSize bytes).
std::vector<std::byte> framed_image(const Handle& file) {
  require(H5Fflush(file.get(), H5F_SCOPE_GLOBAL), "the buffers");
  const ssize_t size = H5Fget_file_image(file.get(), nullptr, 0);
  if (size <= 0) require(-1, "the image");
  std::vector<std::byte> image(hdf5::kFrameSize + static_cast<std::size_t>(size));
  const ssize_t got = H5Fget_file_image(file.get(), image.data() + hdf5::kFrameSize,
                                        static_cast<std::size_t>(size));
  if (got != size) require(-1, "the image");
  return image;
}

Eigen::Matrix3Xd vectors(const Object& group, const std::string& name) {
  const std::vector<double> data = group.numbers(name, 3);
  return Eigen::Map<const Eigen::Matrix3Xd>(data.data(), 3,
                                            static_cast<Eigen::Index>(data.size() / 3));
}

Cell read_cell(const Object& group) {
  Cell cell;
  cell_numbers(cell, [&](const char* name, double& value) { value = group.number(name); });
  const std::uint64_t moving = group.count("moving");
  if (moving > 1) refuse("/restart/cell/moving", "does not name a wall");
  cell.moving = static_cast<MovingWall>(moving);
  const auto side = group.bytes("wall_grain_side");
  const Eigen::Matrix3Xd position = vectors(group, "wall_grain_position");
  if (static_cast<std::size_t>(position.cols()) != side.size()) {
    refuse("/restart/cell/wall_grain_position", "does not have as many rows as wall_grain_side");
  }
  for (std::size_t i = 0; i < side.size(); ++i) {
    if (side[i] > 3) refuse("/restart/cell/wall_grain_side", "does not name a wall");
    cell.wall_grains.push_back(
        {static_cast<WallSide>(side[i]), position.col(static_cast<Eigen::Index>(i))});
  }
  return cell;
}

void read_restart(const Object& restart, Checkpoint& checkpoint) {
  if (restart.count("format") != hdf5::kRestartFormat) {
    refuse("/restart/format", "has an unknown format; use the shearcell version that wrote it");
  }
  State& state = checkpoint.state;
  checkpoint.run = restart.text("run");
  state.step = restart.count("step");
  restart_numbers(checkpoint,
                  [&](const char* name, double& value) { value = restart.number(name); });
  state.position = vectors(restart, "position");
  state.velocity = vectors(restart, "velocity");
  if (state.position.cols() != state.velocity.cols()) {
    refuse("/restart/velocity", "does not have as many rows as position");
  }
  checkpoint.cell = read_cell(restart.child("cell"));
}

}  // namespace

std::vector<std::byte> encode_checkpoint(const Checkpoint& checkpoint) {
  require_sound(checkpoint);
  std::vector<std::byte> image;
  try {
    constexpr std::size_t about = 3 * 256;  // [bytes per grain], for three copies of the file
    const hdf5::Library library(about * static_cast<std::size_t>(checkpoint.state.position.cols()));
    const Handle access(require(H5Pcreate(H5P_FILE_ACCESS), "a property list"), H5Pclose);
    require(H5Pset_fapl_core(access.get(), 1 << 20, false), "a memory file");
    // Selects the oldest version of the superblock, which has no checksum. In newer versions,
    // HDF5 1.10 writes a wrong checksum.
    require(H5Pset_libver_bounds(access.get(), H5F_LIBVER_EARLIEST, H5F_LIBVER_V18), "version");
    const Handle creation = creation_list(H5P_FILE_CREATE);
    require(H5Pset_userblock(creation.get(), hdf5::kFrameSize), "a user block");
    const Handle file(require(H5Fcreate("checkpoint", H5F_ACC_TRUNC, creation.get(), access.get()),
                              "a memory file"),
                      H5Fclose);
    // H5MD requires the version of the creator. The layout version is written instead of the
    // program version, so that equal states give equal bytes in every release.
    hdf5::put_h5md(file, std::to_string(hdf5::kRestartFormat));
    put_particles(file, checkpoint);
    put_observables(file, checkpoint);
    put_restart(file, checkpoint);
    image = framed_image(file);
  } catch (const std::runtime_error&) {
    if (const auto no_memory = std::get_new_handler()) no_memory();
    throw std::bad_alloc();  // the file exists only in memory, so the cause is a lack of memory
  }
  const std::string frame =
      hdf5::frame_text(sha256_hex(std::span(image).subspan(hdf5::kFrameSize)));
  std::memcpy(image.data(), frame.data(), frame.size());
  return image;
}

Checkpoint decode_checkpoint(std::span<const std::byte> image) {
  const std::string_view text(reinterpret_cast<const char*>(image.data()), image.size());
  if (image.size() <= hdf5::kFrameSize || !text.starts_with(hdf5::kFrameTitle)) {
    refuse("file", "it is not a checkpoint of a known version");
  }
  const Object top = Object::root(image.subspan(hdf5::kFrameSize));
  Checkpoint checkpoint;
  read_restart(top.child("restart"), checkpoint);
  const Object observables = top.child("observables");
  for (const std::string& name : observables.names()) {
    const std::vector<double> value = observables.child(name).numbers("value", 0);
    if (value.size() != 1) refuse("/observables/" + name + "/value", "is not one number");
    checkpoint.observables[name] = value[0];
  }
  return checkpoint;
}

void require_plausible(const Checkpoint& checkpoint) {
  constexpr double kFarthest = 1e9;  // [d]; grains may drift along the periodic direction
  constexpr double kSteepest = 1.5;  // [rad]
  const Cell& cell = checkpoint.cell;
  if (!(cell.width > 0 && cell.depth > 0)) refuse("/restart/cell", "has no width or no depth");
  for (const double length :
       {cell.width, cell.depth, cell.bottom, cell.top, checkpoint.state.wall_height}) {
    if (std::abs(length) > kLongestCell) refuse("/restart/cell", "has an implausible size");
  }
  // The next two checks limit the memory that periodic images and layers need in an analysis.
  if (cell.depth < 0.1 * cell.width) {
    refuse("/restart/cell", "has a depth of less than a tenth of its width");
  }
  const double moving = checkpoint.state.wall_height;
  const double height =
      std::max({cell.top, cell.bottom, moving}) - std::min({cell.top, cell.bottom, moving});
  const auto grains = static_cast<double>(checkpoint.state.position.cols());
  if (cell.width * cell.depth * height > kLoosestCell * (grains + 100)) {
    refuse("/restart/cell", "is too large for its number of grains");
  }
  if (std::abs(checkpoint.theta) > kSteepest) refuse("/restart/theta", "is not a plausible tilt");
  if (!(checkpoint.state.position.array().abs() <= kFarthest).all()) {
    refuse("/restart/position", "has a grain at an implausible position");
  }
  for (const WallGrain& grain : cell.wall_grains) {
    if (grain.position.cwiseAbs().maxCoeff() > kFarthest) {
      refuse("/restart/cell/wall_grain_position", "has a grain at an implausible position");
    }
  }
}

std::string state_hash(const Checkpoint& checkpoint) {
  const State& state = checkpoint.state;
  const Cell& cell = checkpoint.cell;
  const auto numbers = [](const Eigen::Matrix3Xd& m) {
    return std::as_bytes(std::span(m.data(), static_cast<std::size_t>(m.size())));
  };
  Sha256 sha;
  sha.add("shearcell state 1\n").add_u64(state.step);
  sha.add_u64(static_cast<std::uint64_t>(state.position.cols()));
  sha.add(numbers(state.position)).add(numbers(state.velocity));
  sha.add_f64(state.wall_height).add_f64(state.wall_velocity);
  sha.add_f64(cell.width).add_f64(cell.depth).add_f64(cell.bottom).add_f64(cell.top);
  sha.add_u64(static_cast<std::uint64_t>(cell.moving)).add_u64(cell.wall_grains.size());
  for (const WallGrain& grain : cell.wall_grains) {
    sha.add_u64(static_cast<std::uint64_t>(grain.side));
    for (const double x : grain.position) sha.add_f64(x);
  }
  return sha.hex();
}

}  // namespace shearcell
