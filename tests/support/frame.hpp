// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "provenance/sha256.hpp"

namespace shearcell::test {

constexpr std::size_t kFrame = 512;  ///< bytes before a checkpoint's HDF5

/// Puts the frame of a checkpoint, with the right SHA-256, before the bytes. Replaces a frame that
/// they have.
inline std::vector<std::byte> sealed(std::span<const std::byte> bytes) {
  const std::string title = "shearcell checkpoint 1\n";
  const std::size_t frame = std::min(bytes.size(), kFrame);
  if (frame >= title.size() && std::memcmp(bytes.data(), title.data(), title.size()) == 0) {
    bytes = bytes.subspan(frame);
  }
  std::string text = title + "sha256 of all bytes after the first 512: ";
  text += sha256_hex(bytes);
  text += '\n';
  std::vector<std::byte> image(kFrame);
  std::memcpy(image.data(), text.data(), text.size());
  image.insert(image.end(), bytes.begin(), bytes.end());
  return image;
}

}  // namespace shearcell::test
