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
#include <utility>
#include <vector>

namespace shearcell {

/// The objects of one store folder. Several threads and processes may use the folder at the same
/// time: an object appears under its name only when it is complete. Links in the store are not
/// followed.
class ObjectStore {
 public:
  /// The store folder must exist. The first call of put() creates the folder `objects` in it.
  explicit ObjectStore(std::filesystem::path store_folder) : folder_(std::move(store_folder)) {}

  /// Writes the bytes to disk (with fsync) and returns their SHA-256. Keeps an existing object if
  /// it is valid, otherwise replaces it. Throws std::system_error if writing fails. Throws
  /// StoreDamaged if `objects` or the object's subfolder is not a folder but a file or a link.
  std::string put(std::span<const std::byte> bytes);

  /// Reads an object. Throws StoreDamaged, with the file's name, if its size or its hash differs.
  std::vector<std::byte> get(std::string_view sha256, std::uint64_t size) const;

  /// Whether the file of the object exists; its content is not checked.
  bool contains(std::string_view sha256) const;

  /// Deletes the file of an object. Returns false when there was no file. Throws std::system_error.
  bool remove(std::string_view sha256);

  /// Files in `objects` whose digests are not in `known`, including temporary files of interrupted
  /// writes. The paths are relative to the store folder and sorted.
  std::vector<std::string> strangers(const std::set<std::string>& known) const;

  /// The path of an object's file, relative to the store folder.
  static std::string file_of(std::string_view sha256);

 private:
  std::filesystem::path folder_;
};

}  // namespace shearcell
