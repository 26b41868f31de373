// SPDX-License-Identifier: GPL-3.0-or-later
// The manifests at the top of experiments/: each expands at every scale, and runs that coincide
// between them have equal ids, so that they are computed once.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/expand.hpp"
#include "experiments/manifest/shipped.hpp"
#include "experiments/manifest/suggest.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(SHEARCELL_TEST_DATA) / ".." / ".." / "experiments";
const std::vector<std::string> kScales = {"smoke", "desk", "paper"};
/// Those that have the scales "second" and "extension": experiments/results/PLAN.md.
const std::set<std::string> kSecond = {
    "choices", "drag", "moving_wall", "relaxation", "nucleation_sites", "onset_amplitude"};
const std::set<std::string> kExtension = {"gravity", "onset_amplitude"};

/// With the runs that the manifest starts from.
Plan plan(const std::string& experiment, const std::string& scale) {
  const Manifest manifest = load_manifest(kFolder / (experiment + ".yaml"));
  std::vector<Stage> known;
  const Start& start = manifest.base.start;
  if (!start.experiment.empty()) add_as_computed(plan(start.experiment, scale), known);
  return expand(manifest, {.scale = scale, .known = known});
}

std::set<std::string> last_stages(const Plan& plan) {
  std::set<std::string> keys;
  for (const PlannedRun& run : plan.runs) keys.insert(run.stage.id);
  return keys;
}

std::map<std::string, std::size_t> runs_of_variants(const Plan& plan) {
  std::map<std::string, std::size_t> count;
  for (const PlannedRun& run : plan.runs) ++count[run.place.variant];
  return count;
}

TEST(Manifests, EachExpandsAtEveryScale) {
  std::set<std::string> experiments;
  for (const auto& entry : fs::directory_iterator(kFolder)) {
    if (entry.path().extension() != ".yaml") continue;
    const std::string experiment = entry.path().stem();
    SCOPED_TRACE(experiment);
    const Manifest manifest = load_manifest(entry.path());
    EXPECT_EQ(manifest.experiment, experiment);
    EXPECT_FALSE(manifest.question.empty());
    EXPECT_FALSE(manifest.figures.empty() && manifest.plots.empty());
    experiments.insert(experiment);
    if (!manifest.of.empty()) continue;  // it has no runs
    std::vector<std::string_view> scales(kScales.begin(), kScales.end());
    if (kSecond.contains(experiment)) scales.push_back("second");
    if (kExtension.contains(experiment)) scales.push_back("extension");
    EXPECT_EQ(names_of(manifest.scales), scales);
    for (const Scale& has : manifest.scales) {
      const std::string& scale = has.name;
      const Plan expanded = plan(experiment, scale);
      EXPECT_FALSE(expanded.runs.empty());
      // Some time steps are above 0.7 of the stability limit on purpose.
      const bool published = scale == "paper" || scale == "second";
      const bool larger =
          experiment == "timestep" || experiment.starts_with("committor") ||
          (published && (experiment == "critical_size" || experiment == "nucleation_sites"));
      EXPECT_EQ(expanded.warnings.size(), experiment == "accuracy" ? 4U  // small ones, too
                                          : published && experiment == "nucleation_sites"
                                              ? 2U  // for each spring constant
                                          : larger ? 1U
                                                   : 0U)
          << scale;
    }
  }
  EXPECT_EQ(experiments,
            (std::set<std::string>{
                "accuracy", "choices", "committor", "committor_parents", "critical_size", "drag",
                "gravity", "moving_wall", "nucleation_sites", "onset_amplitude", "relaxation",
                "spring_constant", "summary", "system_size", "timestep", "walls"}));
}

