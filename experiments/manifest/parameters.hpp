// SPDX-License-Identifier: GPL-3.0-or-later
// The parameters of one run in SI units: every key of a manifest's `base`, with type and default.
// Their meanings and ranges are in the schema (schema.hpp).
#pragma once

#include <cstdint>

#include "core/cell.hpp"
#include "core/named.hpp"
#include "core/scene.hpp"

namespace shearcell {

enum class StageKind : std::uint8_t { prepare, shear, stiffen };

template <>
inline constexpr auto kNames<StageKind> = names_in_order<StageKind>("prepare", "shear", "stiffen");

/// What is done to the settled packing: shear without or with pauses (B.5), or stiffening (B.2).
enum class ProtocolKind : std::uint8_t { continuous, paused, stiffen };
template <>
inline constexpr auto kNames<ProtocolKind> = names_in_order<ProtocolKind>("continuous", "paused",
                                                                          "stiffen");

/// The program that computes a shear stage: this program or LAMMPS.
enum class EngineKind : std::uint8_t { shearcell, lammps };
template <>
inline constexpr auto kNames<EngineKind> = names_in_order<EngineKind>("shearcell", "lammps");

/// The kind of stage that follows the settling under this protocol.
constexpr StageKind stage_after_settling(ProtocolKind protocol) {
  return protocol == ProtocolKind::stiffen ? StageKind::stiffen : StageKind::shear;
}

struct Parameters {
  // Grains and what acts on them (Table I).
  std::uint64_t grains = 7900;
  double mass_kg = 2.0e-5;
  double diameter_m = 3.0e-3;
  double stiffness_N_per_m = 654;
  double drag_kg_per_s = 1.28e-3;
  Fluid fluid = Fluid::still;
  double gravity_m_per_s2 = 9.81;
  double pressure_Pa = 954;
  PressureAt pressure_at = PressureAt::top;

  // The cell.
  WallTexture walls = WallTexture::rough;
  MovingWall moving_wall = MovingWall::bottom;
  double height_over_width = 1.675;
  double nominal_packing_fraction = 0.64;
  double wall_grain_area_fraction = 0.52;
  double wall_grain_recess_diameters = 0.25;
  std::uint64_t wall_grain_draw = 0;
  double wall_mass_grains_per_d2 = 10;
  double wall_drag_grains_per_d2_s = 1000;

  // Preparation.
  double fill_packing_fraction = 0.28;
  double settle_time_step_s = 2.0 / 45600;
  double settle_force_tolerance = 1e-3;
  double settle_kinetic_tolerance = 1e-8;
  double settle_time_limit_s = 60;

  /// In every stage, a run fails and stops if its largest overlap exceeds this value.
  double max_overlap_diameters = 0.25;

  // Shear.
  ProtocolKind protocol = ProtocolKind::continuous;
  double amplitude_rad = 0.0833;
  double period_s = 2;
  std::uint64_t steps_per_cycle = 45600;
  double pause_s = 2;
  PauseWalls pause_walls = PauseWalls::held;
  EngineKind engine = EngineKind::shearcell;

  // Recorded state with which the shear begins (`start`), and the noise on its positions.
  std::uint64_t start_seed = 0;
  std::uint64_t start_cycle = 0;
  double start_noise_d = 0;

  // Stiffening.
  std::uint64_t stiffness_steps_per_decade = 4;
  double minimize_force_tolerance = 1e-4;

  // Lengths of runs. They do not enter the id of a run: a longer run extends a shorter run.
  std::uint64_t cycles = 200;
  std::uint64_t stiffness_decades = 2;

  bool operator==(const Parameters&) const = default;
};

}  // namespace shearcell
