// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/figures/curves.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "analysis/error.hpp"
#include "analysis/published.hpp"

namespace shearcell {
namespace {

bool matches(const nlohmann::json& a, const nlohmann::json& b) {
  if (a.is_number() && b.is_number()) {
    const auto x = a.get<double>();
    const auto y = b.get<double>();
    return std::abs(x - y) <= 0.03 * std::abs(y);
  }
  return a == b;
}

/// gnuplot's strcol() ends a field at every comma and does not read quotes as RFC 4180 does.
/// Variants of our manifests have no other special characters; those of a foreign store may.
std::string plain_field(std::string variant) {
  const auto odd = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x80 && std::isalnum(byte) == 0 &&
           std::string_view("=.+-_;: /").find(c) == std::string_view::npos;
  };
  std::replace_if(variant.begin(), variant.end(), odd, ';');
  return variant;
}

/// Values of `keys` in a run.
std::vector<nlohmann::json> values_of(const FigureRun& run, std::span<const std::string> keys) {
  std::vector<nlohmann::json> values;
  for (const std::string& key : keys) values.push_back(parameter_of(run, key));
  return values;
}

template <class Value>
int rank_in(const std::set<Value>& all, const Value& value) {
  return static_cast<int>(std::distance(all.begin(), all.find(value)));
}

/// Styles by what varies: ranks of the values decide colour and symbol. Each pair comes once.
class StylesOfOthers {
 public:
  explicit StylesOfOthers(std::span<const FigureRun> runs) : keys_(varied_keys(runs)) {
    for (const FigureRun& run : runs) {
      std::vector<nlohmann::json> values = values_of(run, keys_);
      if (!values.empty()) firsts_.insert(values.front());
      if (!values.empty()) values.erase(values.begin());
      rests_.insert(std::move(values));
    }
  }

  /// Place among the variants.
  std::pair<int, int> place(const FigureRun& run) const {
    std::vector<nlohmann::json> values = values_of(run, keys_);
    const int first = values.empty() ? 0 : rank_in(firsts_, values.front());
    if (!values.empty()) values.erase(values.begin());
    return {first, rank_in(rests_, values)};
  }
  CurveStyle style(const FigureRun& run) const {
    const auto [first, rest] = place(run);
    // 5, 7, 9, 11, 13: filled symbols; where one key varies, they change with the colour.
    const int symbol = rests_.size() > 1 ? rest : first;
    constexpr int symbols = 5;
    return {nullptr, run.name.empty() ? run.variant : run.name,
            safe_colours[static_cast<std::size_t>(first) % safe_colours.size()],
            5 + 2 * (symbol % symbols)};
  }
  const std::vector<std::string>& keys() const { return keys_; }

 private:
  std::vector<std::string> keys_;
  std::set<nlohmann::json> firsts_;
  std::set<std::vector<nlohmann::json>> rests_;
};

std::vector<CurvePoint> points_of(std::span<const FigureRun* const> runs) {
  std::map<std::int64_t, std::vector<const Measures*>> found;
  for (const FigureRun* run : runs) {
    std::set<std::int64_t> seen;
    for (const CheckpointMeasures& checkpoint : run->checkpoints) {
      if (std::floor(checkpoint.cycle) != checkpoint.cycle) continue;
      const auto cycle = static_cast<std::int64_t>(checkpoint.cycle);
      if (!seen.insert(cycle).second) {
        throw AnalysisError("run " + run->run_id + " has two checkpoints of cycle " +
                            std::to_string(cycle));
      }
      found[cycle].push_back(&checkpoint.measures);
    }
  }
  std::vector<CurvePoint> points;
  for (auto& [cycle, measures] : found) points.push_back({cycle, std::move(measures)});
  return points;
}

const MeasureColumn crystalline = {"crystalline", "percent", &Measures::crystalline_percent};

}  // namespace

std::string column_name(const MeasureColumn& measure, const char* statistic) {
  return measure.name + "_" + statistic + (measure.unit.empty() ? "" : "_" + measure.unit);
}

void add_columns(const MeasureColumn& measure, std::vector<std::string>& columns) {
  columns.push_back(column_name(measure, "mean"));
  columns.push_back(column_name(measure, "standard_error"));
}

void add_values(const RunStatistics& statistics, std::vector<TableValue>& row) {
  row.push_back(table_value(statistics.mean));
  row.push_back(table_value(statistics.standard_error));
}

