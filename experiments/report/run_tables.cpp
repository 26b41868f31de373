// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/run_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>
#include <tuple>

namespace shearcell {
namespace {

using nlohmann::json;

/// Scale, variant and run: a run of two versions of a manifest is a member of it twice.
using RowKey = std::tuple<std::string, std::string, std::string>;

std::size_t place(const RunTable& table, std::string_view name) {
  const auto found = std::ranges::find(table.columns, name, &TableColumn::name);
  return static_cast<std::size_t>(found - table.columns.begin());
}

RowKey key_of(const RunTable& table, const std::vector<json>& row) {
  const auto text = [&](const char* name) { return row[place(table, name)].get<std::string>(); };
  return {text("scale"), text("variant"), text("run")};
}

/// Six significant digits are enough for a drawing.
json rounded(const json& value) {
  if (!value.is_number_float()) return value;
  return std::stod(fmt::format("{:.6g}", value.get<double>()));
}

std::map<RowKey, json> traces_of(const RunTable& checkpoints) {
  std::map<RowKey, json> traces;
  std::set<std::pair<RowKey, json>> seen;
  for (const std::vector<json>& row : checkpoints.rows) {
    const RowKey key = key_of(checkpoints, row);
    const json& cycle = row[place(checkpoints, "cycle")];
    if (!seen.emplace(key, cycle).second) continue;
    json& trace = traces[key];
    trace["cycle"].push_back(cycle);
    trace["phi"].push_back(rounded(row[place(checkpoints, "phi")]));
    trace["percent"].push_back(rounded(row[place(checkpoints, "crystalline_percent")]));
  }
  return traces;
}

void add_run_table(const Store& store, const RunSelection& selection,
                   const MeasureOptions& measuring, ReportExperiment& experiment, Report& report) {
  experiment.table = run_table(store, selection, RowPer::run, measuring);
  const RunTable checkpoints = run_table(store, selection, RowPer::checkpoint, measuring);
  std::set<RowKey> seen;
  std::erase_if(experiment.table.rows, [&](const std::vector<json>& row) {
    return !seen.insert(key_of(experiment.table, row)).second;
  });
  const std::map<RowKey, json> traces = traces_of(checkpoints);
  for (const std::vector<json>& row : experiment.table.rows) {
    const auto found = traces.find(key_of(experiment.table, row));
    experiment.traces.push_back(found == traces.end() ? json::object() : found->second);
  }
  for (const std::string& line : experiment.table.damage) {
    if (std::ranges::find(report.damage, line) == report.damage.end())
      report.damage.push_back(line);
  }
}

}  // namespace

void add_run_tables(const Store& store, const ReportOptions& options, ReportData& data,
                    Report& report) {
  for (ReportExperiment& experiment : data.experiments) {
    RunSelection selection;
    selection.experiments = {experiment.name};
    if (options.scale) selection.scales = {*options.scale};
    try {
      add_run_table(store, selection, {options.workers, false, options.measured}, experiment,
                    report);
    } catch (const std::runtime_error& problem) {
      // No run at this scale, or a record that this version of the program cannot read.
      report.notes.push_back(
          fmt::format("table of runs of {}: {}", experiment.name, problem.what()));
    }
  }
}

json run_traces(const ReportData& data) {
  json all = json::array();
  for (const ReportExperiment& experiment : data.experiments) {
    json runs = json::array();
    for (std::size_t r = 0; r < experiment.table.rows.size(); ++r) {
      const std::vector<json>& row = experiment.table.rows[r];
      json& run = runs.emplace_back(experiment.traces[r]);
      for (const char* key : {"scale", "variant", "seed"}) {
        run[key] = row[place(experiment.table, key)];
      }
      run["id"] = row[place(experiment.table, "run")];
      run["kind"] = data.runs.at(run["id"].get<std::string>()).run.kind;
    }
    all.push_back({{"experiment", experiment.name}, {"runs", std::move(runs)}});
  }
  return all;
}

}  // namespace shearcell
