// SPDX-License-Identifier: GPL-3.0-or-later
// SHA-256, the one hash of the store; digests are written as 64 lower-case hex digits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace shearcell {

/// Takes data piece by piece. Throws std::runtime_error when OpenSSL refuses (as in a FIPS build
/// without SHA-256), which leaves nothing for the caller to do.
class Sha256 {
 public:
  Sha256();
  Sha256& add(std::span<const std::byte> data);
  Sha256& add(std::string_view text);
  /// Eight bytes, least significant first, on every machine.
  Sha256& add_u64(std::uint64_t value);
  /// The bits of the number: -0.0 and 0.0 differ.
  Sha256& add_f64(double value);
  /// The digest of all that was added. The hasher is spent afterwards.
  std::string hex();

 private:
  struct Free {
    void operator()(void* context) const;
  };
  std::unique_ptr<void, Free> context_;
};

std::string sha256_hex(std::span<const std::byte> data);
std::string sha256_hex(std::string_view text);

/// Of a whole file, read in pieces. Throws std::runtime_error when it cannot be read.
std::string sha256_hex_of_file(const std::filesystem::path& file);

/// Whether the text is a digest as written here: 64 lower-case hex digits.
bool is_sha256_hex(std::string_view text);

}  // namespace shearcell
