// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of a store always follow from its events: derived step by step, rebuilt, derived from
// events of older layouts, and computed by a fold that shares no code with them.
#include <algorithm>
#include <optional>

#include "provenance/projections.hpp"
#include "tests/property.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell {
namespace {

using test::run_id;

// Something that is done to a store; where it does not fit it is refused.
struct Act {
  int what;
  int run;
  std::uint64_t amount;
};

constexpr const char* kActs[] = {"declare",  "start",    "record", "interrupt", "fail",
                                 "complete", "reject",   "prune",  "restore",   "figure",
                                 "replay",   "manifest", "reopen"};

std::ostream& operator<<(std::ostream& out, const Act& act) {
  return out << kActs[act.what] << " run " << act.run << ", " << act.amount;
}

Checkpoint sample(const std::string& id, std::uint64_t step) {
  return test::sample_checkpoint(id, step, 4);
}

void declare(Store& store, const Act& act) {
  Stage d = test::sample_run(act.run, act.amount);
  d.grains = 4;  // as sample() has
  if (act.run > 0) d.parent = run_id(0);
  if (act.amount % 3 == 0) d.memberships[0].place.experiment = "another";
  d.memberships[0].ask.checkpoint_every = 1 + act.amount % 2;
  store.declare_stage(d);
}

void perform(Store& store, const Act& act) {
  const std::string what = kActs[act.what], id = run_id(act.run);
  const auto known = store.checkpoints(id);
  const auto some = act.amount % 2 == 0 ? std::nullopt : std::optional(act.amount);
  const auto last = known.empty() ? std::nullopt : std::optional(known.back().sha256);
  if (what == "declare") declare(store, act);
  if (what == "start") store.start_stage(id, {}, last);
  if (what == "record") store.record_checkpoint(id, sample(id, act.amount), {0.5, 100});
  if (what == "interrupt") store.interrupt_stage(id, "SIGTERM");
  if (what == "fail") store.fail_stage(id, "an overlap");
  if (what == "complete") store.complete_stage(id, {}, some);
  if (what == "figure")
    store.record("figure/S" + std::to_string(act.run),
                 {"FigureGenerated", {{"inputs", {act.amount}}}});
  if (what == "replay") store.record(run_stream(id), {"ReplayVerified", {{"step", act.amount}}});
  if (what == "manifest") store.register_manifest("a: " + std::to_string(act.amount), "a.yaml", {});
  if (what == "prune") {
    store.prune(store.prunable({.runs = {id}, .keep_every = act.amount}));
  }
  for (const CheckpointRecord& record : store.checkpoints(id, Listed::all)) {
    if (record.step != act.amount) continue;
    if (what == "reject") store.reject_checkpoint(id, record.sha256, "why");
    if (what == "restore" && record.state == CheckpointState::pruned) {
      store.restore_checkpoint(record, sample(id, record.step));
    }
  }
}

struct RunModel {
  std::string state = "declared";
  std::uint64_t target = 0, attempts = 0;
  double particle_steps = 0;
  std::map<std::string, std::pair<std::uint64_t, std::string>> checkpoints;  // step and state

  std::map<std::uint64_t, double> cycle_of;  // of a step

  std::uint64_t step() const {
    std::uint64_t furthest = 0;
    for (const auto& [sha256, known] : checkpoints) {
      if (known.second == "recorded") furthest = std::max(furthest, known.first);
    }
    return furthest;
  }

