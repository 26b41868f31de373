// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/core/scenes.hpp"

#include <cstring>

namespace shearcell::test {
namespace {

bool same(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return a.cols() == b.cols() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

}  // namespace

bool same_bits(const State& a, const State& b) {
  return a.step == b.step && same(a.position, b.position) && same(a.velocity, b.velocity) &&
         std::memcmp(&a.wall_height, &b.wall_height, sizeof(double)) == 0 &&
         std::memcmp(&a.wall_velocity, &b.wall_velocity, sizeof(double)) == 0;
}

}  // namespace shearcell::test
