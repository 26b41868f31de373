// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/sha256.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <stdexcept>

namespace shearcell {

namespace {

static_assert(std::endian::native == std::endian::little,
              "the machine must be little-endian, because little-endian numbers are hashed");

void require_done(int result) {
  if (result != 1) throw std::runtime_error("OpenSSL cannot compute SHA-256 on this machine");
}

}  // namespace

Sha256::Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
  require_done(context_ ? EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) : 0);
}

Sha256& Sha256::add(std::span<const std::byte> data) {
  require_done(EVP_DigestUpdate(context_.get(), data.data(), data.size()));
  return *this;
}

void Sha256::add_field(std::string_view text) {
  add(std::to_string(text.size()) + ":").add(text).add(",");
}

std::string Sha256::hex() {
  std::array<unsigned char, 32> digest;
  require_done(EVP_DigestFinal_ex(context_.get(), digest.data(), nullptr));
  return fmt::format("{:02x}", fmt::join(digest, ""));
}

bool is_sha256_hex(std::string_view text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == text.npos;
}

}  // namespace shearcell
