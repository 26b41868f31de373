// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a manifest. `fields` describes the keys of each struct once: Reader reads and checks them,
// and keys_markdown() documents them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "analysis/expression.hpp"
#include "analysis/figure.hpp"
#include "analysis/figures/curves.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/schema.hpp"
#include "experiments/manifest/shipped.hpp"
#include "experiments/manifest/suggest.hpp"
#include "provenance/limits.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

using nlohmann::json;
using std::string;
using std::string_view;
using Names = std::vector<string_view>;

constexpr std::size_t kLongestLabel = 120;  // [bytes]
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Range kCycles = {0, StoreLimits::cycles};
// A double holds it exactly, so readers in any language can.
constexpr std::uint64_t kLargestSeed = (std::uint64_t{1} << 53) - 1;

template <class... More>
Names joined(Names names, const More&... more) {
  (names.insert(names.end(), more.begin(), more.end()), ...);
  return names;
}

// The parameters that distinguish runs. The record of a run does not hold the others.
Names parameters() {
  Names names;
  for (const Field& field : schema()) {
    if (field.identity.distinguishes_runs()) names.push_back(field.name);
  }
  return names;
}

// The parameters that are numbers.
Names numbers() {
  Names names;
  for (const Field& field : schema()) {
    if (!field.is_choice()) names.push_back(field.name);
  }
  return names;
}

// `until` as it is written: one of the measures.
struct UntilKeys {
  std::optional<double> crystalline_percent, largest_crystallite, phi;
  std::uint64_t extra_cycles = 0;

  double of(StopMeasure measure) const {
    const std::optional<double> values[] = {crystalline_percent, largest_crystallite, phi};
    return values[static_cast<std::size_t>(measure)].value_or(0);
  }
};

void fields(UntilKeys& until, const auto& visit) {
  visit(until.crystalline_percent,
        {.name = "crystalline_percent", .unit = "%", .range = {0, 100, true}});
  visit(until.largest_crystallite,
        {.name = "largest_crystallite", .range = {1, 1e8}, .whole = true});
  visit(until.phi, {.name = "phi", .range = {0, 1, true}});
  visit(until.extra_cycles, {.name = "extra_cycles", .range = {0, StoreLimits::cycles}});
}

void fields(Checkpoints& checkpoints, const auto& visit) {
  visit(checkpoints.every_cycles, {.name = "every_cycles", .range = {1, StoreLimits::cycles}});
  visit(checkpoints.phases, {.name = "phases", .example = "[0.25, 0.5, 0.75]"});
}

void fields(Sweep& sweep, const auto& visit) {
  visit(sweep.grid, {.name = "grid"});
  visit(sweep.zip, {.name = "zip"});
}

void fields(Scale& scale, const auto& visit) {
  visit(scale.sweep,
        {.name = "sweep",
         .doc = "parameters that vary: `grid` takes every combination, keys of `zip` advance "
                "together",
         .example = "{grid: {fluid: [still, cell]}}"});
  visit(scale.seeds,
        {.name = "seeds", .doc = "seeds 1 to 6, or a list; default 1", .example = "6"});
  visit(scale.checkpoints,
        {.name = "checkpoints",
         .doc = "cycles between checkpoints, default 1, and always one after the last cycle; "
                "`phases` adds fractions of each cycle that follows one, pause included, default "
                "none",
         .example = "{every_cycles: 1, phases: [0.25, 0.5, 0.75]}",
         .wanted = "a map of settings"});
  visit(scale.until,
        {.name = "until",
         .doc = "ends a run `extra_cycles` after the measure reaches the value; default: at "
                "`cycles`",
         .example = "{crystalline_percent: 10, extra_cycles: 15}"});
}

void fields(SeriesSpec& series, const auto& visit) {
  visit(series.label, {.name = "label", .longest = kLongestLabel});
  visit(series.colour, {.name = "colour", .names = colour_names});
  visit(series.marker, {.name = "marker"});
}

void fields(PublishedSpec& published, const auto& visit) {
  constexpr Range any = {-1e15, 1e15};
  visit(published.label, {.name = "label", .longest = kLongestLabel});
  visit(published.source, {.name = "source", .required = true, .longest = kLongestLabel});
  visit(published.value, {.name = "value", .range = any});
  visit(published.error, {.name = "error", .range = {0, any.max}});
  visit(published.points, {.name = "points", .range = any, .example = "[[0.05, 0.646, 0.001]]"});
}

