// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/run_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <set>

#include "analysis/onset.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/suggest.hpp"
#include "experiments/runner/outlook.hpp"
#include "experiments/runner/registered.hpp"
#include "provenance/lineage.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

/// The run and the checkpoint that a row describes.
struct Row {
  const FrameRun* run = nullptr;
  const CheckpointMeasures* checkpoint = nullptr;  // null for a run that was not started
  // Onsets are computed from this copy of the run, which has only the measured checkpoints at whole
  // cycles. Null if the row shows no onsets.
  const FrameRun* history = nullptr;
};

struct Column : TableColumn {
  std::function<TableCell(const Row&)> cell;
};

TableCell number(double value) {
  return std::isfinite(value) ? TableCell(value) : TableCell();
}

template <class Value>
Column of_run(std::string_view name, std::string_view meaning, Value value) {
  return {{std::string(name), std::string(meaning)},
          [value](const Row& row) { return TableCell(value(*row.run)); }};
}

template <class Value>
Column of_checkpoint(std::string_view name, std::string_view meaning, Value value) {
  return {{std::string(name), std::string(meaning)}, [value](const Row& row) {
            return row.checkpoint == nullptr ? TableCell() : TableCell(value(*row.checkpoint));
          }};
}

Column column_of(const Measure& measure) {
  return {{std::string(measure.name), std::string(measure.meaning)},
          [&measure](const Row& row) -> TableCell {
            const bool of_run = measure.kind == MeasureKind::run;
            if (of_run ? row.history == nullptr : row.checkpoint == nullptr) return {};
            const double value = of_run ? measure.of_run(*row.history).or_nan()
                                        : row.checkpoint->measures.number(measure.name);
            const bool count = measure.kind == MeasureKind::count && std::isfinite(value);
            return count ? TableCell(static_cast<std::int64_t>(value)) : number(value);
          }};
}

std::vector<Column> which_checkpoint() {
  return {of_checkpoint(
              "cycle",
              "cycles since the shear began; in a stiffening, number of completed minimizations",
              [](const CheckpointRecord& c) { return c.cycle; }),
          of_checkpoint("checkpoint", "SHA-256 of the checkpoint's file",
                        [](const CheckpointRecord& c) { return c.sha256; })};
}

/// The columns of a checkpoint. A measure that needs a simulation has a column only if `simulated`
/// contains the name of the measure's provider.
std::vector<Column> measures(std::span<const std::string> simulated) {
  std::vector<Column> columns = which_checkpoint();
  for (const Measure* measure : all_measures(MeasureKind::number)) {
    const Provider& by = provider_of(*measure);
    const bool listed = std::ranges::count(simulated, by.name) > 0;
    if (by.from != ComputedFrom::simulation || listed) columns.push_back(column_of(*measure));
  }
  return columns;
}

Column outcome_of(const char* name, const char* meaning, OnsetMethod find) {
  return {{name, std::string("outcome (observed, never, before_start or unclear) of ") + meaning},
          [find](const Row& row) -> TableCell {
            if (row.history == nullptr || row.history->checkpoints.empty()) return {};
            const Missing missing = find(*row.history).missing;
            return missing == Missing::nothing     ? "observed"
                   : missing == Missing::too_short ? "never"
                   : missing == Missing::too_late  ? "before_start"
                                                   : "unclear";
          }};
}

std::vector<Column> ends() {
  std::vector<Column> columns;
  for (const Measure* one : all_measures(MeasureKind::run)) columns.push_back(column_of(*one));
  columns.push_back(outcome_of("onset_size", "method 1", onset_by_size));
  columns.push_back(outcome_of("onset_slope", "method 2", onset_by_slope));
  columns.insert(
      columns.end(),
      {of_run("state", "declared, running, interrupted, failed or completed",
              [](const Run& s) { return std::string(name_of(s.stage.state)); }),
       of_checkpoint("state_hash", "hash of this state; equal states have equal hashes",
                     [](const CheckpointRecord& c) { return c.state_hash; }),
       of_run("target_cycles", "number of cycles that the experiment asks for",
              [](const Run& s) { return s.ask.target_cycles; }),
       of_run("wall_time_s", "wall-clock time of the computation, summed over all attempts",
              [](const Run& s) { return number(s.stage.wall_seconds); }),
       of_run("particle_steps_per_s", "mean speed of the computation, in particle-steps per second",
              [](const Run& s) { return number(s.stage.particle_steps / s.stage.wall_seconds); })});
  return columns;
}

