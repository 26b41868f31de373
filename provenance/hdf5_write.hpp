// SPDX-License-Identifier: GPL-3.0-or-later
// Writing groups, attributes and datasets so that equal content gives equal bytes. Each throws
// std::runtime_error that names what HDF5 could not write.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "provenance/hdf5_handle.hpp"

namespace shearcell::hdf5 {

using Shape = std::vector<hsize_t>;

/// The result of a call, when it did not fail.
hid_t require(hid_t result, const std::string& what);

/// Property list for creating files, groups or datasets without times of writing.
Handle creation_list(hid_t kind);

/// For so many members.
Handle make_group(const Handle& parent, const std::string& name, std::size_t links = 0);

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
