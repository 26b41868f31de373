// SPDX-License-Identifier: GPL-3.0-or-later
// Work that is split between machines by seeds, and what `figures` leaves out after a merge if the
// manifests differ.
#include <gtest/gtest.h>

#include "provenance/sha256.hpp"
#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

class Split : public ProgramTest {
 protected:
  static std::string seeds(const std::string& stated, const std::string& more = "") {
    return tiny_manifest("  cycles: 0\n", kBothFluids + "seeds: " + stated + "\n" + more);
  }

  void run_in(const std::string& store, const std::string& text, const Arguments& options = {}) {
    write(store + ".yaml", text);
    expect(0, joined({"run", store + ".yaml", "-q", "--store", store}, options));
  }

  nlohmann::json figure(const std::string& store) {
    return json({"figures", "S2", "--store", store, "--json"}).at("figures").at(0);
  }

  void merge(const Arguments& sources, const std::string& store) {
    EXPECT_EQ(json(joined({"merge", "--store", store, "--json"}, sources)).at("warnings"),
              nlohmann::json::array());
  }

  /// Whether the figure has one note on left-out runs, with the two versions of the manifest and
  /// numbers of runs.
  void expect_names(const std::string& store, const std::string& newest, const std::string& shown,
                    const std::string& older, const std::string& lost,
                    const std::string& scale = "") {
    const nlohmann::json notes = figure(store).at("notes");
    ASSERT_EQ(notes.size(), 1U) << notes;
    const std::string text = notes.at(0);
    for (const std::string& part :
         {"experiment tiny" + scale + ": left out: " + lost + " of manifest version " +
              sha256_hex(older).substr(0, 8),
          "shown: " + shown + " of the version that was registered last, " +
              sha256_hex(newest).substr(0, 8)}) {
      EXPECT_TRUE(has(text, part)) << part << "\n" << text;
    }
  }
};

TEST_F(Split, FiguresNameTheRunsThatTheyLeaveOutAfterAMerge) {
  const std::string many = seeds("3"), few = seeds("[4]");
  run_in("many", many);
  run_in("few", few);  // registered later
  for (const bool into_few : {true, false}) {
    const std::string from = into_few ? "many" : "few", into = into_few ? "few" : "many";
    std::filesystem::copy(path(into), path("into"), std::filesystem::copy_options::recursive);
    merge({from}, "into");
    expect_names("into", few, "2 runs", many, "6 runs");
    EXPECT_EQ(figure("into").at("runs"), 2U);
    // The union, from a manifest that states both.
    write("all.yaml", seeds("[1, 2, 3, 4]"));
    EXPECT_EQ(json({"run", "all.yaml", "--store", "into", "-q", "--json"}).at("completed"), 0);
    EXPECT_EQ(figure("into").at("runs"), 8U);
    std::filesystem::remove_all(path("into"));
  }
  merge({"many", "few"}, "new");
  expect_names("new", few, "2 runs", many, "6 runs");
}

TEST_F(Split, FiguresCountRunsThatBothVersionsDeclare) {
  const std::string many = seeds("3"), few = seeds("[3, 4]");
  run_in("many", many);
  run_in("few", few);
  merge({"few"}, "many");
  expect_names("many", few, "4 runs", many, "4 runs");
}

TEST_F(Split, FiguresNameOnlyTheScaleThatItConcerns) {
  const std::string scales = "scales: {one: {cycles: 0}, two: {cycles: 0, seeds: 2}}\n";
  run_in("a", seeds("1", scales), {"--scale", "one"});
  run_in("a", seeds("1", scales), {"--scale", "two"});
  const std::string later = seeds("[7]", "scales: {one: {cycles: 0}}\n");
  run_in("b", later, {"--scale", "one"});
  merge({"b"}, "a");
  expect_names("a", later, "2 runs", seeds("1", scales), "2 runs", " at scale one");
}

