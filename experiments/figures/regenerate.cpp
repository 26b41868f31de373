// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/regenerate.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "analysis/error.hpp"
#include "analysis/plot.hpp"
#include "experiments/figures/derive.hpp"
#include "experiments/figures/figure_lineage.hpp"
#include "experiments/runner/host.hpp"
#include "provenance/derived.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"
#include "provenance/io/plain_file.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {
namespace {

struct ManifestFacts {
  std::string experiment;
  std::vector<std::string> figures;
};

std::vector<ManifestFacts> manifests(const Store& store) {
  std::vector<ManifestFacts> found;
  for (const Event& event : store.events()) {
    if (event.type != "ManifestRegistered") continue;
    try {
      const nlohmann::json body = event.body();
      const nlohmann::json& info = body.at("info");
      found.push_back({info.at("experiment").get<std::string>(),
                       info.at("figures").get<std::vector<std::string>>()});
    } catch (const nlohmann::json::exception& problem) {
      throw damaged_payload(event, problem);
    }
  }
  return found;
}

bool asks_for(const ManifestFacts& manifest, std::string_view figure) {
  return std::find(manifest.figures.begin(), manifest.figures.end(), figure) !=
         manifest.figures.end();
}

// One run of the figure, with where it stands in an experiment and what to read.
struct Input {
  RunRecord run;
  Membership membership;
  std::vector<CheckpointRecord> checkpoints;  // at whole cycles
};

// At whole cycles, as far as the experiment asks for them: another may have extended the run. Of a
// figure that measures nothing the last one.
std::vector<CheckpointRecord> checkpoints_of(const Store& store, const Figure& figure,
                                             const Input& input) {
  std::vector<CheckpointRecord> found;
  const auto end = static_cast<double>(input.membership.target_cycles);
  for (const CheckpointRecord& record : store.checkpoints(input.run.id, true)) {
    if (record.state == CheckpointState::rejected) continue;
    if (record.cycle != std::floor(record.cycle) || record.cycle > end) continue;
    if (figure.needs == FigureNeeds::none) found.clear();
    found.push_back(record);
  }
  return found;
}

// A run that two experiments share is one run, as long as the longer of them asks: counted twice,
// it would make errors too small. A figure of every experiment tells of each by itself.
std::vector<Input> each_once(std::vector<Input> inputs, bool in_each_experiment) {
  std::vector<Input> once;
  std::map<std::pair<std::string, std::string>, std::size_t> places;
  for (Input& input : inputs) {
    const std::string within = in_each_experiment ? input.membership.experiment : "";
    const auto [place, first] = places.try_emplace({input.run.id, within}, once.size());
    if (first) {
      once.push_back(std::move(input));
    } else {
      std::uint64_t& target = once[place->second].membership.target_cycles;
      target = std::max(target, input.membership.target_cycles);
    }
  }
  return once;
}

std::vector<Input> inputs_of(const Store& store, const Figure& figure,
                             const std::optional<std::string>& asked_scale, std::string& scale) {
  const bool every = figure.scope == FigureScope::every;
  std::set<std::string> experiments;
  for (const ManifestFacts& manifest : manifests(store)) {
    if (every || asks_for(manifest, figure.name)) experiments.insert(manifest.experiment);
  }
  std::vector<Input> inputs;
  for (const RunRecord& run : store.runs()) {
    if (run.kind == "prepare") continue;
    for (const Membership& membership : run.memberships) {
      if (experiments.count(membership.experiment) == 0) continue;
      if (asked_scale && membership.scale != *asked_scale) continue;
      inputs.push_back({run, membership, {}});
    }
  }
  if (inputs.empty()) {
    throw NotFound("no run of the store belongs to figure " + std::string(figure.name) +
                   (asked_scale ? " at scale " + *asked_scale : "") +
                   "; run a manifest that lists it under `figures` first");
  }
  // Sizes are not mixed in one figure.
  scale = inputs.back().membership.scale;
  inputs.erase(std::remove_if(inputs.begin(), inputs.end(),
                              [&](const Input& i) { return i.membership.scale != scale; }),
               inputs.end());
  inputs = each_once(std::move(inputs), every);
  for (Input& input : inputs) input.checkpoints = checkpoints_of(store, figure, input);
  return inputs;
}

struct Measured {
  Measures measures;
  std::optional<CrystalliteMap> crystallites;
};

std::vector<DerivedMeasure> needed(const Figure& figure) {
  if (figure.needs == FigureNeeds::none) return {};
  std::vector<DerivedMeasure> measures = {scalar_measures()};
  if (figure.needs == FigureNeeds::crystallites) measures.push_back(crystallite_measure());
  return measures;
}

// Measures of the checkpoints of all inputs, one after the other; empty where one cannot be read.
std::vector<std::optional<Measured>> measure(const Store& store, const Figure& figure,
                                             const std::vector<Input>& inputs,
                                             const RegenerateOptions& options,
                                             RegeneratedFigure& result) {
  std::vector<CheckpointRecord> records;
  for (const Input& input : inputs) {
    records.insert(records.end(), input.checkpoints.begin(), input.checkpoints.end());
  }
  Derived derived =
      derive(store, records, needed(figure), {options.workers, options.fresh, options.report});
  std::vector<std::optional<Measured>> measured;
  try {
    for (auto& results : derived.results) {
      std::optional<Measured>& one = measured.emplace_back();
      if (!results) continue;
      one.emplace();
      if (!results->empty()) one->measures = read_measures(results->front());
      if (results->size() > 1) one->crystallites = read_crystallite_map(results->at(1));
      results.reset();  // as JSON it takes more memory than all that is kept of it
    }
  } catch (const AnalysisError& problem) {
    throw AnalysisError(std::string(DerivedCache::kFile) + " holds something else (" +
                        problem.what() + "); delete it, or measure again with --fresh");
  }
  result.measured = derived.computed;
  result.damage = std::move(derived.damage);
  result.pruned = std::move(derived.pruned);
  result.changed = std::move(derived.changed);
  result.cache_trouble = std::move(derived.trouble);
  return measured;
}

std::vector<FigureRun> figure_runs(const std::vector<Input>& inputs,
                                   std::vector<std::optional<Measured>> measured) {
  std::vector<FigureRun> runs;
  std::size_t next = 0;
  for (const Input& input : inputs) {
    FigureRun run{input.run.id,
                  input.membership.experiment,
                  input.membership.variant,
                  input.membership.labels,
                  input.run.resolved.value("parameters", nlohmann::json::object()),
                  input.membership.seed,
                  {}};
    for (const CheckpointRecord& record : input.checkpoints) {
      std::optional<Measured>& one = measured[next++];
      if (!one) continue;
      CheckpointMeasures& checkpoint = run.checkpoints.emplace_back();
      checkpoint.cycle = record.cycle;
      checkpoint.step = record.step;
      checkpoint.sha256 = record.sha256;
      checkpoint.measures = one->measures;
      checkpoint.crystallites = std::move(one->crystallites);
      const auto stiffness = record.observables.find("stiffness_N_per_m");
      if (stiffness != record.observables.end()) checkpoint.stiffness_N_per_m = stiffness->second;
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

std::filesystem::path write_text(const std::filesystem::path& path, const std::string& text) {
  write_output(path, text);
  return path;
}

// What the figure came from, in terms that do not change when it is made again.
nlohmann::json lineage(const RegeneratedFigure& result, const std::vector<Input>& inputs,
                       const std::vector<FigureRun>& runs) {
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t r = 0; r < runs.size(); ++r) {
    nlohmann::json checkpoints = nlohmann::json::array();
    for (const CheckpointMeasures& c : runs[r].checkpoints) checkpoints.push_back(c.sha256);
    list.push_back({{"run", runs[r].run_id},
                    {"parent", inputs[r].run.parent},
                    {"experiment", inputs[r].membership.experiment},
                    {"manifest", inputs[r].membership.manifest},
                    {"variant", runs[r].variant},
                    {"seed", runs[r].seed},
                    {"checkpoints", checkpoints}});
  }
  return {{"figure", result.name},
          {"scale", result.scale},
          {"analysis_version", analysis_version},
          {"inputs", list},
          {"outputs", nlohmann::json::object()}};
}

// Unless the newest record of the figure says the same, whoever made it.
void record(Store& store, const std::string& name, nlohmann::json facts) {
  for (const FigureRecord& known : store.figures()) {
    if (known.name == name && lineage_text(known.provenance) == lineage_text(facts)) return;
  }
  facts["made"] = host_facts();
  store.record_figure(name, facts);
}

}  // namespace

std::vector<std::string> figures_of_store(const Store& store) {
  const std::vector<ManifestFacts> registered = manifests(store);
  std::vector<std::string> names;
  for (const Figure& figure : all_figures()) {
    const bool asked =
        std::any_of(registered.begin(), registered.end(), [&](const ManifestFacts& manifest) {
          return figure.scope == FigureScope::every || asks_for(manifest, figure.name);
        });
    if (asked) names.emplace_back(figure.name);
  }
  return names;
}

std::vector<const Figure*> in_order_of_needs(std::vector<const Figure*> figures) {
  std::ranges::stable_sort(figures, std::greater{}, &Figure::needs);
  return figures;
}

ComputedFigure compute_figure(const Store& store, const Figure& figure,
                              const RegenerateOptions& options) {
  ComputedFigure computed;
  RegeneratedFigure& about = computed.about;
  about.name = figure.name;
  const std::vector<Input> inputs = inputs_of(store, figure, options.scale, about.scale);
  const std::vector<FigureRun> runs =
      figure_runs(inputs, measure(store, figure, inputs, options, about));
  about.runs = runs.size();
  for (const FigureRun& run : runs) about.checkpoints += run.checkpoints.size();
  computed.result = figure.make(runs);
  about.verdicts = computed.result.verdicts;
  computed.lineage = lineage(about, inputs, runs);
  return computed;
}

RegeneratedFigure regenerate(Store& store, const Figure& figure, const RegenerateOptions& options) {
  ComputedFigure computed = compute_figure(store, figure, options);
  RegeneratedFigure& result = computed.about;
  const FigureResult& made = computed.result;
  std::filesystem::create_directories(options.folder);
  for (const FigureTable& table : made.tables) require_own_files(table, options.folder);
  require_ours(options.folder / (result.name + ".verdict.json"), [](std::string_view beginning) {
    return beginning.starts_with("{\n \"claims\": [");
  });
  require_ours(options.folder / (result.name + ".lineage.json"), [&](std::string_view beginning) {
    return beginning.starts_with("{\n \"analysis_version\": ") &&
           beginning.find("\n \"figure\": \"" + result.name + "\"") != beginning.npos;
  });
  for (const FigureTable& table : made.tables) {
    result.files.push_back(write_csv(table, options.folder));
    try {
      const std::filesystem::path svg = draw_svg(table, options.folder);
      result.files.push_back(svg);
      if (auto pdf = convert_to_pdf(svg)) result.files.push_back(std::move(*pdf));
    } catch (const AnalysisError& error) {
      result.plot_error = error.what();
    }
  }
  if (!made.verdicts.empty()) {
    nlohmann::json verdict = to_json(made.verdicts);
    verdict["figure"] = result.name;
    verdict["scale"] = result.scale;
    result.files.push_back(
        write_text(options.folder / (result.name + ".verdict.json"), verdict.dump(1) + "\n"));
  }

  nlohmann::json& facts = computed.lineage;
  for (const auto& file : result.files) {
    facts["outputs"][file.filename().string()] = sha256_hex_of_file(file);
  }
  result.files.push_back(
      write_text(options.folder / (result.name + ".lineage.json"), lineage_text(facts)));

  record(store, result.name, facts);
  return std::move(computed.about);
}

}  // namespace shearcell
