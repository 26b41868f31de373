// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a manifest. fields() lists the keys of each struct: for each key, the member that holds the
// value, the name, the meaning and the allowed values. With this list, Reader reads and checks the
// keys, and keys_markdown() documents them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <boost/algorithm/string/trim_all.hpp>
#include <cctype>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <ranges>
#include <set>
#include <span>
#include <utility>

#include "analysis/estimators.hpp"
#include "analysis/expression.hpp"
#include "analysis/figure.hpp"
#include "analysis/styles.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/shipped.hpp"
#include "experiments/manifest/suggest.hpp"
#include "experiments/manifest/variants.hpp"
#include "provenance/io/read_number.hpp"
#include "provenance/limits.hpp"
#include "provenance/words.hpp"

namespace shearcell {

enum class Spacing : std::uint8_t { linear, log };
template <>
inline constexpr auto kNames<Spacing> = names_in_order<Spacing>("linear", "log");

namespace {

using nlohmann::json;
using std::string;
using std::string_view;
using Names = std::vector<string_view>;

constexpr std::size_t kLongestLabel = 120, kLongestPath = 1000;  // [bytes]
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Range kCycles = {0, StoreLimits::cycles};
// A double can hold every whole number up to this one without rounding.
constexpr std::uint64_t kLargestSeed = (std::uint64_t{1} << 53) - 1;

template <class... More>
Names joined(Names names, const More&... more) {
  (names.insert(names.end(), more.begin(), more.end()), ...);
  return names;
}

Names parameters() {
  return names_of(schema() | std::views::filter([](const Field& field) {
                    return field.identity.distinguishes_runs();
                  }));
}

Names measures(MeasureKind kind) {
  Names names;
  for (const Measure* one : all_measures(kind)) names.push_back(one->name);
  return names;
}

Names numbers() {
  return names_of(schema() | std::views::filter(std::not_fn(&Field::is_choice)));
}

void fields(Checkpoints& checkpoints, const auto& visit) {
  visit(checkpoints.every_cycles, "every_cycles", "", {.range = {1, StoreLimits::cycles}});
  visit(checkpoints.phases, "phases", "",
        {.range = {-kInfinity, kInfinity}, .example = "[0.25, 0.5, 0.75]"});
}

Field field_of_until(const Measure& one) {
  const bool counts = one.kind == MeasureKind::count;
  Field field{.unit = one.unit, .whole = counts};
  field.range = counts ? Range{1, 1e8} : Range{-1e100, 1e100};
  if (one.unit == "%") field.range = {0, 100, true};
  if (one.name == "phi" || one.name.ends_with("_phi")) field.range = {0, 1, true};
  return field;
}

void fields(Until& until, const auto& visit) {
  for (const Provider& by : all_providers()) {
    for (const Measure& one : by.measures) {
      if (can_be_until(one.name)) visit(until.value, one.name, "", field_of_until(one));
    }
  }
  visit(until.extra_cycles, "extra_cycles", "", {.range = kCycles});
}

void fields(Sweep& sweep, const auto& visit) {
  visit(sweep.grid, "grid");
  visit(sweep.zip, "zip");
}

void fields(Start& start, const auto& visit) {
  visit(start.experiment, "experiment", "experiment of the recorded run");
  visit(start.scale, "scale", "scale of the recorded run; default: the scale of the new run");
  visit(start.variant, "variant",
        "swept values that select the variant of the recorded run, as in `where` or as "
        "`\"fluid=still\"`. Default: the values of the new run, for each key that is swept both in "
        "this manifest and in `experiment`",
        {.example = "{fluid: still}"});
  visit(start.run, "checkpoint",
        "instead of experiment, seed and cycle: `ID@CYCLE`. ID is at least the first eight digits "
        "of the run's id; CYCLE is a whole number",
        {.example = "0123abcd@10", .longest = kLongestLabel});
  visit(start.settings, "seed", "parameter start_seed");
  visit(start.settings, "cycle", "parameter start_cycle, default 0");
  visit(start.settings, "noise_d", "parameter start_noise_d, default 0");
  visit(start.file, "file",
        "a file of grain positions, instead of a recorded run. The path is relative to the folder "
        "of the manifest. If `settle` is given (even `{}`), the grains first settle",
        {.example = "packing.extxyz", .longest = kLongestPath});
  visit(start.unit, "unit", "unit of lengths, if the file does not give it");
}

void fields(Scale& scale, const auto& visit) {
  visit(scale.sweep, "sweep",
        "parameters that vary, with lists or ranges of values. `grid` combines all values of its "
        "keys; `zip` combines the k-th values of all its keys",
        {.example = "{grid: {fluid: [still, cell]}}"});
  visit(scale.settle, "settle",
        "parameter values that apply only while the packing settles. The parameters must act on "
        "the grains or on the moving wall. Variants that differ only in the parameters set here "
        "share their packings",
        {.example = "{drag_kg_per_s: 1.28e-3}"});
  visit(scale.start, "start",
        "initial state: the grains of a file, or the state of a recorded run. Each seed can add "
        "different noise to a recorded state. Default: loose grains that settle",
        {.besides = ", or `{file: packing.extxyz}`",
         .example =
             "{experiment: drag, variant: \"fluid=still\", seed: 3, cycle: 10, noise_d: 1.0e-13}"});
  visit(scale.seeds, "seeds",
        "`6` means the seeds 1 to 6. Other seeds: `2001-2040` or `[1-6, 9]`. Default 1",
        {.example = "6"});
  visit(scale.checkpoints, "checkpoints",
        "`every_cycles`: number of cycles between checkpoints, default 1; the last cycle always "
        "has a checkpoint. `phases`: in the cycle after each checkpoint of `every_cycles`, further "
        "checkpoints are written at these fractions of the cycle. A pause counts as a part of the "
        "cycle. Default: none",
        {.example = "{every_cycles: 1, phases: [0.25, 0.5, 0.75]}"});
  visit(scale.until, "until",
        "ends a run `extra_cycles` cycles after the measure first reaches the value; only "
        "checkpoints at whole cycles count. Default: the run ends at `cycles`",
        {.besides = ", or `none`", .example = "{crystalline_percent: 10, extra_cycles: 15}"});
  visit(scale.looks, "looks",
        "planned looks (interim analyses), each given by the number of seeds that it includes. "
        "Claims get verdicts at each look. More looks widen the intervals. Default: one look, with "
        "all seeds",
        {.range = {least_runs, ManifestLimits::runs}, .example = "[12, 36, 60]"});
  visit(scale.primary, "primary",
        "ids of the claims that these runs are meant to decide; all other claims are exploratory",
        {.example = "[S5a.onset@amplitude_rad=0.05]", .longest = 300});
}

void fields(SeriesSpec& series, const auto& visit) {
  visit(series.label, "label", "", {.longest = kLongestLabel});
  visit(series.colour, "colour", "",
        {.names = colour_names, .besides = ", or \"#rrggbb\" in quotes"});
  visit(series.marker, "marker", "", {.names = marker_names});
}

void fields(PublishedSpec& published, const auto& visit) {
  constexpr Range any = {-1e15, 1e15};
  visit(published.label, "label", "", {.longest = kLongestLabel});
  visit(published.source, "source", "", {.required = true, .longest = kLongestLabel});
  visit(published.value, "value", "", {.range = any});
  visit(published.error, "error", "", {.range = {0, any.max}});
  visit(published.points, "points", "", {.range = any, .example = "[[0.05, 0.646, 0.001]]"});
}

void fields(MarkSpec& mark, const auto& visit) {
  static const Names runs = measures(MeasureKind::run);
  visit(mark.x, "x", "", {.names = runs, .required = true});
  visit(mark.y, "y", "", {.names = runs, .required = true});
  visit(mark.label, "label", "", {.longest = kLongestLabel});
}

void fields(Placed<PlotSpec>& plot, const auto& visit) {
  static const Names scalars = measures(MeasureKind::number);
  static const Names runs = measures(MeasureKind::run);
  static const Names can_be_by = joined({"experiment"}, parameters()),
                     can_be_x = joined({"cycle"}, scalars, can_be_by, runs);
  static const Names can_be_y = joined(scalars, measures(MeasureKind::curve), runs);
  static const Names terms = joined({"cycle"}, scalars, numbers(), runs);
  visit(plot.name, "name", "required; also the name of the plot's files", {.required = true});
  visit(plot.columns, "y",
        "required; a [measure](#measures), with values at checkpoints or one value for each run "
        "(`onset_size_phi`), or an expression of measures and parameters: "
        "`stress_xy_Pa/contact_pressure_Pa`. For a measure of the onset, the caption gives the "
        "number of runs that end before the onset. A list draws several columns, and so does a map "
        "from column names to measures: `{phi_u: phi_uncorrected, phi: phi}`",
        {.names = can_be_y, .terms = terms, .required = true});
  visit(plot.x, "x",
        "`cycle` (default), a measure, a parameter, or an expression such as `1/period_s`. If `x` "
        "has one value for each run, `y` is the value at `at_cycle`. If `x` is a measure with one "
        "value for each run, such as `core_time_s`, each variant has one point, at the mean of `x` "
        "over the runs of the variant",
        {.names = can_be_x, .terms = terms});
  visit(plot.where, "where",
        "selects runs by parameters, each with a value, a list, or a range `{min: 5200}`",
        {.example = "{fluid: [still, cell]}"});
  visit(plot.minus, "minus",
        "swept values that select one variant. The `y` of this variant, for the same packing and "
        "cycle, is subtracted. The caption gives the number of runs that have no `y` to "
        "subtract",
        {.example = "{steps_per_cycle: 45600}"});
  visit(plot.by, "by",
        "one curve for each value of this parameter. It is an error if a curve would average over "
        "another swept parameter; use `where` to select one value of that parameter. Default: one "
        "curve for each variant or, if `x` is a parameter, for each combination of the other swept "
        "values",
        {.names = can_be_by});
  visit(plot.figure, "figure",
        "name of a figure. Plots with the same `figure` are panels (a), (b), ... of one figure. A "
        "claim can also have this key. Default: a separate figure");
  visit(plot.panel, "panel",
        "one panel for each value of this parameter, with equal axis ranges. The panels are named "
        "NAME_1, NAME_2, ...",
        {.names = can_be_by});
  visit(plot.show, "show",
        "`mean` (default) or `rms` (root mean square), with standard errors; `traces`: every run "
        "as a line; `scatter`: every value as a point. With `traces` and `scatter`, the CSV file "
        "lists every run. If `y` is a curve, or if `x` has one value for each run, the file lists "
        "means instead");
  visit(plot.log, "log", "logarithmic axes; default `none`");
  visit(plot.xlabel, "xlabel",
        "label of the axis, with formulas between `$`: `drag $b$ [kg/s]`. For another unit, use an "
        "expression: `x: 1000*diameter_m, xlabel: \"$d$ [mm]\"`",
        {.longest = kLongestLabel});
  visit(plot.ylabel, "ylabel", "see `xlabel`", {.longest = kLongestLabel});
  visit(plot.series, "series",
        "styles of curves, in drawing order. A style has label, colour (blue, vermilion, green, "
        "purple, orange, sky, black or `\"#rrggbb\"`) and marker. Each style is written under one "
        "of these keys: a value of `by`; or `\"KEY=VALUE\"`, as in `labels`; or a column name from "
        "the map `y`",
        {.example = "{still: {label: $v_f = 0$, colour: blue, marker: open_circle}}"});
  visit(plot.published, "published",
        "published numbers that the plot shows. Each has a `source`, and either a `value` with an "
        "`error` or a list `points`, whose items are [x, y] or [x, y, error]",
        {.example = "[{label: Jin et al., value: 0.646, error: 0.001, source: S C}]"});
  visit(plot.columns, "also",
        "with `show: mean`: further columns of the CSV file, as a list of measures, or as a map "
        "from column names to measures: `{phi_u: phi_uncorrected}`",
        {.names = can_be_y, .terms = terms, .example = "[phi_uncorrected]"});
  visit(plot.mark, "mark",
        "a black point on each curve, at the means of two measures with one value per run",
        {.example = "{x: onset_size_cycle, y: onset_size_phi, label: onset}"});
  visit(plot.cycle, "at_cycle",
        "the cycle to draw, if `y` is a curve for each checkpoint, or if `x` has one value for "
        "each run. Default: the last cycle that all runs have; the CSV file and the caption give "
        "the cycle",
        {.range = kCycles});
  visit(plot.cycles, "cycles",
        "with `show: traces` or `scatter`: the first and the last cycle to draw. A plot with this "
        "key also draws the checkpoints at `phases`. All other plots draw only whole cycles",
        {.range = kCycles, .example = "[20, 21]"});
}

void fields(Placed<ClaimSpec>& claim, const auto& visit) {
  static const Names can_be_compared =
      joined(measures(MeasureKind::number), measures(MeasureKind::run));
  static const Names can_be_by = joined({"experiment"}, parameters()),
                     estimators = names_of(all_estimators());
  static const Names can_be_against = joined(can_be_compared, numbers()),
                     terms = joined({"cycle"}, can_be_against);
  visit(claim.id, "id",
        "required; letters, digits, -, _ and dots. `primary` and verdicts refer to the claim by "
        "this id. The part before the first dot is the figure of the claim",
        {.example = "S2.phi", .longest = kLongestName});
  visit(claim.id, "name", "older name of the key `id`");
  visit(claim.figure, "figure",
        "see `figure` of a plot; default: the part of `id` before its first dot");
  visit(claim.compare, "compare",
        "required; a measure or an expression, as in `y` of a plot; curves are not allowed",
        {.names = can_be_compared, .terms = terms, .required = true});
  visit(claim.estimator, "estimator",
        "quantity to estimate; by default, it follows from the other keys", {.names = estimators});
  visit(claim.against, "against",
        "with `estimator: slope`: the column of the x axis, taken at the first checkpoint of each "
        "run. With `spread_ratio`: the column whose standard deviation is the divisor",
        {.names = can_be_against, .terms = can_be_against});
  visit(
      claim.where, "where",
      "selects runs for both sides of the claim: values, lists of values, or ranges `{min: 5200}`",
      {.example = "{amplitude_rad: [0.04, 0.05]}"});
  visit(claim.for_each, "for_each",
        "a parameter. Each value of the parameter gives one claim, with the id `ID@KEY=VALUE`. "
        "`{KEY}` in `statement` is replaced by the value",
        {.names = can_be_by});
  visit(claim.between, "between",
        "the two sides that the claim compares, each selected by swept values. The difference is "
        "the first side minus the second side",
        {.example = "[{fluid: still}, {fluid: cell}]"});
  visit(claim.published, "published",
        "instead of `between`: a published number, which is subtracted from the mean over the "
        "runs. With `is: lower` or `is: higher`, the margin can be left out: the number is then a "
        "bound. The verdict ignores `error`, so a margin should include the error",
        {.example = "{value: 0.646, error: 0.001, source: S C}"});
  visit(
      claim.between[0], "of",
      "with `published`: swept values that select the variant to compare with the published number",
      {.example = "{fluid: still}"});
  visit(claim.margin, "margin",
        "in the unit of the measure. For `onset_size_cycle` and `reaches`, the margin is the "
        "largest allowed log2 of the ratio of the two waiting times: a margin of 1 allows a factor "
        "of 2. Claims about waiting times use the log-rank test, which includes runs that end "
        "before the event",
        {.range = {0, kInfinity, true}});
  visit(claim.margin, "relative_margin",
        "instead of `margin`: limit of the relative difference; 0.03 means 3 %. The difference is "
        "computed from means of logarithms",
        {.range = {0, kInfinity, true}});
  visit(claim.cycles, "at_cycle", "cycle of the comparison", {.range = kCycles});
  visit(claim.cycles, "cycles",
        "instead of `at_cycle`: the first and the last cycle of a range, over which the measure is "
        "averaged",
        {.range = kCycles, .example = "[1, 15]"});
  visit(claim.phi, "phi",
        "instead of `at_cycle`: a range of phi, over which the measure is averaged",
        {.range = {0, 1}, .example = "[0.646, 0.67]"});
  visit(claim.reaches, "reaches",
        "instead of `at_cycle`: a value of the measure. The claim compares the two sides of "
        "`between` by the first cycle at which each run reaches this value",
        {.range = {-1e15, 1e15}});
  visit(claim.is, "is",
        "`same` (default): the difference is within the margin; `higher`, `lower`: the first side "
        "is higher or lower by more than the margin");
  visit(claim.statement, "statement",
        "what the claim says, for human readers; default: made from the other keys",
        {.longest = 300, .folds = true});
  visit(claim.optional, "optional", "`true`: no verdict at scales that lack one of the variants",
        {.example = "true"});
  visit(claim.cannot_be_decided, "cannot_be_decided",
        "the reason why no number of runs would decide the claim. The verdict is then `cannot be "
        "decided`, with this reason and the measured numbers",
        {.example = "the error of the published number is larger than the margin", .longest = 300});
}

void fields(Manifest& manifest, const auto& visit) {
  visit(manifest.experiment, "experiment",
        "required; name of the experiment: letters, digits, - and _", {.example = "drag"});
  visit(manifest.question, "question",
        "the question that the experiment answers, for human readers",
        {.example = "Does the fluid matter?", .longest = 2'000, .folds = true});
  visit(manifest.of, "of",
        "experiments in the store whose runs the plots and claims use. A manifest with this key "
        "defines no runs. A selection of runs may contain the key `experiment`",
        {.example = "[drag, timestep]"});
  visit(manifest.figures, "figures", "figures of the supplement to draw", {.example = "[S2]"});
  visit(manifest.labels, "labels",
        "display names of variants, for drawings, captions, claims, progress messages, `status` "
        "and `table`",
        {.example = "{\"fluid=still\": fluid at rest}"});
  visit(manifest.plots, "plots", "your own figures",
        {.example = "[{name: compaction, y: phi, x: cycle}]"});
  visit(manifest.claims, "claims", "your own claims, decided like the claims of the supplement",
        {.example = "[{id: same, compare: phi, at_cycle: 10, between: [{fluid: still}, {fluid: "
                    "cell}], margin: 0.001}]"});
  visit(manifest.base.settings, "base",
        "parameters of every run; other parameters have their default",
        {.example = "{grains: 7900}"});
  fields(manifest.base, visit);
  visit(manifest.scales, "scales",
        "named sets of keys that override the keys above. The default scale is `desk`",
        {.example = "{smoke: {grains: 600, seeds: 2, cycles: 5}}"});
}

template <class T>
concept HasFields = requires(T& value) {
  fields(value, [](auto&, string_view, string_view = "", const Field& = {}) {});
};

template <HasFields T>
std::vector<Field> keys_of() {
  T empty;
  std::vector<Field> keys;
  fields(empty,
         [&]<class Member>(Member&, string_view name, string_view doc = "", Field field = {}) {
           field.name = name;
           field.doc = doc;
           keys.push_back(with_type<Member>(field));
         });
  return keys;
}

struct ValueRange {
  double from = 0, to = 0;
  std::uint64_t count = 0;
  Spacing spacing = Spacing::linear;
};
constexpr string_view kRangeExample = "{from: 300, to: 3000, count: 5, spacing: log}";

void fields(ValueRange& range, const auto& visit) {
  constexpr Range any = {-kInfinity, kInfinity};
  visit(range.from, "from", "the first value", {.range = any, .required = true});
  visit(range.to, "to", "the last value", {.range = any, .required = true});
  visit(range.count, "count", "number of values, both ends included",
        {.range = {2, ManifestLimits::values_per_list}, .required = true});
  visit(range.spacing, "spacing",
        "equal steps (`linear`, the default) or equal ratios (`log`). Values between the ends are "
        "rounded to 12 significant digits, or to whole numbers if the key needs them");
}

// The text that messages show for the value of the node.
string shown(const Node& node) {
  switch (node.kind) {
    case Node::Kind::null:
      return "nothing";
    case Node::Kind::list:
      return node.parts.empty() ? "an empty list" : "a list";
    case Node::Kind::map:
      return node.parts.empty() ? "an empty map" : "a map";
    case Node::Kind::scalar:
      break;
  }
  return node.quoted ? fmt::format("\"{}\"", printable(node.text)) : printable(node.text);
}

// Returns a sentence with the example of the key, such as "It takes `[1, 15]`.". If there is no
// example, the sentence gives the allowed values.
string remedy_of(const Field& about) {
  return about.example.empty() ? fmt::format("It takes {}.", expected_values(about))
                               : fmt::format("It takes `{}`{}.", about.example, about.besides);
}

bool is_rgb(const Node& in) {
  const string& text = in.text;
  return in.is_scalar() && text.starts_with('#') && text.size() == 7 &&
         text.find_first_not_of("0123456789abcdefABCDEF", 1) == text.npos;
}

// Reads the values of keys into the members of structs. After a problem, reading continues, so that
// all problems are reported at once.
struct Reader {
  ProblemList& problems;
  const Node& document;
  const Scale& base;                             // the keys that apply to all scales
  std::span<const Figure> figures_to_list = {};  // the figures allowed in `figures`
  Names experiments = {};  // plots and claims can select runs of these experiments

  void check_of() {
    if (document.find("of") == nullptr) return;
    for (const char* key :
         {"base", "sweep", "settle", "start", "seeds", "checkpoints", "until", "looks", "scales"}) {
      if (const Node* own = document.find(key)) {
        reject_key(*own, "cannot be used with `of`", "A manifest with `of` has no runs.");
      }
    }
  }

  // Reports a problem at the value and quotes the value.
  void reject_value(const Node& in, const string& problem, const string& remedy) {
    problems.add(in.at, in.path, problem, shown(in), remedy);
  }
  // Reports a value of a wrong type. `wanted` is the right type, for example "a list".
  void reject_type(const Node& in, string_view wanted, const string& remedy) {
    if (in.kind == Node::Kind::map && in.parts.empty())
      return reject(in, "is an empty map", remedy);
    reject_value(in, fmt::format("is not {}", wanted), remedy);
  }
  // reject() reports a problem at the value, reject_key() at the key. Neither quotes the value.
  void reject(const Node& in, const string& problem, const string& remedy) {
    problems.add(in.at, in.path, problem, "", remedy);
  }
  void reject_key(const Node& in, const string& problem, const string& remedy) {
    problems.add(in.key_at, in.path, problem, "", remedy);
  }
  // Reports a problem of `in`, if `in` is not null and `wrong` is true.
  void reject_if(bool wrong, const Node* in, const string& problem, const string& remedy) {
    if (wrong && in != nullptr) reject(*in, problem, remedy);
  }
  void reject_value_if(bool wrong, const Node* in, const string& problem, const string& remedy) {
    if (wrong && in != nullptr) reject_value(*in, problem, remedy);
  }

  // Reports a key that is not one of the `allowed` keys of its map, and says what to write.
  void reject_unknown(const Node& in, const Names& allowed) {
    static const std::vector<Field> sections = keys_of<Manifest>();
    if (read_number<double>(in.key)) {
      return reject_key(in, "is a number, but a key is expected", kDecimalPoint);
    }
    if (in.path == printable(in.key) && find_field(in.key) != nullptr) {  // at the top level
      return reject_key(in, "is a parameter", "Move it under `base:`.");
    }
    const Tried* tried = find_tried(in.key, allowed);
    if (tried != nullptr && !tried->remark.empty()) {
      return reject_key(in, tried->instead.empty() ? "is not modelled" : "is an unknown key",
                        string(tried->remark));
    }
    if (find_named(sections, in.key) != nullptr) {
      return reject_key(in, "does not belong here", "Move it to the top level.");
    }
    const string near = suggest_name(in.key, allowed);
    const Field* field = find_field(near);
    const string unit =
        field != nullptr && has_unit(*field) ? fmt::format(", in {}", field->unit) : "";
    const bool few = allowed.size() < 30;
    reject_key(in, "is an unknown key",
               !near.empty() ? fmt::format("Did you mean {}{}?", near, unit)
               : few         ? fmt::format("Known here: {}.", fmt::join(allowed, ", "))
                             : "`shearcell manual` lists the keys.");
  }

  // Reads a number or a choice. Returns nothing if the type or range is wrong.
  std::optional<json> read_scalar(const Node& in, const Field& about) {
    if (!in.is_scalar()) {
      reject_type(in, "a single value",
                  remedy_of(about) +
                      (in.kind == Node::Kind::list ? " To vary a parameter, use `sweep`." : ""));
      return std::nullopt;
    }
    auto read = read_value(about, in.text, in.quoted);
    if (const auto* wrong = std::get_if<ValueProblem>(&read)) {
      reject_value(in, wrong->problem, wrong->remedy);
      return std::nullopt;
    }
    return std::get<json>(std::move(read));
  }

  // The items of a list. If the value is not a list, or the list is empty or too long, reports a
  // problem and returns no items.
  std::span<const Node> items_of(const Node& in, string_view example) {
    constexpr std::size_t most = ManifestLimits::values_per_list;
    const std::size_t count = in.parts.size();
    if (in.kind != Node::Kind::list) {
      reject_type(in, "a list", fmt::format("It takes a list such as {}.", example));
    } else if (count == 0) {
      reject(in, "is an empty list",
             fmt::format("Remove the key, or write a list such as {}.", example));
    } else if (count > most) {
      problems.add(in.at, in.path, fmt::format("has more than {} values", most),
                   fmt::format("{} values", count), "Shorten the list.");
    } else {
      return in.parts;
    }
    return {};
  }

  // Whether the expression can be evaluated and all names in it are known.
  bool check_expression(const Node& in, const Field& about) {
    if (const string wrong = wrong_in_expression(in.text); !wrong.empty()) {
      reject_value(in, wrong, expression_syntax());
      return false;
    }
    bool of_run = false, of_checkpoint = false;
    for (const string& name : names_in(in.text)) {
      if (std::ranges::find(about.terms, name) == about.terms.end()) {
        reject_value(
            in,
            with_nearest(fmt::format("uses {}, which is not a numeric quantity", printable(name)),
                         name, about.terms),
            "`shearcell manual` lists measures and parameters.");
        return false;
      }
      of_run = of_run || find_measure(name, MeasureKind::run) != nullptr;
      of_checkpoint = of_checkpoint || !is_of_run(name);
    }
    if (of_run && of_checkpoint) {
      reject_value(in, "combines a value of the whole run with a value of a checkpoint",
                   "Use either values of whole runs or values of checkpoints.");
    }
    return !(of_run && of_checkpoint);
  }

  // Adds to `where` a parameter with its value, its list of values or its range. Two other keys are
  // allowed: `experiment` selects runs of an experiment, `cycle` selects checkpoints.
  void read_where(const Node& in, json& where) {
    const std::array others = {Field{.name = "experiment", .names = experiments},
                               Field{.name = "cycle", .range = kCycles}};
    const Field* parameter = find_field(in.key);
    const Field* other = find_named(others, in.key);
    if (other == nullptr && (parameter == nullptr || !parameter->identity.distinguishes_runs())) {
      return reject_unknown(in, parameters());
    }
    if (where.contains(in.key)) return reject_key(in, "appears twice", "Write it once.");
    const Field& field = other != nullptr ? *other : *parameter;
    if (in.kind == Node::Kind::list) {
      json& any = where[in.key] = json::array();
      for (const Node& item : items_of(in, "[1, 2]")) {
        if (auto read = read_scalar(item, field)) any.push_back(std::move(*read));
      }
    } else if (in.is_map() && !field.is_choice()) {
      json& range = where[in.key] = json::object();
      for (const Node& end : in.parts) {
        if (end.key != "min" && end.key != "max") {
          reject_unknown(end, {"min", "max"});
        } else if (auto read = read_scalar(end, field)) {
          range[end.key] = std::move(*read);
        }
      }
    } else if (auto read = read_scalar(in, field)) {
      where[in.key] = std::move(*read);
    }
  }

  // Reads a selection such as "fluid=still,amplitude_rad=0.05". The selection is the key of the
  // node or, if `text` is true, the value of the node.
  json read_selector(const Node& in, bool text = false) {
    json where = json::object();
    const string& whole = text ? in.text : in.key;
    const Position at = text ? in.at : in.key_at;
    for (string_view rest = whole; !rest.empty();) {
      const string part = same_spelling(rest.substr(0, rest.find(',')));
      rest.remove_prefix(std::min(rest.find(','), rest.size() - 1) + 1);
      const std::size_t equal = part.find('=');
      if (equal == part.npos) {
        problems.add(at, in.path, "does not select variants",
                     fmt::format("\"{}\"", printable(whole)),
                     "Write `\"fluid=still\"`, or several values joined by commas.");
        break;
      }
      const string key = part.substr(0, equal);
      read_where({.kind = Node::Kind::scalar,
                  .at = at,
                  .text = part.substr(equal + 1),
                  .key = key,
                  .key_at = at,
                  .path = in.path + '.' + printable(key)},
                 where);
    }
    return where;
  }

  // Reads a key of T. Returns false if T has no such key.
  template <HasFields T>
  bool read_key(const Node& in, T& value) {
    bool known = false;
    fields(value,
           [&]<class Member>(Member& member, string_view name, string_view = "", Field about = {}) {
             if (name != in.key) return;
             known = true;
             about.name = name;
             read(in, with_type<Member>(about), member);
           });
    return known;
  }

  template <HasFields T>
  void read_keys(const Node& in, T& value) {
    for (const Node& part : in.parts) {
      if (!read_key(part, value)) reject_unknown(part, names_of(keys_of<T>()));
    }
  }

  template <class T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void read(const Node& in,
                                                                   const Field& about, T& value) {
    const auto read = read_scalar(in, about);
    if (!read) return;
    if constexpr (std::is_enum_v<T>) {
      value = value_of<T>(read->get_ref<const string&>()).value();
    } else {
      read->get_to(value);
    }
  }
  void read(const Node& in, const Field&, bool& value) {
    value = in.is_scalar() && in.text == "true";
    if (!value && in.text != "false") reject_type(in, "true or false", "Write `true`.");
  }
  template <class T>
  void read(const Node& in, const Field& about, std::optional<T>& value) {
    read(in, with_type<T>(about), value.emplace());
  }

  // Reads an expression, a free text, a choice from a list, or a name. `about` decides which.
  void read(const Node& in, const Field& about, string& value) {
    const string& text = in.text;
    if (in.is_scalar() && !about.terms.empty() && is_expression(text)) {
      if (check_expression(in, about)) value = text;
    } else if (!about.besides.empty() && is_rgb(in)) {
      value = text;
    } else if (about.is_choice()) {
      if (const auto read = read_scalar(in, about)) read->get_to(value);
    } else if (about.longest > 0) {
      value = about.folds ? boost::algorithm::trim_fill_copy(text, " ") : text;
      if (!in.is_scalar() || value.size() > about.longest || value.find('\n') != value.npos) {
        return reject_type(in, "a plain text",
                           fmt::format("Write one {}, at most {} bytes long.",
                                       about.folds ? "text" : "line", about.longest));
      }
      const bool needs_text = about.name == "cannot_be_decided" || about.name == "file";
      reject_value_if(needs_text && as_seen(value).empty(), &in, "has no visible characters",
                      "Write a text, or leave out the key.");
      reject_value_if(about.name.ends_with("label") && std::ranges::count(text, '$') % 2 == 1, &in,
                      "has an odd number of $", "Write a formula between two $.");
    } else if (in.is_scalar() && is_name(text)) {
      value = text;
    } else {
      reject_type(in, "a name",
                  fmt::format("Use at most {} characters: ASCII letters, digits, - and _. Do not "
                              "begin with -.",
                              kLongestName));
    }
  }

  // Reads a pair: the sides of a claim, the first and last cycle, or the ends of a window.
  // `at_cycle` is both the first and the last cycle.
  template <class T>
  void read(const Node& in, const Field& about, std::array<T, 2>& both) {
    constexpr bool sides = std::is_same_v<T, json>, whole = std::is_integral_v<T>;
    const Field each = sides ? about : with_type<T>({.range = about.range});
    if (about.name == "at_cycle") {
      read(in, each, both[0]);
      both[1] = both[0];
      return;
    }
    const std::size_t problems_before = problems.size();
    const std::span<const Node> parts = items_of(in, about.example);
    for (std::size_t k = 0; k < std::min<std::size_t>(parts.size(), 2); ++k) {
      read(parts[k], each, both[k]);
    }
    bool fits = parts.size() == 2;
    if constexpr (!sides) fits = fits && (both[0] < both[1] || (whole && both[0] == both[1]));
    if (fits || problems.size() > problems_before) return;
    reject(in, sides ? "does not name two variants" : "is not a range [lower, upper]",
           remedy_of(about));
  }

  // Reads measures, or a map from names of columns to measures. The columns of `y` come before the
  // columns of `also`.
  void read(const Node& in, const Field& about, std::vector<ColumnSpec>& all) {
    const bool named = in.is_map(), is_y = about.name == "y", one_y = is_y && in.is_scalar();
    std::vector<ColumnSpec> columns;
    for (const Node& one : one_y ? std::span(&in, 1)
                           : named
                               ? std::span(in.parts)
                               : items_of(in, is_y ? "[phi_uncorrected, phi]" : about.example)) {
      ColumnSpec& column = columns.emplace_back();
      if (named) {
        read({.kind = Node::Kind::scalar, .at = one.key_at, .text = one.key, .path = one.path}, {},
             column.name);
      }
      read(one, about, column.measure);
    }
    all.insert(is_y ? all.begin() : all.end(), columns.begin(), columns.end());
  }

  template <class T>
  void read(const Node& in, const Field& about, std::vector<T>& values) {
    values.clear();  // a scale starts with a copy of the top level's list
    Field item = with_type<T>(about);
    // An item's example: the list's example without its brackets; "" if the items are numbers.
    item.example = item.example.substr(1, std::is_arithmetic_v<T> ? 0 : item.example.size() - 2);
    for (const Node& each : items_of(in, about.example)) read(each, item, values.emplace_back());
  }

  // Reads the values of the map `series`, which are styles. name_series() reads the keys of the
  // map.
  void read(const Node& in, const Field& about, std::vector<SeriesSpec>& series) {
    if (!in.is_map()) return reject_type(in, "a map", remedy_of(about));
    for (const Node& part : in.parts) {
      read(part, {.example = "{label: a name, colour: blue, marker: circle}"},
           series.emplace_back());
    }
  }

  // Reads parameters and their values: a map, or a text such as "fluid=still,amplitude_rad=0.05".
  void read(const Node& in, const Field& about, json& where) {
    where = json::object();
    if (in.is_scalar() && in.text.find('=') != string::npos) {
      where = read_selector(in, true);
      return;
    }
    // "base" is the variant of an experiment without a sweep.
    if (about.name == "variant" && in.is_scalar() && in.text == "base") return;
    if (!in.is_map()) return reject_type(in, "a map of swept values", remedy_of(about));
    for (const Node& part : in.parts) read_where(part, where);
  }

  void read(const Node& in, const Field& about, std::vector<string>& names) {
    for (const Node& item : items_of(in, about.example)) {
      string name;
      read(item, {.longest = about.longest}, name);
      if (name.empty()) continue;
      if (std::ranges::find(names, name) != names.end()) {
        reject_value(item, "is listed twice", "Keep one of them.");
      } else if (about.name == "figures" && find_named(figures_to_list, name) == nullptr) {
        reject_value(item, with_nearest("lists an unknown figure", name, names_of(figures_to_list)),
                     "`shearcell figures --help` shows the known figures.");
      }
      names.push_back(name);
    }
  }

  void read(const Node& in, const Field& about, PrimaryClaim& claim) {
    claim.at = in.at;
    read(in, {.longest = about.longest}, claim.id);
  }

  void read(const Node& in, const Field& about, std::vector<VariantLabel>& labels) {
    if (!in.is_map()) return reject_type(in, "a map", remedy_of(about));
    for (const Node& part : in.parts) {
      VariantLabel& label = labels.emplace_back();
      read(part, {.longest = 60}, label.name);
      label.where = read_selector(part);
      label.at = part.key_at;
    }
  }

  // Reads a parameter. Returns false if the key is not a parameter.
  bool read_parameter(const Node& in, Settings& settings) {
    const Field* field = find_field(in.key);
    if (field == nullptr) return false;
    if (takes_auto(field->name) && in.text == "auto") {
      settings[in.key] = {in.text, in.at};
    } else if (auto value = read_scalar(in, *field)) {
      settings[in.key] = {std::move(*value), in.at};
    }
    return true;
  }

  // Reads a parameter of `base`, `settle` or `start`. `KEY` in `start` is the parameter start_KEY.
  void read(const Node& in, const Field& about, Settings& settings) {
    if (about.name != "base" && about.name != "settle") {
      Node parameter = in;
      parameter.key.insert(0, "start_");
      read_parameter(parameter, settings);
      return;
    }
    settings.clear();
    for (const Node& part : settings_in(in)) {
      if (!read_parameter(part, settings)) {
        reject_unknown(part, names_of(schema()));
      } else if (about.name == "settle" && !find_field(part.key)->identity.settles) {
        reject_key(part, "cannot be set for the settling alone", "Set it in `base` or in a scale.");
      }
    }
  }

  std::span<const Node> settings_in(const Node& in) {
    if (in.kind == Node::Kind::map) return in.parts;
    reject_type(in, "a map of parameters", "Indent `key: value` lines under it.");
    return {};
  }

  void read(const Node& in, const Field&, std::vector<Scale>& scales) {
    const string remedy = "Write entries `NAME: {key: value}`, with names such as desk and paper.";
    if (!in.is_map()) return reject_type(in, "a map of scales", remedy);
    if (in.parts.size() > ManifestLimits::scales) {
      return problems.add(in.at, in.path,
                          fmt::format("has more than {} scales", ManifestLimits::scales),
                          fmt::format("{} scales", in.parts.size()), "");
    }
    for (const Node& part : in.parts) {
      if (!is_name(part.key)) {
        problems.add(part.key_at, part.path, "is not a name for a scale",
                     fmt::format("\"{}\"", printable(part.key)), remedy);
      }
      Scale& scale = scales.emplace_back(base);
      scale.name = part.key;
      scale.at = part.key_at;
      if (const Node* settle = part.find("settle")) scale.settle_at = settle->key_at;
      for (const Node& key : settings_in(part)) {
        if (!read_parameter(key, scale.settings) && !read_key(key, scale)) {
          reject_unknown(key, joined(names_of(schema()), names_of(keys_of<Scale>())));
        }
        scale.own.insert(key.key);
      }
    }
  }

  // The values of a range as a manifest would list them; empty if the range has a problem.
  std::vector<Node> written_out(const Node& in, const Field& field) {
    ValueRange range;
    const std::size_t problems_before = problems.size();
    read(in, {.example = kRangeExample}, range);
    if (problems.size() > problems_before) return {};
    std::vector<Node> values(range.count, *in.find("from"));
    values.back() = *in.find("to");
    for (std::size_t k = 1; k + 1 < range.count; ++k) {
      const double part = static_cast<double>(k) / static_cast<double>(range.count - 1);
      const double value = range.spacing == Spacing::log
                               ? range.from * std::pow(range.to / range.from, part)
                               : range.from + part * (range.to - range.from);
      values[k].text = fmt::format("{:.12g}", field.whole ? std::nearbyint(value) : value);
    }
    return values;
  }

  void read(const Node& in, const Field& about, std::vector<SweepAxis>& axes) {
    if (!in.is_map()) return reject_type(in, "a map", "Write `{key: [values]}`.");
    for (const Node& part : in.parts) {
      static const Field seeds = {
          .name = "seeds", .range = {1, ManifestLimits::runs}, .whole = true};
      const Field* field = part.key == seeds.name ? &seeds : find_field(part.key);
      if (field == nullptr) {
        reject_unknown(part, names_of(schema()));
        continue;
      }
      const bool length = is_length(field->name);
      if (!field->identity.distinguishes_runs() && !(about.name == "zip" && length)) {
        reject_key(part, "cannot be swept: runs that differ only in this key have the same id",
                   length ? "Set it in `base` or in a scale, or zip it with a swept parameter."
                          : "Set it in `base` or in a scale.");
        continue;
      }
      SweepAxis& axis = axes.emplace_back(SweepAxis{part.key, part.key_at, {}});
      const bool is_range = part.kind == Node::Kind::map && !field->is_choice();
      const std::vector<Node> range = is_range ? written_out(part, *field) : std::vector<Node>();
      const string example = field->is_choice() ? fmt::format("[{}]", fmt::join(field->names, ", "))
                                                : "[1, 2], or " + string(kRangeExample);
      for (const Node& item : is_range ? std::span(range) : items_of(part, example)) {
        if (auto value = read_scalar(item, *field)) {
          axis.values.push_back({std::move(*value), item.at});
        }
      }
    }
  }

  void read(const Node& in, const Field&, Seeds& seeds) {
    const auto is_range = [](const Node& node) { return node.text.find('-', 1) != string::npos; };
    seeds = {.counted = in.kind != Node::Kind::list && !is_range(in), .at = in.key_at};
    if (seeds.counted) {
      std::uint64_t count = 1;
      read(in,
           {.range = {1, ManifestLimits::runs},
            .besides = ", a range such as 1-6, or a list such as [3, 5]",
            .whole = true},
           count);
      seeds.values.resize(count);
      std::iota(seeds.values.begin(), seeds.values.end(), 1);
      return;
    }
    seeds.values.clear();
    std::set<std::uint64_t> known;
    for (const Node& item : is_range(in) ? std::span(&in, 1) : items_of(in, "[3, 5]")) {
      const Field each = {.range = {1, kLargestSeed}, .whole = true};
      const std::size_t dash = is_range(item) ? item.text.find('-', 1) : string::npos;
      std::uint64_t first = 0, last = 0;
      Node end = item;
      end.text = trimmed(item.text.substr(0, dash));
      read(end, each, first);
      if (dash != string::npos) end.text = trimmed(item.text.substr(dash + 1));
      read(end, each, last);
      if (first == 0 || last == 0) continue;  // already reported
      if (last < first || last - first >= ManifestLimits::runs - seeds.values.size()) {
        reject_value(item, "is not a range from a lower to a higher seed",
                     fmt::format("A scale has at most {} seeds.", ManifestLimits::runs));
        continue;
      }
      for (std::uint64_t seed = first; seed <= last; ++seed) {
        if (known.insert(seed).second)
          seeds.values.push_back(seed);
        else
          reject_value(item, fmt::format("repeats the seed {}", seed), "Keep one of them.");
      }
    }
  }

  void read(const Node& in, const Field& about, StatedUntil& stated) {
    stated = {{}, in.at};
    if (!in.is_scalar() || in.text != "none") read(in, about, stated.until);
  }

  template <HasFields T>
  void read(const Node& in, const Field& about, T& value) {
    value = {};
    if constexpr (requires { value.at; }) value.at = in.at;
    if (!in.is_map()) return reject_type(in, "a map", remedy_of(about));
    read_keys(in, value);
    for (const Field& key : keys_of<T>()) {
      if (!key.required || in.find(key.name) != nullptr) continue;
      return reject(in, fmt::format("lacks {}", key.name), remedy_of(about));
    }
    check(in, about, value);
  }

  void check(const Node& in, const Field&, Sweep& sweep) {
    for (const SweepAxis& axis : sweep.grid) {
      if (std::ranges::count(sweep.zip, axis.key, &SweepAxis::key) == 0) continue;
      problems.add(axis.at, fmt::format("{}.grid.{}", in.path, axis.key), "is in both grid and zip",
                   "", "Keep one of them.");
    }
    for (const SweepAxis& axis : sweep.zip) {
      const auto& [first, at, values] = sweep.zip.front();
      if (axis.values.size() == values.size()) continue;
      problems.add(
          axis.at, fmt::format("{}.zip.{}", in.path, axis.key),
          fmt::format("differs in length from {}, which has length {}", first, values.size()),
          counted(axis.values.size(), "value"), "Give all lists of a zip the same length.");
    }
  }

  void check(const Node& in, const Field& about, Until& until) {
    const auto is_measure = [](const Node& part) { return part.key != "extra_cycles"; };
    const auto measure = std::ranges::find_if(in.parts, is_measure);
    if (std::ranges::count_if(in.parts, is_measure) != 1) {
      return reject(in, "does not name exactly one measure", remedy_of(about));
    }
    until.measure = measure->key;
  }

  void check(const Node& in, const Field&, Checkpoints& checkpoints) {
    const Node* phases = in.find("phases");
    if (phases == nullptr) return;
    checkpoints.at = phases->at;
    double last = 0;
    for (const double phase : checkpoints.phases) {
      reject_if(phase <= last || phase >= 1, phases, "are not ascending fractions of a cycle",
                "Write numbers p, 0 < p < 1.");
      last = phase;
    }
  }

  // Allows at most one of these keys in the map and, if `required`, exactly one.
  void require_one(const Node& in, bool required, std::initializer_list<const char*> keys,
                   const string& remedy) {
    const Node* first = nullptr;
    for (const char* key : keys) {
      const Node* one = in.find(key);
      if (one == nullptr) continue;
      if (first != nullptr) {
        return reject(*one, fmt::format("cannot be used with {}", first->key), "Give one of them.");
      }
      first = one;
    }
    reject_if(required && first == nullptr, &in, fmt::format("lacks {}", fmt::join(keys, " or ")),
              remedy);
  }

  void check(const Node& in, const Field& about, Start& start) {
    require_one(in, true, {"experiment", "checkpoint", "file"}, remedy_of(about));
    static const std::map<string_view, Names> go_with = {
        {"scale", {"experiment"}}, {"variant", {"experiment"}},
        {"seed", {"experiment"}},  {"cycle", {"experiment"}},
        {"unit", {"file"}},        {"noise_d", {"experiment", "checkpoint"}}};
    for (const Node& part : in.parts) {
      const auto sources = go_with.find(part.key);
      const auto is_given = [&](string_view key) { return in.find(key) != nullptr; };
      if (sources == go_with.end() || std::ranges::any_of(sources->second, is_given)) continue;
      reject_key(part,
                 fmt::format("can only be used with `{}`", fmt::join(sources->second, "` or `")),
                 "Leave it out.");
    }
    const Node* checkpoint = in.find("checkpoint");
    if (checkpoint == nullptr) return;
    const std::size_t at = checkpoint->text.find('@');
    start.run = checkpoint->text.substr(0, at);
    const bool is_id = start.run.size() >= 8 && start.run.size() <= 64 &&
                       start.run.find_first_not_of("0123456789abcdef") == string::npos;
    if (!is_id || at == string::npos) {
      return reject_value(
          *checkpoint, "does not name a run and a cycle",
          "Write 8 or more digits of the run's id, @ and the cycle: `0123abcd@10`.");
    }
    Node cycle = *checkpoint;
    cycle.key = "start_cycle";
    cycle.text.erase(0, at + 1);
    read_parameter(cycle, start.settings);
  }

  void check(const Node& in, const Field&, const ValueRange& range) {
    reject_if(range.spacing == Spacing::log && std::min(range.from, range.to) <= 0, &in,
              "has logarithmic spacing, so both ends must be above 0", "Use `spacing: linear`.");
  }

  void check(const Node&, const Field&, const auto&) {}

  void check(const Node& in, const Field&, Placed<PlotSpec>& plot) {
    if (plot.columns.empty()) plot.columns.emplace_back();  // y was refused
    const Node *x = in.find("x"), *y = in.find("y");
    const Node *cycles = in.find("cycles"), *also = in.find("also");
    plot.drawn = std::clamp<std::size_t>(y->parts.size(), 1, plot.columns.size());
    const Measure* curve = find_measure(plot.y(), MeasureKind::curve);
    const bool is_curve = curve != nullptr, of_run = is_of_run(plot.x);
    const string not_with_curve = "cannot be used with " + plot.y();
    reject_value_if(is_curve, x, not_with_curve,
                    fmt::format("Leave it out. The x axis of {} is {}.", plot.y(),
                                is_curve ? curve->x : string_view()));
    const bool y_of_run = !plot.y().empty() && is_of_run(plot.y());
    reject_if(y_of_run && !of_run, &in, plot.y() + " has one value for each run",
              "Use a parameter as x.");
    reject_if(is_curve, in.find("minus"), not_with_curve,
              "As y, use a measure that is a number: curves cannot be subtracted.");
    reject_value_if(plot.show == Show::rms && !is_curve && plot.x != "cycle" && !of_run,
                    in.find("show"), fmt::format("cannot be used with {} as x", plot.x),
                    "As x, use `cycle`, a parameter, or a measure with one value for each run.");
    const bool of_runs = plot.show == Show::traces || plot.show == Show::scatter;
    reject_if(!of_runs || of_run, cycles,
              "can only be used with `show: traces` or `scatter`, and with an x that changes "
              "during a run",
              "Use `show: traces`. As x, use `cycle` or a measure.");
    reject_if(!plot.figure.empty(), cycles, "cannot be used with figure", "Leave out `figure`.");
    const bool any_curve = std::ranges::any_of(plot.columns, [](const ColumnSpec& one) {
      return find_measure(one.measure, MeasureKind::curve) != nullptr;
    });
    const auto of_checkpoint = [](const ColumnSpec& one) { return !is_of_run(one.measure); };
    reject_if(
        y_of_run && std::ranges::any_of(plot.columns | std::views::take(plot.drawn), of_checkpoint),
        y, "combines a value of the whole run with a value of a checkpoint",
        "Draw them in separate plots, or list the value of the whole run last.");
    reject_if(any_curve && plot.columns.size() > 1, also != nullptr ? also : y,
              "combines a curve with other columns", "Draw each curve in a plot of its own.");
    if (also != nullptr && plot.show != Show::mean) {
      reject(*also, "needs `show: mean`", "Leave it out.");
    } else if (const string twice = repeated_column(plot); !twice.empty()) {
      reject(also != nullptr ? *also : in, fmt::format("gives two columns the name {}", twice),
             "Rename one of these columns: `also: {NAME: measure}`.");
    }
    if (const Field* field = find_field(plot.x)) {
      plot.x_symbol = field->symbol;
      if (field->unit != "1") plot.x_unit = field->unit;
      reject_value_if(field->is_choice(), x, "is not a number",
                      "Use `by` to draw a curve for each value.");
    }
    if (const Node* series = in.find("series")) name_series(*series, plot);
    if (const Node* published = in.find("published")) {
      for (const Node& one : published->parts) {
        reject_if(one.find("label") == nullptr, &one, "lacks label",
                  "Give the label that the legend of the plot shows.");
        require_one(one, true, {"value", "points"}, "Give one of them.");
        for (const Node& point : values_of(one.find("points"))) {
          reject_if(point.parts.size() < 2 || point.parts.size() > 3, &point, "is not a point",
                    "It takes [x, y], or [x, y, error].");
        }
      }
    }
  }

  // Reads the keys of `series`. A key without `=` is the name of a column, or a value of `by`.
  void name_series(const Node& in, Placed<PlotSpec>& plot) {
    const std::span drawn = std::span(plot.columns).first(plot.drawn);
    for (std::size_t k = 0; k < plot.series.size(); ++k) {
      const Node& part = in.parts[k];
      json& where = plot.series[k].where = json::object();
      if (part.key.find('=') != string::npos) {
        where = read_selector(part);
      } else if (std::ranges::count(drawn, part.key, &ColumnSpec::name) > 0) {
        plot.series[k].column = part.key;
      } else if (plot.by.empty()) {
        reject_key(part, "names no parameter",
                   "Write `\"KEY=VALUE\"`, set `by` to the parameter, or name a measure in `y`.");
      } else {
        read_where({.kind = Node::Kind::scalar,
                    .at = part.key_at,
                    .text = part.key,
                    .key = plot.by,
                    .path = part.path},
                   where);
      }
    }
  }

  void check(const Node& in, const Field& about, Placed<ClaimSpec>& claim) {
    if (claim.compare.empty()) return;  // reported already
    const Node *published = in.find("published"), *reaches = in.find("reaches");
    const Node *relative = in.find("relative_margin"), *id = in.find("id");
    const string example = remedy_of(about);
    const Estimator* named = find_named(all_estimators(), claim.estimator);
    const bool of_all = named != nullptr && named->one_side, of_run = is_of_run(claim.compare);
    const bool is_bound = published != nullptr && claim.is != Relation::same;
    const auto times = {"at_cycle", "cycles", "phi", "reaches"};
    require_one(in, true, {"id", "name"}, example);
    require_one(in, !of_all, {"between", "published"}, example);
    require_one(in, !is_bound, {"margin", "relative_margin"}, example);
    require_one(in, !of_run, times, example);
    reject_value_if(!is_claim_id(claim.id), id != nullptr ? id : in.find("name"), "is not an id",
                    "Write letters, digits, -, _ and dots: `id: S2.phi`.");
    if (named != nullptr) {
      const bool cycle = named == &all_estimators()[0] && in.find("at_cycle") != nullptr;
      reject_if(!named->key.empty() && in.find(named->key) == nullptr && !cycle, &in,
                fmt::format("lacks {}", named->key),
                fmt::format("`estimator: {}` needs this key.", named->name));
      const bool takes_run = named->of_run.value_or(of_run);
      reject_value_if(of_run != takes_run, in.find("estimator"),
                      fmt::format("cannot be used with {}", claim.compare),
                      fmt::format("Set `compare` to a measure that has one value for each {}.",
                                  takes_run ? "run" : "checkpoint"));
    }
    for (const char* key : times) {
      reject_if(of_run, in.find(key), claim.compare + " has one value for each run",
                "Leave it out.");
    }
    reject_if(claim.published && !claim.published->value, published, "lacks value",
              "Give the published number as `value`.");
    const Estimator& estimator = estimator_of(claim);
    const bool takes_published =
        estimator.scalar != nullptr || estimator.name == rate_exponent.name;
    reject_if(!takes_published && reaches == nullptr, published,
              fmt::format("cannot be used with `estimator: {}`", estimator.name), "Leave it out.");
    reject_if(claim.where.contains("cycle"), in.find("where"), "selects checkpoints",
              "Use `at_cycle` or `cycles`.");
    reject_if(published == nullptr && !of_all, in.find("of"), "can only be used with `published`",
              "Use `between` for two variants.");
    reject_if(in.find("between") == nullptr, reaches, "can only be used with `between`",
              "A waiting time can only be compared with another waiting time.");
    claim.relative = relative != nullptr;
    reject_if(compares_waits(claim), relative, "cannot be used with waiting times",
              "Use `margin`.");
    reject_if(claim.published && claim.published->value == 0.0, relative,
              "cannot be used with a published value of 0", "Use `margin`.");
  }

  static std::span<const Node> values_of(const Node* list) {
    return list == nullptr ? std::span<const Node>() : list->parts;
  }

  // Reports each plot, claim, figure and panel whose name occurs twice or is already the name of a
  // figure or panel of the supplement. Exception: plots and claims that define figure F of the
  // supplement may be named like F and its panels, unless C++ code computes F or `listed` has F.
  // `listed`: the names in `figures`.
  void check_own_names(std::span<const Figure> supplement, const std::vector<string>& listed) {
    std::vector<std::pair<const Node*, string>> names, figures;  // {node, its figure}
    Names panels;
    for (const char* list : {"plots", "claims"}) {
      for (const Node& item : values_of(document.find(list))) {
        const Node *id = item.find("id"), *figure = item.find("figure");
        const Node* name = id != nullptr ? id : item.find("name");
        const string of = figure != nullptr ? figure->text
                          : id != nullptr   ? id->text.substr(0, id->text.find('.'))
                                            : "";
        if (name != nullptr) names.emplace_back(name, of);
        if (figure != nullptr) figures.emplace_back(figure, of);
        if (name != nullptr && item.find("panel") != nullptr) panels.push_back(name->text);
      }
    }
    names.insert(names.end(), figures.begin(), figures.end());
    for (const auto& [own, of] : names) {
      const string& text = own->text;
      if (!is_claim_id(text)) continue;
      // A figure that C++ code does not compute is defined by the plots of a manifest.
      const bool is_stated = find_named(computed_figures(), of) == nullptr;
      const bool is_listed = std::ranges::count(listed, of) > 0;
      const auto clash = std::ranges::find_if(supplement, [&, of = of](const Figure& figure) {
        const bool is_part = is_stated && !is_listed && of == figure.name;
        if (is_part || !text.starts_with(figure.name)) return false;
        const string_view rest = string_view(text).substr(figure.name.size());
        return rest.size() < 2 || rest.front() == '_';
      });
      const auto first =
          std::ranges::find_if(names, [&](const auto& other) { return other.first->text == text; });
      const bool is_taken = own->key == "figure" ? first->second != text : first->first != own;
      const bool is_panel = std::ranges::any_of(panels, [&](string_view name) {
        return text.starts_with(string(name) + "_") &&
               text.find_first_not_of("0123456789", name.size() + 1) == text.npos;
      });
      reject_value_if(clash != supplement.end() || is_taken || is_panel, own,
                      "is the name of another figure, plot or claim",
                      "Choose another name, or remove the figure from `figures`.");
    }
  }
};

}  // namespace

bool is_name(string_view text) {
  const auto allowed = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
  return !text.empty() && text.size() <= kLongestName && text.front() != '-' &&
         std::ranges::all_of(text, allowed);
}

bool is_claim_id(string_view text) {
  const std::size_t dot = text.find('.');
  return text.size() <= kLongestName && is_name(text.substr(0, dot)) &&
         (dot == text.npos || is_claim_id(text.substr(dot + 1)));
}

Manifest read_manifest(string_view text, string_view file, bool shipped) {
  Node root = read_document(text, file);
  ProblemList problems(file);
  Manifest manifest;
  manifest.file = file;
  manifest.text = text;
  manifest.base.at = root.at;
  const std::span<const Figure> known = shipped ? computed_figures() : all_figures();
  Reader reader{problems, root, manifest.base, known};
  const Node *of = root.find("of"), *own = root.find("experiment");
  for (const Node& one : of != nullptr    ? std::span(of->parts)
                         : own != nullptr ? std::span(own, 1)
                                          : std::span<const Node>()) {
    reader.experiments.push_back(one.text);
  }
  if (root.kind != Node::Kind::map) {
    reader.reject_type(root, "a map of keys", "Begin with `experiment: NAME`.");
    problems.raise();
  }
  // Scales are read last, because each scale starts as a copy of the keys that apply to all scales.
  std::stable_partition(root.parts.begin(), root.parts.end(),
                        [](const Node& part) { return part.key != "scales"; });
  if (const Node* settle = root.find("settle")) manifest.base.settle_at = settle->key_at;
  reader.read_keys(root, manifest);
  if (const Node* experiment = root.find("experiment")) {
    manifest.experiment_at = experiment->key_at;
  } else {
    problems.add(root.at, "experiment", "is missing", "", "Begin with `experiment: NAME`.");
  }
  if (const Node* base = root.find("base")) manifest.base.at = base->key_at;
  reader.check_of();
  reader.check_own_names(known, manifest.figures);
  problems.raise();
  return manifest;
}

std::vector<std::uint64_t> read_seeds(const string& text, string_view option) {
  const Node list{.kind = Node::Kind::list,
                  .parts = {{.kind = Node::Kind::scalar, .text = text, .path = "seeds"}}};
  ProblemList problems(option);
  Seeds seeds;
  Reader{problems, list, {}}.read(list, {}, seeds);
  problems.raise();
  return seeds.values;
}

namespace {

string takes_markdown(const Field& key) {
  if (key.is_choice() && key.names.size() <= 12)
    return fmt::format("{}", fmt::join(key.names, ", "));
  return key.example.empty() ? "" : fmt::format("`{}`", key.example);
}

template <HasFields T>
string keys_markdown(string_view head) {
  string text = fmt::format("| key | {} | meaning |\n|---|---|---|\n", head);
  for (const Field& key : keys_of<T>()) {
    text += fmt::format("| `{}` | {} | {} |\n", key.name, takes_markdown(key), key.doc);
  }
  return text;
}

}  // namespace

string manifest_markdown() {
  return keys_markdown<Manifest>("example") +
         "\nKeys of a range of swept values, as in `grid: {pressure_Pa: " + string(kRangeExample) +
         "}`:\n\n" + keys_markdown<ValueRange>("values") + "\nKeys of `start`:\n\n" +
         keys_markdown<Start>("values") + "\nKeys of a plot:\n\n" +
         keys_markdown<Placed<PlotSpec>>("values") + "\nKeys of a claim:\n\n" +
         keys_markdown<Placed<ClaimSpec>>("values");
}

}  // namespace shearcell
