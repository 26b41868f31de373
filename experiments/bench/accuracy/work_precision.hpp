// SPDX-License-Identifier: GPL-3.0-or-later
// Error against cost of every method on the small scenes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "analysis/figure.hpp"
#include "core/scene.hpp"
#include "experiments/bench/accuracy/integrate.hpp"

namespace shearcell::accuracy {

/// A question with one number for an answer, 0 when it is answered without error.
struct SmallScene {
  std::string name;   ///< of its files
  std::string title;  ///< what the error is of
  std::string error;  ///< column and axis
  std::function<double(const Method& method, double dt)> measure;
  bool irregular = false;  ///< where a contact ends within a step makes single errors jump
};

/// How thoroughly the small scenes are measured.
struct SmallSceneSettings {
  int phases = 32;      ///< of a collision within a step
  double periods = 10;  ///< of the oscillations
  int layers = 6;       ///< of the crystal: layers^3/2 grains
  int modes = 5;
  std::uint64_t mode_steps = 2000;
};

/// Collision (speed after it, its end), wall, cage, frequencies of a crystal, and the paths of its
/// shaken grains while contacts stay closed and while they open and close.
std::vector<SmallScene> small_scenes(const Scene& scene, const SmallSceneSettings& settings);

struct WorkPoint {
  const Method* method = nullptr;
  double time_step = 0;  ///< [s]
  double error = 0;      ///< NaN when the watchdog stopped it
};

/// Every method at every time step [s].
std::vector<WorkPoint> work_points(const SmallScene& scene, const std::vector<double>& time_steps);

/// Order of convergence, over the points whose time steps are not above `largest` [s]; of an
/// irregular scene over 17 more in factors of the fourth root of 2 below it.
double order_of(const SmallScene& scene, const std::vector<WorkPoint>& points, const Method& method,
                double largest);

/// What a time step costs: `seconds_per_evaluation` is that of the engine for all grains of the
/// sheared scene, `period` [s] that of a cycle.
struct Cost {
  double contact_time = 0, stability_limit = 0, period = 0, seconds_per_evaluation = 0;
};

/// Columns: method, time_step_s, dt over the contact time and over the stability limit, evaluations
/// of the forces per contact time, seconds per cycle of the sheared scene, error. Drawn as error
/// against seconds per cycle, one curve a method.
FigureTable work_table(const SmallScene& scene, const std::vector<WorkPoint>& points,
                       const Cost& cost);

}  // namespace shearcell::accuracy
