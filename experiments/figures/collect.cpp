// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/figures/collect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "experiments/manifest/suggest.hpp"
#include "provenance/errors.hpp"
#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

/// At whole cycles, up to the end that the experiment asks for: another experiment may have
/// extended the run. A figure that measures nothing gets the last one only.
std::vector<CheckpointRecord> checkpoints_of(const Store& store, const Figure& figure,
                                             const CollectedRun& run) {
  std::vector<CheckpointRecord> found;
  const auto end = static_cast<double>(run.membership.target_cycles);
  for (const CheckpointRecord& record : store.checkpoints(run.run.id, true)) {
    if (record.state == CheckpointState::rejected) continue;
    if (record.cycle != std::floor(record.cycle) || record.cycle > end) continue;
    if (figure.needs == FigureNeeds::none) found.clear();
    found.push_back(record);
  }
  return found;
}

std::vector<CollectedRun> each_once(std::vector<CollectedRun> runs, bool per_experiment) {
  std::vector<CollectedRun> once;
  std::map<std::pair<std::string, std::string>, std::size_t> places;
  for (CollectedRun& run : runs) {
    const std::string within = per_experiment ? run.membership.experiment : "";
    const auto [place, first] = places.try_emplace({run.run.id, within}, once.size());
    if (first) {
      once.push_back(std::move(run));
    } else {
      std::uint64_t& target = once[place->second].membership.target_cycles;
      target = std::max(target, run.membership.target_cycles);
    }
  }
  return once;
}

std::string unknown_figure(const std::string& name) {
  std::vector<std::string_view> known;
  for (const Figure& figure : all_figures()) known.push_back(figure.name);
  const Suggestion nearest = suggest_name(name, known);
  return fmt::format("there is no figure {}; {}", name,
                     nearest.name.empty() ? fmt::format("known are {}", fmt::join(known, ", "))
                                          : "did you mean " + nearest.name + "?");
}

}  // namespace

std::vector<RegisteredManifest> registered_manifests(const Store& store) {
  std::vector<RegisteredManifest> found;
  for (const Event& event : store.events()) {
    if (event.type != "ManifestRegistered") continue;
    try {
      const nlohmann::json body = event.body();
      const nlohmann::json& info = body.at("info");
      found.push_back({info.at("experiment").get<std::string>(), info.value("question", ""),
                       info.at("figures").get<std::vector<std::string>>()});
    } catch (const nlohmann::json::exception& problem) {
      throw damaged_payload(event, problem);
    }
  }
  return found;
}

const Figure& figure_called(const std::string& name) {
  const Figure* figure = find_figure(name);
  if (figure == nullptr) throw NotFound(unknown_figure(name));
  return *figure;
}

WantedFigures figures_of_store(const Store& store) {
  WantedFigures wanted;
  std::set<std::string> names;
  const std::vector<RegisteredManifest> manifests = registered_manifests(store);
  for (const RegisteredManifest& manifest : manifests) {
    for (const std::string& name : manifest.figures) {
      if (!names.insert(name).second || find_figure(name) != nullptr) continue;
      wanted.unknown.push_back("experiment " + manifest.experiment + ": " + unknown_figure(name));
    }
  }
  for (const Figure& figure : all_figures()) {
    const bool every = figure.scope == FigureScope::every && !manifests.empty();
    if (every || names.contains(std::string(figure.name))) wanted.figures.push_back(&figure);
  }
  return wanted;
}

std::vector<const Figure*> in_order_of_needs(std::vector<const Figure*> figures) {
  std::ranges::stable_sort(figures, std::greater{}, &Figure::needs);
  return figures;
}

CollectedRuns collect_runs(const Store& store, const Figure& figure,
                           const std::optional<std::string>& scale) {
  const bool every = figure.scope == FigureScope::every;
  std::set<std::string> experiments;
  for (const RegisteredManifest& manifest : registered_manifests(store)) {
    if (every || std::ranges::find(manifest.figures, figure.name) != manifest.figures.end()) {
      experiments.insert(manifest.experiment);
    }
  }
  CollectedRuns collected;
  std::vector<CollectedRun>& runs = collected.runs;
  for (const RunRecord& run : store.runs()) {
    if (run.kind == "prepare") continue;
    for (const Membership& membership : run.memberships) {
      if (!experiments.contains(membership.experiment)) continue;
      if (!scale || membership.scale == *scale) runs.push_back({run, membership, {}});
    }
  }
  if (runs.empty()) {
    throw NotFound(
        fmt::format("no run of the store belongs to figure {}{}; run a manifest that "
                    "lists it under `figures` first",
                    figure.name, scale ? " at scale " + *scale : ""));
  }
  collected.scale = runs.back().membership.scale;
  std::erase_if(runs,
                [&](const CollectedRun& run) { return run.membership.scale != collected.scale; });
  runs = each_once(std::move(runs), every);
  for (CollectedRun& run : runs) run.checkpoints = checkpoints_of(store, figure, run);
  return collected;
}

}  // namespace shearcell
