// SPDX-License-Identifier: GPL-3.0-or-later
// `bench`: measures the speed of this program.
#include <fmt/format.h>

#include "experiments/bench/speed.hpp"
#include "experiments/cli/command.hpp"

namespace shearcell::cli {
namespace {

Facts facts(const bench::SpeedResult& r) {
  const auto digits = [](double value, int count) { return fmt::format("{:.{}f}", value, count); };
  const auto percent = [&](double share) { return digits(100 * share, 1); };
  return {{"N", r.grains, "N"},
          {"simd", r.simd, "SIMD"},
          {"threads", r.threads, "thr"},
          {"million_particle_steps_per_second", r.median_rate, "M/s", digits(r.median_rate, 1)},
          {"slowest", r.slowest_rate, "range",
           fmt::format("{:.0f}-{:.0f}", r.slowest_rate, r.fastest_rate)},
          {"fastest", r.fastest_rate},
          {"limit", r.limit, "limit", digits(r.limit, 0)},
          {"share_forces", r.force_share, "force%", percent(r.force_share)},
          {"share_integration", r.integration_share, "integ%", percent(r.integration_share)},
          {"share_walls", r.wall_share, "wall%", percent(r.wall_share)},
          {"share_search", r.search_share, "search%", percent(r.search_share)},
          {"share_prune", r.prune_share, "prune%", percent(r.prune_share)},
          {"bytes_per_grain", r.bytes_per_grain, "B/grain", digits(r.bytes_per_grain, 0)},
          {"steps_per_search", r.steps_per_search},
          {"steps_per_prune", r.steps_per_prune},
          {"multiplications_per_particle_step", r.multiplications},
          {"state_hash", r.state_hash}};
}

void speed(bench::SpeedOptions& options, Context& context) {
  options.report = [](const std::string& what) { print_stderr("{}\n", what); };
  print_list("sizes", list_of(bench::measure_speed(options), facts), context);
  if (context.json) return;
  fmt::print(
      "M/s: million particle-steps per second, median of {} timings. limit: upper limit of M/s for "
      "any kernel.\nThe columns with % are shares of the time of one thread. search%: building the "
      "outer neighbour lists. prune%: building the inner neighbour lists.\n",
      options.repeats);
}

void add_speed(CLI::App& bench, Context& context) {
  const auto [command, options] = add_command(
      bench, context, "speed",
      "Measure the speed of simulated shear, and the fraction of time for each part of a step",
      speed);
  add_number(*command, "--size", options->sizes, "Numbers of grains", "N", 1, 100'000'000)
      ->capture_default_str();
  add_number(*command, "--threads", options->threads, "Numbers of threads", "T", 1, 1024)
      ->capture_default_str();
  add_number(*command, "--repeats", options->repeats, "Number of timings; the median is printed",
             "N", 1, 1000)
      ->capture_default_str();
  add_number(*command, "--seconds", options->seconds_per_repeat, "Duration of one timing [s]", "S",
             0.01, 60)
      ->capture_default_str();
  add_json_option(*command, context);
  command->footer(
      "Checks that all kernels of this machine give the same state, then times each kernel.\n"
      "Examples:\n  shearcell bench speed --size 600 5200\n"
      "  shearcell bench speed --size 18200 --threads 1 2 --json");
}

}  // namespace

void add_bench(CLI::App& app, Context& context) {
  CLI::App* command =
      app.add_subcommand("bench", "Measure the speed of the program on this machine");
  command->require_subcommand(1);
  command->footer("Example:\n  shearcell bench speed");
  add_speed(*command, context);
}

}  // namespace shearcell::cli
