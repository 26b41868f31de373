// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/merge_run.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "provenance/events.hpp"
#include "provenance/queries.hpp"

namespace shearcell {

namespace {

using events::CheckpointRecorded;
using sqlite::Database;
using sqlite::Statement;

/// The checkpoint that the event rejects, prunes or regenerates; nothing for other events.
std::optional<std::string> subject_of(const Event& event) {
  const events::Any decoded = events::decode(event);
  if (const auto* e = std::get_if<events::CheckpointRejected>(&decoded)) return e->sha256;
  if (const auto* e = std::get_if<events::CheckpointPruned>(&decoded)) return e->sha256;
  if (const auto* e = std::get_if<events::CheckpointRegenerated>(&decoded)) return e->sha256;
  return std::nullopt;
}

/// Whether the event adds a place in an experiment, or raises its target.
bool declares_news(const Database& into, const Event& event) {
  const auto declared = std::get<events::RunDeclared>(events::decode(event));
  const Membership& m = declared.membership;
  Statement same(into,
                 "SELECT target_cycles FROM memberships WHERE run = ? AND experiment = ? AND "
                 "scale = ? AND variant = ? AND seed = ? AND manifest = ?",
                 event.stream.substr(4), m.experiment, m.scale, m.variant, m.seed, m.manifest);
  return !same.step() || same.u64(0) < declared.target_cycles;
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

/// The events (by seq) of the attempts to copy.
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
    if (events::begins_attempt(*event)) {
      close(false);
      attempt.insert(event->seq);
    } else if (event->type == CheckpointRecorded::kType) {
      const auto recorded = std::get<CheckpointRecorded>(events::decode(*event));
      if (plan.known.contains(recorded.sha256)) continue;
      attempt.insert(event->seq);
      news = true;
    } else if (events::ends_attempt(*event)) {
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
                 "AND state_hash = ? AND state <> 'rejected'))",
                 record.run, record.sha256, record.step, record.state_hash);
  bool damaged_here = false;
  while (same.step()) {
    if (same.text(0) != "rejected") return false;
    damaged_here = true;
  }
  return !damaged_here || record.state == CheckpointState::recorded;
}

bool RunMerge::wants(const Database& into, const Event& event) const {
  if (event.type == events::RunDeclared::kType) return !before || declares_news(into, event);
  if (events::begins_attempt(event) || events::ends_attempt(event) ||
      event.type == CheckpointRecorded::kType) {
    return attempts.contains(event.seq);
  }
  const auto subject = subject_of(event);
  return !subject || !known.contains(*subject);
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
      if (events::begins_attempt(event) || events::ends_attempt(event))
        plan.last_claim = std::move(event);
    }
  }
  plan.source_wins = !plan.before || std::pair(source_run.step, source_run.state) >
                                         std::pair(plan.before->step, plan.before->state);
  for (const CheckpointRecord& record : query_checkpoints(source_tables, source_run.id)) {
    if (!is_news(into, record)) plan.known.insert(record.sha256);
  }
  plan.attempts = attempts_to_take(stream_of(source_events, source_run.id), plan);
  return plan;
}

}  // namespace shearcell
