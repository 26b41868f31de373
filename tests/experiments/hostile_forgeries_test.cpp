// SPDX-License-Identifier: GPL-3.0-or-later
// Forged stores with matching hashes, stores with unusual names, places and sizes, and faults
// around a store. The cases have the form of hostile_stores_test.cpp.
#include "provenance/io/clock.hpp"
#include "tests/experiments/hostile.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Damage event(const std::string& type, const std::function<void(json&)>& change) {
  return rebuilt(payload(type, change));
}

/// Of the runs that shear.
Damage member(const std::string& path, const json& value) {
  return event("RunDeclared", [=](json& b) {
    if (b["kind"] == "shear") b[json::json_pointer(path)] = value;
  });
}

/// Of checkpoints.
Damage without_times() {
  return rebuilt(forged([](Event& e) {
    if (e.type == "CheckpointRecorded") e.recorded_at.clear();
  }));
}

Damage recorded(const std::string& path, const json& value) {
  return event("CheckpointRecorded", [=](json& b) { b[json::json_pointer(path)] = value; });
}

/// Events whose numbers are not those of the file, and runs that are not what they are named after.
std::vector<Case> forged_events() {
  const auto swapped = [](json& b) {
    b["membership"]["labels"]["fluid"] =
        b["membership"]["variant"] == "fluid=still" ? "cell" : "still";
  };
  return {
      reported("cycle", "verify", 4, recorded("/cycle", 7.0), "cycle"),
      reported("cycle_in_figures", "figures S2", 4, unmeasured(recorded("/cycle", 1.0)), "cycle"),
      reported("cycle_in_export", "export RUN --to extxyz --out x", 4, recorded("/cycle", 1.0),
               "cycle"),
      reported("time", "verify", 4, recorded("/time_s", 7.0), "time_s"),
      reported("step", "verify", 4, recorded("/step", 7), "step"),
      reported("observable", "verify", 4, recorded("/observables/mean_overlap_d", 0.1),
               "mean_overlap_d"),
      reported("observable_removed", "verify", 4, recorded("/observables", json::object()),
               "absent"),
      reported("observable_added", "verify", 4, recorded("/observables/phi", 0.7), "phi"),
      reported("state_hash", "verify", 4, recorded("/state_hash", std::string(64, 'a')), "state"),
      reported("file_elsewhere", "verify", 4, recorded("/file", "objects/../../x.h5"),
               "objects/../../x"),
      reported("grains", "verify", 4, member("/grains", 100), "grains"),
      reported("beginning", "verify", 4,
               event("RunStarted",
                     [](json& b) {
                       if (b["parent_checkpoint"].is_string()) {
                         b["parent_checkpoint"] = std::string(64, 'a');
                       }
                     }),
               "this run started from the wrong state"),
      reported("sha256_of_a_manifest", "verify", 4,
               event("ManifestRegistered", [](json& b) { b["sha256"] = std::string(64, 'a'); }),
               "the SHA-256 of the registered text differs"),
      reported("parent", "verify", 4, member("/parent", ""), "parent"),
      reported("kind", "verify", 4, member("/kind", "stiffen"), "stiffen"),
      reported("parameters", "verify", 4, member("/resolved/parameters/pressure_Pa", 10.0),
               "the id is not the hash of the recorded parameters"),
      reported("seed", "verify", 4, member("/membership/seed", 7), "seed"),
      reported("labels_swapped", "verify", 4,
               event("RunDeclared",
                     [=](json& b) {
                       if (b["kind"] == "shear") swapped(b);
                     }),
               "fluid"),
      reported("variant", "verify", 4, member("/membership/variant", "fluid=none"), "fluid=none"),
      reported("manifest_text", "verify", 4,
               event("ManifestRegistered", [](json& b) { b["text"] = "a: 1"; }), "SHA-256"),
      reported("no_time", "verify", 4, without_times(), "does not say when it was recorded"),
      reported("no_time_in_a_crate", "export RUN --to ro-crate --out x", 0, without_times()),
      reported("no_time_in_show", "show RUN", 0, without_times()),
  };
}

