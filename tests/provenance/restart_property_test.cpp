// SPDX-License-Identifier: GPL-3.0-or-later
// A run that is cut anywhere, stored as a checkpoint and read back ends in the same bits as an
// uninterrupted one, for every kind of run and every kernel that continues it.
#include <algorithm>

#include "provenance/checkpoint.hpp"
#include "tests/core/random_scenes.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

Checkpoint advanced(Checkpoint at, const Scene& scene, const Drive& drive, std::uint64_t until,
                    const SimulationSettings& settings) {
  Simulation simulation(at.cell, scene, at.state, settings);
  simulation.advance(drive, until - at.state.step);
  at.state = simulation.state();
  at.theta = tilt(drive, until).theta;
  at.time_s = static_cast<double>(until) * scene.time_step;
  at.cycle = static_cast<double>(until) / static_cast<double>(cycle_steps(drive));
  return at;
}

PROPERTY(Restart, AtAnyStepFromACheckpointGivesTheSameBits, 80) {
  Sheared packing = any_packing(300);
  Checkpoint start;
  start.run = "any";
  start.cell = std::move(packing.cell);
  start.state = std::move(packing.state);
  const Scene scene = any_scene();
  const Drive drive = any_drive();
  const auto last = *rc::gen::inRange<std::uint64_t>(1, 1500).as("last step");
  auto cuts =
      *rc::gen::container<std::vector<std::uint64_t>>(rc::gen::inRange<std::uint64_t>(0, last + 1))
           .as("cuts");
  cuts.resize(std::min<std::size_t>(cuts.size(), 8));
  std::sort(cuts.begin(), cuts.end());
  Checkpoint cut = start;
  for (const std::uint64_t step : cuts) {
    cut = decode_checkpoint(encode_checkpoint(advanced(cut, scene, drive, step, any_settings())));
  }
  cut = advanced(cut, scene, drive, last, any_settings());
  const Checkpoint whole = advanced(start, scene, drive, last, any_settings());
  RC_ASSERT(same_bits(cut.state, whole.state));
  RC_ASSERT(state_hash(cut) == state_hash(whole));
  RC_ASSERT(encode_checkpoint(cut) == encode_checkpoint(whole));
}

}  // namespace
}  // namespace shearcell
