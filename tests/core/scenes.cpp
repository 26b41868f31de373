// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/core/scenes.hpp"

#include <bit>
#include <cstring>

namespace shearcell::test {
namespace {

std::uint64_t bits(double value) {
  return std::bit_cast<std::uint64_t>(value);
}

bool same(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return a.cols() == b.cols() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

}  // namespace

bool same_bits(const State& a, const State& b) {
  return a.step == b.step && same(a.position, b.position) && same(a.velocity, b.velocity) &&
         bits(a.wall_height) == bits(b.wall_height) &&
         bits(a.wall_velocity) == bits(b.wall_velocity);
}

std::uint64_t fingerprint(const State& state) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  const auto add = [&hash](double value) {
    for (int byte = 0; byte < 8; ++byte) {
      hash = (hash ^ (bits(value) >> 8 * byte & 0xFF)) * 0x100000001b3U;
    }
  };
  for (const double value : state.position.reshaped()) add(value);
  for (const double value : state.velocity.reshaped()) add(value);
  add(state.wall_height);
  add(state.wall_velocity);
  add(static_cast<double>(state.step));
  return hash;
}

}  // namespace shearcell::test
