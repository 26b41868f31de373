// SPDX-License-Identifier: GPL-3.0-or-later
// `prune` measures before it deletes, so tables and figures stay as they are; `regenerate` restores
// the files of whole experiments.
#include <gtest/gtest.h>

#include <csignal>
#include <regex>

#include "analysis/measures.hpp"
#include "provenance/derived.hpp"
#include "provenance/events.hpp"
#include "tests/experiments/damage.hpp"
#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

// Short cycles: their energies are simulated again for each measure of `heat`.
constexpr std::uint64_t kShortCycle = 2500;  // steps

class Prune : public ProgramTest {
 protected:
  const std::string short_ = "  period_s: 0.25\n  steps_per_cycle: 2500\n";
  const std::string plots_ =
      "plots:\n"
      "  - {name: heat, y: dissipation_per_cycle_J, x: cycle, cycles: [1, 2], show: traces}\n"
      "  - {name: pairs, y: pair_correlation, at_cycle: 3}\n";

  void SetUp() override {
    const std::string manifest = tiny_manifest(short_, kBothFluids + "seeds: 2\n" + plots_);
    campaign(manifest, {"--cycles", "5"});
    // Measured once for all tests, with what it shows.
    shared("measured " + manifest, "whole", [&](const std::string& folder) {
      fs::copy(path("shearcell-store"), folder, fs::copy_options::recursive);
      const std::string all = shown(folder);
      std::ofstream(fs::path(folder) / "shown", std::ios::binary) << all;
    });
    shown_ = read_bytes(path("whole/shown"));
    ASSERT_FALSE(shown_.empty());
    fs::remove(path("whole/shown"));
  }

  void keep_a_copy() {
    fs::remove_all(path("whole"));
    fs::copy(path("shearcell-store"), path("whole"), fs::copy_options::recursive);
    shown_ = shown("whole");
  }

  void start_again() {
    fs::remove_all(path("shearcell-store"));
    fs::copy(path("whole"), path("shearcell-store"), fs::copy_options::recursive);
    fs::remove(path("shearcell-store/derived.sqlite"));  // nobody has measured anything
  }

  /// Everything that a table and the figures say of a store.
  std::string shown(const std::string& store) {
    std::string all = expect(0, {"table", "--store", store}).out +
                      expect(0, {"table", "--per", "run", "--store", store}).out +
                      expect(0, {"table", "--curve", "structure_factor", "--store", store}).out;
    return all + drawn(store);
  }

  /// The numbers of the figures alone, which do not depend on computing times.
  std::string drawn(const std::string& store) {
    fs::remove_all(path("drawn"));
    expect(0, {"figures", "--store", store, "--out", "drawn"});
    std::string all;
    for (const std::string& file : listing()) {
      if (file.starts_with("drawn/") && file.ends_with(".csv")) all += read_bytes(path(file));
    }
    return all;
  }

  /// Changes digits of every measure of this name, and its digest in the cache.
  void forge_measures(const std::string& store, const std::string& name) {
    measures(name, [](nlohmann::json& content) {
      const std::string text = content.dump();
      content = nlohmann::json::parse(std::regex_replace(text, std::regex("\\.6"), ".7"));
    })(path(store));
  }

  std::size_t pruned_events() const {
    return Store(path("shearcell-store"), Access::read).events("", "CheckpointPruned").size();
  }

  std::string shown_;
};

TEST_F(Prune, ChangesNoTableAndNoFigure) {
  const std::size_t files = objects();
  for (const Arguments& choice : {Arguments{"--keep-every", "2"},
                                  {"--keep-every", "3"},
                                  {"--keep-every", "10"},
                                  {"--state", "completed"},
                                  {"--experiment", "tiny"},
                                  {"--variant", "fluid=cell"},
                                  {"--scale", "base", "--seed", "2"},
                                  {last_run()}}) {
    SCOPED_TRACE(choice.back());
    start_again();
    const nlohmann::json done = json(joined({"prune", "--yes", "--json"}, choice));
    EXPECT_GT(done.at("measured"), 0);
    EXPECT_LE(done.at("measured"), files) << "each checkpoint once";
    EXPECT_EQ(done.at("kept_unmeasured"), 0);
    EXPECT_GT(done.at("checkpoints").size(), 2U);
    EXPECT_EQ(objects(), files - done.at("checkpoints").size());
    EXPECT_EQ(shown("shearcell-store"), shown_);
  }
}