void fields(Placed<PlotSpec>& plot, const auto& visit) {
  static const Names scalars = measure_names({MeasureKind::number});
  static const Names runs = measure_names({MeasureKind::run});
  static const Names can_be_by = parameters(), can_be_x = joined({"cycle"}, scalars, can_be_by);
  static const Names can_be_y =
      measure_names({MeasureKind::number, MeasureKind::curve, MeasureKind::run});
  static const Names x_terms = joined({"cycle"}, scalars, numbers());
  static const Names y_terms = joined(x_terms, runs);
  visit(plot.name, {.name = "name", .doc = "required; the name of its files", .required = true});
  visit(plot.y,
        {.name = "y",
         .doc = "required; a [measure](#measures), a number of each run such as `onset_size_phi`, "
                "or an expression of measures and parameters: `stress_xy_Pa/contact_pressure_Pa`. "
                "Runs that end before their onset are counted in the caption",
         .names = can_be_y,
         .terms = y_terms,
         .required = true});
  visit(plot.x,
        {.name = "x",
         .doc = "`cycle` (default), a measure, a parameter, or an expression: `1/period_s`. A "
                "number of the run takes `y` at `at_cycle`",
         .names = can_be_x,
         .terms = x_terms});
  visit(plot.by, {.name = "by",
                  .doc = "one curve for each value of this parameter; averaging over another swept "
                         "parameter is refused. Default: one for each variant or, with a parameter "
                         "as `x`, for each combination of the other swept values",
                  .names = can_be_by});
  visit(plot.figure,
        {.name = "figure",
         .doc = "plots and claims with the same `figure` are its panels (a), (b), ... and its "
                "claims, with one caption; default: a figure of its own"});
  visit(plot.panel, {.name = "panel",
                     .doc = "one panel, NAME_1, NAME_2, ..., for each value of this parameter, "
                            "with equal ranges",
                     .names = can_be_by});
  visit(plot.show, {.name = "show",
                    .doc = "the mean (default) with its standard error, every run as a line, or "
                           "every value as a point. The CSV of a curve measure or against a number "
                           "of the run has the means"});
  visit(plot.log, {.name = "log", .doc = "logarithmic axes; default `none`"});
  visit(
      plot.xlabel,
      {.name = "xlabel",
       .doc = "label of the axis, formulas between `$`: `drag $b$ [kg/s]`. For another unit, take "
              "an expression: `x: 1000*diameter_m, xlabel: \"$d$ [mm]\"`",
       .longest = kLongestLabel});
  visit(plot.ylabel, {.name = "ylabel", .doc = "likewise", .longest = kLongestLabel});
  visit(
      plot.series,
      {.name = "series",
       .doc = "label, colour (blue, vermilion, green, purple, orange, sky, black or `\"#rrggbb\"`) "
              "and marker of curves: by the value of `by`, or by `\"KEY=VALUE\"` as in `labels`. "
              "Curves come in this order",
       .example = "{still: {label: $v_f = 0$, colour: blue, marker: open_circle}}"});
  visit(plot.published,
        {.name = "published",
         .doc = "published numbers that the plot shows: a `value` with an `error`, or `points` [x, "
                "y] or [x, y, error], each with its `source`",
         .example = "[{label: Jin et al., value: 0.646, error: 0.001, source: S C}]"});
  visit(plot.also, {.name = "also",
                    .doc = "further measures in the CSV of a plot of means against the cycle; as a "
                           "map, with names for their columns: `{phi_u: phi_uncorrected}`",
                    .names = scalars,
                    .example = "[phi_uncorrected]"});
  visit(plot.cycle,
        {.name = "at_cycle",
         .range = kCycles,
         .doc = "the cycle of a curve measure, or of `y` against a number of the run; default: the "
                "last one that all runs have, named in the CSV and the caption"});
  visit(plot.cycles,
        {.name = "cycles",
         .range = kCycles,
         .doc = "with `show: traces` or `scatter`: only these cycles, first to last, with the "
                "checkpoints at `phases`; other plots are of whole cycles",
         .example = "[20, 21]"});
}

void fields(Placed<ClaimSpec>& claim, const auto& visit) {
  static const Names scalars = measure_names({MeasureKind::number});
  static const Names runs = measure_names({MeasureKind::run});
  static const Names can_be_compared = joined({}, scalars, runs);
  static const Names terms = joined({"cycle"}, scalars, runs, numbers());
  visit(claim.name, {.name = "name", .doc = "required", .required = true});
  visit(claim.figure, {.name = "figure", .doc = "as of a plot"});
  visit(claim.compare, {.name = "compare",
                        .doc = "required; as `y` of a plot, but no curve",
                        .names = can_be_compared,
                        .terms = terms,
                        .required = true});
  visit(claim.between,
        {.name = "between",
         .doc = "swept values that single out a variant, for the first and for the second. The "
                "difference is the first less the second",
         .example = "[{fluid: still}, {fluid: cell}]"});
  visit(claim.published,
        {.name = "published",
         .doc = "instead of `between`: the mean over the runs less this number; "
                "with `is: lower` or `higher` and no margin, the number is a bound",
         .example = "{value: 0.646, error: 0.001, source: S C}"});
  visit(claim.between[0], {.name = "of",
                           .doc = "with `published`: swept values that single out the variant",
                           .example = "{fluid: still}"});
  visit(claim.margin,
        {.name = "margin",
         .range = {0, kInfinity, true},
         .doc = "in the unit of the measure; of `onset_size_cycle` and `reaches`, of log2 of the "
                "ratio of both waiting times (log-rank test, which counts runs that end before): 1 "
                "is a factor of 2"});
  visit(claim.margin, {.name = "relative_margin",
                       .range = {0, kInfinity, true},
                       .doc = "instead of `margin`: of the relative difference; 0.03 is 3 %"});
  visit(claim.cycles, {.name = "at_cycle", .range = kCycles, .doc = "the cycle that is compared"});
  visit(claim.cycles, {.name = "cycles",
                       .range = kCycles,
                       .doc = "or first and last of the cycles whose mean is compared",
                       .example = "[1, 15]"});
  visit(claim.phi, {.name = "phi",
                    .range = {0, 1},
                    .doc = "or a window of phi over which the mean is compared",
                    .example = "[0.646, 0.67]"});
  visit(claim.reaches, {.name = "reaches",
                        .range = {-1e15, 1e15},
                        .doc = "or the value whose first cycle is compared"});
  visit(claim.is, {.name = "is",
                   .doc = "`same` (default): the difference is within the margin; `higher`, "
                          "`lower`: the first is so by more than the margin"});
  visit(claim.statement, {.name = "statement",
                          .doc = "what the claim says, for people; default: from its keys",
                          .longest = 300});
  visit(claim.optional, {.name = "optional",
                         .doc = "`true`: no verdict where a scale lacks one of the variants",
                         .example = "true"});
}

