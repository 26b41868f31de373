// SPDX-License-Identifier: GPL-3.0-or-later
// Random small cells, forces, drives and engines, for properties (tests/property.hpp).
#pragma once

#include "tests/core/scenes.hpp"
#include "tests/property.hpp"

namespace shearcell::test {

/// From low up to high in a thousand steps, the lowest first when it is shrunk.
inline double any_number(const char* name, double low, double high) {
  return low +
         (high - low) * *rc::gen::inRange(0, 1001).as(std::string(name) + ", 0 to 1000") / 1000;
}

inline bool any_bool(const char* name) {
  return *rc::gen::arbitrary<bool>().as(name);
}

/// A packing in the midst of moving, from loose to dense.
inline Sheared any_packing(std::size_t most_grains) {
  const auto grains = *rc::gen::inRange<std::size_t>(60, most_grains + 1).as("grains");
  const auto steps = *rc::gen::inRange<std::uint64_t>(3000, 12000).as("pressed for");
  const auto walls = any_bool("rough") ? WallTexture::rough : WallTexture::smooth;
  const auto moving = any_bool("top moves") ? MovingWall::top : MovingWall::bottom;
  return pressed(grains, steps, walls, moving);
}

/// Table I with or without drag, gravity and a moving fluid; P acts on either wall.
inline Scene any_scene() {
  Scene scene = table_1();
  scene.fluid =
      Fluid{static_cast<std::uint8_t>(*rc::gen::inRange<int>(0, kNames<Fluid>.size()).as("fluid"))};
  if (any_bool("without gravity")) scene.gravity = 0;
  if (any_bool("P at the top")) scene.pressure_at = PressureAt::top;
  if (*rc::gen::inRange(0, 4).as("no drag if 3") == 3) scene.drag_rate = 0;
  return scene;
}

/// Continuous or paused, of cycles so short that a test sees several.
inline Drive any_drive() {
  Drive drive;
  drive.steps_per_cycle = *rc::gen::inRange<std::uint64_t>(40, 2000).as("steps per cycle");
  drive.amplitude = any_number("amplitude", 0, 5e-5) * static_cast<double>(drive.steps_per_cycle);
  drive.pause_steps = *rc::gen::element<std::uint64_t>(0, 0, 17, 300).as("pause");
  if (any_bool("moving in a pause")) drive.pause_walls = PauseWalls::moving;
  return drive;
}

/// Any instructions that the machine has, one to three threads, and ways to keep the lists.
inline SimulationSettings any_settings() {
  SimulationSettings settings;
  settings.kernels = kernels_here()[*rc::gen::inRange<std::size_t>(0, kernels_here().size())
                                         .as("kernel, the fastest first")];
  settings.threads = *rc::gen::element<std::size_t>(1, 1, 2, 3).as("threads");
  settings.limits.overlap = settings.limits.escape = 1;  // small cells driven hard
  settings.lists.inner_cutoff = any_number("inner cutoff", 1.02, 1.2);
  settings.lists.outer_cutoff = settings.lists.inner_cutoff + any_number("outer beyond", 0.02, 0.1);
  settings.lists.widest_cutoff = settings.lists.outer_cutoff + any_number("widest beyond", 0, 0.3);
  settings.lists.rebuild_every_step = *rc::gen::inRange(0, 10).as("rebuilt always if 9") == 9;
  settings.lists.sort_memory = any_bool("memory sorted");
  return settings;
}

}  // namespace shearcell::test
