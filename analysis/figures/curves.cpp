// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/figures/curves.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "analysis/binning.hpp"
#include "analysis/claims.hpp"
#include "analysis/error.hpp"
#include "analysis/published.hpp"

namespace shearcell {
namespace {

/// A variant as one field without quotes, for readers that do not know RFC 4180. Variants of
/// manifests have no special characters but the comma; those of another program's store may.
std::string plain_field(std::string variant) {
  const auto odd = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x80 && std::isalnum(byte) == 0 &&
           std::string_view("=.+-_;: /").find(c) == std::string_view::npos;
  };
  std::replace_if(variant.begin(), variant.end(), odd, ';');
  return variant;
}

/// Styles of curves by the keys that vary: the rank of the first key's value decides the colour,
/// the rank of the other values the symbol, as far as there are colours and symbols.
class StylesOfOthers {
 public:
  explicit StylesOfOthers(std::span<const FigureRun> runs) : keys_(varied_keys(runs)) {
    for (const FigureRun& run : runs) {
      const auto [first, rest] = values_of(run);
      firsts_.insert(first);
      rests_.insert(rest);
    }
  }

  /// Place among the variants.
  std::pair<std::size_t, std::size_t> place(const FigureRun& run) const {
    const auto rank = [](const std::set<nlohmann::json>& all, const nlohmann::json& value) {
      return static_cast<std::size_t>(std::distance(all.begin(), all.find(value)));
    };
    const auto [first, rest] = values_of(run);
    return {rank(firsts_, first), rank(rests_, rest)};
  }
  CurveStyle style(const FigureRun& run) const {
    auto [first, rest] = place(run);
    // Colour and symbol change together where one key varies, and where the values of more keys
    // would need a style twice: that gives 70 styles.
    if (rests_.size() == 1 || firsts_.size() > safe_colours.size() || rests_.size() > curve_symbols)
      first = rest = first * rests_.size() + rest;
    return {{},
            run.name.empty() ? run.place.variant : run.name,
            safe_colours[first % safe_colours.size()],
            curve_symbol(rest)};
  }
  const std::vector<std::string>& keys() const { return keys_; }

 private:
  /// The value of the first key, and an array of the others.
  std::pair<nlohmann::json, nlohmann::json> values_of(const FigureRun& run) const {
    nlohmann::json first, rest = nlohmann::json::array();
    for (const std::string& key : keys_) {
      (key == keys_.front() ? first : rest.emplace_back()) = parameter_of(run, key);
    }
    return {first, rest};
  }

  std::vector<std::string> keys_;
  std::set<nlohmann::json> firsts_;
  std::set<nlohmann::json> rests_;
};

std::vector<CurvePoint> points_of(RunGroup runs) {
  std::map<std::int64_t, CurvePoint> found;
  for (const FigureRun* run : runs) {
    for (const CheckpointMeasures& checkpoint : run->checkpoints) {
      if (std::floor(checkpoint.cycle) != checkpoint.cycle) continue;
      const auto cycle = static_cast<std::int64_t>(checkpoint.cycle);
      CurvePoint& point = found[cycle];
      if (!point.runs.empty() && point.runs.back() == run) {
        throw AnalysisError("run " + run->stage.id + " has two checkpoints of cycle " +
                            std::to_string(cycle));
      }
      point.cycle = cycle;
      point.runs.push_back(run);
      point.measures.push_back(&checkpoint.measures);
    }
  }
  std::vector<CurvePoint> points;
  for (auto& [cycle, point] : found) points.push_back(std::move(point));
  return points;
}

RunStatistics over(const CurvePoint& point, const MeasureColumn& measure) {
  std::vector<double> values;
  for (const Measures* measures : point.measures) values.push_back(measure.of(*measures));
  return measure.over(over_packings(point.runs, values));
}

/// Where runs end at different cycles, the mean over the rest would jump. So the mean ends where
/// the first run ends, and every run continues as a thin line. Returns whether the runs end at
/// different cycles.
bool follow_runs(const Curve& curve, const MeasureColumn& measure, Series& mean,
                 std::vector<Series>& single) {
  double first_end = infinite;
  for (const FigureRun* run : curve.runs) {
    if (!run->checkpoints.empty()) first_end = std::min(first_end, run->checkpoints.back().cycle);
  }
  if (static_cast<double>(curve.points.back().cycle) <= first_end) return false;
  mean.columns = {};
  for (const CurvePoint& point : curve.points) {
    const auto cycle = static_cast<double>(point.cycle);
    const RunStatistics statistics = over(point, measure);
    if (cycle > first_end || !statistics.mean) continue;
    mean.points.push_back({cycle, *statistics.mean, std::nullopt, statistics.standard_error,
                           static_cast<double>(statistics.runs)});
  }
  for (const FigureRun* run : curve.runs) {
    Series line = thin_line({}, mean.colour);
    for (const CheckpointMeasures& c : run->checkpoints) {
      const double one = measure.of(c.measures), value = measure.rms ? std::abs(one) : one;
      if (c.cycle >= first_end && std::isfinite(value)) line.points.push_back({c.cycle, value});
    }
    if (line.points.size() > 1) single.push_back(std::move(line));
  }
  return true;
}

}  // namespace

