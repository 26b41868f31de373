// SPDX-License-Identifier: GPL-3.0-or-later
// The commands that prove, free, restore and unite, and several programs on one store.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>
#include <thread>

#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class Care : public ProgramTest {
 protected:
  const std::string manifest_ = tiny_manifest("", kBothFluids);

  std::string head() {
    const nlohmann::json told = json({"verify", "--json"}).at("head");
    return std::to_string(told.at("seq").get<std::uint64_t>()) + ":" +
           told.at("hash").get<std::string>();
  }
};

TEST_F(Care, PruneShowsFirstAndRegenerateBringsBack) {
  campaign(manifest_, {"--cycles", "4"});
  EXPECT_EQ(run({"prune"}).code, 2) << "nothing was said to go";
  EXPECT_EQ(run({"prune", "--state", "lost"}).code, 2);
  const std::size_t files = objects();
  const Outcome shown = run({"prune", "--keep-every", "2"});
  EXPECT_EQ(shown.code, 0);
  EXPECT_TRUE(contains(shown.out, "4 checkpoints")) << shown.out;
  EXPECT_TRUE(contains(shown.out, "Nothing was freed")) << shown.out;
  EXPECT_EQ(objects(), files);
  const nlohmann::json done = json({"prune", "--keep-every", "2", "--yes", "--json"});
  EXPECT_EQ(done.at("bytes_freed"), done.at("bytes"));
  EXPECT_EQ(objects(), files - 4);
  EXPECT_EQ(run({"verify"}).code, 0);

  const Outcome figures = run({"figures", "S2"});
  EXPECT_EQ(figures.code, 1) << "it is incomplete";
  const std::string sha = done.at("checkpoints").at(0).at("sha256");
  EXPECT_TRUE(contains(figures.err, "shearcell regenerate " + sha.substr(0, 12))) << figures.err;

  EXPECT_TRUE(contains(run({"show", sha}).out, "pruned; `shearcell regenerate")) << sha;
  EXPECT_EQ(json({"show", sha, "--json"}).at("state"), "pruned");
  for (const auto& checkpoint : done.at("checkpoints")) {
    const Outcome again = run({"regenerate", checkpoint.at("sha256").get<std::string>()});
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_TRUE(contains(again.out, "the same file again")) << again.out;
  }
  EXPECT_EQ(objects(), files);
  EXPECT_EQ(run({"figures", "S2"}).code, 0);
  EXPECT_EQ(run({"verify"}).code, 0);
  EXPECT_TRUE(contains(run({"regenerate", sha}).out, "the file is intact"));
  EXPECT_EQ(run({"regenerate", "no-such"}).code, 2);
}

TEST_F(Care, VerifyReplaysAndHoldsAgainstAHead) {
  campaign(manifest_);
  const std::string before = head();
  const nlohmann::json told = json({"verify", "--replay", "3", "--seed", "5", "--json"});
  ASSERT_EQ(told.at("replay").at("replayed").size(), 3U);
  for (const auto& replay : told.at("replay").at("replayed")) EXPECT_EQ(replay.at("same"), true);
  EXPECT_EQ(run({"verify", "--against", before}).code, 0);
  const auto colon = before.find(':');
  EXPECT_EQ(run({"verify", "--against", before.substr(0, colon), before.substr(colon + 1)}).code,
            0);
  EXPECT_EQ(run({"verify", "--against", "3:" + before.substr(colon + 1)}).code, 4);
  EXPECT_EQ(run({"verify", "--against", "9999" + before.substr(colon)}).code, 4);
  EXPECT_EQ(run({"verify", "--against", "yesterday"}).code, 2);
  const Outcome rebuilt = run({"rebuild"});
  EXPECT_EQ(rebuilt.code, 0);
  EXPECT_TRUE(contains(rebuilt.out, "3 runs")) << rebuilt.out;
  EXPECT_EQ(run({"verify", "--against", before}).code, 0);
}

TEST_F(Care, RebuildMendsATableThatWasChanged) {
  campaign(manifest_, {"--cycles", "0"});
  sqlite::Database(path("shearcell-store/store.sqlite"), sqlite::Open::existing)
      .execute("UPDATE runs SET state = 'failed'");
  const Outcome damaged = run({"verify"});
  EXPECT_EQ(damaged.code, 4);
  EXPECT_TRUE(contains(damaged.out, "run `rebuild`")) << damaged.out;
  EXPECT_EQ(run({"rebuild"}).code, 0);
  EXPECT_EQ(run({"verify"}).code, 0);
}