std::vector<Curve> curves_of(std::span<const FigureRun> runs, const std::string& parameter,
                             std::span<const CurveStyle> styles) {
  return curves_by(
      runs, std::span(&parameter, 1),
      [&](const FigureRun& run) { return parameter_of(run, parameter); }, styles);
}

std::vector<Curve> curves_by(std::span<const FigureRun> runs, std::span<const std::string> keys,
                             const std::function<nlohmann::json(const FigureRun&)>& value_of,
                             std::span<const CurveStyle> styles) {
  std::map<std::string, std::vector<const FigureRun*>> variants;
  for (const FigureRun& run : runs) variants[run.variant].push_back(&run);
  const StylesOfOthers others(runs);
  const bool own = std::ranges::all_of(others.keys(), [&](const std::string& key) {
    return std::ranges::find(keys, key) != keys.end();
  });
  std::vector<std::size_t> used(styles.size() + 1);
  std::vector<std::pair<std::size_t, Curve>> ranked;  // by style
  for (auto& [variant, members] : variants) {
    Curve curve;
    curve.variant = plain_field(variant);
    curve.value = value_of(*members.front());
    curve.points = points_of(members);
    curve.runs = std::move(members);
    if (curve.points.empty()) continue;
    const auto style = std::ranges::find_if(
        styles, [&](const CurveStyle& s) { return own && matches(curve.value, s.value); });
    const auto rank = static_cast<std::size_t>(style - styles.begin());
    ++used[rank];
    ranked.emplace_back(rank, std::move(curve));
  }
  for (auto& [rank, curve] : ranked) {
    const FigureRun& run = *curve.runs.front();
    curve.style = others.style(run);
    if (used[rank] > 1) rank = styles.size();
    if (rank == styles.size()) continue;
    if (run.named) {
      curve.style.colour = styles[rank].colour, curve.style.point = styles[rank].point;
    } else {
      curve.style = styles[rank];
    }
  }
  std::ranges::stable_sort(ranked, {}, [&](const auto& entry) {
    return std::pair(entry.first, others.place(*entry.second.runs.front()));
  });
  std::vector<Curve> curves;
  for (auto& [rank, curve] : ranked) curves.push_back(std::move(curve));
  return curves;
}

const Curve* curve_with(std::span<const Curve> curves, const nlohmann::json& value) {
  const Curve* found = nullptr;
  for (const Curve& curve : curves) {
    if (!matches(curve.value, value)) continue;
    if (found != nullptr) return nullptr;
    found = &curve;
  }
  return found;
}

RunStatistics over(const CurvePoint& point, const Quantity& quantity) {
  std::vector<double> values;
  values.reserve(point.runs.size());
  for (const Measures* measures : point.runs) values.push_back(quantity(*measures));
  return over_runs(values);
}

Axis cycle_axis() {
  return {.name = "shear cycle", .symbol = italic("n"), .whole = true};
}

Axis phi_axis() {
  return {.name = "volume fraction", .symbol = italic("ϕ")};
}

Axis crystalline_axis() {
  return {.name = "percentage crystalline", .unit = "%", .low = 0};
}

Axis overlap_axis() {
  return {.name = "mean overlap", .symbol = Text("⟨") + italic("δ") + "⟩", .unit = italic("d")};
}

Axis amplitude_axis() {
  return {.name = "amplitude", .symbol = italic("A"), .unit = "rad", .low = 0, .high = 0.12};
}

Axis onset_axis() {
  return {.name = "onset", .symbol = italic("ϕ")};
}

std::vector<ReferenceLine> onset_lines() {
  const Text title = "the supplement's onset, 0.646 ± 0.001";
  return {{.at = published_onset_phi - published_onset_error, .title = title},
          {.at = published_onset_phi + published_onset_error, .title = title}};
}

std::vector<Series> series_of(std::span<const Curve> curves, const SeriesColumns& columns) {
  std::vector<Series> series;
  std::set<std::string> titles;
  for (const Curve& curve : curves) {
    if (!titles.insert(plain_text(curve.style.title)).second) {
      throw AnalysisError("two curves of a figure have the label '" +
                          plain_text(curve.style.title) + "'; give their variants other `labels`");
    }
    series.push_back({.title = curve.style.title,
                      .colour = curve.style.colour,
                      .point = curve.style.point,
                      .join = Join::line,
                      .band = true,
                      .columns = columns,
                      .filter = {"variant", curve.variant}});
  }
  return series;
}

