// SPDX-License-Identifier: GPL-3.0-or-later
// Reading a checkpoint from bytes that nobody vouches for: each claim is checked before it is used.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "provenance/checkpoint.hpp"
#include "provenance/errors.hpp"
#include "provenance/hdf5_handle.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {

namespace {

using hdf5::Handle;

constexpr std::uint64_t kMostGrains = 100'000'000;
constexpr hsize_t kMostObservables = 10'000;
constexpr std::size_t kLongestText = 4096;

[[noreturn]] void fail(const std::string& where, const std::string& why) {
  throw StoreDamaged("checkpoint: " + where + ": " + why);
}

/// Opens what a hard link names. Soft and external links could lead to another file.
Handle open_object(const Handle& parent, const std::string& name, const std::string& path,
                   H5I_type_t kind) {
  H5L_info_t link;
  if (H5Lget_info(parent.get(), name.c_str(), &link, H5P_DEFAULT) < 0) fail(path, "is missing");
  if (link.type != H5L_TYPE_HARD) fail(path, "is a link to elsewhere");
  Handle object(H5Oopen(parent.get(), name.c_str(), H5P_DEFAULT), H5Oclose);
  if (!object.valid()) fail(path, "cannot be opened");
  if (H5Iget_type(object.get()) != kind) fail(path, "is not the kind of object expected there");
  return object;
}

void require_type(const Handle& type, hid_t expected, const std::string& path) {
  if (!type.valid() || H5Tequal(type.get(), expected) <= 0) fail(path, "has another number type");
}

/// Reads below one group, and knows how large the file is.
class Group {
 public:
  Group(Handle handle, std::string path, std::size_t file_size)
      : handle_(std::move(handle)), path_(std::move(path)), file_size_(file_size) {}

  Group group(const std::string& name) const {
    return {open_object(handle_, name, path(name), H5I_GROUP), path(name), file_size_};
  }

  double number(const std::string& name) const {
    double value = 0;
    read_attribute(name, H5T_IEEE_F64LE, &value);
    if (!std::isfinite(value)) fail(path(name), "is not finite");
    return value;
  }

  std::uint64_t count(const std::string& name) const {
    std::uint64_t value = 0;
    read_attribute(name, H5T_STD_U64LE, &value);
    return value;
  }

  std::string text(const std::string& name) const {
    const Handle attribute = open_scalar(name);
    const Handle type(H5Aget_type(attribute.get()), H5Tclose);
    if (!type.valid() || H5Tget_class(type.get()) != H5T_STRING ||
        H5Tis_variable_str(type.get()) != 0) {
      fail(path(name), "is not a text of fixed length");
    }
    const std::size_t length = H5Tget_size(type.get());
    if (length == 0 || length > kLongestText) fail(path(name), "is too long");
    std::string value(length, '\0');
    if (H5Aread(attribute.get(), type.get(), value.data()) < 0) fail(path(name), "is unreadable");
    return value.substr(0, value.find('\0'));
  }

  /// All values of a dataset with this many columns (0: a plain list), row by row.
  template <typename Number>
  std::vector<Number> table(const std::string& name, hid_t type, hsize_t columns) const {
    const Handle dataset = open_object(handle_, name, path(name), H5I_DATASET);
    require_type(Handle(H5Dget_type(dataset.get()), H5Tclose), type, path(name));
    const hsize_t values = size_of(dataset, name, columns, sizeof(Number));
    std::vector<Number> data(values);
    if (values > 0 &&
        H5Dread(dataset.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data()) < 0) {
      fail(path(name), "is unreadable");
    }
    return data;
  }

  Eigen::Matrix3Xd vectors(const std::string& name) const {
    const std::vector<double> data = table<double>(name, H5T_IEEE_F64LE, 3);
    if (!std::all_of(data.begin(), data.end(), [](double x) { return std::isfinite(x); })) {
      fail(path(name), "holds a number that is not finite");
    }
    return Eigen::Map<const Eigen::Matrix3Xd>(data.data(), 3,
                                              static_cast<Eigen::Index>(data.size() / 3));
  }

  std::vector<std::string> names() const {
    H5G_info_t info;
    if (H5Gget_info(handle_.get(), &info) < 0) fail(path_, "is unreadable");
    if (info.nlinks > kMostObservables) fail(path_, "holds too many entries");
    std::vector<std::string> found;
    for (hsize_t i = 0; i < info.nlinks; ++i) {
      const ssize_t length = H5Lget_name_by_idx(handle_.get(), ".", H5_INDEX_NAME, H5_ITER_INC, i,
                                                nullptr, 0, H5P_DEFAULT);
      if (length <= 0 || static_cast<std::size_t>(length) > kLongestText) {
        fail(path_, "holds a bad name");
      }
      std::string name(static_cast<std::size_t>(length), '\0');
      H5Lget_name_by_idx(handle_.get(), ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(),
                         name.size() + 1, H5P_DEFAULT);
      found.push_back(std::move(name));
    }
    return found;
  }

 private:
  std::string path(const std::string& name) const { return path_ + "/" + name; }

  Handle open_scalar(const std::string& name) const {
    if (H5Aexists(handle_.get(), name.c_str()) <= 0) fail(path(name), "is missing");
    Handle attribute(H5Aopen(handle_.get(), name.c_str(), H5P_DEFAULT), H5Aclose);
    if (!attribute.valid()) fail(path(name), "cannot be opened");
    const Handle space(H5Aget_space(attribute.get()), H5Sclose);
    if (!space.valid() || H5Sget_simple_extent_type(space.get()) != H5S_SCALAR) {
      fail(path(name), "is not a single value");
    }
    return attribute;
  }