TEST_F(Prune, DeletesOnlyWhatIsSelected) {
  start_again();
  for (const Arguments& nothing :
       {Arguments{"--state", "failed"}, {last_run(), "--state", "interrupted"}}) {
    const std::size_t files = objects();
    EXPECT_TRUE(json(joined({"prune", "--yes", "--json"}, nothing)).at("checkpoints").empty());
    EXPECT_EQ(objects(), files);
  }
  for (const Arguments& unknown : {Arguments{"--experiment", "tini"},
                                   {"--scale", "desk"},
                                   {"--variant", "fluid=oil"},
                                   {"--seed", "3"}}) {
    expect_refused(joined({"prune", "--yes"}, unknown), {unknown.back()});
  }
  const nlohmann::json cells =
      json({"prune", "--variant", "fluid=cell", "--seed", "1-2", "--yes", "--json"});
  EXPECT_EQ(cells.at("checkpoints").size(), 2U * 5U) << "of two runs all but the last";
  const Store store(path("shearcell-store"), Access::read);
  for (const auto& one : cells.at("checkpoints")) {
    EXPECT_EQ(store.stage(one.at("run")).memberships.front().place.variant, "fluid=cell");
  }
}

TEST_F(Prune, KeepsTheFileOfACheckpointThatCannotBeMeasured) {
  start_again();
  const std::string run = last_run();
  std::vector<CheckpointRecord> records;
  {
    const Store store(path("shearcell-store"), Access::read);
    records = store.checkpoints(run);
  }
  truncate_file(path("shearcell-store/" + records[2].file));
  expect(4, {"prune", run, "--yes"},
         {"not measured: ", records[2].sha256.substr(0, 12),
          "kept, because measuring failed: the files of 2 checkpoints", "freed"});
  for (const std::size_t k :
       {2U, 3U, 5U}) {  // the motion at cycle 3 is from cycle 2; 5 is the last
    EXPECT_TRUE(fs::exists(path("shearcell-store/" + records[k].file))) << k;
  }
  for (const std::size_t k : {0U, 1U, 4U}) {
    EXPECT_FALSE(fs::exists(path("shearcell-store/" + records[k].file))) << k;
  }
  expect(0, {"regenerate", "--all"}, {"the same bytes"});
  const nlohmann::json again = json({"prune", run, "--yes", "--json"});
  EXPECT_EQ(again.at("kept_unmeasured"), 0);
  EXPECT_EQ(again.at("checkpoints").size(), 5U);
  EXPECT_EQ(shown("shearcell-store"), shown_);
}

// A failed run may leave a state that has no Voronoi cells.
TEST_F(Prune, KeepsAStateThatCannotBeAnalysed) {
  start_again();
  const std::string run = last_run();
  std::string file;
  {
    Store store(path("shearcell-store"), Access::write);
    const std::vector<CheckpointRecord> records = store.checkpoints(run);
    Checkpoint together = store.load_checkpoint(records[1]);
    together.state.position.col(1) = together.state.position.col(0);
    together.state.step += kShortCycle / 2;
    together.cycle += 0.5;
    store.start_stage(run, {}, records[1].sha256, "", true);
    file = store.record_checkpoint(run, together).file;
    store.complete_stage(run);
  }
  expect(4, {"prune", run, "--yes"},
         {"not measured: ", "kept, because measuring failed: the file"});
  EXPECT_TRUE(fs::exists(path("shearcell-store/" + file)));
}

TEST_F(Prune, AKillWhileItMeasuresLosesNothing) {
  for (const int milliseconds : {5, 100, 400}) {
    SCOPED_TRACE(milliseconds);
    start_again();
    const std::size_t files = objects();
    const Running program = start_beside({"prune", "--keep-every", "5", "--yes"}, "kill");
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    kill(program.pid, SIGKILL);
    wait_for(program);
    if (pruned_events() == 0) {
      EXPECT_EQ(objects(), files);
    }
    EXPECT_EQ(shown("shearcell-store"), shown_);
    expect(0, {"prune", "--keep-every", "5", "--yes"});
    EXPECT_LT(objects(), files);
    EXPECT_EQ(shown("shearcell-store"), shown_);
  }
}

