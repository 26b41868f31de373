// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "provenance/hdf5_read.hpp"
#include "provenance/sha256.hpp"

namespace shearcell::test {

constexpr std::size_t kFrame = hdf5::kFrameSize;

/// Puts the frame of a checkpoint, with the right SHA-256, before the bytes. Replaces a frame that
/// they have.
inline std::vector<std::byte> sealed(std::span<const std::byte> bytes) {
  const std::string_view title = hdf5::kFrameTitle;
  const std::size_t frame = std::min(bytes.size(), kFrame);
  if (frame >= title.size() && std::memcmp(bytes.data(), title.data(), title.size()) == 0) {
    bytes = bytes.subspan(frame);
  }
  const std::string text = hdf5::frame_text(sha256_hex(bytes));
  std::vector<std::byte> image(kFrame);
  std::memcpy(image.data(), text.data(), text.size());
  image.insert(image.end(), bytes.begin(), bytes.end());
  return image;
}

}  // namespace shearcell::test
