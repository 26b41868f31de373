// SPDX-License-Identifier: GPL-3.0-or-later
// Sections on whole packings: chaos, means over seeds, finite stiffness, bond order.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "analysis/measures.hpp"
#include "analysis/statistics.hpp"
#include "core/random.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/report/accuracy/accuracy.hpp"
#include "experiments/report/accuracy/box.hpp"
#include "experiments/report/accuracy/fit.hpp"
#include "experiments/report/accuracy/near_neighbours.hpp"
#include "experiments/report/accuracy/sheared.hpp"

namespace shearcell::accuracy {
namespace {

Parameters small_cell(bool quick) {
  Parameters parameters;
  parameters.grains = quick ? 300 : 600;
  return parameters;
}

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "";
}

// work(n) for n < count, `jobs` at once. The first exception is thrown on.
template <class Work>
void in_parallel(std::size_t count, std::size_t jobs, Work&& work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex mutex;
  {
    std::vector<std::jthread> workers;
    for (std::size_t j = 0; j < std::clamp<std::size_t>(jobs, 1, count); ++j) {
      workers.emplace_back([&] {
        try {
          for (std::size_t n = next++; n < count; n = next++) work(n);
        } catch (...) {
          next = count;
          const std::lock_guard lock(mutex);
          if (!failure) failure = std::current_exception();
        }
      });
    }
  }
  if (failure) std::rethrow_exception(failure);
}

std::vector<Packing> packings(const Options& options, std::size_t seeds) {
  std::vector<Packing> all(seeds);
  in_parallel(seeds, options.jobs,
              [&](std::size_t s) { all[s] = settled(small_cell(options.quick), s + 1); });
  return all;
}

double seconds_per_cycle(const Parameters& p, double time_step, double engine_rate) {
  return p.period_s / time_step * static_cast<double>(p.grains) / (1e6 * engine_rate);
}

std::string with_error(const RunStatistics& of, int digits) {
  return fmt::format("{:.{}f} +- {:.{}f}", of.mean.value_or(std::nan("")), digits,
                     of.standard_error.value_or(std::nan("")), digits);
}

// Time step [s] at which the distance from the reference was, and that distance, at the look
// nearest to a time; a look is a whole number of steps, so the times of two runs differ a little.
double order_before_chaos(const Chaos& chaos, double time) {
  std::vector<double> step, distance;
  for (const Separation& run : chaos.runs) {
    const auto near =
        std::ranges::min_element(run.time, {}, [&](double t) { return std::fabs(t - time); });
    step.push_back(run.time_step);
    distance.push_back(run.distance[static_cast<std::size_t>(near - run.time.begin())]);
  }
  return fitted_order(step, distance);
}

}  // namespace

Section separation_section(const Options& options) {
  if (options.report) options.report("runs part from a reference at 1/32 of the time step");
  const Packing packing = settled(small_cell(options.quick), 1);
  // Whole numbers of the reference's steps nearest to the supplement's four time steps, and beyond.
  std::vector<std::uint64_t> steps = {182400, 76800, 58368, 45600, 29184, 19200};
  if (options.quick) steps = {182400, 45600};
  const Chaos chaos = separate(packing, steps, options.quick ? 0.08 : 0.4, options.quick ? 16 : 80);
  Section section{fmt::format("{} sheared grains: distance from a run at 1/32 of Table I's step",
                              packing.parameters.grains),
                  {},
                  {"dt [s]", "after 10 ms [d]", "20 ms", "40 ms", "80 ms", "end"},
                  {},
                  {}};
  section.table.name = "accuracy-separation";
  section.table.columns = {"run", "time_step_s", "time_s", "distance_d"};
  const auto add = [&](const std::string& name, const Separation& run) {
    for (std::size_t n = 0; n < run.time.size(); ++n) {
      section.table.rows.push_back({name, run.time_step, run.time[n], run.distance[n]});
    }
    const auto at = [&](double time) {
      const auto near =
          std::ranges::min_element(run.time, {}, [&](double t) { return std::fabs(t - time); });
      return number(run.distance[static_cast<std::size_t>(near - run.time.begin())]);
    };
    section.summary.push_back(
        {name, at(0.01), at(0.02), at(0.04), at(0.08), number(run.distance.back())});
  };
  for (const Separation& run : chaos.runs) add(fmt::format("{:.3g}", run.time_step), run);
  add("moved by 1e-13 d", chaos.perturbed);
  section.findings = {
      fmt::format("Order after 10 ms: {:.2f}.", order_before_chaos(chaos, 0.01)),
      fmt::format("Lyapunov time {:.3g} ms: two runs moved apart by 1e-13 d differ by 1e-4 d after "
                  "about {:.0f} ms, whatever the integrator. What can be right is the statistics.",
                  1e3 * chaos.lyapunov_time, 1e3 * chaos.lyapunov_time * std::log(1e9))};
  section.table.plot =
      "set logscale y\nset format y '10^{%T}'\nset xlabel 'time  [s]'\n"
      "set ylabel 'distance  [{/:Italic d}]'\nplot ";
  for (std::size_t n = 0; n < section.summary.size(); ++n) {
    const std::string& name = section.summary[n][0];
    const bool moved = n + 1 == section.summary.size();
    section.table.plot += fmt::format(
        "{}data using (strcol(1) eq '{}' ? $3 : NaN):4 with lines lw 1.5 lc {} title '{}{}'",
        n == 0 ? "" : ", \\\n     ", name, moved ? "rgb '#000000'" : std::to_string(n + 1), name,
        moved ? "" : " s");
  }
  section.table.plot += "\n";
  return section;
}

