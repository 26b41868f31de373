// SPDX-License-Identifier: GPL-3.0-or-later
// `bench`: measurements of the program itself.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "analysis/plot.hpp"
#include "core/machine.hpp"
#include "experiments/bench/accuracy/accuracy.hpp"
#include "experiments/bench/engines.hpp"
#include "experiments/bench/speed.hpp"
#include "experiments/bench/stability/stability.hpp"
#include "experiments/cli/command.hpp"
#include "provenance/io/file.hpp"

namespace shearcell::cli {
namespace {

using bench::Fact;
using bench::Facts;

std::string digits(double value, int count) {
  return fmt::format("{:.{}f}", value, count);
}

std::string significant(double value, int count) {
  return fmt::format("{:.{}g}", value, count);
}

Facts facts(const bench::SpeedResult& r) {
  const auto percent = [](double share) { return digits(100 * share, 1); };
  return {{"N", r.grains, "N"},
          {"simd", r.simd, "SIMD"},
          {"threads", r.threads, "thr"},
          {"million_particle_steps_per_second", r.median_rate, "M/s", digits(r.median_rate, 1)},
          {"slowest", r.slowest_rate, "range",
           fmt::format("{:.0f}-{:.0f}", r.slowest_rate, r.fastest_rate)},
          {"fastest", r.fastest_rate},
          {"arithmetic_limit", r.arithmetic_limit, "arith", digits(r.arithmetic_limit, 0)},
          {"memory_limit", r.memory_limit, "mem", digits(r.memory_limit, 0)},
          {"share_forces", r.force_share, "force%", percent(r.force_share)},
          {"share_integration", r.integration_share, "integ%", percent(r.integration_share)},
          {"share_walls", r.wall_share, "wall%", percent(r.wall_share)},
          {"share_search", r.search_share, "search%", percent(r.search_share)},
          {"share_prune", r.prune_share, "prune%", percent(r.prune_share)},
          {"bytes_per_grain", r.bytes_per_grain, "B/grain", digits(r.bytes_per_grain, 0)},
          {"steps_per_search", r.steps_per_search},
          {"steps_per_prune", r.steps_per_prune},
          {"vector_operations_per_particle_step", r.work.vector_operations},
          {"bytes_per_particle_step", r.work.bytes},
          {"state_hash", r.state_hash}};
}

Facts facts(const bench::TrajectoryCheck& t) {
  return {{"scene", t.scene, "scene"},
          {"steps", t.steps, "steps"},
          {"distance_d", t.distance, "distance [d]", significant(t.distance, 2)},
          {"height_difference_d", t.height, "height [d]", significant(t.height, 2)},
          {"rounding_d", t.rounding, "one rounding [d]", significant(t.rounding, 2)}};
}

Facts facts(const bench::EngineSpeed& speed) {
  const double rate = speed.million_particle_steps_per_second;
  return {{"engine", speed.engine, "engine"},
          {"million_particle_steps_per_second", rate, "M/s", digits(rate, 2)},
          {"bytes", speed.bytes, "memory", format_bytes(speed.bytes)}};
}

Facts facts(const bench::Settling& s) {
  const bench::PackingNumbers& n = s.numbers;
  const double rate = s.million_particle_steps_per_second;
  return {{"engine", s.engine, "settled by"},
          {"seed", s.seed, "seed"},
          {"steps", s.state.step, "steps"},
          {"wall_seconds", s.seconds, "seconds", digits(s.seconds, 1)},
          {"million_particle_steps_per_second", rate, "M/s", digits(rate, 2)},
          {"bytes", s.bytes, "memory", format_bytes(s.bytes)},
          {"phi", n.phi, "phi", digits(n.phi, 4)},
          {"contacts_per_grain", n.contacts_per_grain, "contacts", digits(n.contacts_per_grain, 3)},
          {"mean_overlap_d", n.mean_overlap, "overlap [d]", fmt::format("{:.3e}", n.mean_overlap)},
          {"wall_force_imbalance", n.imbalance, "imbalance", fmt::format("{:.1e}", n.imbalance)},
          {"height_d", n.height}};
}

Facts facts(const bench::EngineMean& m) {
  return {{"quantity", m.quantity},
          {"engine", m.engine},
          {"mean", m.of.mean.value_or(0)},
          {"standard_error", m.of.standard_error.value_or(0)},
          {"standard_errors_apart", m.apart}};
}

// The tables of `accuracy` are facts already.
const Facts& facts(const Facts& result) {
  return result;
}

nlohmann::json json_of(const TableValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* count = std::get_if<std::int64_t>(&value)) return *count;
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return nullptr;
}

template <class Result>
nlohmann::json json_of(const std::vector<Result>& results) {
  return json_list(results, [](const Result& result) {
    nlohmann::json one;
    for (const Fact& fact : facts(result)) one[fact.key] = json_of(fact.value);
    return one;
  });
}

template <class Result>
void print_facts(const std::vector<Result>& results) {
  Row header;
  std::vector<Row> rows;
  for (const Result& result : results) {
    header.clear();
    rows.emplace_back();
    for (const auto& [key, value, heading, text] : facts(result)) {
      if (heading.empty()) continue;
      header.push_back(heading);
      const auto* word = std::get_if<std::string>(&value);
      const auto* count = std::get_if<std::int64_t>(&value);
      const std::string plain = word ? *word : count ? std::to_string(*count) : "";
      rows.back().push_back(text.empty() ? plain : text);
    }
  }
  print_table(header, rows);
}

void report_progress(const std::string& what) {
  print_stderr("{}\n", what);
}

void add_speed(CLI::App& bench, Context& context) {
  auto options = std::make_shared<bench::SpeedOptions>();
  CLI::App* command = bench.add_subcommand(
      "speed",
      "Measure particle-steps per second in the sheared rough cell, and the share of each part");
  add_number(*command, "--size", options->sizes, "Numbers of grains", "N", 1, 100'000'000)
      ->capture_default_str();
  add_number(*command, "--threads", options->threads, "Threads inside one run", "T", 1, 1024)
      ->capture_default_str();
  add_number(*command, "--repeats", options->repeats, "Number of timings; the median is printed",
             "N", 1, 1000)
      ->capture_default_str();
  add_number(*command, "--seconds", options->seconds_per_repeat, "Length of one timing", "S", 0.01,
             60)
      ->capture_default_str();
  add_json_option(*command, context);
  command->footer(
      "Checks that all kernels of this machine give the same state, then times each.\n"
      "Examples:\n  shearcell bench speed --size 600 5200\n"
      "  shearcell bench speed --size 18200 --threads 1 2 --json");
  command->callback([options, &context] {
    options->report = report_progress;
    const std::vector<bench::SpeedResult> results = bench::measure_speed(*options);
    if (context.json) return print_json({{"sizes", json_of(results)}});
    print_facts(results);
    fmt::print(
        "M/s: million particle-steps/s, median of {}. arith, mem: what this machine's vector units "
        "and\nits caches or memory would allow. Shares of one thread's time; search: building the "
        "outer\nneighbour list, prune: the inner one.\n",
        options->repeats);
  });
}

nlohmann::json json_of(const accuracy::Section& section) {
  return {{"name", section.name}, {"title", section.title}, {"rows", json_of(section.results)}};
}

FigureTable table_of(const accuracy::Section& section) {
  FigureTable table{.name = section.name, .columns = {}, .chart = section.chart};
  for (const Fact& fact : section.results.at(0)) table.columns.push_back(fact.key);
  for (const Facts& result : section.results) {
    TableRow& row = table.rows.emplace_back();
    for (const Fact& fact : result) row.push_back(fact.value);
  }
  return table;
}

constexpr auto is_chart = [](std::string_view text) { return text.starts_with("{\"lines\":"); };

// Creates the folder. Throws NotOurs if a file would be overwritten that this program did not
// write: a table must have its chart file beside it.
void make_own_folder(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const char* name :
       {"accuracy-collision-speed", "accuracy-seeds", "accuracy-stiffness", "accuracy-wall"}) {
    const std::string base = folder / name, chart = base + ".chart.json";
    require_ours(chart, is_chart);
    const auto made = [&](std::string_view) { return std::filesystem::exists(chart); };
    for (const char* kind : {".csv", ".svg", ".pdf"}) require_ours(base + kind, made);
  }
}