TEST_F(Prune, MeasuresForEveryExperimentThatSharesAStage) {
  const std::string other = renamed(
      tiny_manifest(short_, kBothFluids + "seeds: 2\ncheckpoints: {every_cycles: 2}\n"), "other");
  expect(0, {"run", write("other.yaml", other), "--cycles", "4", "-q"});
  keep_a_copy();
  start_again();
  expect(0, {"prune", "--experiment", "tiny", "--variant", "fluid=still"}, {"other, tiny"});
  expect(0, {"prune", "--experiment", "other", "--yes"});
  EXPECT_GT(pruned_events(), 0U);
  EXPECT_EQ(shown("shearcell-store"), shown_);
}

// Motion over ten cycles then needs files that are gone; that keeps no other file.
TEST_F(Prune, PrunesARunThatWasContinued) {
  start_again();
  expect(0, {"prune", "--keep-every", "5", "--yes"});
  expect(0, {"run", "m.yaml", "--cycles", "13", "-q"});
  fs::copy(path("shearcell-store"), path("continued"), fs::copy_options::recursive);
  const std::string before = shown("continued");
  const nlohmann::json done = json({"prune", "--keep-every", "5", "--yes", "--json"});
  EXPECT_EQ(done.at("kept_unmeasured"), 0);
  EXPECT_EQ(done.at("checkpoints").size(), 4U * 6U) << "cycles 6 to 9, 11 and 12 of four runs";
  EXPECT_EQ(shown("shearcell-store"), before);
}

TEST_F(Prune, DeletesNothingIfMeasuresCannotBeKept) {
  start_again();
  fs::create_directories(path("shearcell-store/derived.sqlite/in-the-way"));
  const std::size_t files = objects();
  expect(1, {"prune", "--keep-every", "5", "--yes"},
         {"measures cannot be cached", "kept, because measuring failed: ", "Nothing was freed.\n"});
  EXPECT_EQ(objects(), files);
  EXPECT_EQ(pruned_events(), 0U);
}

// As older versions pruned: means are then of fewer runs at some cycles.
TEST_F(Prune, WithoutMeasuringIsSaidInTheDrawing) {
  start_again();
  // In S2a, and how often in the report, whose bins of phi may have fewer runs in any case.
  const auto key_says = [&] {
    expect(0, {"figures", "S2", "--out", "drawn"});
    expect(0, {"report", "--out", "r.html"});
    const std::string words = "(1 to 2 runs)", page = read_bytes(path("r.html"));
    std::size_t count = 0;
    for (auto at = page.find(words); at != page.npos; at = page.find(words, at + 1)) ++count;
    return std::pair(bool(has(read_bytes(path("drawn/tiny/base/S2a.gp")), words)), count);
  };
  const auto [before, in_report] = key_says();
  EXPECT_FALSE(before);
  fs::remove(path("shearcell-store/derived.sqlite"));
  {
    Store store(path("shearcell-store"), Access::write);
    const std::vector<CheckpointRecord> records = store.checkpoints(last_run());
    store.prune({records[2], records[3]});
  }
  const auto [pruned, then_in_report] = key_says();
  EXPECT_TRUE(pruned);
  EXPECT_GT(then_in_report, in_report);
  expect(0, {"regenerate", "--all"});
  EXPECT_EQ(key_says(), std::pair(false, in_report));
}

// The energies of a cycle are simulated from the checkpoint at its beginning.
TEST_F(Prune, ATableSaysWhichSimulatedMeasuresLackAFile) {
  campaign(tiny_manifest(), {"--cycles", "6"}, "own");
  expect(0, {"prune", "--keep-every", "3", "--yes", "--store", "own"});
  const Outcome table = expect(0, {"table", "--ledger", "--store", "own"});
  EXPECT_TRUE(
      has(table.err,
          "in 2 checkpoints the ledger measures are missing, because a checkpoint before them"))
      << table.err;
  expect(0, {"regenerate", "--all", "--store", "own"});
  EXPECT_FALSE(has(expect(0, {"table", "--ledger", "--store", "own"}).err, "ledger measures"));
}

TEST_F(Prune, RegenerateRestoresTheFilesOfSelectedRuns) {
  start_again();
  const std::size_t files = objects();
  expect(0, {"prune", "--experiment", "tiny", "--yes"});
  const std::size_t left = objects();
  ASSERT_LT(left, files);
  expect_refused({"regenerate"}, {"--experiment E or --all"});
  expect_refused({"regenerate", "--all", "0123abcd"}, {"either name checkpoints, or select runs"});
  expect_refused({"regenerate", "--experiment", "tini"}, {"tini"});
  expect(0, {"regenerate", "--experiment", "tiny", "--variant", "fluid=cell", "--seed", "2"},
         {"the same bytes"});
  EXPECT_EQ(objects(), left + 5);
  expect(0, {"regenerate", "--scale", "base", "--seed", "1"});
  const std::size_t now = objects();
  EXPECT_GE(now, left + 15);
  truncate_file(path(newest_file(last_run())));
  EXPECT_EQ(json({"regenerate", "--all", "--json"}).at("checkpoints").size(), files - now + 1);
  EXPECT_EQ(objects(), files);
  expect(0, {"verify"});
  expect(0, {"regenerate", "--all"}, {"every file is intact"});
}

