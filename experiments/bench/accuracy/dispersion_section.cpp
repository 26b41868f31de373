// SPDX-License-Identifier: GPL-3.0-or-later
// Waves in a row of grains and in a crystal, against their closed forms.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "experiments/manifest/conversion.hpp"
#include "experiments/bench/accuracy/accuracy.hpp"
#include "experiments/bench/accuracy/crystal.hpp"
#include "experiments/bench/accuracy/packings.hpp"

namespace shearcell::accuracy {
namespace {

constexpr double kOverlap = 0.003;

// Waves along z that move the grains along one axis, and their closed form.
struct Branch {
  const char* name;
  const char* colour;
  const Crystal* crystal;
  const Method* method;
  Eigen::Index axis;
  double (*exact)(const Scene& scene, double overlap, double q);
};

// Adds the waves with n periods in the box, n = 1 to `most`. Returns how far the worst frequency is
// from the leapfrog's own, relatively.
double add_branch(const Branch& branch, const Scene& scene, int most, std::uint64_t steps,
                  Section& section) {
  const double dt = scene.time_step;
  const Eigen::Matrix3Xd& at = branch.crystal->position;
  double worst = 0;
  for (int n = 1; n <= most; ++n) {
    const double q = 2 * std::numbers::pi * n / branch.crystal->box.size.z();
    Eigen::Matrix3Xd shape = Eigen::Matrix3Xd::Zero(3, at.cols());
    shape.row(branch.axis) = (q * at.row(2)).array().cos();
    const Eigen::VectorXd unit = shape.reshaped().normalized();
    const double exact = branch.exact(scene, kOverlap, q);
    const double found = measured_frequency(*branch.crystal, unit, *branch.method, dt, steps);
    const double theory = std::asin(exact * dt / 2) / (exact * dt / 2) - 1;
    worst = std::max(worst, std::fabs(found / exact - 1 - theory));
    section.table.rows.push_back(
        {std::string(branch.name), q, exact, found, found / exact - 1, theory});
    section.summary.push_back({branch.name, short_number(q), fmt::format("{:.1f}", exact),
                               fmt::format("{:.1f}", found), short_number(found / exact - 1),
                               short_number(theory)});
  }
  return worst;
}

}  // namespace

Section dispersion_section(const Options& options) {
  const Scene scene = shear_scene(Parameters{});
  const int layers = options.quick ? 4 : 8;
  const Crystal row = chain(scene, 2 * layers, kOverlap);
  const Crystal bulk = fcc(scene, layers, kOverlap, false);
  const Method& plain = methods()[1];
  const std::array branches = {
      Branch{"row in the engine", "#000000", &row, &engine(), 2, chain_longitudinal},
      Branch{"FCC longitudinal", "#d62728", &bulk, &plain, 2, fcc_longitudinal},
      Branch{"FCC transverse", "#1f4fd8", &bulk, &plain, 0, fcc_transverse}};
  Section section{"Waves along z at Table I's time step", {}, {}, {}, {}};
  section.table.name = "accuracy-dispersion";
  section.table.columns = {
      "wave",           "wave_number_per_d", "exact_rad_per_s", "found_rad_per_s",
      "relative_error", "leapfrog_theory"};
  section.header = {"wave", "q [1/d]", "exact [rad/s]", "found", "error", "theory"};
  section.table.plot =
      "set xlabel 'wave number  {/:Italic q}  [1/{/:Italic d}]'\n"
      "set ylabel 'frequency  [rad/s]'\nplot ";
  double worst = 0;
  for (const Branch& b : branches) {
    const int most = b.crystal == &row ? layers : layers / 2;
    worst = std::max(worst, add_branch(b, scene, most, options.quick ? 200 : 2000, section));
    section.table.plot += fmt::format(
        "{0}data using (strcol(1) eq '{1}' ? $2 : NaN):3 with lines lc rgb '{2}' notitle, \\\n"
        "     data using (strcol(1) eq '{1}' ? $2 : NaN):4 with points pt 7 lc rgb '{2}' title "
        "'{1}'",
        b.name == branches.front().name ? "" : ", \\\n     ", b.name, b.colour);
  }
  section.table.plot += "\n";
  section.findings.push_back(
      fmt::format("Every frequency is too high by what the leapfrog's own dispersion, "
                  "sin(w' dt/2) = w dt/2, says (theory); the rest is {:.1g}.",
                  worst));
  return section;
}

}  // namespace shearcell::accuracy
