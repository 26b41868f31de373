// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <stdexcept>

#include "experiments/figures/lineage.hpp"
#include "provenance/derived.hpp"
#include "provenance/ro_crate.hpp"
#include "tests/fuzz/seeds.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell::fuzz {
namespace {

namespace fs = std::filesystem;

struct Place {
  TemporaryFolder folder;
  fs::path store = make_store(folder.path() / "store");
  fs::path log = store / "store.sqlite";
  std::string sound = test::read_bytes(log);
};

/// Three bytes say where, one how many follow.
std::string patched(std::string bytes, std::string_view patches) {
  const auto byte = [&](std::size_t i) -> unsigned {
    return static_cast<unsigned char>(patches[i]);
  };
  while (patches.size() > 4) {
    const std::size_t at = (byte(0) | byte(1) << 8U | byte(2) << 16U) % bytes.size();
    const std::size_t count =
        std::min({std::size_t{1} + byte(3) % 16, patches.size() - 4, bytes.size() - at});
    bytes.replace(at, count, patches.substr(4, count));
    patches.remove_prefix(4 + count);
  }
  return bytes;
}

/// Appends events under right hashes: what a forger who knows the format can write.
void forge(const fs::path& log, std::string_view lines) {
  sqlite::Database database(log, sqlite::Open::existing);
  EventLog events(database);
  const sqlite::WriteTransaction all(database);
  for (const Event& event : forged_events(lines)) events.append_copy(all, event);
  database.execute("COMMIT");
}

/// Calls what reads a store; each call ends in an answer or a message.
template <typename Work>
void attempt(Work&& work) {
  try {
    work();
  } catch (const std::runtime_error& told) {
    // JSON's own exceptions and bad_alloc are none of these: nobody translated them.
    require(*told.what() != '\0', "an error says what is wrong");
  }
}

void look_at_runs(const Store& store) {
  for (const RunRecord& run : store.runs()) {
    attempt([&] { store.checkpoints(run.id, true); });
    attempt([&] {
      const CrateFacts facts = crate_facts(store, run.id);
      ro_crate_metadata(facts, prov_json(facts).dump());
    });
  }
}

void look_at_figures(const Store& store) {
  for (const FigureRecord& record : figure_records(store)) {
    attempt([&] {
      const FigureLineage lineage = figure_lineage(store, record);
      to_json(lineage);
      check_inputs(store, lineage);
    });
  }
}

void look_at(const fs::path& folder) {
  attempt([&] {
    const Store store(folder, Access::read);
    attempt([&] { look_at_runs(store); });
    attempt([&] { look_at_figures(store); });
    attempt([&] { store.leases(); });
    attempt([&] { store.verify(); });
  });
  attempt([&] {
    Store store(folder, Access::write);
    attempt([&] { store.rebuild(); });
    attempt([&] {
      for (const RunRecord& run : store.runs()) store.newest_valid_checkpoint(run.id);
    });
    attempt([&] { store.verify(); });
    attempt([&] { store.prunable({}); });
  });
}

/// The first byte chooses what the rest is.
void run(Input input) {
  static const Place place;
  if (input.empty()) return;
  const std::string_view rest = text_of(input).substr(1);
  for (const auto& entry : fs::directory_iterator(place.store)) {
    if (entry.path().filename() != "objects") fs::remove_all(entry.path());
  }
  const bool forged = input.front() % 2 == 1;
  test::write_bytes(place.log, forged ? place.sound : patched(place.sound, rest));
  attempt([&] {
    if (forged) forge(place.log, rest);
  });
  look_at(place.store);
}

}  // namespace

const Target store_target{"store", run, store_seeds};

}  // namespace shearcell::fuzz
