// SPDX-License-Identifier: GPL-3.0-or-later
// Stages that LAMMPS computes, through the program: recorded like ours, under other ids, and
// continued after an interruption.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>

#include "core/contact.hpp"
#include "core/simulation.hpp"
#include "experiments/figures/select_runs.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/identity.hpp"
#include "provenance/io/child_process.hpp"
#include "tests/experiments/program.hpp"
#include "tests/support/lammps_script.hpp"
#include "tests/support/text.hpp"
#include "tests/support/variable.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

class EngineRun : public ProgramTest {
 protected:
  bool lammps() const { return find_program("lmp").has_value(); }

  /// The run of that variant in `status --json`.
  nlohmann::json run_of(const std::string& variant) {
    const nlohmann::json status = json({"status", "--json"});
    for (const nlohmann::json& run : status["runs"]) {
      if (run["variant"] == variant) return run;
    }
    ADD_FAILURE() << "no variant " << variant;
    return {};
  }

  /// The shear of that experiment.
  Stage shear_of(const std::string& experiment) {
    const Store store(path("shearcell-store"), Access::read);
    for (const Stage& stage : store.stages()) {
      if (stage.kind == "shear" && first_place(stage).experiment == experiment) return stage;
    }
    throw std::runtime_error("no shear of " + experiment);
  }

  std::vector<double> cycles(const std::string& id) {
    std::vector<double> all;
    const nlohmann::json run = json({"show", id, "--json"});
    for (const nlohmann::json& c : run["checkpoints"]) {
      all.push_back(c["cycle"]);
    }
    return all;
  }

  /// A program that answers -h as LAMMPS does, and otherwise runs `body`.
  std::string fake(const std::string& body) {
    std::string file = path("fake").string();
    write_script(
        file,
        "#!/bin/sh\nif [ \"$1\" = -h ]; then echo >> '" + path("asked").string() +
            "'; echo 'Massively Parallel Simulator - 1 Jan 2000'; echo gran/hooke; exit 0; fi\n" +
            body + "\n");
    return file;
  }
};

TEST_F(EngineRun, IsRecordedBesideOursAndStartsFromTheSamePacking) {
  if (!lammps()) GTEST_SKIP() << "needs LAMMPS (Debian package lammps)";
  const std::string manifest =
      write("m.yaml", tiny_manifest("", "sweep: {grid: {engine: [shearcell, lammps]}}\n"));
  expect(0, {"plan", manifest}, {"rounding errors"});
  expect(0, {"run", manifest, "--mpi", "1"});
  const auto ours = run_of("engine=shearcell"), theirs = run_of("engine=lammps");
  EXPECT_NE(ours["id"], theirs["id"]);
  EXPECT_NE(ours["state_hash"], theirs["state_hash"]);
  EXPECT_EQ(cycles(theirs["id"]), (std::vector<double>{0, 1, 2}));
  const auto a = json({"show", ours["id"], "--json"}), b = json({"show", theirs["id"], "--json"});
  EXPECT_EQ(a["parent"], b["parent"]);
  EXPECT_EQ(a["checkpoints"][0]["state_hash"], b["checkpoints"][0]["state_hash"]);
  EXPECT_FALSE(a["resolved"]["parameters"].contains("engine"));
  const double height = a["checkpoints"][2]["observables"]["cell_height_d"];
  EXPECT_NEAR(height, b["checkpoints"][2]["observables"]["cell_height_d"], 0.1);
  EXPECT_EQ(b["engine"]["name"], "LAMMPS");
  EXPECT_EQ(b["engine"]["processes"], 1);
  EXPECT_TRUE(a["engine"].is_null());
  expect(0, {"show", theirs["id"]}, {"engine   LAMMPS "});

  expect(0, {"figures", "S2", "--out", "figures"});
  EXPECT_TRUE(has(read_bytes(path("figures/tiny/base/S2a.csv")), "engine=lammps"));

  // Only our checkpoints are replayed, pruned and regenerated.
  const auto replayed = json({"verify", "--replay", "99", "--json"});
  EXPECT_TRUE(replayed["ok"]);
  EXPECT_EQ(replayed["replay"]["left_out"], 3);
  const auto pruned = json({"prune", "--keep-every", "2", "--yes", "--json"});
  EXPECT_EQ(pruned["kept_of_other_engines"], 1);
  expect(0, {"regenerate", b["checkpoints"][1]["sha256"]}, {"the file is intact"});
  fs::remove(path("shearcell-store") / b["checkpoints"][1]["file"].get<std::string>());
  expect(1, {"regenerate", b["checkpoints"][1]["sha256"]}, {"LAMMPS computed this state"});
}