/// Files and events that agree.
std::vector<Case> forged_states() {
  const auto replay = "verify --replay 9";
  return {
      reported("untouched", replay, 0, states([](Checkpoint&) {}), "the same state"),
      reported("cycle", replay, 4, states([](Checkpoint& c) { c.cycle += 1; }), "DIVERGED",
               "cycle"),
      reported("time", replay, 4, states([](Checkpoint& c) { c.time_s *= 2; }), "DIVERGED",
               "time_s"),
      reported("tilt", replay, 4, states([](Checkpoint& c) { c.theta += 0.01; }), "DIVERGED",
               "theta"),
      reported("observable", replay, 4,
               states([](Checkpoint& c) { c.observables["mean_overlap_d"] *= 1.1; }), "DIVERGED",
               "mean_overlap_d"),
      reported("observable_made_up", replay, 4,
               states([](Checkpoint& c) { c.observables["phi"] = 0.7; }), "DIVERGED", "phi"),
      reported("velocity", replay, 4, states([](Checkpoint& c) { c.state.velocity(0, 0) += 1e-3; }),
               "DIVERGED"),
      reported("diameter", "verify", 4, states([](Checkpoint& c) { c.units.diameter_m *= 2; }),
               "diameter_m"),
      reported("diameter_in_export", "export RUN --to extxyz --out x", 4,
               states([](Checkpoint& c) { c.units.diameter_m *= 2; }), "diameter_m"),
      reported("grain_outside", "figures S2", 4,
               states([](Checkpoint& c) { c.state.position(1, 0) += 1000; }), "checkpoint",
               "of run", "grain 0 lies outside the cell"),
      reported("grain_outside_in_export", "export RUN --to vtk --out x", 4,
               states([](Checkpoint& c) { c.state.position(1, 0) += 1000; }), "of run",
               "grain 0 lies outside the cell"),
      reported("mass", "verify", 4, states([](Checkpoint& c) { c.units.mass_kg *= 2; }), "mass_kg"),
      reported("mass_in_export", "export RUN --to lammps --out x", 4,
               states([](Checkpoint& c) { c.units.mass_kg *= 2; }), "mass_kg"),
      reported("one_grain_less", "verify", 4, states([](Checkpoint& c) {
                 c.state.position.conservativeResize(3, 199);
                 c.state.velocity.conservativeResize(3, 199);
               }),
               "199"),
      reported("measures", "verify", 4, measures("scalars", [](json& m) { m["phi"] = 0.719; }),
               "derived.sqlite", "phi", "regenerate"),
      reported("measures_not_finite", "verify", 4,
               measures("scalars", [](json& m) { m["phi"] = std::nan(""); }), "derived.sqlite"),
      reported("measures_of_another_kind", "verify", 4,
               measures("scalars", [](json& m) { m = "none"; }), "derived.sqlite"),
      reported("measures_untouched", "verify", 0, measures("scalars", [](json&) {}), "4 of 4"),
      reported("measures_of_garbage", "verify", 0, at("derived.sqlite", written("garbage")),
               "nothing was changed"),
  };
}

std::vector<Case> forged_limits() {
  const std::uint64_t huge = std::uint64_t{1} << 60;
  const auto table = [](const std::string& update) {
    return sql("UPDATE " + update + "; UPDATE runs SET state = 'interrupted'");
  };
  const std::string range = "1 to 1000000";
  return {
      reported("cadence_in_resume", "resume", 4,
               table("memberships SET checkpoint_every = 1 << 60"), range),
      reported("cadence_in_verify", "verify", 4, member("/membership/checkpoint_every", huge),
               range),
      reported("cadence_in_the_table", "plan m.yaml", 4,
               sql("UPDATE memberships SET checkpoint_every = 1152921504606846976"), range),
      reported("no_cadence", "resume", 4, table("memberships SET checkpoint_every = 0"), range),
      reported("target", "verify", 4, member("/target_cycles", huge), "0 to 1000000"),
      reported("target_in_the_table", "status", 4, sql("UPDATE runs SET target_cycles = -1"),
               "0 to 1000000"),
      reported("extra_cycles", "resume", 4, rebuilt([=](auto& s) {
                 member("/membership/until", {{"phi", 0.1}, {"extra_cycles", huge}})(s);
                 member("/target_cycles", 2)(s);
               }),
               "extra_cycles"),
  };
}