// Writes all data before it draws, since drawing needs gnuplot.
void write(const std::vector<accuracy::Section>& sections, const std::filesystem::path& folder) {
  std::vector<FigureTable> tables;
  for (const accuracy::Section& section : sections) tables.push_back(table_of(section));
  for (const FigureTable& table : tables) {
    require_own_files(table, folder);
    require_ours(folder / (table.name + ".chart.json"), is_chart);
  }
  for (const FigureTable& table : tables) {
    write_csv(table, folder);
    write_output(folder / (table.name + ".chart.json"), chart_json(table).dump() + "\n");
  }
  for (const FigureTable& table : tables) draw_svg(table, folder);
}

void measure(const accuracy::Options& options, const std::string& out, Context& context) {
  // Report an unusable folder before minutes of measuring.
  if (!out.empty()) make_own_folder(out);
  nlohmann::json all = nlohmann::json::array();
  const std::vector<accuracy::Section> sections = accuracy::measure_accuracy(options);
  for (const accuracy::Section& section : sections) {
    all.push_back(json_of(section));
    if (context.json) continue;
    fmt::print("{}\n", section.title);
    print_facts(section.summary.empty() ? section.results : section.summary);
    fmt::print("\n");
  }
  if (context.json) print_json({{"quick", options.quick}, {"sections", all}});
  if (!out.empty()) write(sections, out);
}

