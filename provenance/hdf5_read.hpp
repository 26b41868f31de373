// SPDX-License-Identifier: GPL-3.0-or-later
// Reads untrusted HDF5 files with the features that checkpoint.cpp uses. The HDF5 library is not
// used because version 1.10 crashes on some forged files.
//
// The reader supports superblock 0, object headers of version 1 that contain hard links and
// attributes, and contiguous data. What is stored in another way (soft and external links, chunks,
// filters, dense groups, shared types) is rejected or counts as missing. Every address, length and
// count is checked before use. Format:
// https://support.hdfgroup.org/documentation/hdf5/latest/_f_m_t3.html
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <ranges>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace shearcell::hdf5 {

/// The frame of a checkpoint is the HDF5 user block: two lines of text padded with zeros. The frame
/// holds the SHA-256 of all bytes that follow, for readers that do not have the log.
inline constexpr std::size_t kFrameSize = 512;
inline constexpr const char* kFrameTitle = "shearcell checkpoint 1\n";

/// Version of the layout of /restart.
inline constexpr std::uint64_t kRestartFormat = 1;

/// The two lines of text in a frame, without padding. `sha256`: hash of all bytes after the frame.
inline std::string frame_text(const std::string& sha256) {
  return kFrameTitle + ("sha256 of all bytes after the first 512: " + sha256 + "\n");
}

/// Throws StoreDamaged with the message "checkpoint: WHERE: WHY".
[[noreturn]] void refuse(const std::string& where, const std::string& why);

using Bytes = std::span<const std::byte>;

/// A group or a dataset. The bytes of the file must outlive the object. All functions throw
/// StoreDamaged, which names the path within the file.
class Object {
 public:
  /// The root group. `hdf5_part` is a checkpoint file without its frame.
  static Object root(Bytes hdf5_part);

  Object child(const std::string& name) const;
  auto names() const { return std::views::keys(links_); }  ///< of the members of a group, sorted

  // The value of a scalar attribute.
  double number(const std::string& name) const;        ///< a finite number
  std::uint64_t count(const std::string& name) const;  ///< 64 bits, unsigned
  std::string text(const std::string& name) const;     ///< at most 4096 bytes

  // All values of a dataset, row by row. `columns` is the number of columns, or 0 for a
  // one-dimensional dataset. The values that numbers() returns are finite.
  std::vector<double> numbers(const std::string& name, std::uint64_t columns) const;
  std::vector<std::uint8_t> bytes(const std::string& name) const;

 private:
  using Shape = std::optional<std::vector<std::uint64_t>>;
  struct Attribute {
    Bytes type;
    Shape shape;
    Bytes data;
  };
  struct Layout {
    std::uint64_t address, size;
  };

  Object(Bytes file, std::uint64_t address, std::string path);
  [[noreturn]] void fail(const std::string& why) const;
  std::string below(const std::string& name) const { return path_ + "/" + name; }
  Bytes at(std::uint64_t address, std::uint64_t size) const;
  void read_message(std::uint64_t type, Bytes body);
  void read_link(Bytes body);
  void read_attribute(Bytes body);
  void read_layout(Bytes body);
  const Attribute& scalar(const std::string& name) const;
  Bytes word(const std::string& name, std::string_view type) const;
  Bytes values(const std::string& name, std::string_view type, std::uint64_t columns,
               std::size_t bytes_each) const;

  Bytes file_;
  std::string path_;
  std::map<std::string, std::uint64_t> links_;  ///< addresses of the members of a group
  std::map<std::string, Attribute> attributes_;
  Bytes type_;   ///< data type of a dataset
  Shape shape_;  ///< shape of a dataset
  std::optional<Layout> layout_;
};

}  // namespace shearcell::hdf5
