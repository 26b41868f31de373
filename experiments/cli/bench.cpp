// SPDX-License-Identifier: GPL-3.0-or-later
// `bench`: measurements of the program itself; those of engines are in bench_engines.cpp.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "analysis/plot.hpp"
#include "experiments/bench/accuracy/accuracy.hpp"
#include "experiments/bench/speed.hpp"
#include "experiments/bench/stability/stability.hpp"
#include "experiments/cli/command.hpp"
#include "provenance/io/plain_file.hpp"

namespace shearcell::cli {
namespace {

void say(const std::string& what) {
  tell_stderr("{}\n", what);
}

nlohmann::json speed_facts(const SpeedResult& r) {
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
  if (context.json) return print_json({{"sizes", json_list(results, speed_facts)}});
  const auto percent = [](double share) { return fmt::format("{:.1f}", 100 * share); };
  print_table({"N", "SIMD", "thr", "M/s", "range", "arith", "mem", "force%", "integ%", "wall%",
               "search%", "prune%", "B/grain"},
              results, [&](const SpeedResult& r) -> Row {
                return {std::to_string(r.grains),
                        r.simd,
                        std::to_string(r.threads),
                        fmt::format("{:.1f}", r.median_rate),
                        fmt::format("{:.0f}-{:.0f}", r.slowest_rate, r.fastest_rate),
                        fmt::format("{:.0f}", r.arithmetic_limit),
                        fmt::format("{:.0f}", r.memory_limit),
                        percent(r.force_share),
                        percent(r.integration_share),
                        percent(r.wall_share),
                        percent(r.search_share),
                        percent(r.prune_share),
                        fmt::format("{:.0f}", r.bytes_per_grain)};
              });
  fmt::print(
      "M/s: million particle-steps/s, median of {}. arith, mem: what this machine's vector units "
      "and\n"
      "its caches or memory would allow. Shares of one thread's time; search: building the outer\n"
      "neighbour list, prune: the inner one.\n",
      options.repeats);
}

// --- Accuracy ---

struct AccuracyOptions {
  accuracy::Options measure;
  std::string out;
};

struct JsonOf {
  nlohmann::json operator()(std::monostate) const { return nullptr; }
  nlohmann::json operator()(const auto& value) const { return value; }
};

nlohmann::json section_facts(const accuracy::Section& section) {
  const auto row_facts = [&](const std::vector<TableValue>& row) {
    nlohmann::json values = nlohmann::json::object();
    for (std::size_t c = 0; c < row.size(); ++c) {
      values[section.table.columns[c]] = std::visit(JsonOf{}, row[c]);
    }
    return values;
  };
  return {{"name", section.table.name},
          {"title", section.title},
          {"rows", json_list(section.table.rows, row_facts)}};
}

// All data before the first figure, which needs gnuplot.
void write(const std::vector<accuracy::Section>& sections, const std::filesystem::path& folder) {
  for (const accuracy::Section& section : sections) require_own_files(section.table, folder);
  for (const accuracy::Section& section : sections) {
    write_csv(section.table, folder);
    write_output(folder / (section.table.name + ".chart.json"),
                 chart_json(section.table).dump() + "\n");
  }
  for (const accuracy::Section& section : sections) draw_svg(section.table, folder);
}

void print(const std::vector<accuracy::Section>& sections) {
  for (const accuracy::Section& section : sections) {
    fmt::print("{}\n", section.title);
    print_table(section.header, section.summary);
    fmt::print("\n");
  }
}

void measure(const AccuracyOptions& options, Context& context) {
  // A folder that cannot be created is an error before minutes of measuring, not after.
  if (!options.out.empty()) std::filesystem::create_directories(options.out);
  const std::vector<accuracy::Section> sections = accuracy::measure_accuracy(options.measure);
  if (context.json) {
    print_json(
        {{"quick", options.measure.quick}, {"sections", json_list(sections, section_facts)}});
  } else {
    print(sections);
  }
  if (!options.out.empty()) write(sections, options.out);
}

// --- Stability ---

void print_case(const StabilityResult& r) {
  fmt::print("{} {}  ({:.1f} s)\n    {}\n    expected: {}\n    outcome:  {}\n",
             r.as_expected ? "ok " : "NOT", r.name, r.seconds, r.done, r.expected, r.outcome);
}

nlohmann::json case_facts(const StabilityResult& r) {
  return {{"name", r.name},
          {"done", r.done},
          {"expected", r.expected},
          {"outcome", r.outcome},
          {"as_expected", r.as_expected},
          {"seconds", r.seconds}};
}

void stability(const StabilityOptions& options, Context& context) {
  const std::vector<StabilityResult> results = map_stability(options);
  std::size_t right = 0;
  double seconds = 0;
  for (const StabilityResult& r : results) {
    right += r.as_expected ? 1 : 0;
    seconds += r.seconds;
    if (!context.json) print_case(r);
  }
  if (context.json) {
    print_json({{"cases", json_list(results, case_facts)}});
  } else {
    fmt::print("{} of {} cases ended as expected, in {:.0f} s.\n", right, results.size(), seconds);
  }
  if (right < results.size()) context.exit_code = kRunFailed;
}

void add_bench_speed(CLI::App& bench, Context& context) {
  auto options = std::make_shared<SpeedOptions>();
  CLI::App* rate = bench.add_subcommand(
      "speed",
      "Measure particle-steps per second in the sheared rough cell, and the share of each part");
  add_count(*rate, "--size", options->sizes, "Numbers of grains", "N", 1, 100'000'000);
  add_count(*rate, "--threads", options->threads, "Threads inside one run", "T", 1, 1024);
  add_count(*rate, "--repeats", options->repeats, "Number of timings; the median is printed", "N",
            1, 1000);
  add_number(*rate, "--seconds", options->seconds_per_repeat, "Length of one timing", "S", 0.01,
             60);
  add_json_option(*rate, context);
  rate->footer(
      "Checks that all kernels of this machine give the same state, then times each.\n"
      "Examples:\n  shearcell bench speed --size 600 5200\n"
      "  shearcell bench speed --size 18200 --threads 1 2 --json");
  rate->callback([options, &context] {
    options->report = say;
    speed(*options, context);
  });
}

void add_bench_accuracy(CLI::App& bench, Context& context) {
  auto options = std::make_shared<AccuracyOptions>();
  options->measure.jobs = core_count();
  CLI::App* command = bench.add_subcommand(
      "accuracy", "Measure error against cost of integrators, time steps and stiffness");
  command->add_flag("--quick", options->measure.quick,
                    "Seconds instead of minutes: the same tables from fewer runs");
  add_count(*command, "--jobs", options->measure.jobs, "Runs computed at once", "J", 1, 1024);
  command->add_option("--out", options->out, "Folder for CSV files and figures")->type_name("DIR");
  add_json_option(*command, context);
  command->footer(
      "core/ACCURACY.md explains the tables and how to choose a time step.\n"
      "Examples:\n  shearcell bench accuracy --quick\n  shearcell bench accuracy --out accuracy");
  command->callback([options, &context] {
    options->measure.report = say;
    measure(*options, context);
  });
}

void add_bench_stability(CLI::App& bench, Context& context) {
  auto options = std::make_shared<StabilityOptions>();
  CLI::App* command = bench.add_subcommand(
      "stability", "Run hard cases: each must give the right answer or be stopped with the reason");
  command->add_option("--only", options->only, "Names of cases, or their beginnings")
      ->type_name("NAME")
      ->check(unknown_case, "");
  command->add_flag("--quick", options->quick, "Fewer steps in the very long cases");
  add_number(*command, "--seconds", options->seconds_per_case,
             "A case that takes longer counts as hanging", "S", 0.1, 86400);
  add_json_option(*command, context);
  command->footer(
      "Ends with code 3 if a case does not end as expected.\n"
      "Examples:\n  shearcell bench stability --quick\n"
      "  shearcell bench stability --only vacancy limit --json");
  command->callback([options, &context] {
    options->report = say;
    stability(*options, context);
  });
}

}  // namespace

void add_bench(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand("bench", "Measure the program on this machine");
  command->require_subcommand(1);
  command->footer(
      "Examples:\n  shearcell bench speed\n  shearcell bench accuracy --quick\n"
      "  shearcell bench stability --quick\n  shearcell bench engines --size 600 --cycles 1");
  add_bench_speed(*command, context);
  add_bench_accuracy(*command, context);
  add_bench_engines(*command, context);
  add_bench_stability(*command, context);
}

}  // namespace shearcell::cli
