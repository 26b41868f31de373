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

struct ObjectInfo {
  std::string file;  ///< relative to the store's folder
  std::string sha256;
  std::uint64_t size = 0;  ///< [bytes]
};

/// Below one store folder. Several threads and processes may put and get at the same time: an
/// object appears under its name whole or not at all. No link inside the store is followed.
class ObjectStore {
 public:
  /// The folder must exist; `objects` below it is made by the first put.
  explicit ObjectStore(std::filesystem::path store_folder);

  /// The bytes are on the disk, under their final name, when this returns. An object that is there
  /// already is kept if it is sound and replaced if it is not. Throws std::runtime_error when the
  /// machine fails and StoreDamaged when the folders are not folders.
  ObjectInfo put(std::span<const std::byte> bytes);

  /// Throws StoreDamaged, naming the file, unless it has this size and hash.
  std::vector<std::byte> get(std::string_view sha256, std::uint64_t size) const;

  /// Whether something has the object's name; its bytes are not looked at.
  bool contains(std::string_view sha256) const;

  /// Frees the bytes for good; false when there was no such file. Throws std::system_error.
  bool remove(std::string_view sha256);

  /// Files under `objects` that are not in `known` (SHA-256 digests), temporaries of interrupted
  /// writes included; relative to the store's folder, sorted.
  std::vector<std::string> strangers(const std::set<std::string>& known) const;

  /// Where an object lies, relative to the store's folder.
  static std::string file_of(std::string_view sha256);

 private:
  std::filesystem::path folder_;
};

}  // namespace shearcell