TEST_F(Care, MergesAndRefusesConflicts) {
  campaign(tiny_manifest(), {"--cycles", "1"}, "a");
  campaign(manifest_, {}, "b");
  const auto whole = hashes("b");
  const Outcome merged = run({"merge", "a", "b", "--store", "all"});
  EXPECT_EQ(merged.code, 0) << merged.err;
  EXPECT_EQ(hashes("all"), whole);
  EXPECT_EQ(run({"verify", "--store", "all"}).code, 0);
  EXPECT_EQ(run({"verify", "--replay", "2", "--store", "all"}).code, 0);
  EXPECT_EQ(run({"merge", "all", "--store", "all"}).code, 2);
  EXPECT_EQ(run({"merge", "nowhere", "--store", "all"}).code, 2);
  {
    // Somebody's own arithmetic: another state for a step that is known.
    Store store(path("odd"), Access::create);
    const Store other(path("b"), Access::read);
    store.merge({path("a")});
    const RunRecord sheared = runs_of_kind(store, "shear").at(0);
    Checkpoint wrong = other.load_checkpoint(other.checkpoints(sheared.id).at(2));
    wrong.state.position(0, 0) += 1e-9;
    RunDeclaration longer{
        sheared.id, sheared.parent,           sheared.kind, sheared.resolved, sheared.grains,
        2,          sheared.memberships.at(0)};
    store.declare_run(longer);
    store.start_run(sheared.id, {}, store.checkpoints(sheared.id).back().sha256);
    store.record_checkpoint(sheared.id, wrong);
    store.interrupt_run(sheared.id, "a test");
  }
  const Outcome refused = run({"merge", "odd", "--store", "all"});
  EXPECT_EQ(refused.code, 4);
  EXPECT_TRUE(contains(refused.err, "Nothing was merged")) << refused.err;
  EXPECT_EQ(hashes("all"), whole);
}

TEST_F(Care, PlanTellsWhatIsDoneSharedAndNew) {
  campaign(manifest_, {"--cycles", "1"});
  const auto stage = [](const nlohmann::json& plan, const std::string& kind,
                        std::uint64_t seed) -> nlohmann::json {
    for (const auto& line : plan.at("stages")) {
      if (line.at("stage") == kind && line.at("seed") == seed) return line;
    }
    ADD_FAILURE() << "no such stage: " << plan.dump(1);
    return {};
  };
  // The same again: done. Longer: to extend. More seeds: new, and only because of the seed.
  const auto again = json({"plan", "m.yaml", "--cycles", "1", "--json"});
  for (const auto& line : again.at("stages")) {
    EXPECT_EQ(line.at("state"), "done");
    EXPECT_TRUE(line.at("new").is_null());
    EXPECT_TRUE(line.at("shared_with").empty());
  }
  const auto more = json({"plan", "m.yaml", "--cycles", "3", "--seeds", "2", "--json"});
  EXPECT_EQ(stage(more, "prepare", 1).at("state"), "done");
  EXPECT_EQ(stage(more, "shear", 1).at("state"), "to extend");
  EXPECT_EQ(stage(more, "shear", 1).at("particle_steps_left"), 300.0 * 2 * 10000);
  EXPECT_EQ(stage(more, "shear", 2).at("state"), "to do");
  EXPECT_EQ(stage(more, "shear", 2).at("most_particle_steps"), 300.0 * 3 * 10000);
  EXPECT_GT(stage(more, "prepare", 2).at("most_particle_steps"),
            stage(more, "prepare", 2).at("particle_steps_left"));
  EXPECT_GE(stage(more, "shear", 2).at("memory_bytes"), 300.0 * 100);
  EXPECT_EQ(stage(more, "shear", 2).at("new").at("fields"),
            nlohmann::json::parse(R"([{"field": "seed", "value": 2, "store_has": 1}])"));

  // A run that ended early is done for every manifest with that `until`, whatever else it says.
  const std::string early = tiny_manifest("", "until: {phi: 0.1}\n");
  write("early.yaml", early);
  ASSERT_EQ(run({"run", "early.yaml", "--cycles", "5", "-q"}).code, 0);
  write("early.yaml", early + "# edited\n");
  EXPECT_EQ(stage(json({"plan", "early.yaml", "--cycles", "5", "--json"}), "shear", 1).at("state"),
            "done");
  EXPECT_EQ(stage(json({"plan", "early.yaml", "--cycles", "6", "--json"}), "shear", 1).at("state"),
            "to extend");

  // Another experiment: one run is shared, one is new by its amplitude.
  std::string twin = tiny_manifest("", "sweep: {grid: {amplitude_rad: [0.0833, 0.1]}}\n");
  twin.replace(twin.find("tiny"), 4, "twin");
  write("twin.yaml", twin);
  const auto other = json({"plan", "twin.yaml", "--cycles", "1", "--json"});
  EXPECT_EQ(stage(other, "shear", 1).at("state"), "done");
  EXPECT_EQ(stage(other, "shear", 1).at("shared_with"), nlohmann::json::parse(R"(["tiny"])"));
  const auto fields = other.at("stages").at(2).at("new").at("fields");
  EXPECT_EQ(fields, nlohmann::json::parse(
                        R"([{"field": "amplitude_rad", "value": 0.1, "store_has": 0.0833}])"));
  const Outcome words = run({"plan", "twin.yaml", "--cycles", "1"});
  EXPECT_TRUE(contains(words.out, "also in tiny")) << words.out;
  EXPECT_TRUE(contains(words.out, "new: amplitude_rad 0.1 (store has 0.0833)")) << words.out;
}

