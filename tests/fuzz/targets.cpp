// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/targets.hpp"

#include <cstdio>
#include <cstdlib>
#include <set>

#include "analysis/crystal.hpp"
#include "analysis/growth.hpp"
#include "analysis/measures.hpp"
#include "analysis/nucleation.hpp"
#include "experiments/figures/lineage.hpp"
#include "experiments/manifest/expand.hpp"
#include "experiments/manifest/lines.hpp"
#include "experiments/manifest/packing_file.hpp"
#include "provenance/derived.hpp"
#include "provenance/errors.hpp"
#include "provenance/projections.hpp"
#include "provenance/ro_crate.hpp"
#include "tests/provenance/samples.hpp"
#include "tests/support/frame.hpp"

namespace shearcell::fuzz {
namespace {

namespace fs = std::filesystem;

std::string_view text_of(Input input) {
  return {reinterpret_cast<const char*>(input.data()), input.size()};
}

// For conditions that must hold for every input.
void require(bool fact, const char* what) {
  if (fact) return;
  std::fprintf(stderr, "not so: %s\n", what);
  std::abort();
}

// Reading an input gives a result, or an error of this type with a message.
template <class Error, class Work>
void attempt(Work&& work) {
  try {
    work();
  } catch (const Error& error) {
    require(*error.what() != '\0', "an error says what is wrong");
  }
}

// Text of a manifest: read, check, expand.
void check_plan(const Plan& plan) {
  std::set<std::pair<std::string, std::uint64_t>> places;
  for (const PlannedRun& run : plan.runs) {
    require(places.emplace(run.place.variant, run.place.seed).second, "no run is planned twice");
    require(read_stage(run.stage.resolved).seed == run.place.seed,
            "a record reads back as its run");
    require(stage_key(run.stage.resolved) == run.stage.id, "a run is named after its record");
  }
}

void take_manifest(Input input) {
  constexpr std::size_t kExpanded = 200;  // runs; more would only take longer
  const std::string text(text_of(input));
  try {
    const Manifest manifest = parse_manifest(text, "fuzz.yaml");
    std::vector<std::optional<std::string>> scales;
    for (const Scale& scale : manifest.scales) scales.emplace_back(scale.name);
    if (scales.empty()) scales.emplace_back();
    for (const auto& scale : scales) {
      const Plan plan = expand(manifest, {.scale = scale, .cycles = {}, .seeds = 1});
      if (plan.runs.size() > kExpanded) continue;
      check_plan(plan);
      for (const PlannedRun& run : plan.runs)
        manifest_lines(text, run.place.scale, run.place.swept, "");
    }
  } catch (const ManifestError& error) {
    require(!std::string_view(error.what()).empty(), "an error says what is wrong");
  }
}

// A file of positions.
void take_packing(Input input) {
  const PackingFacts facts{.unit = LengthUnit::d, .diameter_m = 3e-3, .largest_overlap = 0.25};
  try {
    const PackingFile packing = read_packing(text_of(input), "fuzz.csv", facts);
    require(packing.position.cols() > 0 && packing.position.allFinite(), "grains have places");
    const auto& moving = packing.velocity;
    require(!moving || (moving->allFinite() && moving->cols() == packing.position.cols()),
            "all grains have a velocity, or none");
    if (!packing.box) return;
    for (Eigen::Index i = 0; i < packing.position.cols(); ++i) {
      const Eigen::Array3d p = packing.position.col(i).array();
      require((p >= packing.box->min().array() && p <= packing.box->max().array()).all(),
              "grains are within the box");
    }
  } catch (const ManifestError& error) {
    require(!std::string_view(error.what()).empty(), "an error says what is wrong");
  }
}

// Lines of events: upcast, fold, query.
void take_events(Input input) {
  static sqlite::Database database = empty_projections("fresh");
  const sqlite::WriteTransaction undone(database);
  for (const Event& event : forged_events(text_of(input))) {
    attempt<StoreDamaged>([&] { apply(database, event); });
  }
  attempt<StoreDamaged>([&] {
    for (const Stage& record : query_stages(database)) {
      query_checkpoints(database, record.id);
      query_stages(database, record.id.substr(0, 3));
    }
    query_figures(database);
    projection_rows(database);
  });
}

// Bytes of a checkpoint file, as they are and reframed.
void take_checkpoint(Input input) {
  constexpr Eigen::Index kAnalysed = 64;  // grains; the Voronoi cells of more take long
  const std::span<const std::byte> bytes = std::as_bytes(input);
  attempt<StoreDamaged>([&] { decode_checkpoint(bytes); });
  attempt<StoreDamaged>([&] {
    const Checkpoint checkpoint = decode_checkpoint(test::sealed(bytes));
    if (checkpoint.state.position.cols() > kAnalysed ||
        checkpoint.cell.wall_grains.size() > kAnalysed) {
      return;
    }
    require(state_hash(decode_checkpoint(encode_checkpoint(checkpoint))) == state_hash(checkpoint),
            "a checkpoint that is read, written and read again is the same");
    require_plausible(checkpoint);
    attempt<AnalysisError>([&] {
      const Analysis found = analyse(checkpoint);
      for (const char* name : {"profiles", "wall_distance", "structure_factor"}) {
        provider(name).compute({&found, &checkpoint});
      }
    });
  });
}

// A CSV, and after a NUL the lineage file and the chart beside it, as `show FILE` reads them.
void take_published(Input input) {
  struct Place {
    TemporaryFolder folder;
    fs::path published = folder.path() / "published";
    Store store;
    Place() : store(make_store(folder.path() / "store"), Access::read) {
      fs::create_directory(published);
    }
  };
  static const Place place;
  const std::string_view text = text_of(input);
  const std::size_t end = std::min(text.find('\0'), text.size());
  test::write_bytes(place.published / "S2a.csv", std::string(text.substr(0, end)));
  const std::string second(text.substr(std::min(end + 1, text.size())));
  test::write_bytes(place.published / "S2.lineage.json", second);
  for (const char* name : {"S2a.csv", "S2.lineage.json"}) {
    const auto found = find_published(place.store, place.published / name);
    require(found.has_value(), "the figure that the file is named after is found");
  }
}

// What derived.sqlite keeps of a checkpoint.
void take_measures(Input input) {
  attempt<AnalysisError>([&] {
    const nlohmann::json result = decode_result(std::as_bytes(input));
    attempt<AnalysisError>([&] {
      Measures measures;
      provider("scalars").read(result, measures);
    });
    attempt<AnalysisError>([&] {
      FrameRun run;
      CheckpointMeasures& checkpoint = run.checkpoints.emplace_back();
      provider("crystallites").read(result, checkpoint.measures);
      GrowthBySize counts;
      follow(*checkpoint.measures.crystallite_map, *checkpoint.measures.crystallite_map, counts);
      GrowthCurve({&counts, 1}).delta_rho(10);
      const std::vector<double> places = nucleus_places(run, CellAxis::y);
      density({&places, 1}, 10);
    });
  });
}

// Bytes changed by patches: three say where, one how many follow.
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

// Appends events under right hashes: what a forger who knows the format can write.
void forge(const fs::path& log, std::string_view lines) {
  sqlite::Database database(log, Access::write);
  EventLog events(database);
  const sqlite::WriteTransaction all(database);
  for (const Event& event : forged_events(lines)) events.append_copy(all, event);
  database.execute("COMMIT");
}

// The JSON library's exceptions and bad_alloc are not runtime errors: they were not translated.
template <class Work>
void attempt_store(Work&& work) {
  attempt<std::runtime_error>(work);
}

void look_at_runs(const Store& store) {
  for (const Stage& run : store.stages()) {
    attempt_store([&] { store.checkpoints(run.id, Listed::all); });
    attempt_store([&] {
      // As the program writes it: a forged store may hold text that is not UTF-8.
      ro_crate_metadata(crate_facts(store, run.id))
          .dump(1, ' ', false, nlohmann::json::error_handler_t::replace);
    });
  }
}

void look_at_figures(const Store& store) {
  for (const FigureRecord& record : figure_records(store)) {
    attempt_store([&] {
      const FigureLineage lineage = figure_lineage(store, record);
      to_json(lineage);
      check_inputs(store, lineage);
    });
  }
}

void look_at(const fs::path& folder) {
  attempt_store([&] {
    const Store store(folder, Access::read);
    attempt_store([&] { look_at_runs(store); });
    attempt_store([&] { look_at_figures(store); });
    attempt_store([&] { store.leases(); });
    attempt_store([&] { store.verify(); });
  });
  attempt_store([&] {
    Store store(folder, Access::write);
    attempt_store([&] { store.rebuild(); });
    attempt_store([&] {
      for (const Stage& run : store.stages()) store.newest_valid_checkpoint(run.id);
    });
    attempt_store([&] { store.verify(); });
    attempt_store([&] { store.prunable({}); });
  });
}

// A store with changed bytes or with forged events: the first byte chooses what the rest is.
void take_store(Input input) {
  static const TemporaryFolder folder;
  static const fs::path store = make_store(folder.path() / "store"), log = store / "store.sqlite";
  static const std::string sound = test::read_bytes(log);
  if (input.empty()) return;
  const std::string_view rest = text_of(input).substr(1);
  for (const auto& entry : fs::directory_iterator(store)) {
    if (entry.path().filename() != "objects") fs::remove_all(entry.path());
  }
  const bool forged = input.front() % 2 == 1;
  test::write_bytes(log, forged ? sound : patched(sound, rest));
  attempt_store([&] {
    if (forged) forge(log, rest);
  });
  look_at(store);
}

}  // namespace

const std::array<Target, 7> all_targets = {{{"checkpoint", take_checkpoint, checkpoint_seeds},
                                            {"events", take_events, event_seeds},
                                            {"manifest", take_manifest, manifest_seeds},
                                            {"measures", take_measures, measure_seeds},
                                            {"packing", take_packing, packing_seeds},
                                            {"published", take_published, published_seeds},
                                            {"store", take_store, store_seeds}}};

}  // namespace shearcell::fuzz