TEST_F(EngineRun, FailsWhereTheWatchdogRefusesAFrame) {
  if (!lammps()) GTEST_SKIP() << "needs LAMMPS (Debian package lammps)";
  expect(0, {"run", write("m.yaml", tiny_manifest()), "--cycles", "0", "-q"});  // the packing
  // Above the limit of speed that follows from it, 20 d/s, is no grain.
  const std::string strict = write("strict.yaml", tiny_manifest("  max_overlap_diameters: 1e-3\n"));
  expect(3, {"run", strict, "--engine", "lammps"},
         {"overlap [d] of two grains", "over its limit of 0.001"});
  EXPECT_EQ(run_of("engine=lammps")["state"], "failed");
}

// The planned runs name no engine; if only LAMMPS computes them, its runs are the planned ones.
TEST_F(EngineRun, GivesTheVerdictOfACampaignOfLammpsAlone) {
  if (!lammps()) GTEST_SKIP() << "needs LAMMPS (Debian package lammps)";
  write("m.yaml", tiny_manifest("",
                                "seeds: 3\nclaims: [{id: own.phi, compare: phi, at_cycle: 1, "
                                "of: {fluid: still}, margin: 0.1, "
                                "published: {value: 0.63, source: a guess}}]\n"));
  expect(0, {"run", "m.yaml", "--engine", "lammps", "-q", "--seeds", "2"});
  expect(0, {"figures", "own"}, {"undecided: own.phi"});
  expect(0, {"run", "m.yaml", "--engine", "lammps", "-q"});
  expect(0, {"figures", "own"}, {"agrees: own.phi"});
}

TEST_F(EngineRun, EndsByUntil) {
  if (!lammps()) GTEST_SKIP() << "needs LAMMPS (Debian package lammps)";
  write("m.yaml", tiny_manifest("  cycles: 4\n", "until: {phi: 0.1, extra_cycles: 1}\n"));
  expect(0, {"run", "m.yaml", "--engine", "lammps", "-q"});
  const auto done = run_of("engine=lammps");
  EXPECT_EQ(done["state"], "completed");
  EXPECT_EQ(cycles(done["id"]), (std::vector<double>{0, 1}));
  EXPECT_EQ(done["ended"]["by"], "until");
  expect(0, {"status"}, {"ended at cycle 1: phi >= 0.1 at cycle 0"});
}

TEST_F(EngineRun, ContinuesAfterASignal) {
  if (!lammps()) GTEST_SKIP() << "needs LAMMPS (Debian package lammps)";
  const std::string manifest = write("m.yaml", tiny_manifest("  cycles: 6\n"));
  expect(0, {"run", manifest, "--cycles", "0", "-q"});
  const std::size_t packing = objects();
  const Outcome stopped =
      run_until({"run", manifest, "--engine", "lammps", "-q"}, packing + 2, SIGINT);
  ASSERT_EQ(stopped.code, 85) << stopped.err;
  const std::string id = run_of("engine=lammps")["id"];
  const std::vector<double> before = cycles(id);
  ASSERT_FALSE(before.empty());
  EXPECT_LT(before.back(), 6);
  expect(0, {"resume", "-q"});
  const std::vector<double> after = cycles(id);
  ASSERT_GT(after.size(), before.size());
  EXPECT_TRUE(std::equal(before.begin(), before.end(), after.begin()));
  for (double cycle = 0; cycle <= 6; ++cycle) {
    EXPECT_TRUE(std::count(after.begin(), after.end(), cycle) == 1) << cycle;
  }
  expect(0, {"verify"});
}

TEST_F(EngineRun, ContinuesAfterAKill) {
  if (!lammps()) GTEST_SKIP() << "needs LAMMPS (Debian package lammps)";
  const std::string manifest = write("m.yaml", tiny_manifest("  cycles: 4\n"));
  expect(0, {"run", manifest, "--cycles", "0", "-q"});
  const std::size_t packing = objects();
  const TemporaryFolder temporary;
  const Variable tmpdir("TMPDIR", temporary.path());  // for what a killed program leaves behind
  run_until({"run", manifest, "--engine", "lammps", "-q"}, packing + 2, SIGKILL);
  expect(0, {"resume", "-q"});
  EXPECT_EQ(run_of("engine=lammps")["cycle"], 4);
  expect(0, {"verify"});
}

