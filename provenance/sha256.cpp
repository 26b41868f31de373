// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/sha256.hpp"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <bit>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace shearcell {

namespace {

EVP_MD_CTX* evp(void* context) {
  return static_cast<EVP_MD_CTX*>(context);
}

void require(int result) {
  if (result != 1) throw std::runtime_error("OpenSSL does not compute SHA-256 on this machine");
}

}  // namespace

void Sha256::Free::operator()(void* context) const {
  EVP_MD_CTX_free(evp(context));
}

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  require(context_ ? EVP_DigestInit_ex(evp(context_.get()), EVP_sha256(), nullptr) : 0);
}

Sha256& Sha256::add(std::span<const std::byte> data) {
  require(EVP_DigestUpdate(evp(context_.get()), data.data(), data.size()));
  return *this;
}

Sha256& Sha256::add(std::string_view text) {
  return add(std::as_bytes(std::span(text.data(), text.size())));
}

Sha256& Sha256::add_field(std::string_view text) {
  return add(std::to_string(text.size()) + ":").add(text).add(",");
}

Sha256& Sha256::add_u64(std::uint64_t value) {
  std::array<std::byte, 8> bytes;
  for (std::byte& b : bytes) {
    b = static_cast<std::byte>(value & 0xff);
    value >>= 8;
  }
  return add(bytes);
}

Sha256& Sha256::add_f64(double value) {
  return add_u64(std::bit_cast<std::uint64_t>(value));
}

std::string Sha256::hex() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest;
  unsigned int size = 0;
  require(EVP_DigestFinal_ex(evp(context_.get()), digest.data(), &size));
  std::string text;
  text.reserve(64);
  for (unsigned int i = 0; i < size; ++i) {
    text += "0123456789abcdef"[digest[i] >> 4];
    text += "0123456789abcdef"[digest[i] & 15];
  }
  return text;
}

std::string sha256_hex(std::span<const std::byte> data) {
  return Sha256().add(data).hex();
}

std::string sha256_hex(std::string_view text) {
  return Sha256().add(text).hex();
}

std::string sha256_hex_of_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file.string() + ": cannot be opened for reading");
  Sha256 sha;
  std::vector<char> buffer(1 << 20);
  while (in) {
    in.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    sha.add(std::string_view(buffer.data(), static_cast<std::size_t>(in.gcount())));
  }
  if (in.bad()) throw std::runtime_error(file.string() + ": cannot be read");
  return sha.hex();
}

bool is_sha256_hex(std::string_view text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == text.npos;
}

}  // namespace shearcell