TEST(Manifests, StateTheFiguresThatAreNotComputed) {
  for (const auto& [experiment, figure] : {std::pair("drag", "S2"),
                                           {"timestep", "S3"},
                                           {"moving_wall", "S4"},
                                           {"relaxation", "B5"},
                                           {"walls", "walls"},
                                           {"choices", "choices"},
                                           {"accuracy", "accuracy"}}) {
    const Manifest manifest = load_manifest(kFolder / (std::string(experiment) + ".yaml"));
    const std::vector<Figure> stated = stated_figures(manifest);
    ASSERT_EQ(stated.size(), 1U) << experiment;
    EXPECT_EQ(stated[0].name, figure);
    ASSERT_NE(find_figure(figure), nullptr);
    EXPECT_EQ(find_figure(figure)->title, manifest.question) << "that of the program is older";
    EXPECT_EQ(find_figure(figure)->keys, stated[0].keys);
    EXPECT_FALSE(stated[0].keys.empty());
  }
}

// Still fluid, bottom wall moving, continuous shear, A = 0.0833, time step of Table I, first seed.
TEST(Manifests, ShareTheirCommonRun) {
  for (const std::string& scale : kScales) {
    const std::string base = plan("drag", scale).runs.front().stage.id;
    for (const char* experiment : {"timestep", "relaxation", "moving_wall", "walls"}) {
      // At scale smoke the walls have runs that crystallize.
      const bool shares = scale != "smoke" || experiment != std::string("walls");
      EXPECT_EQ(last_stages(plan(experiment, scale)).contains(base), shares) << experiment << scale;
    }
    if (scale == "paper") continue;  // other cells and time steps
    EXPECT_TRUE(last_stages(plan("critical_size", scale)).contains(base));
    EXPECT_EQ(last_stages(plan("critical_size", scale)),
              last_stages(plan("onset_amplitude", scale)));
  }
  // At its own desk scale, N = 2000, the choices share no run.
  for (const char* scale : {"smoke", "paper"}) {
    EXPECT_TRUE(last_stages(plan("choices", scale)).contains(plan("drag", scale).runs[0].stage.id));
  }
  // With gravity, S6 has two of the amplitudes of S5a; S5b has one of its amplitudes in cells of
  // its size.
  const std::set<std::string> amplitudes = last_stages(plan("onset_amplitude", "paper"));
  const auto shared = [&](const char* experiment) {
    const std::set<std::string> stages = last_stages(plan(experiment, "paper"));
    return std::ranges::count_if(stages, [&](const auto& id) { return amplitudes.contains(id); });
  };
  EXPECT_EQ(shared("gravity"), 6 + 12);
  EXPECT_EQ(shared("system_size"), 12);
}

TEST(Manifests, ShareRunsOfTheSecondLook) {
  const std::set<std::string> reference = last_stages(plan("drag", "second"));
  const std::set<std::string> amplitudes = last_stages(plan("onset_amplitude", "extension"));
  const auto shared = [](const char* experiment, const std::set<std::string>& with,
                         const char* scale = "second") {
    const std::set<std::string> stages = last_stages(plan(experiment, scale));
    return std::ranges::count_if(stages, [&](const auto& id) { return with.contains(id); });
  };
  EXPECT_EQ(reference.size(), 40U + 40);
  EXPECT_EQ(shared("relaxation", reference), 40);
  EXPECT_EQ(shared("choices", reference), 40);
  EXPECT_EQ(shared("moving_wall", reference), 24);
  EXPECT_EQ(last_stages(plan("onset_amplitude", "second")).size(), 72U);
  EXPECT_EQ(amplitudes.size(), 54U);
  EXPECT_EQ(shared("gravity", amplitudes, "extension"), 54);
}

// Seeds that no earlier result has, and the first of them for variants that have fewer.
TEST(Manifests, PublishRunsOfFreshSeeds) {
  for (const auto& entry : fs::directory_iterator(kFolder)) {
    const std::string experiment = entry.path().stem();
    if (entry.path().extension() != ".yaml" || experiment == "accuracy" ||
        experiment.starts_with("committor")) {
      continue;
    }
    std::map<std::string, std::uint64_t> next, next_of_second;
    for (const PlannedRun& run : plan(experiment, "paper").runs) {
      EXPECT_EQ(run.place.seed, 1001 + next[run.place.variant]++) << experiment;
    }
    if (!kSecond.contains(experiment)) continue;
    for (const PlannedRun& run : plan(experiment, "second").runs) {
      EXPECT_EQ(run.place.seed, 2001 + next_of_second[run.place.variant]++) << experiment;
    }
  }
}

