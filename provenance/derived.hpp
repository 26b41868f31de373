// SPDX-License-Identifier: GPL-3.0-or-later
// What was computed from checkpoints, kept so that it need not be computed again: derived.sqlite.
// Not part of the record: it may be deleted at any time, and nothing in it is trusted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "provenance/sqlite.hpp"

namespace shearcell {

/// Says wholly what an object is computed from.
struct DerivedKey {
  std::string checkpoint;     ///< SHA-256 of the checkpoint's file
  std::string measure;        ///< what was computed and with which parameters, as a text
  std::uint64_t version = 0;  ///< of the code that computes it
};

struct DerivedObject {
  DerivedKey key;
  std::vector<std::byte> content;
};

/// Derived objects of one store. For one thread at a time; several processes may use one store.
///
/// No function throws for what the file is: an object that is missing, damaged or stands for
/// another key is not given, a file that is no sound database is begun anew, and where nothing can
/// be kept (no space, no permission, a foreign file) `trouble` says why and nothing is.
class DerivedCache {
 public:
  explicit DerivedCache(const std::filesystem::path& store_folder);

  /// In the order of `keys`; nothing for those that are not kept.
  std::vector<std::optional<std::vector<std::byte>>> get(std::span<const DerivedKey> keys);

  /// Keeps all or none; replaces what has the same key.
  void put(std::span<const DerivedObject> objects);

  /// Why nothing is kept; "" when all is well.
  const std::string& trouble() const { return trouble_; }

  static constexpr const char* kFile = "derived.sqlite";

 private:
  template <typename Work>
  void attempt(Work&& work);
  void open();
  void start_over();
  void give_up(const std::string& why);

  std::filesystem::path file_;
  std::optional<sqlite::Database> database_;
  std::string trouble_;
};

}  // namespace shearcell
