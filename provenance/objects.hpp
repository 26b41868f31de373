// SPDX-License-Identifier: GPL-3.0-or-later
// Immutable files named by the SHA-256 of their bytes: objects/ab/<sha256>.h5.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace shearcell {

/// The objects of one store folder. Several threads and processes may use it at the same time: an
/// object appears under its name complete or not at all. Links inside the store are not followed.
class ObjectStore {
 public:
  /// The folder must exist; the first put creates `objects` in it.
  explicit ObjectStore(std::filesystem::path store_folder);

  /// Writes the bytes and returns their SHA-256; the object is then on the disk. An existing object
  /// is kept if it is valid, else replaced. Throws std::system_error, and StoreDamaged when
  /// `objects` or a folder in it is not a folder.
  std::string put(std::span<const std::byte> bytes);

  /// Throws StoreDamaged, which names the file, unless it has this size and hash.
  std::vector<std::byte> get(std::string_view sha256, std::uint64_t size) const;

  /// Whether a file of this name exists; its content is not checked.
  bool contains(std::string_view sha256) const;

  /// Deletes the file; false when it did not exist. Throws std::system_error.
  bool remove(std::string_view sha256);

  /// Files below `objects` that are not in `known` (SHA-256 digests), including temporary files of
  /// interrupted writes; relative to the store's folder, sorted.
  std::vector<std::string> strangers(const std::set<std::string>& known) const;

  /// The path of an object, relative to the store's folder.
  static std::string file_of(std::string_view sha256);

 private:
  std::filesystem::path folder_;
};

}  // namespace shearcell
