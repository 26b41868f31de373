// SPDX-License-Identifier: GPL-3.0-or-later
#include <set>

#include "experiments/manifest/expand.hpp"
#include "experiments/manifest/lines.hpp"
#include "tests/fuzz/seeds.hpp"
#include "tests/fuzz/targets.hpp"

namespace shearcell::fuzz {
namespace {

constexpr std::size_t kExpanded = 200;  // runs; more would only take longer

void check_plan(const Plan& plan) {
  std::set<std::pair<std::string, std::uint64_t>> places;
  for (const PlannedRun& run : plan.runs) {
    require(places.emplace(run.variant, run.seed).second, "no run is planned twice");
    require(read_stage(run.last.resolved).seed == run.seed, "a record reads back as its run");
    require(stage_key(run.last.resolved) == run.last.key, "a run is named after its record");
  }
}

void run(Input input) {
  const std::string text(text_of(input));
  try {
    const Manifest manifest = parse_manifest(text, "fuzz.yaml");
    std::vector<std::optional<std::string>> scales;
    for (const Scale& scale : manifest.scales) scales.emplace_back(scale.name);
    if (scales.empty()) scales.emplace_back();
    for (const auto& scale : scales) {
      const Plan plan = expand(manifest, {.scale = scale, .cycles = {}, .seeds = 1});
      if (plan.runs.size() > kExpanded) continue;
      check_plan(plan);
      for (const PlannedRun& planned : plan.runs) {
        manifest_lines(text, planned.scale, planned.labels);
      }
    }
  } catch (const ManifestError& error) {
    require(!error.problems().empty(), "an error says what is wrong");
  }
}

}  // namespace

const Target manifest_target{"manifest", run, manifest_seeds};

}  // namespace shearcell::fuzz