Section seeds_section(const Options& options, double engine_rate) {
  if (options.report) options.report("means over seeds at each time step");
  const std::size_t seeds = options.quick ? 2 : 8;
  const std::uint64_t cycles = options.quick ? 1 : 5, first = options.quick ? 1 : 3;
  // The supplement's four, then up to and over the limit.
  std::vector<std::uint64_t> steps = {76923, 57143, 45600, 28571, 20000, 17000, 15000, 14000};
  if (options.quick) steps = {28571, 20000};
  const std::vector<Packing> all = packings(options, seeds);
  std::vector<RunMeans> means(steps.size() * seeds);
  in_parallel(means.size(), options.jobs, [&](std::size_t n) {
    means[n] = sheared_means(all[n % seeds], steps[n / seeds], cycles, first);
  });
  const Parameters& p = all.front().parameters;
  const double limit = stability_limit_s(p);
  Section section{
      fmt::format("{} sheared grains, {} seeds, means of cycles {} to {}", p.grains, seeds, first,
                  cycles),
      {},
      {"dt [s]", "dt/limit", "s/cycle", "phi", "contacts", "overlap [1e-3 d]", "stopped"},
      {},
      {}};
  section.table.name = "accuracy-seeds";
  section.table.columns = {"steps_per_cycle",
                           "time_step_s",
                           "time_step_over_stability_limit",
                           "seconds_per_cycle",
                           "phi",
                           "phi_error",
                           "contacts_per_grain",
                           "contacts_per_grain_error",
                           "mean_overlap_d",
                           "mean_overlap_d_error",
                           "runs",
                           "stopped"};
  for (std::size_t s = 0; s < steps.size(); ++s) {
    std::vector<double> phi, contacts, overlap;
    std::int64_t stopped = 0;
    for (std::size_t n = 0; n < seeds; ++n) {
      const RunMeans& m = means[s * seeds + n];
      phi.push_back(m.phi);
      contacts.push_back(m.contacts);
      overlap.push_back(m.overlap);
      stopped += m.failure.empty() ? 0 : 1;
    }
    const RunStatistics f = over_runs(phi), z = over_runs(contacts), o = over_runs(overlap);
    const double dt = p.period_s / static_cast<double>(steps[s]);
    const double seconds = seconds_per_cycle(p, dt, engine_rate);
    section.table.rows.push_back({static_cast<std::int64_t>(steps[s]), dt, dt / limit, seconds,
                                  table_value(f.mean), table_value(f.standard_error),
                                  table_value(z.mean), table_value(z.standard_error),
                                  table_value(o.mean), table_value(o.standard_error),
                                  static_cast<std::int64_t>(f.runs), stopped});
    for (double& value : overlap) value *= 1e3;
    section.summary.push_back({number(dt), fmt::format("{:.2f}", dt / limit),
                               fmt::format("{:.2f}", seconds), with_error(f, 4), with_error(z, 2),
                               with_error(over_runs(overlap), 3), std::to_string(stopped)});
  }
  section.table.plot =
      "set xlabel 'time step over 2/{/Symbol w}_{max}'\n"
      "set ylabel 'volume fraction  {/:Italic ϕ}'\n"
      "plot data using 3:5:6 with yerrorbars pt 7 lc rgb '#000000' title '" +
      fmt::format("{} seeds'\n", seeds);
  return section;
}