/// In the place of the files beside a database, and links to it.
std::vector<Case> odd_files() {
  const Damage journal_is_pipe = at("store.sqlite-journal", pipe_instead);
  const auto linked_as_snap = [](const fs::path& file) {
    fs::create_hard_link(file, file.parent_path().parent_path() / "snap.sqlite");
  };
  const Damage hard_link = at("store.sqlite", linked_as_snap);
  return {
      reported("journal_is_pipe", "status", 4, journal_is_pipe, "store.sqlite-journal",
               "remove it"),
      reported("journal_is_pipe_for_figures", "figures S2", 4, journal_is_pipe, "remove it"),
      reported("journal_is_folder", "status", 4, at("store.sqlite-journal", folder_instead),
               "remove it"),
      reported("journal_is_link", "run m.yaml", 4,
               at("store.sqlite-journal",
                  [](const fs::path& file) {
                    write_bytes(file, "");
                    link_instead(file);
                  }),
               "remove it"),
      reported(
          "wal_is_pipe", "status", 4,
          [](const fs::path& s) {
            std::string bytes = read_bytes(s / "store.sqlite");
            bytes[18] = bytes[19] = 2;
            write_bytes(s / "store.sqlite", bytes);
            pipe_instead(s / "store.sqlite-wal");
          },
          "store.sqlite-wal", "remove it"),
      reported("measures_journal_is_pipe", "figures S2", 0,
               at("derived.sqlite-journal", pipe_instead), "/S2: "),
      reported("hard_link", "run m.yaml", 4, hard_link, "hard link", "cp -a"),
      reported("hard_link_to_read", "status", 4, hard_link, "hard link", "cp -a"),
      reported("hard_link_to_merge", "merge shearcell-store --store other", 4, hard_link,
               "hard link"),
      reported("hard_linked_measures", "figures S2", 0,
               at("derived.sqlite",
                  [linked_as_snap](const fs::path& file) {
                    sqlite::Database(file, Access::write).execute("DELETE FROM derived");
                    linked_as_snap(file);
                  }),
               "/S2: "),
  };
}

/// A lease of another machine, renewed `ago` seconds ago, that ends in a thousand years.
Damage lease(std::uint64_t ago) {
  return [=](const fs::path& s) {
    const std::uint64_t now = now_ms();
    sql("UPDATE runs SET state = 'running' WHERE kind = 'shear'; INSERT INTO leases SELECT id, "
        "'elsewhere', 'another boot', 77, 1, 'token', 1, " +
        std::to_string(now - 1000 * ago) + ", 9000000000000000 FROM runs")(s);
  };
}

std::vector<Case> other_faults() {
  const auto figure_in_the_future = [](const fs::path& s) {
    forged([](Event& e) {
      if (e.type == "FigureGenerated") e.recorded_at = "2999-01-01T00:00:00.000Z";
    })(s);
    Store store(s, Access::write);
    store.rebuild();
    const json facts = store.figures().front().provenance;
    store.record("figure/S2", {"FigureGenerated", facts});
  };
  return {
      reported("lease_without_end", "resume", 0, lease(58), "elsewhere, process 77", "60 s"),
      reported("lease_without_end_to_merge", "merge shearcell-store --store other", 0, lease(0)),
      reported("lease_that_is_over", "status", 0, lease(61), "3 stages"),
      reported("clock_went_back", "show S2", 0, figure_in_the_future, "made         20"),
      reported("clock_went_back_verified", "verify", 0, figure_in_the_future,
               "nothing was changed"),
  };
}

class ForgedStore : public HostileStore {};
TEST_P(ForgedStore, IsDetected) {
  expect_reported(GetParam());
}
INSTANTIATE_TEST_SUITE_P(Events, ForgedStore, testing::ValuesIn(forged_events()), case_name);
INSTANTIATE_TEST_SUITE_P(States, ForgedStore, testing::ValuesIn(forged_states()), case_name);
INSTANTIATE_TEST_SUITE_P(Limits, ForgedStore, testing::ValuesIn(forged_limits()), case_name);
INSTANTIATE_TEST_SUITE_P(Files, ForgedStore, testing::ValuesIn(odd_files()), case_name);
INSTANTIATE_TEST_SUITE_P(Faults, ForgedStore, testing::ValuesIn(other_faults()), case_name);

class UnusualStore : public ProgramTest {};

// Else an export would leave the folder that it makes.
TEST_F(UnusualStore, AnExperimentNameIsNotAPath) {
  campaign(tiny_manifest("  grains: 200\n", kBothFluids), {"--cycles", "1"});
  const std::string elsewhere = path("elsewhere").string();
  for (const std::string& name : {"../../elsewhere"s, elsewhere, ".."s, ".\x1b[2J/x"s}) {
    member("/membership/experiment", name)(path("shearcell-store"));
    expect(0, {"export", "--variant", "fluid=cell", "--to", "extxyz", "--out", "out/all"});
    const std::set<std::string> made = listing();
    EXPECT_EQ(std::ranges::count_if(made, [](auto& m) { return m.ends_with(".xyz"); }), 1) << name;
    for (const std::string& file : made) {
      EXPECT_TRUE(file.starts_with("shearcell-store") || file == "m.yaml" || file == "out" ||
                  file.starts_with("out/all"))
          << name << ": " << file;
    }
    fs::remove_all(path("out"));
  }
}

