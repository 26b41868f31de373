// SPDX-License-Identifier: GPL-3.0-or-later
// Verifies a store: hash chain, checkpoint files, derived tables.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <system_error>

#include "provenance/errors.hpp"
#include "provenance/projections.hpp"
#include "provenance/store.hpp"

namespace shearcell {

namespace {

void require_same(std::string_view what, const auto& in_file, const auto& in_log) {
  if (in_file == in_log) return;
  throw StoreDamaged(
      fmt::format("its {} is {}, but the log says {}; `regenerate` computes the file again", what,
                  in_file, in_log));
}

void require_recorded(const Checkpoint& c, const CheckpointRecord& record, const Stage& stage) {
  require_same("run", c.run, record.run);
  require_same("name", ObjectStore::file_of(record.sha256), record.file);
  require_same("step", c.state.step, record.step);
  require_same("cycle", c.cycle, record.cycle);
  require_same("time_s", c.time_s, record.time_s);
  require_same("number of grains", static_cast<std::uint64_t>(c.state.position.cols()),
               stage.grains);
  for (const auto& [name, unit] :
       {std::pair("diameter_m", c.units.diameter_m), std::pair("mass_kg", c.units.mass_kg)}) {
    const nlohmann::json::json_pointer place(std::string("/parameters/") + name);
    if (!stage.resolved.is_object() || !stage.resolved.contains(place)) continue;
    const nlohmann::json& parameter = stage.resolved.at(place);
    require_same(name, unit, parameter.is_number() ? parameter.get<double>() : std::nan(""));
  }
  auto all = c.observables;
  all.insert(record.observables.begin(), record.observables.end());
  for (const auto& [name, value] : all) {
    const auto value_in = [&key = name](const std::map<std::string, double>& observables) {
      const auto found = observables.find(key);
      return found == observables.end() ? "absent" : fmt::format("{}", found->second);
    };
    require_same("observable " + name, value_in(c.observables), value_in(record.observables));
  }
  require_same("state", state_hash(c), record.state_hash);
}

using Severity = Finding::Severity;
using Rows = std::map<std::string, TableRows>;

void add_error(VerifyReport& report, const std::string& subject, const std::string& message,
               const std::string& run = "") {
  report.findings.push_back({Severity::error, subject, run, message});
}

/// Removes "PATH/SUBJECT: " or "SUBJECT: " from the beginning of an error message.
std::string without_path(const std::string& subject, const std::string& message) {
  const std::size_t at = message.find(subject + ": ");
  if (at == message.npos || (at > 0 && message[at - 1] != '/')) return message;
  return message.substr(at + subject.size() + 2);
}

/// Checks that the log contains the earlier head. If so, no event up to this head was changed.
void check_extends(const EventLog& log, const Head& earlier, VerifyReport& report) {
  const std::string found = log.hash_at(earlier.seq);
  if (found == earlier.hash) return;
  const std::string why =
      found.empty()
          ? fmt::format("the log was cut off: it ends at event {}", report.head.seq)
          : fmt::format(
                "the log was rewritten, or the given head is wrong: this event has hash {}, "
                "but the given head has hash {}",
                found, earlier.hash);
  add_error(report, fmt::format("event {}", earlier.seq),
            why + "; check the given head, or restore the log from a backup");
}

/// The tables derived from the events. Events that cannot be applied are reported and skipped.
sqlite::Database derive(const EventLog& log, const std::string& name, VerifyReport& report) {
  sqlite::Database fresh = empty_projections(name);
  log.for_each([&](const Event& event) {
    ++report.events;
    const std::string why = try_apply(fresh, event);
    if (why.empty()) return;
    add_error(report, fmt::format("event {}", event.seq), "it cannot be applied: " + why,
              run_of(event).value_or(""));
  });
  return fresh;
}

/// Describes the first difference between two tables. `expected` and `found` are the rows at which
/// the tables differ; a row is null if its table has ended.
std::string row_difference(const RowCells* expected, const RowCells* found) {
  const bool surplus = expected == nullptr || (found != nullptr && *found < *expected);
  const std::string row = fmt::format("row ({})", (surplus ? found : expected)->front());
  if (expected == nullptr || found == nullptr || expected->size() != found->size() ||
      expected->front() != found->front()) {
    return row + (surplus ? " should not be there" : " is missing");
  }
  const auto [a, b] = std::ranges::mismatch(*expected, *found);
  const auto place = std::ranges::mismatch(*a, *b).in1 - a->begin();
  const auto excerpt = [begin = place > 40 ? static_cast<std::size_t>(place) - 20 : 0](
                           const std::string& cell) { return cell.substr(begin, 60); };
  return fmt::format("{} should have {}, but has {}", row, excerpt(*a), excerpt(*b));
}

void compare_tables(const Rows& stored, const Rows& derived, VerifyReport& report) {
  for (const auto& [table, rows] : derived) {
    const TableRows& found = stored.at(table);
    const auto [a, b] = std::ranges::mismatch(rows, found);
    if (a == rows.end() && b == found.end()) continue;
    add_error(report, "table " + table,
              fmt::format("the table differs from the events: {}; run `rebuild`",
                          row_difference(a == rows.end() ? nullptr : &*a,
                                         b == found.end() ? nullptr : &*b)));
  }
}

void check_objects(const std::vector<CheckpointRecord>& records,
                   const std::map<std::string, Stage>& runs, const sqlite::Database& database,
                   const ObjectStore& objects, VerifyReport& report) {
  std::set<std::string> known;
  for (const CheckpointRecord& record : records) {
    const bool rejected = record.state == CheckpointState::rejected;
    const bool pruned = record.state == CheckpointState::pruned;
    known.insert(record.sha256);
    try {
      if (pruned) {
        if (objects.contains(record.sha256)) {
          report.findings.push_back({Severity::note, record.file, record.run,
                                     "it was pruned but its file still exists, probably because of "
                                     "a crash; `shearcell prune` deletes it"});
        }
        continue;
      }
      const std::vector<std::byte> bytes = objects.get(record.sha256, record.size);
      ++report.checkpoints;
      report.bytes += record.size;
      read_checkpoint(bytes, record, runs.at(record.run));
    } catch (const std::exception& problem) {
      // The checkpoint was pruned after the log was read. (If someone changed the table so that a
      // damaged checkpoint seems pruned, compare_tables() has reported the difference.)
      if (!pruned && is_pruned_now(database, record)) continue;
      const std::string message = without_path(record.file, problem.what());
      const bool unread = dynamic_cast<const std::system_error*>(&problem) != nullptr;
      report.findings.push_back({rejected ? Severity::note
                                 : unread ? Severity::unread
                                          : Severity::error,
                                 record.file, record.run,
                                 message + (rejected ? " (rejected already)" : "")});
    }
  }
  for (const std::string& file : objects.strangers(known)) {
    ++report.orphans;
    report.findings.push_back(
        {Severity::note, file, "",
         "no event refers to this file: it was left by a crash or is being written "
         "now; it can be deleted when no program uses the store"});
  }
}

/// Reports a run whose attempts reached different states at the same step.
void check_reproduced(const std::vector<CheckpointRecord>& records, VerifyReport& report) {
  std::map<std::pair<std::string, std::uint64_t>, std::string> states;
  for (const CheckpointRecord& record : records) {
    if (record.state == CheckpointState::rejected) continue;
    const auto [first, fresh] = states.try_emplace({record.run, record.step}, record.state_hash);
    if (fresh || first->second == record.state_hash) continue;
    report.findings.push_back(
        {Severity::note, record.file, record.run,
         fmt::format("two attempts have different states at step {}; compare their builds in "
                     "`shearcell log`",
                     record.step)});
  }
}

}  // namespace

Checkpoint read_checkpoint(std::span<const std::byte> image, const CheckpointRecord& record,
                           const Stage& stage) {
  Checkpoint checkpoint = decode_checkpoint(image);
  require_plausible(checkpoint);
  require_recorded(checkpoint, record, stage);
  return checkpoint;
}

std::size_t VerifyReport::count(Severity severity) const {
  return static_cast<std::size_t>(std::ranges::count(findings, severity, &Finding::severity));
}

VerifyReport Store::verify(const std::optional<Head>& against) const {
  const std::scoped_lock guard(mutex_);
  VerifyReport report;
  std::vector<CheckpointRecord> records;
  std::map<std::string, Stage> runs;
  bool log_was_read = false;
  try {
    // The log is read in one snapshot. The files are read afterwards.
    const sqlite::ReadTransaction snapshot(database_);
    sqlite::Statement integrity(database_, "PRAGMA integrity_check(1)");
    if (integrity.step() && integrity.text(0) != "ok") {
      database_.require_readable("read");
      add_error(report, database_.name(),
                fmt::format("SQLite reports a damaged database: {}; restore it from a backup",
                            integrity.text(0)));
    }
    report.head = log_.head();
    if (const auto fault = log_.verify_chain()) {
      add_error(report, fmt::format("event {}", fault->seq),
                fault->message + "; restore the log from a backup");
    }
    if (against) check_extends(log_, *against, report);
    const sqlite::Database fresh = derive(log_, database_.name(), report);
    for (Stage& stage : query_stages(fresh)) runs.emplace(stage.id, std::move(stage));
    records = query_all_checkpoints(fresh);
    log_was_read = true;
    compare_tables(projection_rows(database_), projection_rows(fresh), report);
  } catch (const StoreDamaged& damage) {
    add_error(report, database_.name(),
              without_path(database_.name(), damage.what()) +
                  (log_was_read ? "; the log is readable, so `shearcell merge` can copy all "
                                  "runs into a new store"
                                : "; the rest of the store was not read"));
  }
  if (!log_was_read) return report;  // without the log, the files cannot be checked
  check_reproduced(records, report);
  check_objects(records, runs, database_, objects_, report);
  return report;
}

}  // namespace shearcell