void add_accuracy(CLI::App& bench, Context& context) {
  auto options = std::make_shared<accuracy::Options>();
  auto out = std::make_shared<std::string>();
  options->jobs = usable_cores();
  CLI::App* command = bench.add_subcommand(
      "accuracy", "Measure error against cost of integrators, time steps and stiffness");
  command->add_flag("--quick", options->quick,
                    "Seconds instead of minutes: the same tables from fewer runs");
  add_number(*command, "--jobs", options->jobs, "Runs computed at once", "J", 1, 1024);
  command->add_option("--out", *out, "Folder for CSV files and figures")->type_name("DIR");
  add_json_option(*command, context);
  command->footer(
      "core/ACCURACY.md explains the tables and how to choose a time step.\n"
      "Examples:\n  shearcell bench accuracy --quick\n  shearcell bench accuracy --out accuracy");
  command->callback([options, out, &context] {
    options->report = report_progress;
    measure(*options, *out, context);
  });
}

void print_means(const char* title, const bench::EngineMeans& all) {
  if (all.means.empty()) return;
  Row header = {title};
  std::vector<Row> rows;
  for (const auto& [quantity, engine, of, apart] : all.means) {
    const bool ours = rows.empty() || rows.back().front() != quantity;
    if (ours) rows.push_back({quantity});
    if (rows.size() == 1) header.push_back(engine);
    std::string text = significant(of.mean.value_or(0), 4);
    if (of.standard_error) text += " +- " + significant(*of.standard_error, 1);
    if (!ours) text += fmt::format(" ({:.1f})", apart);
    rows.back().push_back(text);
  }
  print_table(header, rows);
  fmt::print("In brackets: standard errors from ours, at most {:.1f} by chance.\n\n", all.limit);
}

nlohmann::json json_of(const bench::EngineCheck& check) {
  return {{"lammps", check.lammps_version},
          {"N", check.grains},
          {"settlings", json_of(check.settlings)},
          {"settled_means", json_of(check.settled.means)},
          {"settled_limit_in_standard_errors", check.settled.limit},
          {"trajectories", json_of(check.trajectories)},
          {"means", json_of(check.sheared.means)},
          {"limit_in_standard_errors", check.sheared.limit},
          {"speeds", json_of(check.speeds)},
          {"agree", check.agree()}};
}

void print(const bench::EngineCheck& check) {
  fmt::print("LAMMPS {}; N = {}\n\n", check.lammps_version, check.grains);
  print_facts(check.settlings);
  fmt::print("\n");
  print_means("settled, mean over seeds", check.settled);
  print_facts(check.trajectories);
  fmt::print(
      "distance: largest of a grain from ours; one rounding: effect of 1 ulp in one number.\n\n");
  print_means("sheared, mean over seeds", check.sheared);
  print_facts(check.speeds);
  fmt::print(
      "M/s: million particle-steps/s, of LAMMPS in its time loop. Memory: of our simulation, or "
      "of\nthe largest process of LAMMPS.\n{}\n",
      check.agree() ? "The engines agree." : "The engines do NOT agree.");
}