// The old process must neither play back the new store's journal nor write into it.
TEST_F(UnusualStore, AMovedStoreIsNotWrittenTo) {
  write("long.yaml", tiny_manifest("  cycles: 400\n"));
  write("m.yaml", tiny_manifest());
  const Running program = start_beside({"run", "long.yaml", "-q"}, "moved");
  wait_for_objects(4);
  fs::rename(path("shearcell-store"), path("moved"));
  expect(0, {"run", "m.yaml", "-q"});
  const Outcome stopped = wait_for(program);
  EXPECT_EQ(stopped.code, 1) << stopped.err;
  EXPECT_TRUE(has(stopped.err, "moved, replaced or deleted"));
  const nlohmann::json verified = json({"verify", "--json"});
  EXPECT_TRUE(verified.at("ok"));
  EXPECT_EQ(verified.at("orphans"), 0) << "the old process wrote into the new store";
  expect(0, {"verify", "--store", "moved"});
}

// `show ''` asks for any run.
TEST_F(UnusualStore, NoRunHasAnEmptyId) {
  campaign(tiny_manifest("  grains: 200\n"), {"--cycles", "1"});
  const fs::path store = path("shearcell-store");
  const auto expect_read = [&] {
    const std::string crate = path("crate").string();
    for (const Arguments& words : {Arguments{"status"}, Arguments{"table"}, Arguments{"show", ""},
                                   Arguments{"report"}, Arguments{"figures", "S2"},
                                   Arguments{"export", "", "--to", "ro-crate", "--out", crate}}) {
      const Outcome outcome = run(words);
      EXPECT_TRUE(outcome.signal == 0 && outcome.code != 1) << words[0] << ": " << outcome.err;
      fs::remove_all(crate);
    }
  };
  forged([](Event& e) {
    if (e.type == "RunDeclared" && e.body().at("kind") == "shear") e.stream = "run/";
  })(store);
  expect(4, {"verify"}, {"the id of the run is not a SHA-256"});
  expect(4, {"rebuild"}, {"the id of the run is not a SHA-256"});
  sql("PRAGMA user_version = 1")(store);  // readers derive the tables from the events
  expect_read();
  sql("PRAGMA user_version = 3; DELETE FROM runs WHERE kind = 'shear'; UPDATE runs SET id = ''")(
      store);
  expect_read();
  expect(4, {"verify"});
}

TEST_F(UnusualStore, AFolderMayHaveAnyName) {
  campaign(tiny_manifest("  grains: 200\n"), {"--cycles", "1"});
  for (const std::string name :
       {"a?b", "a%41b", "file:x", "file:x?mode=memory", "a#b", " ", "-x"}) {
    fs::copy(path("shearcell-store"), path(name), fs::copy_options::recursive);
    expect(0, {"verify", "--store=" + name});
  }
  std::string longer = "x";
  for (int i = 0; i < 3; ++i) longer += "/" + std::string(200, 'd');
  expect_refused({"run", "m.yaml", "--store", longer}, {"bytes"});
}

TEST_F(UnusualStore, HasTenThousandRuns) {
  campaign(tiny_manifest("  grains: 200\n"), {"--cycles", "1"});
  sql("WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 10000) INSERT INTO "
      "runs SELECT printf('%064x', i), 100 + i, parent, kind, json_set(resolved, '$.seed', 9000 + "
      "i), "
      "state, grains, target_cycles, attempts, cycle, step, state_hash, wall_seconds, "
      "particle_steps, "
      "error, updated_at, ends FROM n, runs WHERE kind = 'shear' AND length(id) = 64 AND ordinal < "
      "100")(path("shearcell-store"));
  write("many.yaml", tiny_manifest("  grains: 200\n", "seeds: 5000\n"));
  const Stopwatch watch;
  const nlohmann::json plan = json({"plan", "many.yaml", "--json"});
  const double seconds = watch.seconds();
  std::printf("plan of 10,000 stages beside 10,001 known ones: %.2f s\n", seconds);
  EXPECT_EQ(plan.at("stages").size(), 10'000U);
  EXPECT_EQ(plan.at("stages").back().at("state"), "to do");
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_LT(seconds, 30) << "it took minutes when each pair was compared as JSON";
#endif
}

}  // namespace
}  // namespace shearcell::test
