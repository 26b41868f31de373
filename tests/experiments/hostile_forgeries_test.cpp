// SPDX-License-Identifier: GPL-3.0-or-later
// Stores that were forged so that all hashes match, stores that harm each other, and faults around
// a store. Cases like those of hostile_stores_test.cpp.
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
      told("cycle", "verify", 4, recorded("/cycle", 7.0), "cycle"),
      told("cycle_in_figures", "figures S2 --fresh", 4, recorded("/cycle", 1.0), "cycle"),
      told("cycle_in_export", "export RUN --to extxyz --out x", 4, recorded("/cycle", 1.0),
           "cycle"),
      told("time", "verify", 4, recorded("/time_s", 7.0), "time_s"),
      told("step", "verify", 4, recorded("/step", 7), "step"),
      told("observable", "verify", 4, recorded("/observables/mean_overlap_d", 0.1),
           "mean_overlap_d"),
      told("observable_removed", "verify", 4, recorded("/observables", json::object()), "absent"),
      told("observable_added", "verify", 4, recorded("/observables/phi", 0.7), "phi"),
      told("state_hash", "verify", 4, recorded("/state_hash", std::string(64, 'a')), "state"),
      told("file_elsewhere", "verify", 4, recorded("/file", "objects/../../x.h5"),
           "objects/../../x"),
      told("grains", "verify", 4, member("/grains", 100), "grains"),
      told("parent", "verify", 4, member("/parent", ""), "parent"),
      told("kind", "verify", 4, member("/kind", "stiffen"), "stiffen"),
      told("parameters", "verify", 4, member("/resolved/parameters/pressure_Pa", 10.0),
           "are not those that it is named after"),
      told("seed", "verify", 4, member("/membership/seed", 7), "seed"),
      told("labels_swapped", "verify", 4,
           event("RunDeclared",
                 [=](json& b) {
                   if (b["kind"] == "shear") swapped(b);
                 }),
           "fluid"),
      told("variant", "verify", 4, member("/membership/variant", "fluid=none"), "fluid=none"),
      told("manifest_text", "verify", 4,
           event("ManifestRegistered", [](json& b) { b["text"] = "a: 1"; }), "SHA-256"),
  };
}

