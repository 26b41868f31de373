// SPDX-License-Identifier: GPL-3.0-or-later
// What `plan`, `status` and `submit` say is left is what `run` and `resume` then record, for asks
// at random on shared stages, and after kills. The events of the log are the oracle.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <cstdio>
#include <random>

#include "provenance/events.hpp"
#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

constexpr int kRounds = 24;

/// What was recorded or is left of a stage.
struct Amount {
  double checkpoints = 0;
  double particle_steps = 0;
};
using Amounts = std::map<std::string, Amount>;  // by stage

class LeftTest : public ProgramTest {
 protected:
  std::size_t draw(std::size_t most) { return random_() % (most + 1); }

  /// One of three experiments on the same few stages, each time with other asks.
  std::string manifest() {
    std::string text = fmt::format("experiment: {}\nbase:\n", std::string("abc").at(draw(2)));
    text += fmt::format(
        "  grains: 200\n  period_s: 0.25\n  steps_per_cycle: 2500\n  settle_time_step_s: 1.0e-4\n"
        "  cycles: {}\nsweep: {{grid: {{fluid: [{}]}}}}\nseeds: {}\n",
        draw(6), draw(2) == 0 ? "still, cell" : "still", 1 + draw(1));
    const char* phases[] = {"", ", phases: [0.5]", ", phases: [0.25, 0.7]"};
    text += fmt::format("checkpoints: {{every_cycles: {}{}}}\n", 1 + draw(3), phases[draw(2)]);
    if (draw(3) == 0) {
      text +=
          fmt::format("until: {{phi: {}, extra_cycles: {}}}\n", draw(1) == 0 ? 0.3 : 0.99, draw(2));
    }
    return text;
  }

  std::uint64_t head() const {
    const std::filesystem::path folder = path("shearcell-store");
    return std::filesystem::exists(folder) ? Store(folder, Access::read).head().seq : 0;
  }

  /// Of all events after this one.
  Amounts recorded_since(std::uint64_t seq) const {
    Amounts found;
    for (const Event& event : Store(path("shearcell-store"), Access::read).events()) {
      if (event.seq <= seq || event.type != "CheckpointRecorded") continue;
      Amount& of_stage = found[run_of(event).value()];
      ++of_stage.checkpoints;
      of_stage.particle_steps += event.body().at("particle_steps").get<double>();
    }
    return found;
  }

  nlohmann::json plan() { return json({"plan", "m.yaml", "--json"}); }

  /// How long a packing takes to settle is estimated, and `until` is an upper bound.
  static void expect_recorded(const nlohmann::json& planned, const Amounts& recorded,
                              bool at_most) {
    std::size_t known = 0;
    for (const nlohmann::json& stage : planned.at("stages")) {
      const std::string id = stage.at("id");
      SCOPED_TRACE(stage.dump());
      const auto found = recorded.find(id);
      const Amount made = found == recorded.end() ? Amount() : found->second;
      known += found == recorded.end() ? 0 : 1;
      const double left = stage.at("checkpoints_left"), steps = stage.at("particle_steps_left");
      if (stage.at("state") == "done") {
        EXPECT_EQ(left + steps + made.checkpoints, 0) << "done is done";
      } else if (stage.at("stage") == "prepare") {
        EXPECT_GT(made.checkpoints, 0);
      } else if (at_most) {
        EXPECT_LE(made.checkpoints, left);
        EXPECT_LE(made.particle_steps, steps);
      } else {
        EXPECT_EQ(made.checkpoints, left);
        EXPECT_EQ(made.particle_steps, steps);
      }
    }
    EXPECT_EQ(known, recorded.size()) << "a stage that was not planned";
  }

  std::mt19937 random_{20};
};

TEST_F(LeftTest, IsWhatIsThenRecorded) {
  std::map<std::string, int> seen;  // states of stages
  std::size_t kills = 0;
  for (int round = 0; round < kRounds; ++round) {
    const std::string text = manifest();
    write("m.yaml", text);
    SCOPED_TRACE(fmt::format("round {}\n{}", round, text));
    // An `until` of an experiment may end a stage of another one only where that has one too.
    const bool at_most = has(text, "until");
    if (draw(1) == 0) {
      const std::size_t files = head() == 0 ? 0 : objects();
      const int signal = draw(1) == 0 ? SIGKILL : SIGTERM;
      const Outcome outcome = run_until({"run", "m.yaml", "-q"}, files + 1 + draw(3), signal);
      kills += outcome.signal == SIGKILL || outcome.code == 85 ? 1 : 0;
    }
    const nlohmann::json planned = plan();
    for (const nlohmann::json& stage : planned.at("stages")) {
      ++seen[stage.at("state").get<std::string>()];
    }
    const std::uint64_t seq = head();
    const nlohmann::json submitted = json({"submit", "m.yaml", "--dry-run", "--json"});
    double queued = 0;
    for (const nlohmann::json& task : submitted.at("tasks")) {
      queued += task.at("particle_steps").get<double>();
    }
    EXPECT_NEAR(queued, planned.at("particle_steps_left"), 1);
    expect(0, {"run", "m.yaml", "-q"});
    expect_recorded(planned, recorded_since(seq), at_most);
    const nlohmann::json after = plan();
    for (const nlohmann::json& stage : after.at("stages")) EXPECT_EQ(stage.at("state"), "done");
    EXPECT_EQ(json({"status", "--json"}).at("estimate"), nullptr) << run({"status"}).out;
    if (HasFailure()) return;
  }
  for (const auto& [state, count] : seen) std::printf("%s: %d\n", state.c_str(), count);
  std::printf("%zu kills\n", kills);
  for (const char* state : {"done", "to do", "to extend", "to replay"}) EXPECT_GT(seen[state], 0);
  EXPECT_GT(kills, 0U);  // how many depends on the speed of the machine
  expect(0, {"verify", "--replay", "3"});
}

// `resume` continues what `run` left, and `status` says what that is.
TEST_F(LeftTest, OfAStoreIsWhatResumeRecords) {
  for (int round = 0; round < 6; ++round) {
    const std::string text = manifest();
    if (has(text, "until")) continue;
    write("m.yaml", text);
    SCOPED_TRACE(fmt::format("round {}\n{}", round, text));
    const std::size_t files = head() == 0 ? 0 : objects();
    run_until({"run", "m.yaml", "-q"}, files + 1 + draw(3), SIGKILL);
    const nlohmann::json status = json({"status", "--json"});
    std::set<std::string> packings;  // that are not settled: their work is estimated
    for (const nlohmann::json& run : status.at("runs")) {
      if (run.at("kind") == "prepare" && run.at("state") != "completed") {
        packings.insert(run.at("id"));
      }
    }
    const std::uint64_t seq = head();
    expect(0, {"resume", "-q"});
    double recorded = 0;
    for (const auto& [id, amount] : recorded_since(seq)) recorded += amount.particle_steps;
    const nlohmann::json& left = status.at("estimate");
    if (packings.empty()) {
      EXPECT_EQ(left.is_null() ? 0 : left.at("particle_steps_left").get<double>(), recorded);
    }
    EXPECT_EQ(json({"status", "--json"}).at("estimate"), nullptr);
    const std::uint64_t ended = head();
    expect(0, {"resume", "-q"}, {"nothing is left to compute"});
    EXPECT_EQ(head(), ended);
  }
}

}  // namespace
}  // namespace shearcell::test
