// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/merge_run.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <tuple>

#include "provenance/json_text.hpp"
#include "provenance/queries.hpp"

namespace shearcell {

namespace {

using sqlite::Database;
using sqlite::Statement;

bool begins_attempt(const Event& event) {
  return event.type == "RunStarted" || event.type == "RunResumed";
}

bool ends_attempt(const Event& event) {
  return event.type == "RunInterrupted" || event.type == "RunFailed" ||
         event.type == "RunCompleted";
}

bool about_checkpoint(const Event& event) {
  constexpr std::array<std::string_view, 3> kTypes = {"CheckpointRejected", "CheckpointPruned",
                                                      "CheckpointRegenerated"};
  return std::find(kTypes.begin(), kTypes.end(), event.type) != kTypes.end();
}

int rank(RunState state) {
  switch (state) {
    case RunState::completed:
      return 4;
    case RunState::failed:
      return 3;
    case RunState::interrupted:
      return 2;
    case RunState::running:
      return 1;
    case RunState::declared:
      return 0;
  }
  return 0;
}

/// Whether it says a place in an experiment, or a target, that the store does not know.
bool declares_news(const Database& into, const Event& event) {
  const nlohmann::json body = event.body();
  const nlohmann::json& m = body.at("membership");
  Statement same(into,
                 "SELECT target_cycles, checkpoint_every FROM memberships WHERE run = ? AND "
                 "experiment = ? AND scale = ? AND variant = ? AND seed = ? AND manifest = ?");
  same.bind(1, event.stream.substr(4));
  same.bind(2, m.at("experiment").get_ref<const std::string&>());
  same.bind(3, m.at("scale").get_ref<const std::string&>());
  same.bind(4, m.at("variant").get_ref<const std::string&>());
  same.bind(5, count_at(m, "seed"));
  same.bind(6, m.at("manifest").get_ref<const std::string&>());
  return !same.step() || same.u64(0) < count_at(body, "target_cycles");
}

/// Events of one run's stream in the order of the log.
std::vector<const Event*> stream_of(const std::vector<Event>& events, const std::string& run) {
  const std::string stream = "run/" + run;
  std::vector<const Event*> found;
  for (const Event& event : events) {
    if (event.stream == stream) found.push_back(&event);
  }
  return found;
}

/// Splits a run into attempts and marks those that are to be taken.
std::set<std::uint64_t> attempts_to_take(const std::vector<const Event*>& stream,
                                         const RunMerge& plan) {
  std::set<std::uint64_t> taken, attempt;
  bool news = false;
  const auto close = [&](bool last) {
    if (news || !plan.before || (last && plan.source_wins)) {
      taken.insert(attempt.begin(), attempt.end());
    }
    attempt.clear();
    news = false;
  };
  for (const Event* event : stream) {
    if (begins_attempt(*event)) {
      close(false);
      attempt.insert(event->seq);
    } else if (event->type == "CheckpointRecorded") {
      const std::string sha256 = event->body().at("sha256");
      if (plan.known.contains(sha256)) continue;
      attempt.insert(event->seq);
      news = true;
    } else if (ends_attempt(*event)) {
      attempt.insert(event->seq);
    }
  }
  close(true);
  return taken;
}

}  // namespace

bool is_news(const Database& into, const CheckpointRecord& record) {
  Statement same(into,
                 "SELECT state, sha256 FROM checkpoints WHERE run = ? AND (sha256 = ? OR (step = ? "
                 "AND state_hash = ? AND state <> 'rejected'))");
  same.bind(1, record.run).bind(2, record.sha256).bind(3, record.step).bind(4, record.state_hash);
  bool damaged_here = false;
  while (same.step()) {
    if (same.text(0) != "rejected") return false;
    damaged_here = true;
  }
  return !damaged_here || record.state == CheckpointState::recorded;
}

bool RunMerge::wants(const Database& into, const Event& event) const {
  if (event.type == "RunDeclared") return !before || declares_news(into, event);
  if (begins_attempt(event) || ends_attempt(event) || event.type == "CheckpointRecorded") {
    return attempts.contains(event.seq);
  }
  if (about_checkpoint(event)) {
    const nlohmann::json body = event.body();
    return !known.contains(body.at("sha256").get<std::string>());
  }
  return true;
}

std::optional<Event> RunMerge::closing_event(const Database& into) const {
  if (!before || source_wins || attempts.empty() || !last_claim) return std::nullopt;
  const RunState now = query_runs(into, before->id).front().state;
  const bool more_to_do =
      before->state == RunState::completed && now == RunState::declared;  // a longer target
  if (now == before->state || more_to_do) return std::nullopt;
  return last_claim;
}

RunMerge plan_run(const Database& into, const EventLog& log, const Database& source_tables,
                  const std::vector<Event>& source_events, const RunRecord& source_run) {
  RunMerge plan;
  const std::vector<RunRecord> here = query_runs(into, source_run.id);
  if (!here.empty()) {
    plan.before = here.front();
    for (Event& event : log.events("run/" + source_run.id)) {
      if (begins_attempt(event) || ends_attempt(event)) plan.last_claim = std::move(event);
    }
  }
  plan.source_wins = !plan.before || std::pair(source_run.step, rank(source_run.state)) >
                                         std::pair(plan.before->step, rank(plan.before->state));
  for (const CheckpointRecord& record : query_checkpoints(source_tables, source_run.id)) {
    if (!is_news(into, record)) plan.known.insert(record.sha256);
  }
  plan.attempts = attempts_to_take(stream_of(source_events, source_run.id), plan);
  return plan;
}

}  // namespace shearcell