/// The columns that identify a run: names, seed and swept parameters.
std::vector<Column> columns_of_runs(const std::vector<FrameRun>& runs) {
  std::set<std::string> swept = {"grains"};  // every table has this column
  for (const FrameRun& run : runs) {
    for (const auto& [key, value] : run.place.swept.items()) swept.insert(key);
  }
  std::vector<Column> columns = {
      of_run("experiment", "name of the experiment",
             [](const Run& s) { return s.place.experiment; }),
      of_run("scale", "scale of the manifest",
             [](const Run& s) { return scale_name(s.place.scale); }),
      of_run("variant", "label of the variant in the manifest, or its swept values",
             [](const Run& s) { return s.name; }),
      of_run("run", "id of the run", [](const Run& s) { return s.stage.id; }),
      of_run("seed", "seed of the random numbers", [](const Run& s) { return s.place.seed; }),
  };
  for (const Field& field : schema()) {
    if (!swept.contains(std::string(field.name))) continue;
    columns.push_back(of_run(field.name, field.doc, [&field](const FrameRun& run) {
      return cell_of(parameter_of(run, std::string(field.name)));
    }));
  }
  return columns;
}

std::vector<Column> columns_for(const std::vector<FrameRun>& runs, RowPer per,
                                std::span<const std::string> simulated) {
  std::vector<Column> columns = columns_of_runs(runs);
  std::ranges::move(measures(simulated), std::back_inserter(columns));
  if (per == RowPer::run) std::ranges::move(ends(), std::back_inserter(columns));
  return columns;
}

std::vector<FrameRun> select(const Store& store, const RunSelection& selection,
                             const MeasureOptions& options, RunTable& table) {
  std::vector<FrameRun> runs = frame_runs(select_runs(store, selection), table.notes);
  const VariantNames names(store);
  for (FrameRun& run : runs) {
    run.name = names.of(run.stage, run.place);
    for (CheckpointRecord& record : checkpoints_for(store, run.stage, {&run.ask, 1}, options)) {
      run.checkpoints.push_back({std::move(record)});
    }
  }
  return runs;
}

/// Adds a note on checkpoints that lack a measure because an earlier checkpoint is pruned or
/// damaged. Checkpoints whose own file was pruned are not counted.
void note_lacking(const std::vector<FrameRun>& runs, RunTable& table) {
  std::map<std::string, std::size_t> lacking;  // checkpoints, by provider
  for (const FrameRun& run : runs) {
    for (const CheckpointMeasures& one : run.checkpoints) {
      if (one.state == CheckpointState::pruned) continue;
      for (const std::string& name : one.lacking) ++lacking[name];
    }
  }
  for (const auto& [name, count] : lacking) {
    if (provider(name).cycles_back == 0) continue;
    table.notes.push_back(fmt::format(
        "in {} the {} measures are missing, because a checkpoint before {} is pruned or "
        "damaged; `shearcell regenerate` restores the pruned or damaged file",
        counted(count, "checkpoint"), name, count == 1 ? "it" : "them"));
  }
}

}  // namespace

std::vector<std::string> table_providers() {
  return provider_names([](const Provider& one) {
    return one.from == ComputedFrom::checkpoint && one.has(MeasureKind::number);
  });
}

std::vector<std::string> simulating_providers() {
  return provider_names([](const Provider& one) { return one.from == ComputedFrom::simulation; });
}