// What is published of a campaign: events and measures.
TEST_F(Prune, LastTooLeavesAStoreOfNumbers) {
  start_again();
  fs::copy(path("whole"), path("twin"), fs::copy_options::recursive);
  const nlohmann::json done = json({"prune", "--last-too", "--yes", "--json"});
  EXPECT_EQ(done.at("kept_unmeasured"), 0);
  EXPECT_EQ(objects(), 0U);
  fs::remove_all(path("shearcell-store/objects"));  // as where only the databases are copied
  EXPECT_EQ(shown("shearcell-store"), shown_);
  expect(0, {"verify"}, {"0 checkpoints"});
  const nlohmann::json status = json({"status", "--json"});
  for (const auto& run : status.at("runs")) EXPECT_EQ(run.at("state"), "completed");
  expect(0, {"merge", "shearcell-store", "--store", "united"});
  EXPECT_EQ(shown("united"), shown_);
  expect(0, {"resume"}, {"nothing is left to compute"});
  expect(0, {"verify", "--replay", "100"}, {"checkpoints skipped: "});
  EXPECT_GT(json({"verify", "--replay", "3", "--json"}).at("replay").at("skipped"), 0);
  // More cycles need the last states, which are recomputed.
  const std::string manifest = tiny_manifest(short_, kBothFluids + "seeds: 2\n" + plots_);
  write("m.yaml", manifest);
  const nlohmann::json plan = json({"plan", "m.yaml", "--cycles", "6", "--json"});
  for (const auto& stage : plan.at("stages")) {
    if (stage.at("stage") != "shear") continue;
    EXPECT_EQ(stage.at("particle_steps_left"),
              stage.at("N").get<double>() * (5 + 1) *
                  stage.at("parameters").at("steps_per_cycle").get<double>())
        << "the five cycles whose last state is recomputed, and the new one";
  }
  expect(0, {"run", "m.yaml", "--cycles", "6"}, {"was pruned; its file is recomputed"});
  EXPECT_EQ(objects(), 4U * 2 + 2) << "two packings, and cycles 5 and 6 of four runs";
  expect(0, {"regenerate", "--all"}, {"the same bytes"});
  for (const char* store : {"shearcell-store", "twin"}) {
    expect(0, {"run", "m.yaml", "--cycles", "6", "--store", store});
  }
  EXPECT_EQ(hashes("shearcell-store"), hashes("twin"));
  EXPECT_EQ(drawn("shearcell-store"), drawn("twin"));
}

