// SPDX-License-Identifier: GPL-3.0-or-later
// Checkpoints and declarations for the tests of the store.
#pragma once

#include <random>
#include <span>
#include <string>
#include <vector>

#include "provenance/sha256.hpp"
#include "provenance/store.hpp"
#include "tests/support/files.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {

constexpr std::uint64_t kCycle = 45600;  ///< steps

inline std::vector<std::byte> bytes_of(const std::string& text) {
  const auto view = std::as_bytes(std::span(text));
  return {view.begin(), view.end()};
}

inline Checkpoint sample_checkpoint(const std::string& run, std::uint64_t step = kCycle,
                                    Eigen::Index grains = 20) {
  std::mt19937_64 random(step + 1);
  const auto number = [&random] { return static_cast<double>(random() >> 11) * 0x1p-50 - 4.0; };
  Checkpoint c;
  c.run = run;
  c.time_s = 4.386e-5 * static_cast<double>(step);
  c.cycle = static_cast<double>(step) / 45600;
  c.theta = 0.03;
  c.cell = {.width = 12,
            .depth = 11.5,
            .bottom = 0,
            .top = 20,
            .moving = MovingWall::bottom,
            .wall_grains = {}};
  for (int side = 0; side < 4; ++side) {
    c.cell.wall_grains.push_back(
        {static_cast<WallSide>(side), Eigen::Vector3d(number(), number(), number())});
  }
  c.state.step = step;
  c.state.position = Eigen::Matrix3Xd::NullaryExpr(3, grains, number);
  c.state.velocity = Eigen::Matrix3Xd::NullaryExpr(3, grains, number);
  c.state.wall_height = 0.125;
  c.state.wall_velocity = -1e-7;
  c.observables = {{"phi", 0.6375}, {"kinetic_energy_J", 1.5e-9}};
  return c;
}

inline std::string run_id(int number) {
  return sha256_hex("run " + std::to_string(number));
}

inline Stage sample_run(int number, std::uint64_t target = 5) {
  Stage d;
  d.id = run_id(number);
  d.kind = "shear";
  d.resolved = {{"amplitude_rad", 0.0833}, {"drag", "still"}, {"number", number}};
  d.grains = 20;
  Membership& m = d.memberships.emplace_back();
  m.place = {.experiment = "drag",
             .scale = "smoke",
             .variant = "drag=still",
             .swept = {{"drag", "still"}},
             .seed = 0xffffffffffffffff - static_cast<std::uint64_t>(number),
             .manifest = sha256_hex("manifest")};
  m.ask.target_cycles = target;
  return d;
}

}  // namespace shearcell::test