TEST_F(Split, FiguresHaveNoNoteIfTheyShowAllMergedRuns) {
  const std::string whole = seeds("3");
  const auto notes = [&](const Arguments& sources, const std::string& store) {
    merge(sources, store);
    return figure(store).at("notes");
  };
  run_in("a", whole, {"--seed", "1"});
  run_in("b", whole, {"--seed", "2-3"});
  EXPECT_EQ(notes({"b"}, "a"), nlohmann::json::array()) << "one version";
  EXPECT_EQ(notes({"a", "b"}, "all"), nlohmann::json::array());
  run_in("commented", "# the same runs\n" + whole);
  EXPECT_EQ(notes({"commented"}, "a"), nlohmann::json::array()) << "the newest declares all";
  run_in("other", renamed(seeds("[9]"), "other"));
  EXPECT_EQ(notes({"other"}, "a"), nlohmann::json::array()) << "another experiment";
}

TEST_F(Split, HalvesBySeedMakeTheWhole) {
  const std::string whole = seeds("6");
  run_in("a", whole, {"--seed", "1,2", "--seed", "5"});
  run_in("b", whole, {"--seed", "3-4,6"});
  const auto seeds_of = [&](const std::string& store) {
    std::set<std::uint64_t> found;
    const nlohmann::json status = json({"status", "--json", "--store", store});
    for (const auto& run : status.at("runs")) {
      EXPECT_EQ(run.at("state"), "completed");
      found.insert(run.at("seed").get<std::uint64_t>());
    }
    return found;
  };
  EXPECT_EQ(seeds_of("a"), (std::set<std::uint64_t>{1, 2, 5}));
  EXPECT_EQ(seeds_of("b"), (std::set<std::uint64_t>{3, 4, 6}));
  expect(0, {"resume", "--store", "a"}, {"nothing is left"});
  merge({"b"}, "a");
  EXPECT_EQ(figure("a").at("runs"), 12U);
  const Store store(path("a"), Access::read);
  EXPECT_EQ(store.events("", "ManifestRegistered").size(), 1U) << "one version";
  const nlohmann::json plan = json({"plan", "a.yaml", "--store", "a", "--json"});
  EXPECT_EQ(plan.at("particle_steps_left"), 0);
}

TEST_F(Split, PlanAndSubmitHaveTheSeedsOfRun) {
  write("m.yaml", seeds("6"));
  EXPECT_EQ(json({"plan", "m.yaml", "--seed", "4-6", "--json"}).at("runs"), 6);
  EXPECT_EQ(json({"plan", "m.yaml", "--seeds", "9", "--seed", "7-9", "--json"}).at("runs"), 6);
  EXPECT_EQ(json({"plan", "m.yaml", "--seed", "2", "--variant", "fluid=cell", "--json"}).at("runs"),
            1);
  EXPECT_EQ(json({"plan", "m.yaml", "--seed", "1-2, 2", "--json"}).at("runs"), 4)
      << "each seed once";
  const nlohmann::json dry = json({"submit", "m.yaml", "--seed", "2,3", "--dry-run", "--json"});
  EXPECT_EQ(dry.at("tasks").size(), 2U) << "a packing for each seed";
  for (const char* seed : {"0", "a", "6-", "-6", "6-5", "1--2", "1.5", "1-99999999999", "7", "6-8",
                           "18446744073709551616", "1,,2", "1,", ",1", ",", ""}) {
    for (const char* command : {"plan", "run", "submit"}) {
      expect_refused({command, "m.yaml", std::string("--seed=") + seed}, {"seed"});
    }
  }
  expect_refused({"plan", "m.yaml", "--seed", "1,6-5"},
                 {"--seed: seeds: is not a range from a lower to a higher seed (got 6-5)"});
  expect_refused({"run", "m.yaml", "--seed", "6,7"},
                 {"m.yaml: seed: the manifest does not have this seed (got 7). The manifest has 1, "
                  "2, 3, 4, 5, 6"});
}

}  // namespace
}  // namespace shearcell::test