/// With `--last-too` the cache alone has the measures. What was changed there is damage, what is
/// missing is counted, and `table` and `verify` agree.
TEST_F(Prune, OnlyCopiesOfMeasuresAreCoveredByTheLog) {
  start_again();
  expect(0, {"prune", "--last-too", "--yes"});
  const nlohmann::json sound = json({"verify", "--json"}).at("measures");
  EXPECT_EQ(sound.at("not_covered_checkpoints"), 0);
  EXPECT_EQ(sound.at("absent"), 0);
  expect(0, {"verify"}, {"nothing was changed\n"});
  fs::copy(path("shearcell-store"), path("sound"), fs::copy_options::recursive);
  const fs::path cache = path("shearcell-store/derived.sqlite");
  const auto sql = [&](const std::string& text) {
    sqlite::Database(cache, Access::write).execute(text);
  };
  const auto forge = [&](const char* name) { forge_measures("shearcell-store", name); };
  struct Case {
    const char* what;
    std::function<void()> damage;
    int code;
    std::vector<std::string> verify_says;
  };
  const std::vector<Case> cases = {
      Case{"forged with its digest",
           [&] { forge("scalars"); },
           4,
           {"scalars-", "does not have the digest"}},
      {"forged without it",
       [&] { sql("UPDATE derived SET content = x'00' WHERE measure LIKE 'core%'"); },
       4,
       {"core-", "does not have the digest"}},
      {"without its hash",
       [&] {
         sql("UPDATE derived SET sha256 = '" + std::string(64, '0') +
             "' WHERE checkpoint = (SELECT min(checkpoint) FROM derived)");
       },
       4,
       {"does not have the digest"}},
      {"with the hash of another checkpoint",
       [&] {
         sql("UPDATE derived SET sha256 = (SELECT sha256 FROM derived AS other WHERE "
             "other.measure = derived.measure AND other.checkpoint > derived.checkpoint LIMIT 1) "
             "WHERE measure LIKE 'scalars%' AND checkpoint = (SELECT min(checkpoint) FROM "
             "derived)");
       },
       4,
       {"scalars-", "does not have the digest"}},
      {"swapped",
       [&] {
         sql("UPDATE derived SET content = (SELECT content FROM derived AS other WHERE "
             "other.measure = derived.measure AND other.checkpoint > derived.checkpoint LIMIT 1) "
             "WHERE measure LIKE 'scalars%' AND checkpoint = (SELECT min(checkpoint) FROM "
             "derived)");
       },
       4,
       {"scalars-"}},
      {"cut", [&] { fs::resize_file(cache, fs::file_size(cache) / 2); }, 4, {"derived.sqlite"}},
      {"overwritten",
       [&] { write_bytes(cache, std::string(5000, 'x')); },
       4,
       {"it is not a database of measures"}},
      {"emptied",
       [&] { fs::resize_file(cache, 0); },
       0,
       {" orphans: measures are missing\n", " missing; restore derived.sqlite from a backup"}},
      {"deleted",
       [&] { fs::remove(cache); },
       0,
       {" orphans: measures are missing\n", " missing; restore derived.sqlite from a backup"}},
      {"without one measure",
       [&] { sql("DELETE FROM derived WHERE measure LIKE 'core%'"); },
       0,
       {"measures of pruned checkpoints: 26 missing"}}};
  for (const Case& one : cases) {
    SCOPED_TRACE(one.what);
    fs::remove_all(path("shearcell-store"));
    fs::copy(path("sound"), path("shearcell-store"), fs::copy_options::recursive);
    one.damage();
    expect(one.code, {"verify"}, one.verify_says);
    for (int k = 0; k < 2; ++k) {  // the second time the file has been set aside
      expect(one.code, {"table"}, {one.code == 4 ? "derived.sqlite" : "not measured: "});
      expect(one.code, {"verify"});
    }
  }
  // Something else has the name of the file, so the measures are lost: not a fault of the machine.
  fs::remove(cache);
  fs::create_directory(cache);
  expect(4, {"verify"}, {"error: measures: ", "this is a folder, link or device"});
  expect(4, {"table"}, {"this is a folder, link or device", "only in derived.sqlite"});
  fs::remove(cache);
  sqlite::Database(cache, Access::create).execute("PRAGMA application_id=7; CREATE TABLE t(x)");
  expect(4, {"verify"}, {"error: measures: ", "belongs to another program"});
  for (const char* command : {"table", "figures", "report"}) {
    expect(4, {command}, {"belongs to another program", "only in derived.sqlite"});
  }
  // The remedy that the message gives.
  fs::remove_all(path("shearcell-store"));
  fs::copy(path("sound"), path("shearcell-store"), fs::copy_options::recursive);
  forge("scalars");
  expect(0, {"regenerate", "--all"});
  EXPECT_EQ(shown("shearcell-store"), shown_);
  expect(0, {"prune", "--last-too", "--yes"});
  expect(0, {"verify"}, {"nothing was changed\n"});
}

// The log vouches for the measures of pruned checkpoints, so wrong ones must not get there.
TEST_F(Prune, RefusesMeasuresThatAreNotThoseOfTheFiles) {
  start_again();
  expect(0, {"table"});
  forge_measures("shearcell-store", "scalars");
  const std::size_t files = objects();
  const Outcome refused =
      expect(4, {"prune", "--last-too", "--yes"}, {"deletes the cached values of this checkpoint"});
  EXPECT_EQ(objects(), files);
  Arguments again = {"regenerate"};  // the remedy, for all checkpoints
  const Store store(path("shearcell-store"), Access::read);
  for (const Stage& stage : store.stages()) {
    for (const CheckpointRecord& record : store.checkpoints(stage.id)) {
      again.push_back(record.sha256);
    }
  }
  expect(0, again);
  expect(0, {"prune", "--last-too", "--yes"});
  EXPECT_EQ(shown("shearcell-store"), shown_);
}