/// Files and events that agree.
std::vector<Case> forged_states() {
  const auto replay = "verify --replay 9";
  return {
      told("untouched", replay, 0, states([](Checkpoint&) {}), "the same state"),
      told("cycle", replay, 4, states([](Checkpoint& c) { c.cycle += 1; }), "DIVERGED", "cycle"),
      told("time", replay, 4, states([](Checkpoint& c) { c.time_s *= 2; }), "DIVERGED", "time_s"),
      told("tilt", replay, 4, states([](Checkpoint& c) { c.theta += 0.01; }), "DIVERGED", "theta"),
      told("observable", replay, 4,
           states([](Checkpoint& c) { c.observables["mean_overlap_d"] *= 1.1; }), "DIVERGED",
           "mean_overlap_d"),
      told("observable_made_up", replay, 4,
           states([](Checkpoint& c) { c.observables["phi"] = 0.7; }), "DIVERGED", "phi"),
      told("velocity", replay, 4, states([](Checkpoint& c) { c.state.velocity(0, 0) += 1e-3; }),
           "DIVERGED"),
      told("diameter", "verify", 4, states([](Checkpoint& c) { c.units.diameter_m *= 2; }),
           "diameter_m"),
      told("diameter_in_export", "export RUN --to extxyz --out x", 4,
           states([](Checkpoint& c) { c.units.diameter_m *= 2; }), "diameter_m"),
      told("grain_outside", "figures S2 --fresh", 4,
           states([](Checkpoint& c) { c.state.position(1, 0) += 1000; }), "checkpoint", "of run",
           "grain 0 lies outside the cell"),
      told("grain_outside_in_export", "export RUN --to vtk --out x", 4,
           states([](Checkpoint& c) { c.state.position(1, 0) += 1000; }), "of run",
           "grain 0 lies outside the cell"),
      told("mass", "verify", 4, states([](Checkpoint& c) { c.units.mass_kg *= 2; }), "mass_kg"),
      told("mass_in_export", "export RUN --to lammps --out x", 4,
           states([](Checkpoint& c) { c.units.mass_kg *= 2; }), "mass_kg"),
      told("one_grain_less", "verify", 4, states([](Checkpoint& c) {
             c.state.position.conservativeResize(3, 199);
             c.state.velocity.conservativeResize(3, 199);
           }),
           "199"),
      told("measures", "verify", 4, measures("scalars", [](json& m) { m["phi"] = 0.719; }),
           "derived.sqlite", "phi", "figures"),
      told("measures_not_finite", "verify", 4,
           measures("scalars", [](json& m) { m["phi"] = std::nan(""); }), "derived.sqlite"),
      told("measures_of_another_kind", "verify", 4,
           measures("scalars", [](json& m) { m = "none"; }), "derived.sqlite"),
      told("measures_untouched", "verify", 0, measures("scalars", [](json&) {}), "4 of 4"),
      told("measures_of_garbage", "verify", 0, at("derived.sqlite", written("garbage")),
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
      told("cadence_in_resume", "resume", 4, table("memberships SET checkpoint_every = 1 << 60"),
           range),
      told("cadence_in_verify", "verify", 4, member("/membership/checkpoint_every", huge), range),
      told("cadence_in_the_table", "plan m.yaml", 4,
           sql("UPDATE memberships SET checkpoint_every = 1152921504606846976"), range),
      told("no_cadence", "resume", 4, table("memberships SET checkpoint_every = 0"), range),
      told("target", "verify", 4, member("/target_cycles", huge), "0 to 1000000"),
      told("target_in_the_table", "status", 4, sql("UPDATE runs SET target_cycles = -1"),
           "0 to 1000000"),
      told("extra_cycles", "resume", 4, rebuilt([=](auto& s) {
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
      told("journal_is_pipe", "status", 4, journal_is_pipe, "store.sqlite-journal", "remove it"),
      told("journal_is_pipe_for_figures", "figures S2", 4, journal_is_pipe, "remove it"),
      told("journal_is_folder", "status", 4, at("store.sqlite-journal", folder_instead),
           "remove it"),
      told("journal_is_link", "run m.yaml", 4,
           at("store.sqlite-journal",
              [](const fs::path& file) {
                write_bytes(file, "");
                link_instead(file);
              }),
           "remove it"),
      told(
          "wal_is_pipe", "status", 4,
          [](const fs::path& s) {
            std::string bytes = read_bytes(s / "store.sqlite");
            bytes[18] = bytes[19] = 2;
            write_bytes(s / "store.sqlite", bytes);
            pipe_instead(s / "store.sqlite-wal");
          },
          "store.sqlite-wal", "remove it"),
      told("measures_journal_is_pipe", "figures S2", 0, at("derived.sqlite-journal", pipe_instead),
           "S2 ("),
      told("hard_link", "run m.yaml", 4, hard_link, "hard link", "cp -a"),
      told("hard_link_to_read", "status", 4, hard_link, "hard link", "cp -a"),
      told("hard_link_to_merge", "merge shearcell-store --store other", 4, hard_link, "hard link"),
      told("hard_linked_measures", "figures S2 --fresh", 0, at("derived.sqlite", linked_as_snap),
           "S2 ("),
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
    store.record_figure("S2", facts);
  };
  return {
      told("lease_without_end", "resume", 0, lease(58), "elsewhere, process 77", "60 s"),
      told("lease_without_end_to_merge", "merge shearcell-store --store other", 0, lease(0)),
      told("lease_that_is_over", "status", 0, lease(61), "3 stages"),
      told("clock_went_back", "show S2", 0, figure_in_the_future, "made      20"),
      told("clock_went_back_verified", "verify", 0, figure_in_the_future, "nothing was changed"),
  };
}

class ForgedStore : public HostileStore {};
TEST_P(ForgedStore, IsFound) {
  expect_told(GetParam());
}
INSTANTIATE_TEST_SUITE_P(Events, ForgedStore, testing::ValuesIn(forged_events()), case_name);
INSTANTIATE_TEST_SUITE_P(States, ForgedStore, testing::ValuesIn(forged_states()), case_name);
INSTANTIATE_TEST_SUITE_P(Limits, ForgedStore, testing::ValuesIn(forged_limits()), case_name);
INSTANTIATE_TEST_SUITE_P(Files, ForgedStore, testing::ValuesIn(odd_files()), case_name);
INSTANTIATE_TEST_SUITE_P(Faults, ForgedStore, testing::ValuesIn(other_faults()), case_name);

class Neighbours : public ProgramTest {};

// Else an export would leave the folder that it makes.
TEST_F(Neighbours, TheNameOfAnExperimentIsNoPath) {
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
TEST_F(Neighbours, AStoreThatIsMovedAwayIsLeftAlone) {
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

TEST_F(Neighbours, AFolderMayHaveAnyName) {
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

// The nearest known run is looked for among all of them.
TEST_F(Neighbours, PlansBesideTenThousandRuns) {
  campaign(tiny_manifest("  grains: 200\n"), {"--cycles", "1"});
  sql("WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 10000) INSERT INTO "
      "runs SELECT printf('%064x', i), 100 + i, parent, kind, json_set(resolved, '$.seed', 9000 + "
      "i), "
      "state, grains, target_cycles, attempts, cycle, step, state_hash, wall_seconds, "
      "particle_steps, "
      "error, updated_at FROM n, runs WHERE kind = 'shear' AND length(id) = 64 AND ordinal < 100")(
      path("shearcell-store"));
  write("many.yaml", tiny_manifest("  grains: 200\n", "seeds: 5000\n"));
  const Stopwatch watch;
  const nlohmann::json plan = json({"plan", "many.yaml", "--json"});
  const double seconds = watch.seconds();
  std::printf("plan of 10,000 stages beside 10,001 known ones: %.2f s\n", seconds);
  EXPECT_EQ(plan.at("stages").size(), 10'000U);
  EXPECT_EQ(plan.at("stages").back().at("new").at("fields").size(), 1U);
  EXPECT_LT(seconds, 30) << "it took minutes when each pair was compared as JSON";
}

}  // namespace
}  // namespace shearcell::test