  void read_attribute(const std::string& name, hid_t type, void* value) const {
    const Handle attribute = open_scalar(name);
    require_type(Handle(H5Aget_type(attribute.get()), H5Tclose), type, path(name));
    if (H5Aread(attribute.get(), type, value) < 0) fail(path(name), "is unreadable");
  }

  /// Number of values, once the shape is the expected one and the values lie in this very file.
  hsize_t size_of(const Handle& dataset, const std::string& name, hsize_t columns,
                  std::size_t bytes_each) const {
    const Handle list(H5Dget_create_plist(dataset.get()), H5Pclose);
    if (!list.valid() || H5Pget_layout(list.get()) != H5D_CONTIGUOUS ||
        H5Pget_external_count(list.get()) != 0 || H5Pget_nfilters(list.get()) != 0) {
      fail(path(name), "is not stored as one plain block of this file");
    }
    const Handle space(H5Dget_space(dataset.get()), H5Sclose);
    const int rank = columns == 0 ? 1 : 2;
    hsize_t shape[2] = {0, 1};
    if (!space.valid() || H5Sget_simple_extent_ndims(space.get()) != rank ||
        H5Sget_simple_extent_dims(space.get(), shape, nullptr) != rank ||
        (columns != 0 && shape[1] != columns)) {
      fail(path(name), "has another shape");
    }
    if (shape[0] > kMostGrains) fail(path(name), "claims too many rows");
    const hsize_t values = shape[0] * shape[1];
    if (values * bytes_each > file_size_) fail(path(name), "claims more bytes than the file has");
    if (values > 0 && H5Dget_storage_size(dataset.get()) != values * bytes_each) {
      fail(path(name), "does not have the bytes that it claims");
    }
    return values;
  }

  Handle handle_;
  std::string path_;
  std::size_t file_size_;
};

void require_frame(std::span<const std::byte> image) {
  if (image.size() <= hdf5::kFrameSize) fail("file", "it is cut short");
  const std::string_view frame(reinterpret_cast<const char*>(image.data()), hdf5::kFrameSize);
  if (!frame.starts_with(hdf5::kFrameTitle)) {
    fail("file", "it does not begin as a checkpoint of this version does");
  }
  std::string expected = hdf5::frame_text(sha256_hex(image.subspan(hdf5::kFrameSize)));
  expected.resize(hdf5::kFrameSize, '\0');
  if (frame != expected) fail("file", "it is cut short or changed: its SHA-256 does not fit");
}

Cell read_cell(const Group& group) {
  Cell cell;
  cell.width = group.number("width");
  cell.depth = group.number("depth");
  cell.bottom = group.number("bottom");
  cell.top = group.number("top");
  const std::uint64_t moving = group.count("moving");
  if (moving > 1) fail("/restart/cell/moving", "names no wall");
  cell.moving = static_cast<MovingWall>(moving);
  const auto side = group.table<std::uint8_t>("wall_grain_side", H5T_STD_U8LE, 0);
  const Eigen::Matrix3Xd position = group.vectors("wall_grain_position");
  if (static_cast<std::size_t>(position.cols()) != side.size()) {
    fail("/restart/cell/wall_grain_position", "has another length than wall_grain_side");
  }
  for (std::size_t i = 0; i < side.size(); ++i) {
    if (side[i] > 3) fail("/restart/cell/wall_grain_side", "names no wall");
    cell.wall_grains.push_back(
        {static_cast<WallSide>(side[i]), position.col(static_cast<Eigen::Index>(i))});
  }
  return cell;
}

void read_restart(const Group& restart, Checkpoint& checkpoint) {
  if (restart.count("format") != hdf5::kRestartFormat) {
    fail("/restart/format", "this program does not know the format; use the one that wrote it");
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
  checkpoint.state.position = restart.vectors("position");
  checkpoint.state.velocity = restart.vectors("velocity");
  if (checkpoint.state.position.cols() != checkpoint.state.velocity.cols()) {
    fail("/restart/velocity", "has another length than position");
  }
  checkpoint.cell = read_cell(restart.group("cell"));
}

}  // namespace

Checkpoint decode_checkpoint(std::span<const std::byte> image) {
  require_frame(image);
  const std::scoped_lock lock(hdf5::library_mutex());
  const hdf5::Quiet quiet;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  // HDF5 copies the image, although it takes a pointer to non-const.
  void* bytes = const_cast<std::byte*>(image.data());
  if (H5Pset_fapl_core(access.get(), 1 << 20, false) < 0 ||
      H5Pset_file_image(access.get(), bytes, image.size()) < 0) {
    throw std::runtime_error("HDF5 cannot hold a checkpoint in memory");
  }
  const Handle file(H5Fopen("checkpoint", H5F_ACC_RDONLY, access.get()), H5Fclose);
  if (!file.valid()) fail("file", "HDF5 cannot read it");
  Handle root(H5Gopen2(file.get(), "/", H5P_DEFAULT), H5Gclose);
  if (!root.valid()) fail("/", "cannot be opened");
  const Group top(std::move(root), "", image.size());

  Checkpoint checkpoint;
  read_restart(top.group("restart"), checkpoint);
  const Group observables = top.group("observables");
  for (const std::string& name : observables.names()) {
    const auto value = observables.group(name).table<double>("value", H5T_IEEE_F64LE, 0);
    if (value.size() != 1 || !std::isfinite(value[0])) {
      fail("/observables/" + name + "/value", "is not one finite number");
    }
    checkpoint.observables[name] = value[0];
  }
  return checkpoint;
}

}  // namespace shearcell