/// The end of the exported script's run in LAMMPS beside our continuation from the checkpoint.
void expect_the_same_future(const Store& store, const std::string& id, double cycle,
                            const fs::path& folder) {
  constexpr std::uint64_t steps = 200;
  const Stage stage = store.find_stage(id);
  const StageInputs inputs = read_stage(stage.resolved);
  const Parameters& p = inputs.parameters;
  const bool shears = inputs.stage == StageKind::shear;
  const std::vector<CheckpointRecord> records = store.checkpoints(id);
  const auto record = std::ranges::find(records, cycle, &CheckpointRecord::cycle);
  ASSERT_NE(record, records.end());
  const Checkpoint from = store.load_checkpoint(*record);
  const std::string name =
      shears ? fmt::format("frame_{}", cycle) : fmt::format("frame_step{}", from.state.step);
  SCOPED_TRACE(name);
  run_script(folder, "in." + name, {"-var", "steps", std::to_string(steps)});
  const Eigen::Matrix3Xd theirs =
      three(last_frame(folder / (name + "_end.dump")), "x", "y", "z") / p.diameter_m;
  Simulation ours(from.cell, shears ? shear_scene(p) : settle_scene(p), from.state);
  ours.advance(shears ? drive(p) : Drive{}, steps);
  const State state = ours.state();
  ASSERT_EQ(theirs.cols(), state.position.cols());
  Eigen::Matrix3Xd apart = theirs - state.position;
  const double depth = from.cell.depth;
  apart.row(2) =
      apart.row(2).unaryExpr([&](double z) { return nearest_image(z, depth, 1 / depth); });
  const double moved = (state.position - from.state.position).colwise().norm().maxCoeff();
  std::printf("%s: moved %.2g d, apart %.2g d\n", name.c_str(), moved,
              apart.colwise().norm().maxCoeff());
  EXPECT_LT(apart.colwise().norm().maxCoeff(), 1e-9);
  EXPECT_GT(moved, 1e3 * apart.colwise().norm().maxCoeff());
}

TEST_F(EngineRun, AnExportedScriptContinuesTheRun) {
  if (!lammps()) GTEST_SKIP() << "needs LAMMPS (Debian package lammps)";
  const std::string phases = "checkpoints: {phases: [0.25, 0.6, 0.9]}\n";
  write("plain.yaml", tiny_manifest("  cycles: 1\n  steps_per_cycle: 20000\n", phases));
  write("paused.yaml", renamed(tiny_manifest("  cycles: 1\n  steps_per_cycle: 20000\n  protocol: "
                                             "paused\n  pause_s: 0.5\n  fluid: cell\n"
                                             "  moving_wall: top\n",
                                             phases),
                               "paused"));
  expect(0, {"run", "plain.yaml", "paused.yaml", "-q"});
  for (const char* experiment : {"tiny", "paused"}) {
    std::string id;
    const nlohmann::json status = json({"status", "--experiment", experiment, "--json"});
    for (const nlohmann::json& run : status["runs"]) id = run["id"];
    const nlohmann::json shown = json({"show", id, "--json"});
    const std::string packing = shown["parent"], out = experiment;
    expect(0, {"export", id, "--to", "lammps", "--out", out});
    expect(0, {"export", packing, "--to", "lammps", "--out", out + "_packing"});
    const Store store(path("shearcell-store"), Access::read);
    for (const double cycle : {0.0, 0.25, 0.6, 0.9, 1.0}) {
      expect_the_same_future(store, id, cycle, path(out));
    }
    expect_the_same_future(store, packing, store.checkpoints(packing).back().cycle,
                           path(out + "_packing"));
  }
}

