// SPDX-License-Identifier: GPL-3.0-or-later
// derived.sqlite: a cache of results that were computed from checkpoints. The cache is not part of
// the log and may be deleted at any time.
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

/// The key of a derived object (a stored measure): everything that determines its content.
struct DerivedKey {
  std::string checkpoint;     ///< SHA-256 of the checkpoint's file
  std::string measure;        ///< name and parameters of the computation
  std::uint64_t version = 0;  ///< version of the code that computes the measure
};

struct DerivedObject {
  DerivedKey key;
  std::vector<std::byte> content;
};

/// Short digests of the derived objects of one checkpoint. A key of the map has the form WORD-HASH:
/// the first word of DerivedKey::measure, and a short hash of `measure` and `version`. When a
/// checkpoint is pruned, the log stores the digests of its measures, because these measures cannot
/// be computed again.
using Digests = std::map<std::string, std::string>;
/// The entry of one object in Digests.
Digests::value_type digest_entry(const DerivedObject& object);

/// The derived objects of one store. Not thread-safe; several processes may use one store.
///
/// A damaged file never causes an exception. An object is not returned if it is damaged or was
/// moved to another key. A file that is not a valid database is renamed and replaced. If
/// nothing can be stored (no space, no permission, a foreign file), trouble() gives the reason.
class DerivedCache {
 public:
  /// With Access::read nothing is created, replaced or stored.
  explicit DerivedCache(const std::filesystem::path& store_folder, Access access = Access::create);

  /// Contents of the objects, in the order of `keys`; nothing for an object that is not stored.
  std::vector<std::optional<std::vector<std::byte>>> get(std::span<const DerivedKey> keys);

  /// The digests of the undamaged objects of the checkpoint. With `damaged_too`, the result also
  /// has the value "" for each damaged object. Empty if the cache cannot be read.
  Digests digests(const std::string& checkpoint, bool damaged_too = false);

  /// Stores all objects or, after an error, none. Replaces objects with the same keys.
  void put(std::span<const DerivedObject> objects);

  /// Deletes all objects of the checkpoint.
  void forget(const std::string& checkpoint);

  /// Why nothing can be stored; "" if objects can be stored.
  const std::string& trouble() const { return trouble_; }
  /// Whether reading or writing failed for a reason outside the file, such as a full disk.
  bool is_unread() const { return unread_; }
  /// A warning if a damaged file was ever renamed and replaced; otherwise "".
  std::string replaced() const;

  static constexpr const char* kFile = "derived.sqlite";

 private:
  /// Opens the file if it is not open and calls `work`. If the file is damaged, replaces the file
  /// and calls `work` a second time.
  template <typename Work>
  void attempt(Work&& work);
  void open();

  std::filesystem::path file_;
  bool read_only_;
  std::optional<sqlite::Database> database_;
  std::string trouble_;
  bool unread_ = false;
};

}  // namespace shearcell
