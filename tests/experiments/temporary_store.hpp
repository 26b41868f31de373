// SPDX-License-Identifier: GPL-3.0-or-later
// An experiment small enough to run many times, in a temporary store.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiments/manifest/expand.hpp"
#include "experiments/runner/campaign.hpp"
#include "experiments/runner/stage.hpp"
#include "experiments/runner/stop.hpp"
#include "provenance/store.hpp"
#include "tests/support/files.hpp"

namespace shearcell::test {

/// Cuts a file in half.
inline void truncate_file(const std::filesystem::path& file) {
  ASSERT_GT(std::filesystem::file_size(file), 1U);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
}

inline constexpr std::size_t kGrains = 300;
inline constexpr std::size_t kStepsPerCycle = 10000;

/// Table I with the largest round time step that is stable. A cycle takes about 60 ms and more than
/// one of the runner's chunks, so that an interruption falls within a cycle.
/// Lines of `base` replace base values or are added to them; `rest` is added to the manifest.
inline std::string tiny_manifest(const std::string& base = "", const std::string& rest = "") {
  std::string text =
      "experiment: tiny\n"
      "question: Does the runner keep its promises?\n"
      "figures: [S2]\n"
      "base:\n";
  for (const char* line : {"  grains: 300\n", "  period_s: 1\n", "  steps_per_cycle: 10000\n",
                           "  settle_time_step_s: 1.0e-4\n", "  cycles: 2\n"}) {
    const std::string key = std::string(line).substr(0, std::string(line).find(':') + 1);
    if (base.find(key) == std::string::npos) text += line;
  }
  return text + base + rest;
}

/// The same runs in an experiment of another name.
inline std::string renamed(std::string manifest, const std::string& experiment) {
  return manifest.replace(manifest.find("tiny"), 4, experiment);
}

inline const std::string kBothFluids = "sweep: {grid: {fluid: [still, cell]}}\n";

/// Declares the runs of a manifest; returns its stages.
inline std::vector<StageJob> declared(Store& store, const std::string& text,
                                      const ExpandOptions& options = {}) {
  const Manifest manifest = parse_manifest(text, "tiny.yaml");
  return declare(store, expand(manifest, options));
}

/// Declares the runs of a manifest and computes them.
inline CampaignResult compute(Store& store, const std::string& text,
                              const ExpandOptions& options = {}, std::size_t workers = 2) {
  const std::vector<StageJob> jobs = declared(store, text, options);
  return run_campaign(store, jobs, workers, {}, true);
}

inline CampaignResult resume(Store& store, std::size_t workers = 2) {
  const std::vector<StageJob> jobs = stages_to_resume(store, {});
  return run_campaign(store, jobs, workers, {}, true);
}

/// Run id -> hash of its last state.
inline std::map<std::string, std::string> final_hashes(const Store& store) {
  std::map<std::string, std::string> hashes;
  for (const Stage& run : store.stages()) hashes[run.id] = run.state_hash;
  return hashes;
}

/// Run id -> hash of its last state, of runs that nothing disturbs in a store of their own.
inline std::map<std::string, std::string> undisturbed(const std::string& text,
                                                      const ExpandOptions& options = {}) {
  const TemporaryFolder folder;
  Store store(folder.path() / "store", Access::create);
  compute(store, text, options);
  return final_hashes(store);
}

inline std::vector<Stage> runs_of_kind(const Store& store, const std::string& kind) {
  std::vector<Stage> found;
  for (const Stage& run : store.stages()) {
    if (run.kind == kind) found.push_back(run);
  }
  return found;
}

/// The first run that shears.
inline Stage sheared(const Store& store) {
  return runs_of_kind(store, "shear").at(0);
}

/// Declares the run again for its first experiment.
inline Stage declaration_of(Stage run) {
  run.memberships.resize(1);
  run.memberships[0].ask.target_cycles = run.target_cycles;
  return run;
}

inline std::size_t count_events(const Store& store, const std::string& type,
                                const std::string& stream = "") {
  std::size_t count = 0;
  for (const Event& event : store.events(stream)) count += event.type == type ? 1 : 0;
  return count;
}

inline std::vector<double> cycles_of(const Store& store, const std::string& run) {
  std::vector<double> cycles;
  for (const CheckpointRecord& record : store.checkpoints(run)) cycles.push_back(record.cycle);
  return cycles;
}

/// Clears a request to stop at the beginning and at the end of a test.
struct StopWish {
  StopWish() { request_stop(false); }
  ~StopWish() { request_stop(false); }
  StopWish(const StopWish&) = delete;
  StopWish& operator=(const StopWish&) = delete;
};

/// Runs a stage for one chunk of steps and interrupts it.
inline StageOutcome run_one_chunk(Store& store, const std::string& id) {
  const StopWish wish;
  StageOptions options;
  options.begun = [] { request_stop(true); };
  return run_stage(store, id, options);
}

/// Interrupts a stage after each chunk of its steps until it is completed. Returns how often.
inline std::size_t interrupt_to_the_end(Store& store, const std::string& id,
                                        const std::function<void()>& between = {}) {
  constexpr std::size_t most = 1000;
  std::size_t interrupted = 0;
  while (interrupted < most && run_one_chunk(store, id) == StageOutcome::interrupted) {
    ++interrupted;
    if (between) between();
  }
  EXPECT_LT(interrupted, most) << "the stage makes no progress";
  return interrupted;
}

/// An empty store; a request to stop ends with the test.
class StoreTest : public testing::Test {
 protected:
  TemporaryFolder folder_;
  StopWish wish_;
  Store store_{folder_.path() / "store", Access::create};
};

}  // namespace shearcell::test
