// SPDX-License-Identifier: GPL-3.0-or-later
// `bench engines`: our engine beside LAMMPS.
#include <fmt/format.h>

#include <memory>

#include "experiments/cli/command.hpp"
#include "experiments/report/engines.hpp"

namespace shearcell::cli {
namespace {

nlohmann::json facts(const EngineCheck& check) {
  nlohmann::json trajectories = nlohmann::json::array(), means = trajectories,
                 speeds = trajectories;
  for (const TrajectoryCheck& t : check.trajectories) {
    trajectories.push_back({{"scene", t.scene},
                            {"steps", t.steps},
                            {"distance_d", t.distance},
                            {"height_difference_d", t.height},
                            {"rounding_d", t.rounding}});
  }
  for (const EngineMean& mean : check.means) {
    for (std::size_t e = 0; e < mean.of.size(); ++e) {
      const RunStatistics& of = mean.of[e];
      means.push_back({{"quantity", mean.name},
                       {"engine", check.engines[e]},
                       {"mean", of.mean.value_or(0)},
                       {"standard_error", of.standard_error.value_or(0)},
                       {"standard_errors_apart", mean.apart[e]}});
    }
  }
  for (const EngineSpeed& speed : check.speeds) {
    speeds.push_back(
        {{"engine", speed.engine},
         {"million_particle_steps_per_second", speed.million_particle_steps_per_second},
         {"bytes", speed.bytes}});
  }
  return {{"lammps", check.lammps_version},
          {"N", check.grains},
          {"settle_seconds", check.settle_seconds},
          {"settled_phi", check.settled_phi},
          {"trajectories", trajectories},
          {"explicit_drag_order", check.explicit_drag_order},
          {"means", means},
          {"limit_in_standard_errors", check.limit},
          {"speeds", speeds},
          {"agree", check.agree()}};
}

void print_trajectories(const EngineCheck& check) {
  std::vector<std::vector<std::string>> rows;
  for (const TrajectoryCheck& t : check.trajectories) {
    rows.push_back({t.scene, std::to_string(t.steps), fmt::format("{:.2g}", t.distance),
                    fmt::format("{:.2g}", t.height),
                    t.rounding > 0 ? fmt::format("{:.2g}", t.rounding) : ""});
  }
  print_table({"scene", "steps", "distance [d]", "height [d]", "one rounding [d]"}, rows);
  fmt::print(
      "distance: largest of a grain from ours; one rounding: what 1 ulp in one number does to "
      "ours.\nThe explicit drag, as LAMMPS has it without our added mass, errs by order {:.2f}.\n",
      check.explicit_drag_order);
}

void print_means(const EngineCheck& check) {
  std::vector<std::vector<std::string>> rows;
  for (const EngineMean& mean : check.means) {
    std::vector<std::string> row = {mean.name};
    for (std::size_t e = 0; e < mean.of.size(); ++e) {
      std::string text = fmt::format("{:.4g}", mean.of[e].mean.value_or(0));
      if (mean.of[e].standard_error) text += fmt::format(" +- {:.1g}", *mean.of[e].standard_error);
      if (e > 0) text += fmt::format(" ({:.1f})", mean.apart[e]);
      row.push_back(std::move(text));
    }
    rows.push_back(std::move(row));
  }
  std::vector<std::string> header = {"mean over seeds"};
  header.insert(header.end(), check.engines.begin(), check.engines.end());
  fmt::print("\n");
  print_table(header, rows);
  fmt::print("In brackets: standard errors from ours, at most {:.1f} by chance.\n", check.limit);
}

void print(const EngineCheck& check) {
  fmt::print("LAMMPS {}; N = {}, settled in {:.1f} s at phi = {:.4f}\n\n", check.lammps_version,
             check.grains, check.settle_seconds, check.settled_phi);
  print_trajectories(check);
  if (!check.means.empty()) print_means(check);
  std::vector<std::vector<std::string>> rows;
  for (const EngineSpeed& speed : check.speeds) {
    rows.push_back({speed.engine, fmt::format("{:.2f}", speed.million_particle_steps_per_second),
                    format_bytes(speed.bytes)});
  }
  fmt::print("\n");
  print_table({"engine", "M/s", "memory"}, rows);
  fmt::print(
      "M/s: million particle-steps/s. Memory: of our simulation; of LAMMPS's largest process.\n"
      "{}\n",
      check.agree() ? "The engines agree." : "The engines do NOT agree.");
}

}  // namespace

void add_bench_engines(CLI::App& bench, Context& context) {
  auto options = std::make_shared<EngineCheckOptions>();
  auto weightless = std::make_shared<bool>(false);
  CLI::App* command = bench.add_subcommand(
      "engines", "LAMMPS beside our engine: trajectories, means over seeds, speed");
  command->add_option("--size", options->grains, "Number of grains")
      ->check(CLI::Range(100, 100'000'000))
      ->type_name("N");
  command->add_option("--steps", options->steps, "Time steps of trajectories and timing")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("S");
  command->add_option("--cycles", options->cycles, "Cycles before the means; 0: no means")
      ->check(CLI::Range(0, 1000))
      ->type_name("C");
  command->add_option("--seeds", options->seeds, "Packings of the means")
      ->check(CLI::Range(3, 1000))
      ->type_name("K");
  command->add_option("--mpi", options->ranks, "Also LAMMPS with so many processes, by mpirun")
      ->check(CLI::Range(1, 65536))
      ->type_name("N");
  command->add_flag("--no-gravity", *weightless, "Without gravity, for cells that P cannot lift");
  command->add_flag("--json", context.json, "Print JSON for programs");
  command->footer(
      "Ends with code 3 if the engines do not agree: trajectories as far as rounding lets them,\n"
      "means within their scatter over seeds. Means of three cycles at N = 2000 take minutes.\n"
      "Examples:\n  shearcell bench engines --size 600 --cycles 1\n"
      "  shearcell bench engines --size 100000 --no-gravity --cycles 0 --mpi 2");
  command->callback([options, weightless, &context] {
    options->gravity = !*weightless;
    options->report = [](const std::string& what) { fmt::print(stderr, "{}\n", what); };
    const EngineCheck check = check_engines(*options);
    context.json ? print_json(facts(check)) : print(check);
    if (!check.agree()) context.exit_code = kRunFailed;
  });
}

}  // namespace shearcell::cli