  void apply(const Event& event) {
    const nlohmann::json body = event.body();
    const std::string sha256 = body.value("sha256", "");
    if (event.type == "RunDeclared") {
      const auto asked = body.at("target_cycles").get<std::uint64_t>();
      // A run may have ended before its target.
      const bool longer = step() > 0 && static_cast<double>(asked) > cycle_of[step()];
      if (state == "completed" && (asked > target || longer)) state = "declared";
      target = std::max(target, asked);
    } else if (event.type == "RunStarted" || event.type == "RunResumed") {
      state = "running";
      ++attempts;
    } else if (event.type == "RunInterrupted" || event.type == "RunFailed") {
      state = event.type == "RunFailed" ? "failed" : "interrupted";
    } else if (event.type == "RunCompleted") {
      const nlohmann::json& reached = body.at("target_cycles");
      const bool all = reached.is_null() || reached.get<std::uint64_t>() >= target;
      state = all ? "completed" : "declared";
    } else if (event.type == "CheckpointRecorded") {
      checkpoints[sha256] = {body.at("step").get<std::uint64_t>(), "recorded"};
      cycle_of[body.at("step")] = body.at("cycle");
      particle_steps += body.at("particle_steps").get<double>();
    } else if (event.type == "CheckpointRejected") {
      if (state == "completed" && checkpoints[sha256].first == step()) state = "declared";
      checkpoints[sha256].second = "rejected";
    } else if (event.type == "CheckpointPruned") {
      checkpoints[sha256].second = "pruned";
    } else if (event.type == "CheckpointRegenerated") {
      checkpoints[sha256].second = "recorded";
    }
  }
};

void expect_model(const Store& store) {
  std::map<std::string, RunModel> runs;
  for (const Event& event : store.events()) {
    if (event.stream.starts_with("run/")) runs[event.stream.substr(4)].apply(event);
  }
  RC_ASSERT(store.stages().size() == runs.size());
  for (const Stage& run : store.stages()) {
    const RunModel& model = runs.at(run.id);
    RC_ASSERT(name_of(run.state) == model.state);
    RC_ASSERT(run.target_cycles == model.target);
    RC_ASSERT(run.attempts == model.attempts);
    RC_ASSERT(run.step == model.step());
    RC_ASSERT(run.particle_steps == model.particle_steps);
    const auto checkpoints = store.checkpoints(run.id, Listed::all);
    RC_ASSERT(checkpoints.size() == model.checkpoints.size());
    for (const CheckpointRecord& record : checkpoints) {
      RC_ASSERT(name_of(record.state) == model.checkpoints.at(record.sha256).second);
    }
  }
}

// The event as the first program would have written it, where that loses nothing.
Event in_first_layout(Event event) {
  if (event.schema == 1) return event;
  nlohmann::json body = nlohmann::json::parse(event.payload);
  if (event.type == "RunCompleted" && !body.at("target_cycles").is_null()) return event;
  for (const char* younger : {"process", "parent_checkpoint", "target_cycles"}) body.erase(younger);
  event.payload = body.dump();
  event.schema = 1;
  return event;
}

auto rows_of_old_events(const std::filesystem::path& file, const std::vector<Event>& events) {
  sqlite::Database database = open_database(file, Access::create);
  EventLog log(database);
  sqlite::WriteTransaction lock(database);
  for (const Event& event : events) {
    apply(database, log.append_copy(lock, in_first_layout(event)));
  }
  lock.commit();
  return projection_rows(database);
}

PROPERTY(History, GivesTheTablesOfItsEvents, 100) {
  // Starts, records and ends are drawn more often than the rest.
  const auto what = rc::gen::elementOf(std::vector<int>{
      0, 0, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, 3, 4, 5, 5, 5, 6, 6, 7, 7, 8, 8, 9, 10, 11, 12, 12});
  const auto any_act =
      rc::gen::construct<Act>(what, rc::gen::weightedElement<int>({{3, 0}, {1, 1}}),
                              rc::gen::resize(100, rc::gen::inRange<std::uint64_t>(0, 6)));
  const auto acts = *rc::gen::container<std::vector<Act>>(any_act);
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "store";
  std::optional<Store> store(std::in_place, path, Access::create);
  declare(*store, {0, 0, 1});
  for (const Act& act : acts) {
    const Head before = store->head();
    try {
      perform(*store, act);
    } catch (const ConcurrencyConflict&) {
      RC_ASSERT(store->head().hash == before.hash);
    } catch (const NotFound&) {
      RC_ASSERT(store->head().hash == before.hash);
    } catch (const std::invalid_argument&) {
      RC_ASSERT(store->head().hash == before.hash);
    }
    if (std::string(kActs[act.what]) == "reopen") store.emplace(path, Access::write);
  }
  expect_model(*store);
  const auto rows = [&] {
    return projection_rows(sqlite::Database(path / "store.sqlite", Access::write));
  };
  const auto step_by_step = rows();
  RC_ASSERT(rows_of_old_events(folder.path() / "old.sqlite", store->events()) == step_by_step);
  store->rebuild();
  RC_ASSERT(rows() == step_by_step);
  RC_ASSERT(store->verify().ok());
}

}  // namespace
}  // namespace shearcell
