// SPDX-License-Identifier: GPL-3.0-or-later
// `bench`: measurements of the program itself.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "experiments/bench/speed.hpp"
#include "experiments/cli/command.hpp"

namespace shearcell::cli {
namespace {

nlohmann::json facts(const SpeedResult& r) {
  return {{"N", r.grains},
          {"simd", r.simd},
          {"threads", r.threads},
          {"million_particle_steps_per_second", r.median_rate},
          {"slowest", r.slowest_rate},
          {"fastest", r.fastest_rate},
          {"share_forces", r.force_share},
          {"share_integration", r.integration_share},
          {"share_walls", r.wall_share},
          {"share_search", r.search_share},
          {"share_prune", r.prune_share},
          {"steps_per_search", r.steps_per_search},
          {"steps_per_prune", r.steps_per_prune},
          {"bytes_per_grain", r.bytes_per_grain},
          {"vector_operations_per_particle_step", r.operations_per_step},
          {"bytes_per_particle_step", r.bytes_per_step},
          {"arithmetic_limit", r.arithmetic_limit},
          {"memory_limit", r.memory_limit},
          {"state_hash", r.state_hash}};
}

void speed(const SpeedOptions& options, Context& context) {
  const std::vector<SpeedResult> results = measure_speed(options);
  if (context.json) {
    nlohmann::json sizes = nlohmann::json::array();
    for (const SpeedResult& result : results) sizes.push_back(facts(result));
    print_json({{"sizes", sizes}});
    return;
  }
  std::vector<std::vector<std::string>> rows;
  const auto percent = [](double share) { return fmt::format("{:.1f}", 100 * share); };
  for (const SpeedResult& r : results) {
    rows.push_back({std::to_string(r.grains), r.simd, std::to_string(r.threads),
                    fmt::format("{:.1f}", r.median_rate),
                    fmt::format("{:.0f}-{:.0f}", r.slowest_rate, r.fastest_rate),
                    fmt::format("{:.0f}", r.arithmetic_limit),
                    fmt::format("{:.0f}", r.memory_limit), percent(r.force_share),
                    percent(r.integration_share), percent(r.wall_share), percent(r.search_share),
                    percent(r.prune_share), fmt::format("{:.0f}", r.bytes_per_grain)});
  }
  print_table({"N", "SIMD", "thr", "M/s", "range", "arith", "mem", "force%", "integ%", "wall%",
               "search%", "prune%", "B/grain"},
              rows);
  fmt::print(
      "M/s: million particle-steps/s, median of {}. arith, mem: what this machine's vector units "
      "and\n"
      "its caches or memory would allow. Shares of one thread's time; search: building the outer\n"
      "neighbour list, prune: the inner one.\n",
      options.repeats);
}

}  // namespace

void add_bench(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand("bench", "Measure the program on this machine");
  command->require_subcommand(1);
  command->footer(
      "Examples:\n  shearcell bench speed\n  shearcell bench accuracy --quick\n"
      "  shearcell bench stability --quick\n  shearcell bench engines --size 600 --cycles 1");
  auto options = std::make_shared<SpeedOptions>();
  CLI::App* rate = command->add_subcommand(
      "speed",
      "Measure particle-steps per second in the sheared rough cell, and the share of each part");
  add_count(*rate, "--size", options->sizes, "Numbers of grains", "N", 1, 100'000'000);
  add_count(*rate, "--threads", options->threads, "Threads inside one run", "T", 1, 1024);
  add_count(*rate, "--repeats", options->repeats, "Number of timings; the median is printed", "N",
            1, 1000);
  add_number(*rate, "--seconds", options->seconds_per_repeat, "Length of one timing", "S", 0.01,
             60);
  rate->add_flag("--json", context.json, "Print JSON for programs");
  rate->footer(
      "Checks that all kernels of this machine give the same state, then times each.\n"
      "Examples:\n  shearcell bench speed --size 600 5200\n"
      "  shearcell bench speed --size 18200 --threads 1 2 --json");
  rate->callback([options, &context] {
    options->report = [](const std::string& what) { tell_stderr("{}\n", what); };
    speed(*options, context);
  });
  add_bench_accuracy(*command, context);
  add_bench_engines(*command, context);
  add_bench_stability(*command, context);
}

}  // namespace shearcell::cli