// The dump that the unmodified script ends with is the start of a run: the same grains between the
// same walls. What a start cannot be is refused for what it is.
TEST_F(EngineRun, TheEndOfAnExportedScriptStartsARun) {
  if (!lammps()) GTEST_SKIP() << "needs LAMMPS (Debian package lammps)";
  for (const std::string walls : {"rough", "smooth"}) {
    for (const std::string moving : {"bottom", "top"}) {
      const std::string name = walls + "_" + moving;
      SCOPED_TRACE(name);
      const std::string manifest = tiny_manifest("  cycles: 1\n  grains: 100\n  walls: " + walls +
                                                 "\n  moving_wall: " + moving + "\n");
      const std::string start = "start: {file: " + name + "/frame_0_end.dump}\n";
      write(name + ".yaml", renamed(manifest, name));
      write("again.yaml", renamed(manifest, "again_" + name) + start);
      expect(0, {"run", name + ".yaml", "--cycles", "0", "-q"});
      const std::string id = shear_of(name).id;
      expect(0, {"export", id, "--to", "lammps", "--out", name});
      run_script(path(name), "in.frame_0", {});
      expect(0, {"run", "again.yaml", "--cycles", "0", "-q"});
      const DumpFrame end = last_frame(path(name) / "frame_0_end.dump");
      const DumpFrame all = last_frame(path(name) / "frame_0.lammpstrj");
      const Store store(path("shearcell-store"), Access::read);
      const Checkpoint first =
          store.load_checkpoint(store.checkpoints(shear_of("again_" + name).id).front());
      const double d = first.units.diameter_m;
      Eigen::Matrix3Xd apart = first.state.position - three(end, "x", "y", "z") / d;
      apart.row(2) = apart.row(2).unaryExpr(
          [&](double z) { return nearest_image(z, first.cell.depth, 1 / first.cell.depth); });
      EXPECT_LT(apart.cwiseAbs().maxCoeff(), 1e-9);
      EXPECT_LT((first.state.velocity - three(end, "vx", "vy", "vz") / d).norm(), 1e-9);
      EXPECT_NEAR(first.state.wall_height, all.at("y").tail(1)[0] / d, 1e-9);

      run_script(path(name), "in.frame_0", {"-var", "steps", "300"});
      expect(2, {"run", "again.yaml", "--cycles", "0", "-q"}, {"the box is not orthogonal"});
    }
  }
  std::string script = read_bytes(path("smooth_top/in.frame_0"));
  script.replace(script.find("# set atom"), 2, "");
  write_bytes(path("smooth_top/in.frame_0"), script);
  run_script(path("smooth_top"), "in.frame_0", {});
  expect(2, {"run", "again.yaml", "--cycles", "0", "-q"}, {"diameter: is not the diameter of"});
}

TEST_F(EngineRun, ReportsThatLammpsIsMissing) {
  const Variable nowhere("SHEARCELL_LAMMPS", "/no/such/lmp");
  const std::string manifest = write("m.yaml", tiny_manifest());
  expect(1, {"run", manifest, "--engine", "lammps"}, {"Debian package lammps"});
  EXPECT_FALSE(fs::exists(path("shearcell-store"))) << "nothing was begun";
  EXPECT_TRUE(has(run({"plan", manifest, "--engine", "lammps"}).out, "Debian package lammps"));
  const std::string both =
      write("both.yaml", tiny_manifest("", "sweep: {grid: {engine: [shearcell, lammps]}}\n"));
  expect(1, {"run", both}, {"Debian package lammps"});
  expect(0, {"run", both, "--variant", "engine=shearcell", "--cycles", "0", "-q"});
}

TEST_F(EngineRun, IsNotResumedWithoutLammps) {
  const Variable nowhere("SHEARCELL_LAMMPS", "/no/such/lmp");
  {
    Store store(path("shearcell-store"), Access::create);
    declared(store, tiny_manifest("  engine: lammps\n"));
  }
  expect(1, {"resume", "-q", "--mpi", "2"}, {"Debian package lammps"});  // no run failed
  const Store store(path("shearcell-store"), Access::read);
  EXPECT_EQ(sheared(store).state, StageState::declared);
}

TEST_F(EngineRun, ReportsTheErrorOfLammps) {
  const std::string manifest = write("m.yaml", tiny_manifest());
  for (const auto& [body, says] : std::vector<std::pair<std::string, std::string>>{
           {"echo 'ERROR: Lost atoms'; exit 1", "ERROR: Lost atoms"},
           {"kill -9 $$", "code 137"},
           {"exit 0", "code 0"},
           {"echo garbage > frame.10000; sleep 1", "frame.10000"}}) {
    const Variable program("SHEARCELL_LAMMPS", fake(body));
    SCOPED_TRACE(body);
    expect(3, {"run", manifest, "--engine", "lammps", "-q"}, {says});
    EXPECT_EQ(fs::file_size(path("asked")), 2U) << "once before anything, once for the stage";
    fs::remove(path("asked"));
  }
  expect(0, {"verify"});
}

TEST_F(EngineRun, RejectsWhatLammpsCannotDo) {
  const std::string stiffen = write("s.yaml", tiny_manifest("  protocol: stiffen\n"));
  expect(2, {"plan", stiffen, "--engine", "lammps"},
         {"engine: LAMMPS cannot compute protocol stiffen"});
  const std::string both =
      write("b.yaml", tiny_manifest("  protocol: stiffen\n  engine: lammps\n"));
  expect(2, {"plan", both}, {"b.yaml:11:11: engine: LAMMPS"});
  const std::string swept =
      write("w.yaml", tiny_manifest("", "sweep: {grid: {engine: [shearcell, lammps]}}\n"));
  expect(2, {"plan", swept, "--engine", "lammps"});
}

}  // namespace
}  // namespace shearcell::test