TEST_F(Prune, WhatIsPrunedAndMissingIsCountedByMergeAndByTheCrate) {
  start_again();
  expect(0, {"prune", "--last-too", "--yes"});
  expect(0, {"export", last_run(), "--to", "ro-crate", "--out", "crate"},
         {"left out: ", "pruned; `shearcell regenerate` recomputes them"});
  fs::remove(path("shearcell-store/derived.sqlite"));
  expect(0, {"merge", "shearcell-store", "--store", "into"},
         {"measures of pruned checkpoints are missing"});
}

// Measures that a program caches of a checkpoint after it was pruned do not count.
TEST_F(Prune, AMeasureThatTheLogDoesNotNameIsNotUsed) {
  start_again();
  expect(0, {"prune", "--last-too", "--yes"});
  const std::string before = expect(0, {"table", "--ledger"}).out;
  DerivedCache cache(path("shearcell-store"));
  const Store store(path("shearcell-store"), Access::read);
  const CheckpointRecord record = store.checkpoints(last_run(), Listed::and_pruned).at(4);
  const DerivedObject forged{{record.sha256, provider("ledger").key(), analysis_version},
                             encode_result({1, 2, 3, 4, 5})};
  cache.put({&forged, 1});
  EXPECT_EQ(expect(0, {"table", "--ledger"}).out, before);
}

TEST_F(Prune, AStorePrunedByAnEarlierVersionIsNotCovered) {
  start_again();
  expect(0, {"table"});
  const fs::path cache = path("shearcell-store/derived.sqlite");
  fs::rename(cache, path("aside"));
  {
    Store store(path("shearcell-store"), Access::write);
    store.prune(store.prunable({}));
  }
  fs::rename(path("aside"), cache);
  expect(0, {"verify"}, {"not covered: 20 pruned checkpoints", "nothing was changed\n"});
  expect(0, {"table"});
}

TEST_F(Prune, AMergeTakesMeasuresThatTheLogsCover) {
  start_again();
  fs::copy(path("shearcell-store"), path("few"), fs::copy_options::recursive);
  expect(0, {"table", "--rest"});
  for (const char* store : {"shearcell-store", "few"}) {
    expect(0, {"prune", "--last-too", "--yes", "--store", store});
  }
  // A measure that the other store alone has gets into the log of this one.
  expect(0, {"merge", "shearcell-store", "--store", "few"});
  const std::string whole = expect(0, {"table", "--rest"}).out;
  EXPECT_EQ(expect(0, {"table", "--rest", "--store", "few"}).out, whole);
  const nlohmann::json covered = json({"verify", "--json", "--store", "few"}).at("measures");
  EXPECT_EQ(covered.at("not_covered_checkpoints"), 0);
  EXPECT_EQ(covered.at("absent"), 0);
  const std::size_t events = Store(path("few"), Access::read).head().seq;
  expect(0, {"merge", "shearcell-store", "--store", "few"});
  EXPECT_EQ(Store(path("few"), Access::read).head().seq, events) << "merged again";
  expect(0, {"rebuild", "--store", "few"});
  expect(0, {"verify", "--store", "few"}, {"nothing was changed\n"});
}

TEST_F(Prune, AMergeLeavesOutAlteredMeasuresOnly) {
  start_again();
  expect(0, {"prune", "--last-too", "--yes"});
  const auto count = [&](const std::string& store) {
    sqlite::Database cache(path(store) / "derived.sqlite", Access::read);
    return std::pair(cache.integer("SELECT count(*) FROM derived"),
                     cache.integer("SELECT count(*) FROM derived WHERE measure LIKE 'scalars%'"));
  };
  const auto [all, scalars] = count("shearcell-store");
  ASSERT_GT(all, scalars);
  // So little that a recomputed sample does not show it.
  measures("scalars", [](nlohmann::json& content) {
    content["phi"] = content.at("phi").get<double>() * (1 + 1e-12);
  })(path("shearcell-store"));
  expect(4, {"merge", "shearcell-store", "--store", "united"},
         {"measures not copied: shearcell-store: derived.sqlite: scalars-", " more checkpoints"});
  EXPECT_EQ(count("united"), std::pair(all - scalars, std::int64_t{0}));
  // The log of this store does not have the digests.
  fs::copy(path("whole"), path("kept"), fs::copy_options::recursive);
  fs::remove(path("kept/derived.sqlite"));
  expect(4, {"merge", "shearcell-store", "--store", "kept"}, {"measures not copied: "});
  EXPECT_GT(count("kept").first, 0);
  EXPECT_EQ(count("kept").second, 0);
}