class Sharing : public Care {
 protected:
  static std::string many_runs() {
    return tiny_manifest("  cycles: 6\n", kBothFluids + "seeds: 3\n");
  }

  void expect_each_run_once(const std::map<std::string, std::string>& expected) {
    EXPECT_EQ(hashes(), expected);
    const Store store(path("shearcell-store"), Access::read);
    for (const RunRecord& run : store.runs()) {
      EXPECT_EQ(run.attempts, 1U) << run.id << " was done twice";
      EXPECT_EQ(run.particle_steps, static_cast<double>(kGrains * run.step));
    }
    EXPECT_TRUE(store.leases().empty());
    EXPECT_EQ(run({"verify"}).code, 0);
  }
};

TEST_F(Sharing, TwoProgramsDoEachRunOnce) {
  const std::string text = write("many.yaml", many_runs());
  ASSERT_EQ(run({"run", text, "-q", "--store", "whole"}).code, 0);
  const Running first = start_beside({"run", text, "-j", "1", "--json"}, "first");
  const Running second = start_beside({"run", text, "-j", "1", "--json"}, "second");
  // Meanwhile `status` shows which program holds the run.
  bool seen_two = false, seen = false;
  for (int look = 0; look < 400 && !seen_two; ++look) {
    const Outcome status = run({"status", "--json"});
    const auto facts = nlohmann::json::parse(status.out, nullptr, false);
    std::set<std::uint64_t> pids;
    if (facts.is_object()) {
      for (const auto& run : facts.at("runs")) {
        if (run.at("holder").is_object()) {
          pids.insert(run.at("holder").at("pid").get<std::uint64_t>());
        }
      }
    }
    seen = seen || !pids.empty();
    seen_two = pids.size() == 2;
  }
  EXPECT_TRUE(seen_two);
  EXPECT_TRUE(seen);
  const Outcome one = wait_for(first), two = wait_for(second);
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_EQ(two.code, 0) << two.err;
  const auto a = nlohmann::json::parse(one.out), b = nlohmann::json::parse(two.out);
  std::printf("computed by the first %d, by the second %d of 9 stages\n",
              a.at("completed").get<int>(), b.at("completed").get<int>());
  EXPECT_EQ(a.at("completed").get<int>() + b.at("completed").get<int>(), 9);
  EXPECT_GE(a.at("completed").get<int>(), 1);
  EXPECT_GE(b.at("completed").get<int>(), 1);
  for (const auto& each : {a, b}) {
    EXPECT_EQ(each.at("completed").get<int>() + each.at("already_done").get<int>() +
                  each.at("done_elsewhere").get<int>(),
              9);
  }
  expect_each_run_once(hashes("whole"));
}

TEST_F(Sharing, TheOtherTakesOverWhatAKilledOneHeld) {
  const std::string text = write("one.yaml", tiny_manifest("  cycles: 20\n"));
  ASSERT_EQ(run({"run", text, "-q", "--store", "whole"}).code, 0);
  const Running first = start_beside({"run", text, "-q"}, "first");
  while (objects() < 5) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const Running second = start_beside({"run", text}, "second");
  while (!contains(read_bytes(second.err), "waiting")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    if (contains(read_bytes(second.err), "done")) break;
  }
  kill(first.pid, SIGKILL);
  EXPECT_EQ(wait_for(first).signal, SIGKILL);
  const Outcome rest = wait_for(second);
  EXPECT_EQ(rest.code, 0) << rest.err;
  EXPECT_TRUE(contains(rest.err, "waiting for 1 stage")) << rest.err;
  EXPECT_EQ(hashes(), hashes("whole"));
  EXPECT_EQ(run({"verify"}).code, 0);
}

TEST_F(Care, HardCasesAreToldAndOneThatFailsEndsWithCode3) {
  const nlohmann::json cases =
      json({"bench", "stability", "--quick", "--only", "touching", "equal", "--json"}).at("cases");
  ASSERT_EQ(cases.size(), 4U);
  for (const nlohmann::json& hard : cases) {
    EXPECT_TRUE(hard.at("as_expected").get<bool>()) << hard;
    EXPECT_FALSE(hard.at("name").get<std::string>().empty());
    EXPECT_FALSE(hard.at("expected").get<std::string>().empty());
    EXPECT_FALSE(hard.at("outcome").get<std::string>().empty());
  }
  const Outcome hangs =
      run({"bench", "stability", "--only", "1e7-steps-undamped", "--seconds", "0.1"});
  EXPECT_EQ(hangs.code, 3);
  EXPECT_TRUE(contains(hangs.out, "0 of 1 cases ended as expected")) << hangs.out;
  const Outcome unknown = run({"bench", "stability", "--only", "vacanzy"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_TRUE(contains(unknown.err, "did you mean 'vacancy'?")) << unknown.err;
}

}  // namespace
}  // namespace shearcell::test
