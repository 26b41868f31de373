// SPDX-License-Identifier: GPL-3.0-or-later
// SHA-256, the only hash function of the store. Digests are written as 64 lower-case hex digits.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct evp_md_ctx_st;  // OpenSSL's EVP_MD_CTX

namespace shearcell {

/// Hashes data that is added in parts. Throws std::runtime_error when OpenSSL has no SHA-256.
class Sha256 {
 public:
  Sha256();
  Sha256& add(std::span<const std::byte> data);
  Sha256& add(std::string_view text) { return add(std::as_bytes(std::span(text))); }
  /// Adds each field as a netstring, "<length in bytes>:<text>,", so that different fields cannot
  /// give the same bytes. Numbers are written in decimal.
  template <class... Fields>
  Sha256& add_fields(const Fields&... fields) {
    (add_field(fields), ...);
    return *this;
  }
  /// Adds the eight bytes of a number, least significant first. The doubles 0.0 and -0.0 have
  /// different bytes.
  Sha256& add_u64(std::uint64_t value) { return add(std::as_bytes(std::span(&value, 1))); }
  Sha256& add_f64(double value) { return add_u64(std::bit_cast<std::uint64_t>(value)); }
  /// The digest of all added data. The object cannot be used afterwards.
  std::string hex();

 private:
  void add_field(std::string_view text);
  void add_field(std::uint64_t number) { add_field(std::to_string(number)); }

  std::unique_ptr<evp_md_ctx_st, void (*)(evp_md_ctx_st*)> context_;
};

/// The SHA-256 of bytes or of a text.
std::string sha256_hex(const auto& data) {
  return Sha256().add(data).hex();
}

/// Whether the text is 64 lower-case hex digits.
bool is_sha256_hex(std::string_view text);

}  // namespace shearcell
