// SPDX-License-Identifier: GPL-3.0-or-later
// `bench engines`: our engine and LAMMPS compared.
#include <fmt/format.h>

#include <memory>

#include "experiments/bench/engines.hpp"
#include "experiments/cli/command.hpp"

namespace shearcell::cli {
namespace {

using namespace bench;  // NOLINT(google-build-using-namespace): the results that this file prints

nlohmann::json facts(const EngineMeans& all) {
  nlohmann::json means = nlohmann::json::array();
  for (const EngineMean& mean : all.means) {
    for (std::size_t e = 0; e < mean.of.size(); ++e) {
      const RunStatistics& of = mean.of[e];
      means.push_back({{"quantity", mean.name},
                       {"engine", all.engines[e]},
                       {"mean", of.mean.value_or(0)},
                       {"standard_error", of.standard_error.value_or(0)},
                       {"standard_errors_apart", mean.apart[e]}});
    }
  }
  return means;
}

nlohmann::json facts(const EngineCheck& check) {
  const auto trajectory = [](const TrajectoryCheck& t) -> nlohmann::json {
    return {{"scene", t.scene},
            {"steps", t.steps},
            {"distance_d", t.distance},
            {"height_difference_d", t.height},
            {"rounding_d", t.rounding}};
  };
  const auto settling = [](const Settling& s) -> nlohmann::json {
    return {{"engine", s.engine},
            {"seed", s.seed},
            {"steps", s.state.step},
            {"wall_seconds", s.seconds},
            {"million_particle_steps_per_second", s.million_particle_steps_per_second},
            {"bytes", s.bytes},
            {"phi", s.numbers.phi},
            {"contacts_per_grain", s.numbers.contacts},
            {"mean_overlap_d", s.numbers.overlap},
            {"wall_force_imbalance", s.numbers.imbalance},
            {"height_d", s.numbers.height}};
  };
  const auto speed = [](const EngineSpeed& s) -> nlohmann::json {
    return {{"engine", s.engine},
            {"million_particle_steps_per_second", s.million_particle_steps_per_second},
            {"bytes", s.bytes}};
  };
  return {{"lammps", check.lammps_version},
          {"N", check.grains},
          {"settlings", json_list(check.settlings, settling)},
          {"settled_means", facts(check.settled)},
          {"settled_limit_in_standard_errors", check.settled.limit},
          {"trajectories", json_list(check.trajectories, trajectory)},
          {"means", facts(check.sheared)},
          {"limit_in_standard_errors", check.sheared.limit},
          {"speeds", json_list(check.speeds, speed)},
          {"agree", check.agree()}};
}

void print_trajectories(const EngineCheck& check) {
  print_table({"scene", "steps", "distance [d]", "height [d]", "one rounding [d]"},
              check.trajectories, [](const TrajectoryCheck& t) -> Row {
                return {t.scene, std::to_string(t.steps), fmt::format("{:.2g}", t.distance),
                        fmt::format("{:.2g}", t.height), fmt::format("{:.2g}", t.rounding)};
              });
  fmt::print(
      "distance: largest of a grain from ours; one rounding: effect of 1 ulp in one number.\n");
}

void print_settlings(const EngineCheck& check) {
  print_table({"settled by", "seed", "steps", "seconds", "M/s", "memory", "phi", "contacts",
               "overlap [d]", "imbalance"},
              check.settlings, [](const Settling& s) -> Row {
                return {s.engine,
                        std::to_string(s.seed),
                        std::to_string(s.state.step),
                        fmt::format("{:.1f}", s.seconds),
                        fmt::format("{:.2f}", s.million_particle_steps_per_second),
                        format_bytes(s.bytes),
                        fmt::format("{:.4f}", s.numbers.phi),
                        fmt::format("{:.3f}", s.numbers.contacts),
                        fmt::format("{:.3e}", s.numbers.overlap),
                        fmt::format("{:.1e}", s.numbers.imbalance)};
              });
  fmt::print("\n");
}

void print_means(const char* title, const EngineMeans& all) {
  if (all.means.empty()) return;
  Row header = {title};
  header.insert(header.end(), all.engines.begin(), all.engines.end());
  print_table(header, all.means, [](const EngineMean& mean) {
    Row row = {mean.name};
    for (std::size_t e = 0; e < mean.of.size(); ++e) {
      std::string text = fmt::format("{:.4g}", mean.of[e].mean.value_or(0));
      if (mean.of[e].standard_error) text += fmt::format(" +- {:.1g}", *mean.of[e].standard_error);
      if (e > 0) text += fmt::format(" ({:.1f})", mean.apart[e]);
      row.push_back(std::move(text));
    }
    return row;
  });
  fmt::print("In brackets: standard errors from ours, at most {:.1f} by chance.\n\n", all.limit);
}

void print(const EngineCheck& check) {
  fmt::print("LAMMPS {}; N = {}\n\n", check.lammps_version, check.grains);
  print_settlings(check);
  print_means("settled, mean over seeds", check.settled);
  print_trajectories(check);
  fmt::print("\n");
  print_means("sheared, mean over seeds", check.sheared);
  print_table({"engine", "M/s", "memory"}, check.speeds, [](const EngineSpeed& speed) -> Row {
    return {speed.engine, fmt::format("{:.2f}", speed.million_particle_steps_per_second),
            format_bytes(speed.bytes)};
  });
  fmt::print(
      "M/s: million particle-steps/s, of LAMMPS in its time loop. Memory: of our simulation, or "
      "of\n"
      "the largest process of LAMMPS.\n{}\n",
      check.agree() ? "The engines agree." : "The engines do NOT agree.");
}

}  // namespace

void add_bench_engines(CLI::App& bench, Context& context) {
  auto options = std::make_shared<EngineCheckOptions>();
  auto weightless = std::make_shared<bool>(false);
  CLI::App* command = bench.add_subcommand(
      "engines", "Compare LAMMPS and our engine: trajectories, means over seeds, speed");
  add_count(*command, "--size", options->grains, "Number of grains", "N", 100, 100'000'000);
  add_count(*command, "--steps", options->steps, "Time steps of trajectories and timing", "S", 1,
            1'000'000);
  add_count(*command, "--cycles", options->cycles, "Cycles before the means; 0: no means", "C", 0,
            1000);
  add_count(*command, "--seeds", options->seeds, "Packings of the means", "K", 3, 1000);
  add_count(*command, "--mpi", options->ranks,
            "Run LAMMPS also with this many processes, by mpirun", "N", 1, 65536);
  command->add_flag("--settle", options->settle,
                    "Settle the loose grains in LAMMPS too, with the processes of --mpi");
  add_number(*command, "--settle-time-limit", options->settle_time_limit,
             "Simulated time after which grains that have not settled are an error "
             "(settle_time_limit_s)",
             "S", 1e-3, 1e6);
  command->add_flag("--no-gravity", *weightless, "Without gravity, for cells that P cannot lift");
  add_json_option(*command, context);
  command->footer(
      "Ends with code 3 if the engines do not agree: trajectories within the effect of rounding,\n"
      "means within their scatter over seeds. Both shear our packings; --settle also compares "
      "packings\n"
      "that LAMMPS settles. Means of three cycles at N = 2000 take minutes.\n"
      "Examples:\n  shearcell bench engines --size 600 --cycles 1 --settle\n"
      "  shearcell bench engines --size 100000 --no-gravity --cycles 0 --mpi 2");
  command->callback([options, weightless, &context] {
    options->gravity = !*weightless;
    options->report = [](const std::string& what) { tell_stderr("{}\n", what); };
    const EngineCheck check = check_engines(*options);
    context.json ? print_json(facts(check)) : print(check);
    if (!check.agree()) context.exit_code = kRunFailed;
  });
}

}  // namespace shearcell::cli