TEST_F(Prune, AMergeNamesTheMeasuresOfASourceWithDamagedTables) {
  start_again();
  expect(0, {"table"});
  sql("DELETE FROM checkpoints")(path("shearcell-store"));
  expect(4, {"merge", "shearcell-store", "--store", "united"},
         {"measures not copied: shearcell-store", "run `rebuild`", "merged "});
  expect(0, {"verify", "--store", "united"});
}

TEST_F(Prune, ShowsTheMeasuresOfAPrunedCheckpoint) {
  start_again();
  const Store store(path("shearcell-store"), Access::read);
  const std::string sha256 = store.checkpoints(last_run()).at(1).sha256;
  const nlohmann::json before = json({"show", sha256, "--json"}).at("measures");
  expect(0, {"prune", "--last-too", "--yes"});
  EXPECT_EQ(json({"show", sha256, "--json"}).at("measures"), before);
  expect(0, {"show", sha256}, {"pruned; `shearcell regenerate", "phi "});
  fs::remove(path("shearcell-store/derived.sqlite"));
  expect(0, {"show", sha256}, {"not measured: "});
}

TEST_F(Prune, RunKeepsEveryKthFile) {
  const std::string manifest = tiny_manifest(short_, kBothFluids + "seeds: 2\n" + plots_);
  write("m.yaml", manifest);
  expect(0, {"run", "m.yaml", "--cycles", "5", "--keep-every", "2", "--store", "thin"},
         {"8 files deleted by --keep-every"});
  EXPECT_EQ(drawn("thin"), drawn("whole"));
  const Store store(path("thin"), Access::read);
  for (const Stage& stage : store.stages()) {
    if (stage.kind != "shear") continue;
    std::vector<double> kept;
    for (const CheckpointRecord& one : store.checkpoints(stage.id)) kept.push_back(one.cycle);
    EXPECT_EQ(kept, (std::vector<double>{0, 2, 4, 5})) << "the last one too";
  }
}

// Another command made them, perhaps for another experiment.
TEST_F(Prune, RunKeepsTheFilesOfRunsThatWereDone) {
  const std::size_t files = objects();
  write("m.yaml", tiny_manifest(short_, kBothFluids + "seeds: 2\n" + plots_));
  const nlohmann::json done =
      json({"run", "m.yaml", "--cycles", "5", "--keep-every", "2", "--json"});
  EXPECT_EQ(done.at("completed"), 0);
  EXPECT_EQ(done.at("files_deleted"), 0);
  EXPECT_EQ(objects(), files);
}

TEST_F(Prune, ExtendedRunsHaveTheMotionOverTheirNewCycles) {
  write("m.yaml", tiny_manifest(short_));
  for (const char* cycles : {"5", "12"}) {
    expect(0, {"run", "m.yaml", "--cycles", cycles, "--keep-every", "5", "-q", "--store", "thin"});
  }
  expect(0, {"run", "m.yaml", "--cycles", "12", "-q", "--store", "all"});
  const nlohmann::json thin = json({"table", "--store", "thin", "--json"}).at("rows"),
                       all = json({"table", "--store", "all", "--json"}).at("rows");
  ASSERT_EQ(thin.size(), 13U);
  for (std::size_t cycle = 1; cycle < thin.size(); ++cycle) {
    for (const char* name : {"msd_1_cycle_d2", "d2min_1_cycle_d2", "reversible_percent"}) {
      EXPECT_TRUE(thin[cycle].at(name).is_number()) << cycle;
      EXPECT_EQ(thin[cycle].at(name), all[cycle].at(name)) << cycle;
    }
  }
  EXPECT_EQ(thin[10].at("msd_10_cycles_d2"), all[10].at("msd_10_cycles_d2"));
  EXPECT_TRUE(thin[11].at("msd_10_cycles_d2").is_null()) << "the file of cycle 1 was pruned";
}