RunTable run_table(const Store& store, const RunSelection& selection, RowPer per,
                   const MeasureOptions& options, std::span<const std::string> simulated) {
  RunTable made;
  std::vector<FrameRun> runs = select(store, selection, options, made);
  std::vector<std::string> names = table_providers();
  names.insert(names.end(), simulated.begin(), simulated.end());
  std::vector<ToMeasure> in_rows, others;
  for (FrameRun& run : runs) {
    for (CheckpointMeasures& one : run.checkpoints) {
      const bool has_row = per == RowPer::checkpoint || &one == &run.checkpoints.back();
      (has_row ? in_rows : others).push_back({&one, run.ask.checkpoint_every});
    }
  }
  made += measure_checkpoints(store, in_rows, names, options);
  const std::string scalars = scalars_provider;  // onsets need only the measures of this provider
  made += measure_checkpoints(store, others, {&scalars, 1}, options);
  note_lacking(runs, made);
  const std::vector<Column> columns = columns_for(runs, per, simulated);
  made.table.columns.assign(columns.begin(), columns.end());
  const auto add = [&](const Row& row) {
    TableRow& cells = made.table.rows.emplace_back();
    for (const Column& column : columns) cells.push_back(column.cell(row));
  };
  for (FrameRun& run : runs) {
    if (per == RowPer::checkpoint) {
      for (const CheckpointMeasures& checkpoint : run.checkpoints) add({&run, &checkpoint});
      continue;
    }
    const auto* last = run.checkpoints.empty() ? nullptr : &run.checkpoints.back();
    const double end = last == nullptr ? 0 : last->cycle;
    run.core_time_s = computing_time(store, run.stage.id, end).core_seconds;
    FrameRun& history = made.histories.emplace_back(run);
    leave_out_unmeasured(history);
    std::erase_if(history.checkpoints,
                  [](const CheckpointMeasures& one) { return one.cycle != std::floor(one.cycle); });
    add({&run, last, run.stage.kind == name_of(StageKind::shear) ? &history : nullptr});
  }
  return made;
}

RunTable curve_table(const Store& store, const RunSelection& selection, const Measure& measure,
                     const MeasureOptions& options) {
  const std::string provider = provider_of(measure).name;
  RunTable made;
  std::vector<FrameRun> runs = select(store, selection, options, made);
  made += measure_runs(store, runs, {&provider, 1}, options);
  note_lacking(runs, made);
  std::vector<Column> columns = columns_of_runs(runs);
  std::ranges::move(which_checkpoint(), std::back_inserter(columns));
  made.table.columns.assign(columns.begin(), columns.end());
  made.table.columns.push_back(std::string(measure.x));
  made.table.columns.push_back({std::string(measure.name), std::string(measure.meaning)});
  for (FrameRun& run : runs) {
    for (CheckpointMeasures& checkpoint : run.checkpoints) {
      const MeasuredCurve& curve = checkpoint.measures.curves[std::string(measure.name)];
      TableRow cells;
      for (const Column& column : columns) cells.push_back(column.cell({&run, &checkpoint}));
      for (std::size_t i = 0; i < curve.x.size(); ++i) {
        made.table.rows.push_back(cells);
        made.table.rows.back().push_back(number(curve.x[i]));
        made.table.rows.back().push_back(number(curve.y[i]));
      }
    }
  }
  return made;
}

std::vector<TableColumn> table_columns() {
  const std::vector<Column> columns = columns_for({}, RowPer::run, simulating_providers());
  return {columns.begin(), columns.end()};
}

std::vector<std::pair<TableColumn, TableCell>> facts_of(const CheckpointRecord& record,
                                                        const Measures& found) {
  const CheckpointMeasures checkpoint{record, found};
  std::vector<std::pair<TableColumn, TableCell>> facts;
  for (const Column& column : measures({})) {
    facts.emplace_back(column, column.cell({nullptr, &checkpoint}));
  }
  return facts;
}

std::string to_json(const RunTable& made, bool notes) {
  ordered_json value = to_json(made.table);
  if (notes) {
    value = {{"rows", std::move(value)},
             {"notes", made.notes},
             {"damage", made.damage},
             {"pruned", made.pruned}};
  }
  return value.dump(1, ' ', false, json::error_handler_t::replace) + '\n';
}

bool is_table(std::string_view beginning) {
  return beginning.starts_with("experiment,scale,variant,run,seed,") || beginning == "[]\n" ||
         beginning.starts_with("[\n {\n  \"experiment\": ") ||
         beginning.starts_with("{\n \"rows\": [");
}

}  // namespace shearcell
