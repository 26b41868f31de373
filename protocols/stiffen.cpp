// SPDX-License-Identifier: GPL-3.0-or-later
#include "protocols/stiffen.hpp"

namespace shearcell {
namespace {

double power(double base, std::uint64_t exponent) {
  double product = 1;
  for (std::uint64_t n = 0; n < exponent; ++n) product *= base;
  return product;
}

// Computes 10^(1/m) by Newton's method, because std::pow differs between libraries. The iteration
// starts above the root and decreases until rounding stops it.
double root_of_ten(std::uint64_t m) {
  const auto degree = static_cast<double>(m);
  double root = 1 + 9 / degree;
  for (;;) {
    const double next = root - (power(root, m) - 10) / (degree * power(root, m - 1));
    if (!(next < root)) return root;
    root = next;
  }
}

}  // namespace

double raised_stiffness(double first, std::uint64_t step, std::uint64_t steps_per_decade) {
  return first * power(10, step / steps_per_decade) *
         power(root_of_ten(steps_per_decade), step % steps_per_decade);
}

Protocol stiffen(const StiffenParameters& p, const Scene& scene) {
  const auto advance = [p, scene](Simulation& simulation,
                                  std::uint64_t most_steps) -> StageProgress {
    if (most_steps > 0 && simulation.step() < p.steps) {
      Scene raised = scene;
      raised.stiffness = raised_stiffness(scene.stiffness, simulation.step(), p.steps_per_decade);
      simulation.set_scene(raised);
      minimize_enthalpy(simulation, p.minimize);
    }
    return {.cycle = static_cast<double>(simulation.step()),
            .checkpoint_due = true,
            .finished = simulation.step() >= p.steps};
  };
  return {.last_step = p.steps, .advance = advance};
}

}  // namespace shearcell
