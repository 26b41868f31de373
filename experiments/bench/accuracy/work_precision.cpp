// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/accuracy/work_precision.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "core/watchdog.hpp"
#include "experiments/bench/accuracy/closed_forms.hpp"
#include "experiments/bench/accuracy/crystal.hpp"
#include "experiments/bench/accuracy/fit.hpp"

namespace shearcell::accuracy {
namespace {

// Overlap of neighbours [d], as in a packing under Table I's pressure; random velocities [d/s] that
// leave such contacts closed, and that open them.
constexpr double kOverlap = 0.003, kGentle = 0.5, kHard = 40;

// As in figure_s3: engine and plain copies in black and grey, rivals in colour.
constexpr std::array<const char*, 7> kColours = {"#000000", "#888888", "#d62728", "#1f4fd8",
                                                 "#2ca02c", "#e377c2", "#8c564b"};
constexpr std::array<int, 7> kPoints = {7, 6, 5, 9, 11, 4, 8};

}  // namespace

std::vector<SmallScene> small_scenes(const Scene& scene, const SmallSceneSettings& settings) {
  const auto crystal = std::make_shared<Crystal>(fcc(scene, settings.layers, kOverlap, true));
  const auto path = [crystal, scene](double speed) {
    const auto start = std::make_shared<Motion>(shaken(*crystal, speed, 1));
    const double time = 3 * contact_time(scene);
    return [crystal, start, time](const Method& method, double dt) {
      return trajectory_error(*crystal, *start, method, dt, time);
    };
  };
  return {
      {"collision-speed", "Two grains collide: speed after it", "speed_error",
       [=](const Method& m, double dt) {
         return collision_error(scene, m, dt, settings.phases).speed;
       },
       true},
      {"collision-end", "Two grains collide: when it ends, in contact times", "time_error",
       [=](const Method& m, double dt) {
         return collision_error(scene, m, dt, settings.phases).time;
       },
       true},
      {"wall", "One grain swings on a wall: position, in amplitudes", "position_error",
       [=](const Method& m, double dt) { return wall_error(scene, m, dt, settings.periods); }},
      {"cage", "One grain swings in a cage: position, in amplitudes", "position_error",
       [=](const Method& m, double dt) { return cage_error(scene, m, dt, settings.periods); }},
      {"crystal-frequency", "FCC crystal: worst of its normal frequencies", "frequency_error",
       [=](const Method& m, double dt) {
         return frequency_error(*crystal, m, dt, settings.modes, settings.mode_steps);
       }},
      {"crystal-closed", "FCC crystal, contacts stay closed: position after 3 contact times",
       "distance_d", path(kGentle)},
      {"crystal-opening", "FCC crystal, contacts open and close: position after 3 contact times",
       "distance_d", path(kHard)},
  };
}

std::vector<WorkPoint> work_points(const SmallScene& scene, const std::vector<double>& time_steps) {
  std::vector<WorkPoint> points;
  for (const Method& method : methods()) {
    for (const double dt : time_steps) {
      WorkPoint point{&method, dt, std::numeric_limits<double>::quiet_NaN()};
      try {
        point.error = scene.measure(method, dt);
      } catch (const NumericalFailure&) {
        // An answer as well: this step is too large for this scene.
      }
      points.push_back(point);
    }
  }
  return points;
}

double order_of(const SmallScene& scene, const std::vector<WorkPoint>& points, const Method& method,
                double largest) {
  std::vector<double> step, error;
  for (int n = 0; scene.irregular && n < 17; ++n) {
    step.push_back(largest * std::exp2(-n / 4.0));
    error.push_back(scene.measure(method, step.back()));
  }
  for (const WorkPoint& point : points) {
    const bool usable = point.method == &method && point.time_step <= largest && point.error > 0;
    if (!usable || scene.irregular) continue;
    step.push_back(point.time_step);
    error.push_back(point.error);
  }
  return step.size() < 2 ? std::nan("") : fitted_order(step, error);
}

FigureTable work_table(const SmallScene& scene, const std::vector<WorkPoint>& points,
                       const Cost& cost) {
  FigureTable table;
  table.name = "accuracy-" + scene.name;
  table.columns = {"method",
                   "time_step_s",
                   "time_step_over_contact_time",
                   "time_step_over_stability_limit",
                   "evaluations_per_contact_time",
                   "seconds_per_cycle",
                   scene.error};
  for (const WorkPoint& p : points) {
    const double per_second = p.method->evaluations / p.time_step;
    table.rows.push_back({p.method->name, p.time_step, p.time_step / cost.contact_time,
                          p.time_step / cost.stability_limit, per_second * cost.contact_time,
                          per_second * cost.period * cost.seconds_per_evaluation, p.error});
  }
  table.plot = fmt::format(
      "set logscale xy\nset format y '10^{{%T}}'\n"
      "set xlabel 'seconds per cycle of 600 sheared grains'\nset ylabel '{}'\n"
      "set title '{}' font ',12'\nplot ",
      scene.error == "distance_d" ? "distance [{/:Italic d}]" : "relative error", scene.title);
  for (std::size_t m = 0; m < methods().size(); ++m) {
    table.plot += fmt::format(
        "{}data using (strcol(1) eq '{}' ? $6 : NaN):7 with linespoints lc rgb '{}' pt {} ps 0.7 "
        "title '{}'",
        m == 0 ? "" : ", \\\n     ", methods()[m].name, kColours[m], kPoints[m], methods()[m].name);
  }
  table.plot += "\n";
  return table;
}

}  // namespace shearcell::accuracy
