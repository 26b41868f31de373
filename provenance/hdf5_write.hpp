// SPDX-License-Identifier: GPL-3.0-or-later
// Writes groups, attributes and datasets with the HDF5 library; equal content gives equal bytes.
// Functions throw std::runtime_error, which names the object that could not be written.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace shearcell::hdf5 {

/// To be held around all calls of the library, which may be built without thread safety. From then
/// on the library does not print errors; they are reported as exceptions.
class Library {
 public:
  Library() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

 private:
  static inline std::mutex mutex_;
  const std::scoped_lock<std::mutex> lock_{mutex_};
};

/// Owns an HDF5 identifier; a negative one is the result of a failed call.
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

/// Returns the result of a call; throws if it failed.
hid_t require(hid_t result, const std::string& what);

/// Property list for creating files, groups or datasets without modification times.
Handle creation_list(hid_t kind);

/// `links` and `attributes`: how many it will have, if more than 8.
Handle make_group(const Handle& parent, const std::string& name, std::size_t links = 0,
                  std::size_t attributes = 0);

/// A scalar when the shape is empty.
Handle make_space(const Shape& shape);

void put_attribute(const Handle& object, const std::string& name, hid_t type, const void* data,
                   const Shape& shape = {});
void put_attribute(const Handle& object, const std::string& name, double value);
void put_attribute(const Handle& object, const std::string& name, std::uint64_t value);
void put_attribute(const Handle& object, const std::string& name, const std::string& text);

/// Strings of one fixed length, cells.size() / length of them.
void put_strings(const Handle& object, const std::string& name, const std::string& cells,
                 std::size_t length, const Shape& shape);

/// Contiguous; `unit` becomes its attribute of that name unless empty. Without `data` it is left to
/// be written later.
Handle put_dataset(const Handle& parent, const std::string& name, hid_t type, const void* data,
                   const Shape& shape, const std::string& unit = "");

}  // namespace shearcell::hdf5
