// SPDX-License-Identifier: GPL-3.0-or-later
// Reading the HDF5 that checkpoint.cpp writes, and no other, from bytes that nobody vouches for.
//
// The HDF5 library is not made for hostile files: 1.10 is known to crash on forged ones. A
// checkpoint needs little of the format: superblock 0, object headers of version 1, links and
// attributes kept in them, and data in one plain block each. That much is read here, with every
// address, length and count checked against the file before it is used; whatever else HDF5 allows
// (soft and external links, chunks, filters, dense groups, shared types) is refused.
// Format: https://support.hdfgroup.org/documentation/hdf5/latest/_f_m_t3.html
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace shearcell::hdf5 {

/// A group or a dataset. It refers to the image, which must outlive it. Every function throws
/// StoreDamaged, naming the path within the file, when something is not as it must be.
class Object {
 public:
  using Bytes = std::span<const std::byte>;

  /// The root group of the HDF5 part of a file, which is all of it after `user_block` bytes.
  static Object root(Bytes hdf5_part, std::size_t user_block);

  Object child(const std::string& name) const;
  std::vector<std::string> names() const;  ///< of what is in the group, sorted

  // Attributes that hold one value.
  double number(const std::string& name) const;        ///< finite
  std::uint64_t count(const std::string& name) const;  ///< 64 bits, unsigned
  std::string text(const std::string& name) const;     ///< of fixed length, at most 4096 bytes

  // All values of a dataset with this many columns (0: a plain list), row by row.
  std::vector<double> numbers(const std::string& name, std::uint64_t columns) const;
  std::vector<std::uint8_t> bytes(const std::string& name) const;

 private:
  struct Link {
    std::uint64_t address = 0;
    bool hard = true;
  };
  struct Attribute {
    Bytes type, space, data;
  };
  struct Layout {
    std::uint64_t address, size;
  };

  Object(Bytes file, std::uint64_t address, std::string path);
  [[noreturn]] void fail(const std::string& why) const;
  std::string below(const std::string& name) const { return path_ + "/" + name; }
  Bytes at(std::uint64_t address, std::uint64_t size) const;
  void read_block(Bytes block, std::vector<Bytes>& blocks, std::uint64_t& messages);
  void read_message(unsigned type, Bytes body);
  void read_link(Bytes body);
  void read_attribute(Bytes body);
  void read_layout(Bytes body);
  Bytes attribute(const std::string& name, std::string_view type, std::size_t size) const;
  Bytes values(const std::string& name, std::string_view type, std::uint64_t columns,
               std::size_t bytes_each) const;

  Bytes file_;
  std::string path_;
  std::map<std::string, Link> links_;
  std::map<std::string, Attribute> attributes_;
  std::optional<Bytes> type_, space_;  ///< of a dataset
  std::optional<Layout> layout_;
  bool plain_ = true;  ///< no filter, no external file, no dense storage
};

}  // namespace shearcell::hdf5
