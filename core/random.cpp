// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/random.hpp"

namespace shearcell {

std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> c,
                                        std::array<std::uint32_t, 2> key) {
  constexpr std::uint64_t kMultiplier0 = 0xD2511F53;
  constexpr std::uint64_t kMultiplier1 = 0xCD9E8D57;
  constexpr std::uint32_t kWeyl0 = 0x9E3779B9;
  constexpr std::uint32_t kWeyl1 = 0xBB67AE85;
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = kMultiplier0 * c[0];
    const std::uint64_t p1 = kMultiplier1 * c[2];
    c = {static_cast<std::uint32_t>(p1 >> 32) ^ c[1] ^ key[0], static_cast<std::uint32_t>(p1),
         static_cast<std::uint32_t>(p0 >> 32) ^ c[3] ^ key[1], static_cast<std::uint32_t>(p0)};
    key[0] += kWeyl0;
    key[1] += kWeyl1;
  }
  return c;
}

std::array<double, 2> uniform_pair(std::array<std::uint32_t, 4> counter, std::uint64_t seed) {
  const auto bits = philox4x32(
      counter, {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
  const auto to_unit = [](std::uint32_t high, std::uint32_t low) {
    const std::uint64_t word = (std::uint64_t{high} << 32) | low;
    return static_cast<double>(word >> 11) * 0x1p-53;
  };
  return {to_unit(bits[0], bits[1]), to_unit(bits[2], bits[3])};
}

double normal_number(std::array<std::uint32_t, 4> counter, std::uint64_t seed) {
  double sum = -6;
  for (counter[3] = 0; counter[3] < 6; ++counter[3]) {
    const auto [first, second] = uniform_pair(counter, seed);
    sum += first + second;
  }
  return sum;
}

}  // namespace shearcell