double MeasureColumn::of(const Measures& measures) const {
  if (!known.empty() && !std::isfinite(measures.number(known))) return std::nan("");
  const double value = measures.number(measure);
  return value < least ? least : value;
}

RunStatistics MeasureColumn::over(std::span<const double> values) const {
  return rms ? rms_over_runs(values) : over_runs(values);
}

std::string column_name(const MeasureColumn& measure, const char* statistic) {
  if (measure.rms && statistic == std::string_view("mean")) statistic = "rms";
  return measure.name + "_" + statistic + (measure.unit.empty() ? "" : "_" + measure.unit);
}

void add_columns(const MeasureColumn& measure, std::vector<std::string>& columns) {
  columns.push_back(column_name(measure, "mean"));
  columns.push_back(column_name(measure, "standard_error"));
}

void add_values(const RunStatistics& statistics, TableRow& row) {
  row.insert(row.end(), {statistics.mean, statistics.standard_error});
}

SeriesColumns columns_against(std::string x, const MeasureColumn& y) {
  return {.x = std::move(x),
          .y = column_name(y, "mean"),
          .y_error = column_name(y, "standard_error"),
          .runs = "runs"};
}

std::vector<Curve> curves_of(std::span<const FigureRun> runs, std::span<const CurveStyle> styles) {
  std::map<std::string, std::vector<const FigureRun*>> variants;
  for (const FigureRun& run : runs) variants[run.place.variant].push_back(&run);
  const StylesOfOthers others(runs);
  const bool own = std::ranges::all_of(others.keys(), [&](const std::string& key) {
    return std::ranges::any_of(styles, [&](const CurveStyle& s) { return s.where.contains(key); });
  });
  std::vector<std::size_t> used(styles.size() + 1);
  std::vector<std::pair<std::size_t, Curve>> ranked;  // by style
  for (auto& [variant, members] : variants) {
    Curve curve{plain_field(variant), {}, std::move(members), {}};
    curve.points = points_of(curve.runs);
    if (curve.points.empty()) continue;
    const auto style = std::ranges::find_if(styles, [&](const CurveStyle& s) {
      return (own || s.of_manifest) && has_parameters(*curve.runs.front(), s.where);
    });
    const auto rank = static_cast<std::size_t>(style - styles.begin());
    ++used[rank];
    ranked.emplace_back(rank, std::move(curve));
  }
  for (auto& [rank, curve] : ranked) {
    const FigureRun& run = *curve.runs.front();
    curve.style = others.style(run);
    if (used[rank] > 1) rank = styles.size();
    if (rank == styles.size()) continue;
    const CurveStyle& stated = styles[rank];
    if (!stated.title.empty() && (stated.of_manifest || !run.named)) {
      curve.style.title = stated.title;
    }
    if (!stated.colour.empty()) curve.style.colour = stated.colour;
    if (stated.point >= 0) curve.style.point = stated.point;
  }
  // A colour that a manifest states is of that curve alone.
  std::set<std::string> taken;
  for (const CurveStyle& style : styles) taken.insert(style.of_manifest ? style.colour : "");
  for (auto& [rank, curve] : ranked) {
    if (rank < styles.size() && !styles[rank].colour.empty()) continue;
    if (!taken.contains(curve.style.colour)) continue;
    const auto free = std::ranges::find_if(safe_colours, [&](const char* colour) {
      return !taken.contains(colour) && std::ranges::none_of(ranked, [&](const auto& other) {
        return other.second.style.colour == colour;
      });
    });
    if (free != safe_colours.end()) curve.style.colour = *free;
  }
  std::ranges::stable_sort(ranked, {}, [&](const auto& entry) {
    return std::pair(entry.first, others.place(*entry.second.runs.front()));
  });
  std::vector<Curve> curves;
  for (auto& [rank, curve] : ranked) curves.push_back(std::move(curve));
  return curves;
}

