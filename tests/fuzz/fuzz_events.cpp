// SPDX-License-Identifier: GPL-3.0-or-later
#include "provenance/errors.hpp"
#include "provenance/projections.hpp"
#include "tests/fuzz/seeds.hpp"
#include "tests/fuzz/targets.hpp"

namespace shearcell::fuzz {
namespace {

sqlite::Database& tables() {
  static sqlite::Database database = [] {
    sqlite::Database fresh = sqlite::Database::in_memory();
    fresh.execute("PRAGMA foreign_keys=ON");
    create_projections(fresh);
    return fresh;
  }();
  return database;
}

void run(Input input) {
  sqlite::Database& database = tables();
  const sqlite::WriteTransaction undone(database);
  for (const Event& event : forged_events(text_of(input))) {
    try {
      apply(database, event);
    } catch (const StoreDamaged&) {
    }
  }
  try {
    const std::vector<RunRecord> runs = query_runs(database);
    for (const RunRecord& record : runs) {
      query_checkpoints(database, record.id);
      query_run_ids(database, record.id.substr(0, 3), 10);
    }
    query_figures(database);
    projection_rows(database);
  } catch (const StoreDamaged&) {
  }
}

}  // namespace

const Target events_target{"events", run, event_seeds};

}  // namespace shearcell::fuzz
