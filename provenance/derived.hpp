// SPDX-License-Identifier: GPL-3.0-or-later
// A cache of results computed from checkpoints: derived.sqlite. It is not part of the record and
// may be deleted at any time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "provenance/sqlite.hpp"

namespace shearcell {

/// Everything that determines an object.
struct DerivedKey {
  std::string checkpoint;     ///< SHA-256 of the checkpoint's file
  std::string measure;        ///< name of the computation with its parameters
  std::uint64_t version = 0;  ///< of the code that computes it
};

struct DerivedObject {
  DerivedKey key;
  std::vector<std::byte> content;
};

/// Short digests of objects of one checkpoint, by the first word of the measure and a short hash of
/// measure and version. The log holds the digests of pruned checkpoints, whose measures cannot be
/// computed again.
using Digests = std::map<std::string, std::string>;
/// The entry of one object.
Digests::value_type digest_entry(const DerivedObject& object);

/// Derived objects of one store. For one thread at a time; several processes may use one store.
///
/// The content of the file never causes an exception: an object that is missing, damaged or stored
/// under another key is not returned, and a file that is not a valid database is renamed and
/// replaced. If nothing can be stored (no space, no permission, a foreign file), `trouble` gives
/// the reason.
class DerivedCache {
 public:
  /// With Access::read nothing is created, replaced or stored.
  explicit DerivedCache(const std::filesystem::path& store_folder, Access access = Access::create);

  /// Contents in the order of `keys`; nothing for objects that are not stored.
  std::vector<std::optional<std::vector<std::byte>>> get(std::span<const DerivedKey> keys);

  /// The digests of all objects of a checkpoint, unchecked; empty if the file cannot be read.
  Digests digests(const std::string& checkpoint);

  /// Stores all or none; replaces objects with the same key.
  void put(std::span<const DerivedObject> objects);

  /// Why nothing can be stored; "" without trouble.
  const std::string& trouble() const { return trouble_; }
  /// Names the damaged file that was renamed and replaced, now or earlier; "" without one.
  std::string replaced() const;

  static constexpr const char* kFile = "derived.sqlite";

 private:
  /// Opens the file if it is not open and does the work. If the file is damaged, does the work once
  /// more with a new file.
  template <typename Work>
  void attempt(Work&& work);
  void open();

  std::filesystem::path file_;
  bool read_only_;
  std::optional<sqlite::Database> database_;
  std::string trouble_;
};

}  // namespace shearcell