TEST_F(Prune, RunDeletesNothingIfMeasuresCannotBeKept) {
  write("m.yaml", tiny_manifest(short_));
  expect(0, {"run", "m.yaml", "--cycles", "1", "-q", "--store", "thin"});
  fs::remove(path("thin/derived.sqlite"));
  fs::create_directories(path("thin/derived.sqlite/in-the-way"));
  expect(1, {"run", "m.yaml", "--cycles", "5", "--keep-every", "2", "-q", "--store", "thin"},
         {"measures cannot be cached", "kept, because measuring failed: "});
  EXPECT_TRUE(Store(path("thin"), Access::read).events("", "CheckpointPruned").empty());
}

/// A store of a program that computes other bits. Its states cannot be made again.
class OtherBits : public ProgramTest {
 protected:
  void SetUp() override {
    fs::copy(fs::path(SHEARCELL_TEST_DATA) / "store_v1", path("shearcell-store"),
             fs::copy_options::recursive);
    for (const auto& entry : fs::recursive_directory_iterator(path("shearcell-store"))) {
      fs::permissions(entry, fs::perms::owner_write, fs::perm_options::add);
    }
  }

  std::vector<std::uint64_t> versions() const {
    std::vector<std::uint64_t> found;
    for (const Event& event : Store(path("shearcell-store"), Access::read).events()) {
      if (!events::begins_attempt(event)) continue;
      found.push_back(event.body().value("bits_version", std::uint64_t{0}));
    }
    return found;
  }
};

TEST_F(OtherBits, AreKeptByPrune) {
  expect(0, {"prune", "--last-too", "--yes"}, {"4 checkpoints kept: not bitwise reproducible"});
  EXPECT_EQ(objects(), 4U);
  EXPECT_EQ(json({"prune", "--keep-every", "2", "--json"}).at("kept_of_other_engines"), 1);
  expect(0, {"verify", "--replay", "9"}, {"4 checkpoints left out"});
  expect(0, {"verify"}, {"nothing was changed"});
}

TEST_F(OtherBits, AreNotRegeneratedAndNotCalledDiverged) {
  const Store store(path("shearcell-store"), Access::read);
  const CheckpointRecord record = store.checkpoints(last_run()).at(1);
  fs::remove(path("shearcell-store/" + record.file));
  const std::size_t events = store.head().seq;
  const Outcome refused =
      expect(1, {"regenerate", record.sha256},
             {"shearcell 0.1.0 (41b6139096fb) computed this state with bits_version 1",
              "this program has bits_version 2"});
  EXPECT_FALSE(has(refused.out, "DIVERGED"));
  EXPECT_EQ(store.head().seq, events);
}

TEST_F(OtherBits, AreNamedByWhatContinuesThem) {
  // With the default of that time, which is part of the run's id.
  std::string manifest = read_bytes(fs::path(SHEARCELL_TEST_DATA) / "store_v1/manifest.yaml");
  manifest.insert(manifest.find("  grains"), "  pressure_at: moving_wall\n");
  write("m.yaml", manifest);
  EXPECT_EQ(versions(), (std::vector<std::uint64_t>{0, 0, 0})) << "written before they were";
  const std::string run = last_run();
  expect(0, {"run", "m.yaml", "--cycles", "4", "-q"},
         {"cannot be repeated bit for bit: shearcell 0.1.0", "with bits_version 1"});
  EXPECT_EQ(last_run(), run);
  EXPECT_EQ(versions(), (std::vector<std::uint64_t>{0, 0, 0, 2}));
  // Cycles 3 and 4 can be made again from cycle 2, which cannot.
  expect(0, {"prune", "--last-too", "--yes"}, {"4 checkpoints kept"});
  EXPECT_EQ(objects(), 4U);
  expect(0, {"regenerate", "--all"}, {"the same bytes"});
  EXPECT_EQ(objects(), 6U);
  // A lost file of other bits: the cycles after it cannot be made again, either.
  fs::copy(path("shearcell-store"), path("lost"), fs::copy_options::recursive);
  const Store store(path("lost"), Access::read);
  for (const Stage& stage : store.stages()) {
    for (const CheckpointRecord& record : store.checkpoints(stage.id)) {
      if (record.cycle < 3) fs::remove(path("lost/" + record.file));
    }
  }
  expect(0, {"prune", "--last-too", "--yes", "--store", "lost"}, {"6 checkpoints kept"});
  EXPECT_EQ(objects("lost"), 2U);
  // Nor does a program say so of its own states.
  const Outcome more = expect(0, {"run", "m.yaml", "--cycles", "5", "-q"});
  EXPECT_FALSE(has(more.err, "bits_version")) << more.err;
}

}  // namespace
}  // namespace shearcell::test
