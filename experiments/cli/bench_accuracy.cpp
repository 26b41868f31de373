// SPDX-License-Identifier: GPL-3.0-or-later
// `bench accuracy`: speed against error.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <thread>

#include "analysis/plot.hpp"
#include "experiments/bench/accuracy/accuracy.hpp"
#include "experiments/cli/command.hpp"
#include "provenance/io/plain_file.hpp"

namespace shearcell::cli {
namespace {

struct AccuracyOptions {
  accuracy::Options measure;
  std::string out;
};

struct JsonOf {
  nlohmann::json operator()(std::monostate) const { return nullptr; }
  nlohmann::json operator()(const auto& value) const { return value; }
};

nlohmann::json facts(const accuracy::Section& section) {
  nlohmann::json rows = nlohmann::json::array();
  for (const std::vector<TableValue>& row : section.table.rows) {
    nlohmann::json values = nlohmann::json::object();
    for (std::size_t c = 0; c < row.size(); ++c) {
      values[section.table.columns[c]] = std::visit(JsonOf{}, row[c]);
    }
    rows.push_back(std::move(values));
  }
  return {{"name", section.table.name}, {"title", section.title}, {"rows", rows}};
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
    nlohmann::json all = nlohmann::json::array();
    for (const accuracy::Section& section : sections) all.push_back(facts(section));
    print_json({{"quick", options.measure.quick}, {"sections", all}});
  } else {
    print(sections);
  }
  if (!options.out.empty()) write(sections, options.out);
}

}  // namespace

void add_bench_accuracy(CLI::App& bench, Context& context) {
  auto options = std::make_shared<AccuracyOptions>();
  options->measure.jobs = std::max(1U, std::thread::hardware_concurrency());
  CLI::App* command = bench.add_subcommand(
      "accuracy", "Measure error against cost of integrators, time steps and stiffness");
  command->add_flag("--quick", options->measure.quick,
                    "Seconds instead of minutes: the same tables from fewer runs");
  add_count(*command, "--jobs", options->measure.jobs, "Runs computed at once", "J", 1, 1024);
  command->add_option("--out", options->out, "Folder for CSV files and figures")->type_name("DIR");
  command->add_flag("--json", context.json, "Print JSON for programs");
  command->footer(
      "core/ACCURACY.md explains the tables and how to choose a time step.\n"
      "Examples:\n  shearcell bench accuracy --quick\n  shearcell bench accuracy --out accuracy");
  command->callback([options, &context] {
    options->measure.report = [](const std::string& what) { tell_stderr("{}\n", what); };
    measure(*options, context);
  });
}

}  // namespace shearcell::cli
