// SPDX-License-Identifier: GPL-3.0-or-later
// A small history in which attempts end in every possible way, for the tests of lineage and
// exports.
#pragma once

#include <string>

#include "provenance/events.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell::test {

inline nlohmann::json sample_host(const std::string& commit) {
  return {{"host", "node7"},
          {"system", "Linux 6.1"},
          {"cpu", "A CPU"},
          {"cores", 4},
          {"simd", "AVX2"},
          {"build",
           {{"version", "0.1.0"},
            {"commit", commit},
            {"compiler", "GNU 12"},
            {"flags", "-O3"},
            {"type", "Release"}}},
          {"libraries", {{"hdf5", "1.10.8"}}}};
}

/// Run 1 prepares; run 2 shears what it prepared in four attempts: interrupted, lost, failed and
/// completed, with one checkpoint rejected.
struct SampleHistory {
  std::string packing, sheared;
  std::string rejected;  ///< SHA-256

  explicit SampleHistory(Store& store) {
    store.register_manifest("manifest", "/home/somebody/../m.yaml", {{"experiment", "drag"}});
    Stage first = sample_run(1, 0), second = sample_run(2, 3);
    first.kind = "prepare";
    first.resolved = {{"stage", "prepare"}, {"seed", 7}, {"parameters", {{"mass_kg", 2e-5}}}};
    second.parent = first.id;
    second.resolved = {{"stage", "shear"},
                       {"seed", 7},
                       {"parent", first.id},
                       {"parameters", {{"fluid", "cell"}, {"mass_kg", 2e-5}}}};
    packing = first.id;
    sheared = second.id;
    store.declare_stage(first);
    store.declare_stage(second);
    store.start_stage(packing, sample_host("aaaa"));
    record(store, packing, 500);
    store.complete_stage(packing);

    store.start_stage(sheared, sample_host("aaaa"));
    record(store, sheared, 0);
    store.interrupt_stage(sheared, "stopped by a signal");
    {
      Store killed(store.folder(), Access::write);
      const std::string from = killed.checkpoints(sheared).back().sha256;
      killed.start_stage(sheared, sample_host("aaaa"), from);
      rejected = record(killed, sheared, 45600);
    }
    store.reject_checkpoint(sheared, rejected, "its SHA-256 is not the recorded one");
    store.start_stage(sheared, sample_host("bbbb"), store.checkpoints(sheared).back().sha256);
    store.fail_stage(sheared, "an overlap of 0.3 d");
    store.start_stage(sheared, sample_host("bbbb"), store.checkpoints(sheared).back().sha256);
    record(store, sheared, 91200);
    record(store, sheared, 136800);
    store.complete_stage(sheared);
  }

  static std::string record(Store& store, const std::string& run, std::uint64_t step) {
    return store.record_checkpoint(run, sample_checkpoint(run, step)).sha256;
  }
};

/// Appends an event to a run as another program would, past the store.
inline void append_to_run(const Store& store, const std::string& run, const NewEvent& event) {
  sqlite::Database database(store.folder() / "store.sqlite", Access::write);
  EventLog log(database);
  sqlite::WriteTransaction lock(database);
  log.append(lock, "run/" + run, event);
  lock.commit();
}

}  // namespace shearcell::test