namespace {

/// Where runs end at different cycles, a mean over those that are left jumps: it ends with the
/// first of them, and each run continues as a thin line. Returns whether there are such lines.
bool follow_runs(const Curve& curve, const Quantity& quantity, Series& mean,
                 std::vector<Series>& single) {
  double first_end = std::numeric_limits<double>::infinity();
  for (const FigureRun* run : curve.runs) {
    if (!run->checkpoints.empty()) first_end = std::min(first_end, run->checkpoints.back().cycle);
  }
  if (static_cast<double>(curve.points.back().cycle) <= first_end) return false;
  mean.columns = {};
  for (const CurvePoint& point : curve.points) {
    const auto cycle = static_cast<double>(point.cycle);
    const RunStatistics statistics = over(point, quantity);
    if (cycle > first_end || !statistics.mean) continue;
    mean.points.push_back({cycle, *statistics.mean, std::nullopt, statistics.standard_error});
  }
  for (const FigureRun* run : curve.runs) {
    Series line{.colour = mean.colour, .point = 0, .join = Join::line, .thin = true};
    for (const CheckpointMeasures& c : run->checkpoints) {
      const double value = quantity(c.measures);
      if (c.cycle < first_end || !std::isfinite(value)) continue;
      line.points.push_back({c.cycle, value});
    }
    if (line.points.size() > 1) single.push_back(std::move(line));
  }
  return true;
}

}  // namespace

FigureTable against_cycle(const std::string& name, std::span<const Curve> curves,
                          std::span<const MeasureColumn> measures, Axis y) {
  FigureTable table{.name = name, .columns = {"variant", "cycle"}, .rows = {}};
  for (const MeasureColumn& measure : measures) add_columns(measure, table.columns);
  table.columns.emplace_back("runs");
  for (const Curve& curve : curves) {
    for (const CurvePoint& point : curve.points) {
      auto& row = table.rows.emplace_back(std::vector<TableValue>{curve.variant, point.cycle});
      for (const MeasureColumn& measure : measures) add_values(over(point, measure.quantity), row);
      row.emplace_back(static_cast<std::int64_t>(over(point, measures.front().quantity).runs));
    }
  }
  table.chart = {
      .x = cycle_axis(),
      .y = std::move(y),
      .series = series_of(curves, {.x = "cycle",
                                   .y = column_name(measures.front(), "mean"),
                                   .y_error = column_name(measures.front(), "standard_error")})};
  std::vector<Series> single;
  for (std::size_t k = 0; k < curves.size(); ++k) {
    if (follow_runs(curves[k], measures.front().quantity, table.chart.series[k], single)) {
      table.chart.note = "Thin lines: single runs, from where the first run of a curve has ended";
    }
  }
  std::ranges::move(single, std::back_inserter(table.chart.series));
  return table;
}

FigureTable against_phi(const std::string& name, std::span<const Curve> curves,
                        const MeasureColumn& measure, Axis y) {
  FigureTable table{.name = name,
                    .columns = {"variant", "phi_low", "phi_high", "phi_mean", "phi_standard_error"},
                    .rows = {}};
  add_columns(measure, table.columns);
  table.columns.emplace_back("runs");
  for (const Curve& curve : curves) {
    for (const PhiBin& bin : binned_by_phi(curve.runs, measure.quantity)) {
      auto& row =
          table.rows.emplace_back(std::vector<TableValue>{curve.variant, bin.low, bin.high});
      add_values(bin.phi, row);
      add_values(bin.value, row);
      row.emplace_back(static_cast<std::int64_t>(bin.value.runs));
    }
  }
  table.chart = {.x = phi_axis(),
                 .y = std::move(y),
                 .series = series_of(curves, {.x = "phi_mean",
                                              .y = column_name(measure, "mean"),
                                              .x_error = "phi_standard_error",
                                              .y_error = column_name(measure, "standard_error")})};
  return table;
}

FigureTable phi_against_cycle(const std::string& name, std::span<const Curve> curves) {
  static const std::array<MeasureColumn, 3> measures = {
      {{"phi", "", &Measures::phi},
       {"phi_u", "", &Measures::phi_uncorrected},
       {"overlap", "d", &Measures::mean_overlap}}};
  return against_cycle(name, curves, measures, phi_axis());
}

FigureTable crystallinity_against_cycle(const std::string& name, std::span<const Curve> curves) {
  return against_cycle(name, curves, std::span(&crystalline, 1), crystalline_axis());
}

FigureTable crystallinity_against_phi(const std::string& name, std::span<const Curve> curves) {
  return against_phi(name, curves, crystalline, crystalline_axis());
}

}  // namespace shearcell