void fields(Manifest& manifest, const auto& visit) {
  visit(manifest.experiment, {.name = "experiment",
                              .doc = "required; its name: letters, digits, - and _",
                              .example = "drag"});
  visit(manifest.question, {.name = "question",
                            .doc = "what the experiment is to find out, for people",
                            .example = "Does the fluid matter?",
                            .longest = 2'000});
  visit(manifest.figures,
        {.name = "figures", .doc = "figures of the supplement to draw", .example = "[S2]"});
  visit(manifest.labels,
        {.name = "labels",
         .doc = "names of variants in drawings, captions, claims, progress, `status` and `table`",
         .example = "{\"fluid=still\": fluid at rest}",
         .wanted = "a map of names"});
  visit(manifest.plots, {.name = "plots",
                         .doc = "figures of your own",
                         .example = "[{name: compaction, y: phi, x: cycle}]"});
  visit(manifest.claims,
        {.name = "claims",
         .doc = "claims of your own, decided like those of the supplement",
         .example = "[{name: same, compare: phi, at_cycle: 10, between: [{fluid: still}, {fluid: "
                    "cell}], margin: 0.001}]"});
  visit(manifest.base.settings, {.name = "base",
                                 .doc = "parameters of every run; others have their default",
                                 .example = "{grains: 7900}"});
  fields(manifest.base, visit);
  visit(manifest.scales, {.name = "scales",
                          .doc = "named sizes, which override the keys above; default `desk`",
                          .example = "{smoke: {grains: 600, seeds: 2, cycles: 5}}"});
}

template <class T>
concept HasFields = requires(T& value) {
  fields(value, [](auto&, const Field&) {});
};

template <HasFields T>
std::vector<Field> keys_of() {
  T empty;
  std::vector<Field> keys;
  fields(empty, [&]<class Member>(Member&, const Field& field) {
    keys.push_back(with_type<Member>(field));
  });
  return keys;
}

// A node as messages quote it.
string shown(const Node& node) {
  switch (node.kind) {
    case Node::Kind::null:
      return "nothing";
    case Node::Kind::list:
      return node.items.empty() ? "an empty list" : "a list";
    case Node::Kind::map:
      return node.entries.empty() ? "an empty map" : "a map";
    case Node::Kind::scalar:
      break;
  }
  return node.quoted ? fmt::format("\"{}\"", printable(node.text)) : printable(node.text);
}

// A value of the document while it is read.
struct Entry {
  const Node& key;   // for an item, the key of its list; for the document, the document
  const Node& node;  // the value
  string path;       // to the key, as in "scales.smoke.grains"
  ProblemList& problems;

  bool is_scalar() const { return node.kind == Node::Kind::scalar; }
  bool is_list() const { return node.kind == Node::Kind::list; }
  /// Whether it is a map with at least one key.
  bool is_map() const { return node.kind == Node::Kind::map && !node.entries.empty(); }

  std::vector<Entry> entries() const {
    std::vector<Entry> all;
    for (const auto& [name, value] : node.entries) {
      const string last = printable(name.text);
      all.push_back({name, value, path.empty() ? last : path + "." + last, problems});
    }
    return all;
  }
  std::vector<Entry> items() const {
    std::vector<Entry> all;
    for (const Node& item : node.items) all.push_back({key, item, path, problems});
    return all;
  }
  /// The entry of a key of the map.
  std::optional<Entry> find(string_view name) const {
    for (Entry& entry : entries()) {
      if (entry.key.text == name) return std::optional<Entry>(std::in_place, entry);
    }
    return std::nullopt;
  }

  /// Reports a problem with the value, and quotes it.
  void reject_value(string problem, string remedy) const {
    problems.add(node.at, path, std::move(problem), shown(node), std::move(remedy));
  }
  /// Reports that the value is not `wanted`, as in "a list".
  void reject_type(string_view wanted, string remedy) const {
    reject_value(fmt::format("is not {}", wanted), std::move(remedy));
  }
  /// Reports a problem at the value, or at the key, without a quotation.
  void reject(string problem, string remedy) const {
    problems.add(node.at, path, std::move(problem), "", std::move(remedy));
  }
  void reject_key(string problem, string remedy) const {
    problems.add(key.at, path, std::move(problem), "", std::move(remedy));
  }
  /// Reports that the key is not one of those `allowed` in its map, with the nearest of them.
  void reject_unknown(const Names& allowed) const;
};

void Entry::reject_unknown(const Names& allowed) const {
  static const std::vector<Field> sections = keys_of<Manifest>();
  if (key.text == "<<") return reject_key("merge keys are not read", "Write it out.");
  if (path == printable(key.text) && find_field(key.text) != nullptr) {  // at the top level
    return reject_key("is a parameter", "Move it under `base:`.");
  }
  if (find_named(sections, key.text) != nullptr) {
    return reject_key("does not belong here", "Move it to the top level.");
  }
  const Suggestion near = suggest_name(key.text, allowed);
  if (near.missing_unit) {
    reject_key("is written without its unit", fmt::format("Write {}.", near.name));
  } else if (!near.name.empty()) {
    reject_key("is an unknown key", fmt::format("Did you mean {}?", near.name));
  } else if (allowed.size() <= sections.size()) {
    reject_key("is an unknown key", fmt::format("Known here: {}.", fmt::join(allowed, ", ")));
  } else {
    reject_key("is an unknown key", "`shearcell manual --markdown` lists the keys.");
  }
}

// "It takes [1, 15].", or what the key takes if it has no example.
string remedy_of(const Field& about) {
  return about.example.empty() ? fmt::format("It takes {}.", expected_values(about))
                               : fmt::format("It takes `{}`.", about.example);
}

// The value of a number or choice; nothing after a problem with its type or range.
std::optional<json> read_scalar(const Entry& in, const Field& about) {
  if (!in.is_scalar()) {
    in.reject_type("a single value", remedy_of(about));
    return std::nullopt;
  }
  auto read = read_value(about, in.node.text, in.node.quoted);
  if (const auto* wrong = std::get_if<ValueProblem>(&read)) {
    in.reject_value(wrong->problem, wrong->remedy);
    return std::nullopt;
  }
  return std::get<json>(std::move(read));
}

// Whether the node is the word `auto` and the parameter takes it.
bool is_auto(const Field& field, const Node& node) {
  return takes_auto(field.name) && node.kind == Node::Kind::scalar && !node.quoted &&
         node.text == "auto";
}

// The items of a list; empty after a problem, as with an empty or too long list.
std::vector<Entry> items_of(const Entry& in, string_view example) {
  constexpr std::size_t most = ManifestLimits::values_per_list;
  const std::size_t count = in.node.items.size();
  if (!in.is_list()) {
    in.reject_type("a list", fmt::format("It takes a list such as {}.", example));
  } else if (count == 0) {
    in.reject("is an empty list",
              fmt::format("Remove the key, or write a list such as {}.", example));
  } else if (count > most) {
    in.problems.add(in.node.at, in.path, fmt::format("has more than {} values", most),
                    fmt::format("{} values", count), "Shorten the list.");
  } else {
    return in.items();
  }
  return {};
}

// Whether the expression can be evaluated, and has known terms.
bool check_expression(const Entry& in, const Field& about) {
  if (const string wrong = wrong_in_expression(in.node.text); !wrong.empty()) {
    in.reject_value(wrong, expression_syntax());
    return false;
  }
  bool of_run = false, of_checkpoint = false;
  for (const string& name : names_in(in.node.text)) {
    if (std::ranges::find(about.terms, name) == about.terms.end()) {
      in.reject_value(
          with_nearest(
              fmt::format("uses {}, which is not a number of a run or checkpoint", printable(name)),
              name, about.terms),
          "`shearcell manual --markdown` lists measures and parameters.");
      return false;
    }
    of_run = of_run || find_measure(name, MeasureKind::run) != nullptr;
    of_checkpoint = of_checkpoint || !is_parameter(name);
  }
  if (of_run && of_checkpoint) {
    in.reject_value("combines a number of the whole run with one of its checkpoints",
                    "Take measures of one kind.");
  }
  return !(of_run && of_checkpoint);
}

// Formulas stand between two `$`.
void check_formulas(const std::optional<Entry>& in) {
  if (in && std::ranges::count(in->node.text, '$') % 2 == 1) {
    in->reject_value("has a $ without its partner", "A formula stands between two $.");
  }
}

// Reads a parameter and its value into `where`.
void read_where(const Entry& in, json& where) {
  const Field* field = find_field(in.key.text);
  if (field == nullptr) return in.reject_unknown(parameters());
  if (!field->identity.distinguishes_runs()) {
    return in.reject_key("does not distinguish runs", "Name a parameter that does.");
  }
  if (where.contains(in.key.text)) return in.reject_key("is stated twice", "State it once.");
  if (auto read = read_scalar(in, *field)) where[in.key.text] = std::move(*read);
}

// Reads the key "fluid=still,amplitude_rad=0.05" as a map.
json read_selector(const Entry& in) {
  Node map{Node::Kind::map, in.key.at};
  string_view rest = in.key.text;
  while (!rest.empty()) {
    const string_view part = trimmed(rest.substr(0, rest.find(',')));
    rest.remove_prefix(std::min(rest.find(','), rest.size() - 1) + 1);
    const std::size_t equal = part.find('=');
    if (equal == part.npos) {
      in.problems.add(in.key.at, in.path, "does not select variants", shown(in.key),
                      "It takes `\"fluid=still\"`, or several joined by commas.");
      break;
    }
    map.entries.push_back({{Node::Kind::scalar, in.key.at, string(part.substr(0, equal))},
                           {Node::Kind::scalar, in.key.at, string(part.substr(equal + 1))}});
  }
  json where = json::object();
  for (const Entry& entry : Entry{in.key, map, in.path, in.problems}.entries()) {
    read_where(entry, where);
  }
  return where;
}

void check_grid(const Sweep& sweep, const Entry& in) {
  for (const SweepAxis& axis : sweep.grid) {
    const string path = fmt::format("{}.grid.{}", in.path, axis.key);
    std::set<json> seen;
    for (const Setting& setting : axis.values) {
      if (seen.insert(setting.value).second) continue;
      in.problems.add(setting.at, path, "repeats a value", setting.value.dump(),
                      "Keep one of them.");
    }
    if (std::ranges::find(sweep.zip, axis.key, &SweepAxis::key) != sweep.zip.end()) {
      in.problems.add(axis.at, path, "is in both grid and zip", "", "Keep one of them.");
    }
  }
}

void check_zip(const std::vector<SweepAxis>& zip, const Entry& in) {
  if (zip.empty()) return;
  const string path = in.path + ".zip";
  const SweepAxis& first = zip.front();
  if (zip.size() == 1 && is_length(first.key)) {
    return in.problems.add(first.at, path + "." + first.key, "advances with no other key", "",
                           "Set it in `base` or in a scale.");
  }
  const std::size_t rows = first.values.size();
  for (const SweepAxis& axis : zip) {
    if (axis.values.size() == rows) continue;
    return in.problems.add(axis.at, path + "." + axis.key,
                           fmt::format("differs in length from {}, which has {}", first.key, rows),
                           counted(axis.values.size(), "value"),
                           "The lists of a zip advance together; make them equally long.");
  }
  std::set<json> seen;
  for (std::size_t row = 0; row < rows; ++row) {
    json values = json::array();
    for (const SweepAxis& axis : zip) {
      if (!is_length(axis.key)) values.push_back(axis.values[row].value);
    }
    if (seen.insert(values).second) continue;
    in.problems.add(first.values[row].at, path, "repeats a row of values", printable(values.dump()),
                    "Keep one of them.");
  }
}

// Reads a value into a member of its type. Problems are reported, and reading continues.
struct Reader {
  // Reads the value of one of the keys; false if it is none of them.
  template <HasFields T>
  static bool read_key(const Entry& entry, T& value) {
    bool known = false;
    fields(value, [&]<class Member>(Member& member, const Field& about) {
      if (about.name != entry.key.text) return;
      known = true;
      read(entry, with_type<Member>(about), member);
    });
    return known;
  }

  template <class T>
  requires(std::is_arithmetic_v<T> ||
           std::is_enum_v<T>) static void read(const Entry& in, const Field& about, T& value) {
    const auto read = read_scalar(in, about);
    if (!read) return;
    if constexpr (std::is_enum_v<T>) {
      value = value_of<T>(read->get_ref<const string&>()).value();
    } else {
      read->get_to(value);
    }
  }
  static void read(const Entry& in, const Field&, bool& value) {
    value = in.is_scalar() && in.node.text == "true";
    if (!value && in.node.text != "false") in.reject_type("true or false", "Write `true`.");
  }
  template <class T>
  static void read(const Entry& in, const Field& about, std::optional<T>& value) {
    read(in, with_type<T>(about), value.emplace());
  }

  // One of the names or an expression of terms, a text, or a name.
  static void read(const Entry& in, const Field& about, string& value) {
    const bool scalar = in.is_scalar();
    const string& text = in.node.text;
    const bool colour = about.names.data() == colour_names.data() && text.starts_with('#');
    if (scalar && !about.terms.empty() && is_expression(text)) {
      if (check_expression(in, about)) value = text;
    } else if (scalar && colour && text.size() == 7 &&
               text.find_first_not_of("0123456789abcdefABCDEF", 1) == text.npos) {
      value = text;
    } else if (about.is_choice()) {
      if (const auto read = read_scalar(in, about)) read->get_to(value);
    } else if (about.longest > 0) {
      if (scalar && text.size() <= about.longest && (about.lines || text.find('\n') == text.npos)) {
        value = text;
      } else {
        in.reject_type("a plain text",
                       fmt::format("It takes one text of at most {} bytes.", about.longest));
      }
    } else if (scalar && is_name(text)) {
      value = text;
    } else {
      in.reject_type("a name",
                     fmt::format("It takes ASCII letters, digits, - and _, at most {} of them, and "
                                 "does not begin with -.",
                                 kLongestName));
    }
  }

  // A first and a last cycle.
  static void read(const Entry& in, const Field& about, std::array<std::uint64_t, 2>& value) {
    value = {1, 1};
    if (about.example.empty()) {  // one cycle
      read(in, {.range = about.range, .whole = true}, value[0]);
      value[1] = value[0];
      return;
    }
    const std::vector<Entry> ends = items_of(in, about.example);
    if (ends.size() == 2) {
      read(ends[0], {.range = about.range, .whole = true}, value[0]);
      value[1] = value[0];
      read(ends[1], {.range = about.range, .whole = true}, value[1]);
    }
    if (ends.size() != 2 || value[1] < value[0]) {
      in.reject("is not a first and a last cycle", fmt::format("It takes `{}`.", about.example));
    }
  }

  // The ends of a window.
  static void read(const Entry& in, const Field& about, std::array<double, 2>& window) {
    const std::vector<Entry> ends = items_of(in, about.example);
    for (std::size_t k = 0; k < std::min(ends.size(), window.size()); ++k) {
      read(ends[k], {.range = about.range}, window[k]);
    }
    if (ends.size() != 2 || !(window[0] < window[1])) {
      in.reject("is not a window from a low to a high value",
                fmt::format("It takes `{}`.", about.example));
    }
  }

  // Measures, or names of columns and their measures.
  static void read(const Entry& in, const Field& about, std::vector<ColumnSpec>& columns) {
    const bool named = in.is_map();
    for (const Entry& one : named ? in.entries() : items_of(in, about.example)) {
      ColumnSpec& column = columns.emplace_back();
      if (named) read(Entry{one.key, one.key, one.path, one.problems}, {}, column.name);
      read(one, about, column.measure);
    }
  }

  template <HasFields T>
  static void read(const Entry& in, const Field& about, std::vector<T>& values) {
    Field item = about;
    item.example = about.example.substr(1, about.example.size() - 2);  // without the brackets
    for (const Entry& each : items_of(in, about.example)) read(each, item, values.emplace_back());
  }

  // The curves of a plot. A key without `=` is a value of `by`, which check() replaces.
  static void read(const Entry& in, const Field& about, std::vector<SeriesSpec>& series) {
    if (!in.is_map()) in.reject_type("a map", remedy_of(about));
    for (const Entry& entry : in.entries()) {
      const bool selects = entry.key.text.find('=') != string::npos;
      series.push_back({selects ? read_selector(entry) : json{{"", entry.key.text}}});
      read(entry, {.example = "{label: a name, colour: blue, marker: circle}"}, series.back());
      check_formulas(entry.find("label"));
    }
  }

  // Points [x, y] or [x, y, error].
  static void read(const Entry& in, const Field& about, std::vector<std::vector<double>>& points) {
    for (const Entry& item : items_of(in, about.example)) {
      std::vector<double> point;
      for (const Entry& number : items_of(item, "[0.05, 0.646]")) {
        double value = 0;
        read(number, {.range = about.range}, value);
        point.push_back(value);
      }
      if (point.size() != 2 && point.size() != 3) {
        item.reject("is not a point", "It takes [x, y], or [x, y, error].");
      }
      points.push_back(std::move(point));
    }
  }

  // Parameters and their values.
  static void read(const Entry& in, const Field& about, json& where) {
    where = json::object();
    if (!in.is_map()) in.reject_type("a map", remedy_of(about));
    for (const Entry& entry : in.entries()) read_where(entry, where);
  }

  // Phases of a cycle.
  static void read(const Entry& in, const Field& about, std::vector<double>& phases) {
    for (const Entry& item : items_of(in, about.example)) {
      const auto read = read_scalar(item, {.range = {-kInfinity, kInfinity}});
      if (!read) continue;
      const auto phase = read->get<double>();
      if (!(phase > 0 && phase < 1)) {
        item.reject_value("is not within a cycle", "It takes fractions p of a cycle, 0 < p < 1.");
      } else if (!phases.empty() && phase <= phases.back()) {
        item.reject_value("is not greater than the phase before it",
                          "List them in ascending order, each once.");
      } else {
        phases.push_back(phase);
      }
    }
  }

  // Figures of the supplement.
  static void read(const Entry& in, const Field& about, std::vector<string>& figures) {
    for (const Entry& item : items_of(in, about.example)) {
      string figure;
      read(item, {}, figure);
      if (figure.empty()) continue;
      if (std::ranges::find(figures, figure) != figures.end()) {
        item.reject_value("names a figure twice", "Keep one of them.");
      } else if (find_figure(figure) == nullptr) {
        item.reject_value(with_nearest("names an unknown figure", figure, names_of(all_figures())),
                          "`shearcell figures --help` lists them.");
      }
      figures.push_back(figure);
    }
  }

  static void read(const Entry& in, const Field& about, std::vector<VariantLabel>& labels) {
    if (!in.is_map()) in.reject_type(about.wanted, remedy_of(about));
    for (const Entry& entry : in.entries()) {
      constexpr std::size_t longest = 60;  // [bytes]
      const string& name = entry.node.text;
      if (!entry.is_scalar() || name.empty() || name.size() > longest ||
          name.find('\n') != name.npos) {
        entry.reject_type("a name", fmt::format("It takes a text of at most {} bytes.", longest));
      }
      labels.push_back({read_selector(entry), name, entry.key.at});
    }
  }

  // The two sides of a claim.
  static void read(const Entry& in, const Field& about, std::array<json, 2>& between) {
    const std::size_t problems_before = in.problems.size();
    const std::vector<Entry> sides = items_of(in, about.example);
    for (std::size_t k = 0; k < std::min<std::size_t>(sides.size(), 2); ++k) {
      between[k] = json::object();
      for (const Entry& entry : sides[k].entries()) read_where(entry, between[k]);
    }
    const bool two = sides.size() == 2 && !between[0].empty() && !between[1].empty();
    if (!two && in.problems.size() == problems_before) {
      in.reject("does not name two variants", remedy_of(about));
    }
  }

  // Parameters, and other keys as `read_other` reads them: it returns false for those that it does
  // not know.
  static void read_settings(const Entry& in, Settings& settings, const Names& others,
                            const auto& read_other) {
    if (in.node.kind != Node::Kind::map) {
      return in.reject_type("a map of parameters", "Indent `key: value` lines under it.");
    }
    for (const Entry& entry : in.entries()) {
      const Field* field = find_field(entry.key.text);
      if (field == nullptr) {
        if (!read_other(entry)) entry.reject_unknown(joined(names_of(schema()), others));
      } else if (is_auto(*field, entry.node)) {
        settings[entry.key.text] = {entry.node.text, entry.node.at};
      } else if (auto value = read_scalar(entry, *field)) {
        settings[entry.key.text] = {std::move(*value), entry.node.at};
      }
    }
  }

  static void read(const Entry& in, const Field&, Settings& settings) {
    read_settings(in, settings, {}, [](const Entry&) { return false; });
  }

  static void read(const Entry& in, const Field&, std::vector<Scale>& scales) {
    const string remedy = "It takes `NAME: {key: value}` entries, such as smoke, desk and paper.";
    if (!in.is_map()) return in.reject_type("a map of scales", remedy);
    const std::size_t count = in.node.entries.size();
    if (count > ManifestLimits::scales) {
      return in.problems.add(in.node.at, in.path,
                             fmt::format("has more than {} scales", ManifestLimits::scales),
                             fmt::format("{} scales", count), "");
    }
    for (const Entry& entry : in.entries()) {
      if (!is_name(entry.key.text)) {
        Entry{entry.key, entry.key, entry.path, in.problems}.reject_type("a name for a scale",
                                                                         remedy);
      }
      Scale& scale = scales.emplace_back(Scale{.name = entry.key.text, .at = entry.key.at});
      read_settings(entry, scale.settings, names_of(keys_of<Scale>()),
                    [&](const Entry& part) { return read_key(part, scale); });
    }
  }

  // The axes of `grid` or `zip`.
  static void read(const Entry& in, const Field& about, std::vector<SweepAxis>& axes) {
    if (!in.is_map()) in.reject_value("sweeps nothing", "It takes `{key: [values]}`.");
    for (const Entry& entry : in.entries()) {
      const Field* field = find_field(entry.key.text);
      if (field == nullptr) {
        entry.reject_unknown(names_of(schema()));
        continue;
      }
      const bool length = is_length(field->name);
      if (!field->identity.distinguishes_runs() && !(about.name == "zip" && length)) {
        entry.reject_key("cannot be swept, since another value does not make another run",
                         length ? "Set it in `base` or in a scale, or zip it with a key that does."
                                : "Set it in `base` or in a scale.");
        continue;
      }
      SweepAxis& axis = axes.emplace_back(SweepAxis{entry.key.text, entry.key.at, {}});
      for (const Entry& item : items_of(entry, "[1, 2]")) {
        if (is_auto(*field, item.node)) {
          item.reject("cannot be swept as `auto`",
                      "Set it in `base` or in a scale; it then follows the variant.");
        } else if (auto value = read_scalar(item, *field)) {
          axis.values.push_back({std::move(*value), item.node.at});
        }
      }
    }
  }

  static void read(const Entry& in, const Field&, Sweep& sweep) {
    const string remedy = "It takes `grid: {key: [values]}` or `zip: {key: [values]}`.";
    if (!in.is_map()) in.reject_value("sweeps nothing", remedy);
    for (const Entry& entry : in.entries()) {
      if (read_key(entry, sweep)) continue;
      if (find_field(entry.key.text) != nullptr) {
        entry.reject_key("must be under `grid` or `zip`", remedy);
      } else {
        entry.reject_unknown(names_of(keys_of<Sweep>()));
      }
    }
    check_grid(sweep, in);
    check_zip(sweep.zip, in);
  }

  static void read(const Entry& in, const Field&, Seeds& seeds) {
    seeds = {.counted = !in.is_list(), .at = in.key.at};
    if (seeds.counted) {
      std::uint64_t count = 1;
      read(in, {.range = {1, ManifestLimits::runs}, .whole = true}, count);
      seeds.values.resize(count);
      std::iota(seeds.values.begin(), seeds.values.end(), 1);
      return;
    }
    seeds.values.clear();
    for (const Entry& item : items_of(in, "[3, 5]")) {
      std::uint64_t seed = 0;
      read(item, {.range = {1, kLargestSeed}, .whole = true}, seed);
      if (seed != 0 && std::ranges::count(seeds.values, seed) > 0) {
        item.reject_value("repeats a seed", "Keep one of them.");
      }
      seeds.values.push_back(seed);
    }
  }

  static void read(const Entry& in, const Field& about, StatedUntil& stated) {
    stated = {{}, in.node.at};
    if (in.is_scalar() && in.node.text == "none") return;
    const string remedy = fmt::format("It takes `{}`, or `none`.", about.example);
    if (!in.is_map()) return in.reject_type("a measure with its value", remedy);
    UntilKeys keys;
    read_keys(in, keys);
    std::size_t known = 0;
    for (const Entry& entry : in.entries()) {
      known += find_named(keys_of<UntilKeys>(), entry.key.text) != nullptr ? 1 : 0;
      const auto measure = value_of<StopMeasure>(entry.key.text);
      if (!measure) continue;
      if (stated.until) {
        in.problems.add(entry.key.at, in.path, "names two measures", "", "Keep one of them.");
      } else {
        stated.until = Until{*measure, keys.of(*measure), keys.extra_cycles};
      }
    }
    if (!stated.until && known == in.node.entries.size()) in.reject("names no measure", remedy);
  }

  // Any other map.
  template <HasFields T>
  static void read(const Entry& in, const Field& about, T& value) {
    if constexpr (requires { value.at; }) value.at = in.node.at;
    if (!in.is_map()) {
      return in.reject_type(about.wanted.empty() ? "a map" : about.wanted, remedy_of(about));
    }
    read_keys(in, value);
    for (const Field& key : keys_of<T>()) {
      if (!key.required || in.find(key.name)) continue;
      return in.reject(fmt::format("lacks {}", key.name), remedy_of(about));
    }
    check(in, about, value);
  }

  template <HasFields T>
  static void read_keys(const Entry& in, T& value) {
    for (const Entry& entry : in.entries()) {
      if (!read_key(entry, value)) entry.reject_unknown(names_of(keys_of<T>()));
    }
  }

  static void check(const Entry& in, const Field&, Checkpoints& checkpoints) {
    if (const auto phases = in.find("phases")) checkpoints.at = phases->node.at;
  }

  static void check(const Entry&, const Field&, const auto&) {}

  static void check(const Entry& in, const Field&, Placed<PlotSpec>& plot) {
    const auto x = in.find("x"), cycles = in.find("cycles");
    if (const Measure* curve = find_measure(plot.y, MeasureKind::curve); curve != nullptr && x) {
      x->reject_value(fmt::format("does not go with {}", curve->name),
                      fmt::format("Leave it out: {} is drawn against {}.", curve->name, curve->x));
    }
    if (x && plot.y == plot.x) x->reject_value("is also the y of this plot", "Name another one.");
    const bool of_run = !plot.y.empty() && is_parameter(plot.y) &&
                        find_measure(plot.y, MeasureKind::curve) == nullptr;
    if (of_run && !is_parameter(plot.x)) {
      in.reject(fmt::format("{} is one number of a run", plot.y), "Name a parameter as x.");
    }
    if (cycles && (plot.show == Show::mean || is_parameter(plot.x))) {
      cycles->reject("draws each run along its cycles",
                     "It takes `show: traces`, and `cycle` or a measure as x.");
    }
    if (cycles && !plot.figure.empty()) {
      cycles->reject("does not go with figure", "Give the plot a figure of its own.");
    }
    if (const auto also = in.find("also"); also && (plot.x != "cycle" || plot.show != Show::mean)) {
      also->reject("goes with means against the cycle", "Leave it out.");
    }
    if (const Field* field = find_field(plot.x)) {
      plot.x_symbol = field->symbol;
      if (field->unit != "1") plot.x_unit = field->unit;
      if (field->is_choice()) {
        x->reject_value("is not a number", "Take `by` for a curve of each of its values.");
      }
    }
    for (const char* label : {"xlabel", "ylabel"}) check_formulas(in.find(label));
    if (const auto series = in.find("series")) name_series(*series, plot);
    if (const auto published = in.find("published")) {
      const std::vector<Entry> items = published->items();
      for (std::size_t k = 0; k < std::min(items.size(), plot.published.size()); ++k) {
        check_published(items[k], plot.published[k]);
      }
    }
  }

  // Replaces the values of `by` in the keys of `series`.
  static void name_series(const Entry& in, Placed<PlotSpec>& plot) {
    const std::vector<Entry> entries = in.entries();
    for (std::size_t k = 0; k < entries.size(); ++k) {
      if (!plot.series[k].where.contains("")) continue;
      if (plot.by.empty()) {
        entries[k].reject_key("names no parameter",
                              "Write `\"KEY=VALUE\"`, or name the parameter with `by`.");
        continue;
      }
      Node text = entries[k].key;
      text.quoted = false;
      const Entry plain{text, text, entries[k].path, in.problems};
      plot.series[k].where = json::object();
      if (auto read = read_scalar(plain, *find_field(plot.by))) {
        plot.series[k].where[plot.by] = std::move(*read);
      }
    }
  }

  static void check_published(const Entry& in, const PublishedSpec& published) {
    check_formulas(in.find("label"));
    if (published.label.empty()) in.reject("lacks label", "Name it for the key of the plot.");
    if (published.value.has_value() == !published.points.empty()) {
      in.reject("does not have either a value or points", "State one of them.");
    }
  }

  static void check(const Entry& in, const Field& about, Placed<ClaimSpec>& claim) {
    const auto between = in.find("between"), published = in.find("published");
    if (!between && !published) in.reject("lacks between", remedy_of(about));
    if (between && published) published->reject("does not go with between", "State one of them.");
    if (published && claim.published && !claim.published->value) {
      published->reject("lacks value", "State the published number.");
    }
    if (const auto of = in.find("of"); of && !published) {
      of->reject("goes with published", "Take `between` for two variants.");
    }
    const auto relative = in.find("relative_margin");
    const bool bound = published && claim.is != Relation::same;
    if (relative && in.find("margin")) {
      relative->reject("does not go with margin", "State one of them.");
    } else if (!relative && !in.find("margin") && !bound) {
      in.reject("lacks margin", remedy_of(about));
    }
    claim.relative = relative.has_value();
    std::vector<Entry> when;
    for (const char* key : {"at_cycle", "cycles", "phi", "reaches"}) {
      if (const auto stated = in.find(key)) when.push_back(*stated);
    }
    const bool of_run = !claim.compare.empty() && is_parameter(claim.compare);
    if (of_run && !when.empty()) {
      when.front().reject(fmt::format("{} is one number of a run", claim.compare), "Leave it out.");
    } else if (when.size() > 1) {
      when[1].reject(fmt::format("does not go with {}", when[0].key.text), "State one of them.");
    } else if (!claim.compare.empty() && !of_run && when.empty()) {
      in.reject("lacks at_cycle or cycles", remedy_of(about));
    }
    if (claim.reaches && !between) {
      when.back().reject("goes with between", "A waiting time is compared with another one.");
    }
    if (claim.reaches && relative) relative->reject("does not go with reaches", "Take `margin`.");
  }
};

// Names of plots and claims, of their figures and of the panels of a plot differ from each other
// and from those of the supplement's figures and panels, unless they are parts of such a figure
// that is stated here and not in another manifest. `listed`: the `figures` of this manifest.
void check_own_names(const Entry& document, std::span<const Figure> supplement,
                     const std::vector<string>& listed) {
  std::vector<Entry> items;
  for (const char* list : {"plots", "claims"}) {
    const auto own = document.find(list);
    for (const Entry& item : own ? own->items() : std::vector<Entry>()) items.push_back(item);
  }
  std::map<string, string> taken;  // names, and their figures
  const auto is_taken = [&](const string& text) {
    return std::ranges::any_of(items, [&](const Entry& other) {
      const auto name = other.find("name");
      return other.find("panel") && name && text.starts_with(name->node.text + "_") &&
             text.find_first_not_of("0123456789", name->node.text.size() + 1) == text.npos;
    });
  };
  for (const char* key : {"name", "figure"}) {
    for (const Entry& item : items) {
      const auto own = item.find(key);
      if (!own || !is_name(own->node.text)) continue;
      const string& text = own->node.text;
      const auto its_figure = item.find("figure");
      const string of = its_figure ? its_figure->node.text : "";
      const auto is_panel = [&](const Figure& figure) {
        const bool computed = find_named(computed_figures(), figure.name) != nullptr;
        const bool also_listed = std::ranges::find(listed, figure.name) != listed.end();
        if (!computed && !also_listed && of == figure.name) return false;
        if (!text.starts_with(figure.name)) return false;
        const string_view rest = string_view(text).substr(figure.name.size());
        return rest.size() < 2 || rest.front() == '_';
      };
      const bool names_it = key == string_view("name");
      if (std::ranges::any_of(supplement, is_panel)) {
        own->reject_value("is the name of a figure of the supplement", "Choose another one.");
      } else if (is_taken(text) || (names_it ? !taken.emplace(text, of).second
                                             : taken.contains(text) && taken.at(text) != text)) {
        own->reject_value("is the name of another plot or claim", "Choose another one.");
      }
    }
  }
}

}  // namespace

bool is_name(string_view text) {
  const auto allowed = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
  return !text.empty() && text.size() <= kLongestName && text.front() != '-' &&
         std::ranges::all_of(text, allowed);
}

Manifest read_manifest(string_view text, string_view file, bool shipped) {
  const Node root = read_document(text, file);
  ProblemList problems(file);
  Manifest manifest;
  manifest.file = file;
  manifest.text = text;
  manifest.base.at = root.at;
  const Entry document{root, root, "", problems};
  if (root.kind != Node::Kind::map) {
    document.reject_type("a map of keys", "Begin with `experiment: NAME`.");
    problems.raise();
  }
  Reader::read_keys(document, manifest);
  if (const auto experiment = document.find("experiment")) {
    manifest.experiment_at = experiment->key.at;
  } else {
    problems.add(root.at, "experiment", "is missing", "", "Begin with `experiment: NAME`.");
  }
  if (const auto base = document.find("base")) manifest.base.at = base->key.at;
  check_own_names(document, shipped ? computed_figures() : all_figures(), manifest.figures);
  problems.raise();
  return manifest;
}

namespace {

// What a key takes, for a table.
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
  return keys_markdown<Manifest>("example") + "\nOf a plot:\n\n" +
         keys_markdown<Placed<PlotSpec>>("takes") + "\nOf a claim:\n\n" +
         keys_markdown<Placed<ClaimSpec>>("takes");
}

}  // namespace shearcell
