// SPDX-License-Identifier: GPL-3.0-or-later
// Writes groups, attributes and datasets with the HDF5 library. Equal content gives equal bytes.
// Functions throw std::runtime_error, which names the object that could not be written.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace shearcell::hdf5 {

/// A lock for the HDF5 library, which may be built without thread safety. Create a Library object
/// before any call. The library then prints no errors; require() throws an exception instead. The
/// library may crash when memory runs out. So the constructor tests whether `room` bytes can be
/// allocated, and throws std::bad_alloc if not.
class Library {
 public:
  explicit Library(std::size_t room = 0) {
    ::operator delete(::operator new(room + (std::size_t{16} << 20)));
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }

 private:
  static inline std::mutex mutex_;
  const std::scoped_lock<std::mutex> lock_{mutex_};
};

/// Owns an HDF5 identifier. A negative identifier is the result of a failed call.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  hid_t get() const { return id_; }

 private:
  hid_t id_;
  Close close_;
};

using Shape = std::vector<hsize_t>;

/// Returns the result of an HDF5 call. Throws std::runtime_error if the call failed.
inline hid_t require(hid_t result, const std::string& what) {
  if (result < 0) throw std::runtime_error("HDF5 cannot write " + what);
  return result;
}

/// A property list for creating files, groups or datasets without modification times.
inline Handle creation_list(hid_t kind) {
  Handle list(require(H5Pcreate(kind), "a property list"), H5Pclose);
  H5Pset_obj_track_times(list.get(), false);
  if (kind != H5P_DATASET_CREATE) H5Pset_link_creation_order(list.get(), H5P_CRT_ORDER_TRACKED);
  return list;
}

/// Creates a group. If it will have more than 8 links or attributes, pass their number.
inline Handle make_group(const Handle& parent, const std::string& name, std::size_t links = 0,
                         std::size_t attributes = 0) {
  const Handle list = creation_list(H5P_GROUP_CREATE);
  // By default HDF5 uses a heap for more than eight links or attributes. hdf5_read.cpp does not
  // read heaps, and HDF5 1.10 writes uninitialized bytes into heaps.
  if (links > 8) H5Pset_link_phase_change(list.get(), 65535, 0);
  if (attributes > 8) H5Pset_attr_phase_change(list.get(), 65535, 0);
  return {require(H5Gcreate2(parent.get(), name.c_str(), H5P_DEFAULT, list.get(), H5P_DEFAULT),
                  "group " + name),
          H5Gclose};
}

/// A data space of this shape; an empty shape gives a scalar.
inline Handle make_space(const Shape& shape) {
  if (shape.empty()) return {require(H5Screate(H5S_SCALAR), "a scalar"), H5Sclose};
  return {require(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                  "a data space"),
          H5Sclose};
}

inline void put_attribute(const Handle& object, const std::string& name, hid_t type,
                          const void* data, const Shape& shape = {}) {
  const Handle space = make_space(shape);
  const Handle attribute(
      require(H5Acreate2(object.get(), name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
              "attribute " + name),
      H5Aclose);
  require(H5Awrite(attribute.get(), type, data), "attribute " + name);
}

inline void put_attribute(const Handle& object, const std::string& name, double value) {
  put_attribute(object, name, H5T_IEEE_F64LE, &value);
}

inline void put_attribute(const Handle& object, const std::string& name, std::uint64_t value) {
  put_attribute(object, name, H5T_STD_U64LE, &value);
}

/// Splits `cells` into strings of `length` bytes and writes them as one attribute.
inline void put_strings(const Handle& object, const std::string& name, const std::string& cells,
                        std::size_t length, const Shape& shape) {
  const Handle type(require(H5Tcopy(H5T_C_S1), "a text type"), H5Tclose);
  require(H5Tset_size(type.get(), length), "a text type");
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  put_attribute(object, name, type.get(), cells.data(), shape);
}

inline void put_attribute(const Handle& object, const std::string& name, const std::string& text) {
  const std::string cell = text.empty() ? std::string(1, '\0') : text;
  put_strings(object, name, cell, cell.size(), {});
}

/// Writes a contiguous dataset and, unless `unit` is empty, its attribute `unit`. If `data` is
/// null, the caller writes the values later.
inline Handle put_dataset(const Handle& parent, const std::string& name, hid_t type,
                          const void* data, const Shape& shape, const std::string& unit = "") {
  const Handle space = make_space(shape);
  const Handle list = creation_list(H5P_DATASET_CREATE);
  H5Pset_layout(list.get(), H5D_CONTIGUOUS);
  H5Pset_fill_time(list.get(), H5D_FILL_TIME_NEVER);
  Handle dataset(require(H5Dcreate2(parent.get(), name.c_str(), type, space.get(), H5P_DEFAULT,
                                    list.get(), H5P_DEFAULT),
                         "dataset " + name),
                 H5Dclose);
  if (data != nullptr) {
    require(H5Dwrite(dataset.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "dataset " + name);
  }
  if (!unit.empty()) put_attribute(dataset, "unit", unit);
  return dataset;
}

/// Writes the group `h5md` of an H5MD 1.1 file in SI units.
inline void put_h5md(const Handle& file, const std::string& version_of_creator) {
  const Handle h5md = make_group(file, "h5md");
  const int version[2] = {1, 1};
  put_attribute(h5md, "version", H5T_STD_I32LE, version, {2});
  const Handle author = make_group(h5md, "author");
  put_attribute(author, "name", std::string("shearcell"));
  const Handle creator = make_group(h5md, "creator");
  put_attribute(creator, "name", std::string("shearcell"));
  put_attribute(creator, "version", version_of_creator);
  const Handle modules = make_group(h5md, "modules");
  const Handle units = make_group(modules, "units");
  const int units_version[2] = {1, 0};
  put_attribute(units, "version", H5T_STD_I32LE, units_version, {2});
  put_attribute(units, "system", std::string("SI"));
}

/// Writes the H5MD group `box`, periodic along z only. The caller adds the edges.
inline Handle put_h5md_box(const Handle& particles) {
  Handle box = make_group(particles, "box");
  const int dimension = 3;
  put_attribute(box, "dimension", H5T_STD_I32LE, &dimension);
  put_strings(box, "boundary", std::string("none\0\0\0\0none\0\0\0\0periodic", 24), 8, {3});
  return box;
}

}  // namespace shearcell::hdf5