TEST(Manifests, HaveTheSizesAndNumbersOfTheSupplement) {
  using Variants = std::map<std::string, std::size_t>;
  EXPECT_EQ(runs_of_variants(plan("timestep", "paper")), (Variants{{"steps_per_cycle=76923", 10},
                                                                   {"steps_per_cycle=57143", 10},
                                                                   {"steps_per_cycle=45600", 10},
                                                                   {"steps_per_cycle=28571", 10},
                                                                   {"steps_per_cycle=20000", 10}}));
  EXPECT_EQ(runs_of_variants(plan("moving_wall", "paper")),
            (Variants{{"moving_wall=bottom,pressure_at=top", 10},
                      {"moving_wall=top,pressure_at=top", 10}}));
  EXPECT_EQ(runs_of_variants(plan("critical_size", "paper")),
            (Variants{{"amplitude_rad=0.04", 3},
                      {"amplitude_rad=0.05", 6},
                      {"amplitude_rad=0.0667", 12},
                      {"amplitude_rad=0.0833", 40},
                      {"amplitude_rad=0.1", 40}}));
  EXPECT_EQ(
      runs_of_variants(plan("system_size", "paper")),
      (Variants{
          {"grains=5200", 12}, {"grains=7900", 12}, {"grains=11400", 8}, {"grains=18200", 6}}));
  for (const PlannedRun& run : plan("nucleation_sites", "paper").runs) {
    EXPECT_EQ(run.parameters.grains, 18200U);
  }
}

// The default of choices.yaml is that of the program.
TEST(Manifests, ChoicesChangeOneDefaultAtATimeByAFactorOfThree) {
  const Plan expanded = plan("choices", "desk");
  ASSERT_EQ(expanded.runs.size(), 6 * 6U);
  const Parameters none;
  EXPECT_EQ(none.wall_mass_grains_per_d2, 10);
  EXPECT_EQ(none.wall_drag_grains_per_d2_s, 1000);
  EXPECT_EQ(none.wall_grain_draw, 0U);
  std::vector<std::vector<double>> found;
  for (std::size_t n = 0; n < 6; ++n) {
    const Parameters& p = expanded.runs[6 * n].parameters;
    EXPECT_EQ(p.grains, 2000U);
    found.push_back({p.wall_mass_grains_per_d2 / none.wall_mass_grains_per_d2,
                     p.wall_drag_grains_per_d2_s / none.wall_drag_grains_per_d2_s,
                     static_cast<double>(p.wall_grain_draw)});
  }
  const std::vector<std::vector<double>> wanted = {{1, 1, 0}, {3, 1, 0},       {1.0 / 3, 1, 0},
                                                   {1, 3, 0}, {1, 1.0 / 3, 0}, {1, 1, 1}};
  for (std::size_t n = 0; n < 6; ++n) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found[n][k], wanted[n][k], 1e-12) << n << k;
  }
}

TEST(Manifests, TimeStepsOfFigureS3GiveWholeCycles) {
  const double stated[] = {2.6e-5, 3.5e-5, 4.4e-5, 7.0e-5};
  const Plan expanded = plan("timestep", "paper");
  for (std::size_t n = 0; n < 4; ++n) {
    const Parameters& p = expanded.runs[10 * n].parameters;
    std::printf("time step %.4e s for the stated %.1e s\n", shear_time_step_s(p), stated[n]);
    EXPECT_NEAR(shear_time_step_s(p) / stated[n], 1, n == 2 ? 4e-3 : 2e-5);
  }
}

TEST(Manifests, PausedShearRestsAsLongAsACycle) {
  for (const PlannedRun& run : plan("relaxation", "paper").runs) {
    const Drive walls = drive(run.parameters);
    EXPECT_EQ(walls.pause_steps, run.place.variant == "protocol=paused" ? 45600U : 0U)
        << run.place.variant;
  }
}

}  // namespace
}  // namespace shearcell::test
