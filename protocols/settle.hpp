// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a packing of loose grains: presses them together, then lets them come to rest under gravity
// and pressure.
#pragma once

#include "protocols/protocol.hpp"

namespace shearcell {

struct SettleParameters {
  double force_tolerance = 1e-3;    ///< largest |P A - F| / (P A) of the moving wall
  double kinetic_tolerance = 1e-8;  ///< largest kinetic energy per grain over P d^3
  double time_limit = 60;           ///< [s]; a packing that takes longer is an error
  double overlap_limit = 0.1;       ///< the watchdog's, once the wall has had time to press [d]
};

/// Gravity is switched on only when the moving wall has had time to press the grains together.
/// Grains that fall first form a heap, and a heap nearly as heavy as P A (0.95 of it at N = 18200)
/// jams between rough side walls on its way up and rests there, short of the top, for ever.
///
/// Settled: at one of the looks, every 0.1 s under gravity, the force balance of the moving wall,
/// its speed and the kinetic energy per grain are all under their tolerances. The speed counts as
/// the drag force B_w y' over P A, so a wall that creeps is not taken for one in balance.
///
/// On its way the wall may catch a grain between its own wall grains and those of a side wall, and
/// push it out with all its force: overlaps up to half a diameter pass until the packing is dense.
class Settle final : public Protocol {
 public:
  /// `scene` is what acts on the packing in the end, gravity included.
  Settle(const SettleParameters& parameters, const Scene& scene);
  Drive drive() const override { return {}; }
  StageProgress advance(Simulation& simulation, std::uint64_t most_steps) const override;
  std::uint64_t expected_steps() const override { return 0; }

  /// Steps, a whole number of looks, during which the wall presses without gravity: the way from
  /// the fill height to a dense packing at the speed at which the drags of the wall and of all
  /// grains balance the pressure, and half a second more. 0 without gravity or pressure.
  std::uint64_t press_steps(const Cell& cell, std::size_t grains) const;

  /// The first step after this one at which it looks whether the packing has settled.
  std::uint64_t next_look(std::uint64_t step) const;

 private:
  std::uint64_t way_steps(const Cell& cell, std::size_t grains) const;
  bool settled(const Simulation& simulation) const;

  SettleParameters parameters_;
  Scene scene_;
  std::uint64_t look_steps_;
  std::uint64_t limit_steps_;
};

/// Loose grains -> the same pressed together without gravity by what `scene` has else, for as long
/// as Settle would; a dense packing that has not come to rest. Step 0, upright.
State pressed(const Cell& cell, const State& loose, Scene scene, const EngineSettings& settings);

}  // namespace shearcell