std::vector<ReferenceLine> onset_lines(bool vertical) {
  std::vector<ReferenceLine> lines;
  for (const double error : {-published_onset_error, published_onset_error}) {
    lines.push_back({.at = published_onset_phi + error,
                     .vertical = vertical,
                     .title = "the supplement's onset, 0.646 ± 0.001"});
  }
  return lines;
}

ReferenceLine critical_line(double size, const std::string& colour) {
  return {.at = size, .colour = colour, .title = "the supplement's critical sizes"};
}

void add_size_columns(const std::string& name, std::vector<std::string>& columns) {
  for (const char* ending : {"", "_low", "_high", "_standard_error"}) {
    columns.push_back(name + ending + "_grains");
  }
}

void add_size(const std::optional<Estimate>& size, TableRow& row) {
  if (!size) {
    row.resize(row.size() + 4);
    return;
  }
  row.insert(row.end(), {size->value, size->interval.low, size->interval.high,
                         size->spread / std::sqrt(static_cast<double>(size->runs))});
}

Series thin_line(Text title, std::string colour, int point) {
  return {.title = std::move(title),
          .colour = std::move(colour),
          .point = point,
          .join = Join::line,
          .thin = true};
}

std::vector<Series> series_of(std::span<const Curve> curves, const SeriesColumns& columns) {
  std::vector<Series> series;
  std::set<std::string> titles;
  for (const Curve& curve : curves) {
    if (!titles.insert(plain_text(curve.style.title)).second) {
      throw AnalysisError("two curves of a figure have the label '" +
                          plain_text(curve.style.title) +
                          "'; give each its own, in the `series` of its plot or in `labels`");
    }
    series.push_back({.title = curve.style.title,
                      .colour = curve.style.colour,
                      .point = curve.style.point,
                      .join = Join::line,
                      .band = true,
                      .columns = columns,
                      .filter = {"variant", curve.variant},
                      .runs = by_packing(curve.runs).size()});
  }
  return series;
}

FigureTable against_cycle(const std::string& name, std::span<const Curve> curves,
                          std::span<const MeasureColumn> measures, Axis y) {
  FigureTable table{.name = name, .columns = {"variant", "cycle"}};
  for (const MeasureColumn& measure : measures) add_columns(measure, table.columns);
  table.columns.emplace_back("runs");
  for (const Curve& curve : curves) {
    for (const CurvePoint& point : curve.points) {
      TableRow& row = table.rows.emplace_back(TableRow{curve.variant, point.cycle});
      for (const MeasureColumn& measure : measures) add_values(over(point, measure), row);
      row.emplace_back(over(point, measures.front()).runs);
    }
  }
  table.chart = {.x = cycle_axis,
                 .y = std::move(y),
                 .series = series_of(curves, columns_against("cycle", measures.front()))};
  std::vector<Series> single;
  for (std::size_t k = 0; k < curves.size(); ++k) {
    if (follow_runs(curves[k], measures.front(), table.chart.series[k], single)) {
      table.chart.note = "Thin lines: single runs, from where the first run of a curve has ended";
    }
  }
  std::ranges::move(single, std::back_inserter(table.chart.series));
  return table;
}

FigureTable against_phi(const std::string& name, std::span<const Curve> curves,
                        const MeasureColumn& measure, Axis y) {
  FigureTable table{
      .name = name,
      .columns = {"variant", "phi_low", "phi_high", "phi_mean", "phi_standard_error"}};
  add_columns(measure, table.columns);
  table.columns.emplace_back("runs");
  for (const Curve& curve : curves) {
    for (const PhiBin& bin : binned_by_phi(curve.runs, measure.measure, measure.least)) {
      TableRow& row = table.rows.emplace_back(TableRow{curve.variant, bin.low, bin.high});
      add_values(bin.phi, row);
      add_values(bin.value, row);
      row.emplace_back(bin.value.runs);
    }
  }
  SeriesColumns columns = columns_against("phi_mean", measure);
  columns.x_error = "phi_standard_error";
  table.chart = {.x = phi_axis, .y = std::move(y), .series = series_of(curves, columns)};
  return table;
}

}  // namespace shearcell