void add_engines(CLI::App& bench, Context& context) {
  auto options = std::make_shared<bench::EngineCheckOptions>();
  auto weightless = std::make_shared<bool>(false);
  CLI::App* command = bench.add_subcommand(
      "engines", "Compare LAMMPS and our engine: trajectories, means over seeds, speed");
  add_number(*command, "--size", options->grains, "Number of grains", "N", 100, 100'000'000)
      ->capture_default_str();
  add_number(*command, "--steps", options->steps, "Time steps of trajectories and timing", "S", 1,
             1'000'000)
      ->capture_default_str();
  add_number(*command, "--cycles", options->cycles, "Cycles before the means; 0: no means", "C", 0,
             1000)
      ->capture_default_str();
  add_number(*command, "--seeds", options->seeds, "Packings of the means", "K", 3, 1000)
      ->capture_default_str();
  add_number(*command, "--mpi", options->ranks,
             "Run LAMMPS also with this many processes, by mpirun", "N", 1, 65536);
  command->add_flag("--settle", options->settle,
                    "Settle the loose grains in LAMMPS too, with the processes of --mpi");
  add_number(*command, "--settle-time-limit", options->settle_time_limit,
             "Simulated time after which grains that have not settled are an error "
             "(settle_time_limit_s)",
             "S", 1e-3, 1e6);
  command->add_flag("--no-gravity", *weightless, "Without gravity");
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
    options->report = report_progress;
    const bench::EngineCheck check = bench::check_engines(*options);
    context.json ? print_json(json_of(check)) : print(check);
    if (!check.agree()) context.exit_code = kRunFailed;
  });
}

void map_cases(const stability::Options& options, Context& context) {
  nlohmann::json cases = nlohmann::json::array();
  const std::vector<stability::Result> results = stability::map_stability(options);
  std::size_t right = 0;
  double total = 0;
  for (const auto& [hard, outcome, seconds] : results) {
    right += outcome.as_expected ? 1 : 0;
    total += seconds;
    cases.push_back({{"name", hard.name},
                     {"done", hard.done},
                     {"expected", hard.expected},
                     {"outcome", outcome.text},
                     {"as_expected", outcome.as_expected},
                     {"seconds", seconds}});
    if (context.json) continue;
    fmt::print("{} {}  ({:.1f} s)\n    {}\n    expected: {}\n    outcome:  {}\n",
               outcome.as_expected ? "ok " : "NOT", hard.name, seconds, hard.done, hard.expected,
               outcome.text);
  }
  if (context.json) {
    print_json({{"cases", cases}});
  } else {
    fmt::print("{} of {} cases ended as expected, in {:.0f} s.\n", right, results.size(), total);
  }
  if (right < results.size()) context.exit_code = kRunFailed;
}

void add_stability(CLI::App& bench, Context& context) {
  auto options = std::make_shared<stability::Options>();
  CLI::App* command = bench.add_subcommand(
      "stability", "Run hard cases: each must give the right answer or be stopped with the reason");
  command->add_option("--only", options->only, "Names of cases, or their beginnings")
      ->type_name("NAME")
      ->check(stability::unknown_case, "");
  command->add_flag("--quick", options->quick, "Fewer steps in the very long cases");
  add_number(*command, "--seconds", options->seconds_per_case,
             "A case that takes longer counts as hanging", "S", 0.1, 86400);
  add_json_option(*command, context);
  command->footer(
      "Ends with code 3 if a case does not end as expected.\n"
      "Examples:\n  shearcell bench stability --quick\n"
      "  shearcell bench stability --only vacancy limit --json");
  command->callback([options, &context] {
    options->report = report_progress;
    map_cases(*options, context);
  });
}

}  // namespace

void add_bench(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand("bench", "Measure the program on this machine");
  command->require_subcommand(1);
  command->footer(
      "Examples:\n  shearcell bench speed\n  shearcell bench accuracy --quick\n"
      "  shearcell bench stability --quick\n  shearcell bench engines --size 600 --cycles 1");
  add_speed(*command, context);
  add_accuracy(*command, context);
  add_engines(*command, context);
  add_stability(*command, context);
}

}  // namespace shearcell::cli