Section softness_section(const Options& options, double engine_rate) {
  if (options.report) options.report("finite stiffness");
  const std::size_t seeds = options.quick ? 2 : 4;
  const std::vector<Packing> all = packings(options, seeds);
  std::vector<std::vector<Softness>> runs(seeds);
  in_parallel(seeds, options.jobs,
              [&](std::size_t s) { runs[s] = stiffened(all[s], options.quick ? 1 : 2); });
  const Parameters& p = all.front().parameters;
  Section section{
      fmt::format("Finite stiffness: {} settled packings of {} grains", seeds, p.grains),
      {},
      {"k/k_0", "s/cycle", "overlap [d]", "phi (S4)", "phi_u", "phi - hardest",
       "phi_u - hardest phi"},
      {},
      {}};
  section.table.name = "accuracy-stiffness";
  section.table.columns = {"stiffness_factor",
                           "seconds_per_cycle",
                           "mean_overlap_d",
                           "phi",
                           "phi_bias",
                           "phi_bias_error",
                           "phi_uncorrected",
                           "phi_uncorrected_bias",
                           "phi_uncorrected_bias_error",
                           "runs"};
  for (std::size_t n = 0; n < runs.front().size(); ++n) {
    std::vector<double> phi, phi_u, overlap, bias, bias_u;
    for (const std::vector<Softness>& run : runs) {
      phi.push_back(run[n].phi);
      phi_u.push_back(run[n].phi_uncorrected);
      overlap.push_back(run[n].overlap);
      bias.push_back(run[n].phi - run.back().phi);
      bias_u.push_back(run[n].phi_uncorrected - run.back().phi);
    }
    const double factor = runs.front()[n].stiffness_factor;
    // At the same part of a contact time.
    const double seconds =
        seconds_per_cycle(p, shear_time_step_s(p), engine_rate) * std::sqrt(factor);
    const RunStatistics f = over_runs(phi), u = over_runs(phi_u), o = over_runs(overlap),
                        b = over_runs(bias), c = over_runs(bias_u);
    section.table.rows.push_back(
        {factor, seconds, table_value(o.mean), table_value(f.mean), table_value(b.mean),
         table_value(b.standard_error), table_value(u.mean), table_value(c.mean),
         table_value(c.standard_error), static_cast<std::int64_t>(f.runs)});
    section.summary.push_back({number(factor), fmt::format("{:.2f}", seconds), number(*o.mean),
                               fmt::format("{:.5f}", *f.mean), fmt::format("{:.5f}", *u.mean),
                               with_error(b, 5), with_error(c, 5)});
  }
  section.table.plot =
      "set logscale x\nset xlabel 'seconds per cycle of 600 sheared grains'\n"
      "set ylabel 'bias of the volume fraction'\n"
      "plot data using 2:8:9 with yerrorbars pt 6 lc rgb '#000000' title '{/:Italic ϕ}_u', \\\n"
      "     data using 2:5:6 with yerrorbars pt 7 lc rgb '#d62728' title '{/:Italic ϕ} (S4)', \\\n"
      "     0 lc rgb '#888888' notitle\n";
  return section;
}

namespace {

struct Sample {
  std::string name;
  Cell cell;
  WallPose pose;
  Eigen::Matrix3Xd grains;
};

// A crystal of neighbours that overlap by 0.003 d, each grain moved by up to `by` [d] along each
// axis.
Sample jittered_crystal(double by) {
  Scene scene;
  scene.stiffness = 1;
  const Crystal crystal = fcc(scene, 12, 0.003, false);
  Sample sample{fmt::format("crystal, moved by {:g} d", by), {}, {}, crystal.position};
  sample.cell.width = crystal.box.size.x();
  sample.cell.top = crystal.box.size.y();
  sample.cell.depth = crystal.box.size.z();
  sample.pose = wall_pose(sample.cell, 0, 0);
  for (Eigen::Index i = 0; i < sample.grains.cols(); ++i) {
    const auto id = static_cast<std::uint32_t>(i);
    const auto a = uniform_pair({id, 0, 0, 0}, 1), b = uniform_pair({id, 1, 0, 0}, 1);
    const Eigen::Vector3d unit = Eigen::Vector3d(a[0], a[1], b[0]) * 2 - Eigen::Vector3d::Ones();
    // A quarter of the lattice constant off the walls.
    sample.grains.col(i) += Eigen::Vector3d(0.35, 0.35, 0) + by * unit;
  }
  return sample;
}

// Best of several, in seconds per 1000 grains.
template <class Work>
double time_per_1000(const Sample& sample, int repeats, Work&& work) {
  double best = 1e9;
  for (int n = 0; n < repeats; ++n) {
    const auto start = std::chrono::steady_clock::now();
    work();
    best = std::min(
        best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return 1e3 * best / static_cast<double>(sample.grains.cols());
}

}  // namespace

Section order_section(const Options& options) {
  if (options.report) options.report("bond order from cheaper neighbours");
  const Packing packing = settled(small_cell(options.quick), 1);
  std::vector<Sample> samples = {
      {"settled packing", packing.cell, wall_pose(packing.cell, 0, packing.state.wall_height),
       packing.state.position},
      jittered_crystal(0.002),
      jittered_crystal(0.01)};
  const std::vector<std::pair<std::string, NeighbourRule>> rules = {{"within 1.2 d", {1.2, 0}},
                                                                    {"within 1.3 d", {1.3, 0}},
                                                                    {"within 1.4 d", {1.4, 0}},
                                                                    {"12 nearest", {1.6, 12}}};
  const int repeats = options.quick ? 1 : 5;
  Section section{"Bond order: cheap neighbours beside Voronoi cells",
                  {},
                  {"packing", "neighbours", "ms/1000 grains", "error of q6", "crystalline %"},
                  {},
                  {}};
  section.table.name = "accuracy-order";
  section.table.columns = {"packing", "neighbours", "seconds_per_1000_grains", "q6_error",
                           "crystalline_percent"};
  for (const Sample& sample : samples) {
    const auto add = [&](const std::string& rule, double seconds, double q6, double percent) {
      section.table.rows.push_back({sample.name, rule, seconds, q6, percent});
      section.summary.push_back({sample.name, rule, fmt::format("{:.2f}", 1e3 * seconds),
                                 fmt::format("{:.4f}", q6), fmt::format("{:.1f}", percent)});
    };
    const Measures exact = analyse(sample.cell, sample.pose, sample.grains).measures;
    add("Voronoi faces",
        time_per_1000(sample, repeats, [&] { analyse(sample.cell, sample.pose, sample.grains); }),
        0, exact.crystalline_percent);
    for (const auto& [name, rule] : rules) {
      const OrderError error = order_error(sample.cell, sample.pose, sample.grains, rule);
      const double seconds = time_per_1000(
          sample, repeats, [&] { q6_of_near(sample.cell, sample.pose, sample.grains, rule); });
      add(name, seconds, error.q6, exact.crystalline_percent + error.percent);
    }
  }
  section.findings = {
      "Cheap neighbours know no volume of a cell, so their percentage lacks the criterion "
      "phi_local "
      "> 0.72."};
  return section;
}

std::vector<Section> measure_accuracy(const Options& options) {
  if (options.report) options.report("the engine's rate");
  const double rate = shear_rate_measured(settled(small_cell(options.quick), 1),
                                          options.quick ? 1 : 9, options.quick ? 0.05 : 0.3);
  std::vector<Section> sections = small_scene_sections(options, rate);
  sections.push_back(dispersion_section(options));
  sections.push_back(drift_section(options));
  sections.push_back(separation_section(options));
  sections.push_back(seeds_section(options, rate));
  sections.push_back(softness_section(options, rate));
  sections.push_back(order_section(options));
  return sections;
}

}  // namespace shearcell::accuracy
