// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdlib>

#include "analysis/crystal.hpp"
#include "analysis/measures.hpp"
#include "experiments/figures/lineage.hpp"
#include "provenance/events.hpp"
#include "provenance/sha256.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/provenance/samples.hpp"
#include "tests/support/bad_manifests.hpp"

namespace shearcell::fuzz {
namespace {

namespace fs = std::filesystem;

const char* const kManifest = "experiment: a\nbase: {grains: 600}\nseeds: 2\n";
const char* const kCsv = "variant,cycle\nfluid=still,1\n";

Checkpoint small_checkpoint(std::uint64_t step) {
  return test::sample_checkpoint(test::run_id(0), step, 2);
}

std::string text_of_events(const std::vector<Event>& events, const std::string& stream) {
  std::string text;
  for (const Event& event : events) {
    if (!event.stream.starts_with(stream)) continue;
    text += event.type + '\t' + event.stream + '\t' + std::to_string(event.schema) + '\t' +
            event.payload + '\n';
  }
  return text;
}

std::vector<Event> events_of_store() {
  const TemporaryFolder folder;
  return Store(make_store(folder.path() / "store"), Access::read).events();
}

std::string as_string(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

fs::path make_store(const fs::path& folder) {
  Store store(folder, Access::create);
  const std::string manifest =
      store.register_manifest(kManifest, "a.yaml", {{"experiment", "a"}, {"figures", {"S2"}}});
  Stage prepare = test::sample_run(0), shear = test::sample_run(1);
  prepare.memberships[0].place.manifest = shear.memberships[0].place.manifest = manifest;
  prepare.kind = "prepare";
  shear.parent = prepare.id;
  store.declare_stage(prepare);
  store.declare_stage(shear);
  const nlohmann::json host = {{"host", "h"}, {"build", {{"version", "1"}}}};
  store.start_stage(prepare.id, host);
  const CheckpointRecord first = store.record_checkpoint(prepare.id, small_checkpoint(0));
  store.complete_stage(prepare.id);
  store.start_stage(shear.id, host, std::nullopt, first.sha256);
  nlohmann::json inputs = nlohmann::json::array();
  for (const std::uint64_t step : {0U, 45600U}) {
    Checkpoint checkpoint = small_checkpoint(step);
    checkpoint.run = shear.id;
    inputs.push_back(store.record_checkpoint(shear.id, checkpoint).sha256);
  }
  store.interrupt_stage(shear.id, "a signal");
  nlohmann::json input = {{"run", shear.id},      {"parent", prepare.id}, {"experiment", "a"},
                          {"manifest", manifest}, {"variant", "base"},    {"seed", 1},
                          {"checkpoints", inputs}};  // as earlier versions recorded it
  const auto record = [&] {
    store.record("figure/S2", {"FigureGenerated",
                               {{"figure", "S2"},
                                {"scale", "smoke"},
                                {"analysis_version", 1},
                                {"inputs", {input}},
                                {"outputs", {{"S2a.csv", sha256_hex(kCsv)}}}}});
  };
  record();
  input.erase("checkpoints");
  const States states = states_of(store.checkpoints(shear.id));
  input.update({{"cycles", states.cycles},
                {"state_hash", states.state_hash},
                {"states_sha256", states.sha256}});
  record();
  return folder;
}

std::vector<Event> forged_events(std::string_view lines) {
  std::vector<Event> events;
  while (!lines.empty()) {
    std::string_view line = lines.substr(0, lines.find('\n'));
    lines.remove_prefix(std::min(line.size() + 1, lines.size()));
    std::vector<std::string> fields;
    for (int k = 0; k < 3 && line.find('\t') != line.npos; ++k) {
      fields.emplace_back(line.substr(0, line.find('\t')));
      line.remove_prefix(fields.back().size() + 1);
    }
    if (fields.size() < 3) continue;
    Event event;
    event.seq = 100 + events.size();
    event.version = events.size() + 1;
    event.type = fields[0];
    event.stream = fields[1];
    event.schema = std::strtoull(fields[2].c_str(), nullptr, 10);
    event.recorded_at = "2026-01-01T00:00:00.000Z";
    event.payload = line;
    events.push_back(std::move(event));
  }
  return events;
}

std::vector<std::string> manifest_seeds() {
  std::vector<std::string> seeds = {kManifest};
  const fs::path repository = fs::path(SHEARCELL_TEST_DATA) / ".." / "..";
  for (const auto& entry : fs::directory_iterator(repository / "experiments")) {
    if (entry.path().extension() == ".yaml") seeds.push_back(test::read_bytes(entry.path()));
  }
  for (const auto& [name, bad] : test::bad_manifests(SHEARCELL_TEST_DATA)) {
    seeds.push_back(bad.text);
  }
  return seeds;
}

std::vector<std::string> event_seeds() {
  const std::vector<Event> known = events_of_store();
  std::vector<std::string> seeds;
  for (const char* stream : {"", "run/", "figure/", "manifest/"}) {
    seeds.push_back(text_of_events(known, stream));
  }
  std::vector<Event> later;
  const auto add = [&later](const events::Any& any) {
    NewEvent encoded = events::encode(any);
    Event& event = later.emplace_back();
    event.stream = "run/" + test::run_id(1);
    event.type = encoded.type;
    event.schema = events::newest_schema(event.type);
    event.payload = encoded.payload.dump();
  };
  CheckpointRecord checkpoint;
  checkpoint.sha256 = std::string(64, 'a');
  add(events::RunFailed{"x", nlohmann::json::object()});
  add(events::CheckpointPruned{{checkpoint}});
  add(events::CheckpointRejected{checkpoint.sha256, 1, "x"});
  add(events::RunResumed{{2, nlohmann::json::object(), {}}, {checkpoint.sha256, 1, 1}});
  seeds.push_back(seeds[1] + text_of_events(later, ""));
  return seeds;
}

std::vector<std::string> checkpoint_seeds() {
  std::vector<std::string> seeds;
  Checkpoint bare = small_checkpoint(1);
  bare.cell.wall_grains.clear();
  bare.observables.clear();
  Checkpoint many = small_checkpoint(2);
  for (int k = 0; k < 12; ++k) many.observables["o" + std::to_string(k)] = k;
  for (const Checkpoint& checkpoint : {small_checkpoint(0), bare, many}) {
    seeds.push_back(as_string(encode_checkpoint(checkpoint)));
  }
  return seeds;
}

std::vector<std::string> store_seeds() {
  std::vector<std::string> seeds = {
      std::string("\0\x10\0\0\x03"
                  "abc\0",
                  9)};
  for (const std::string& events : event_seeds()) seeds.push_back('\1' + events);
  return seeds;
}

std::vector<std::string> published_seeds() {
  const std::string csv = kCsv, lineage = R"({"outputs": {"S2a.csv": ")" + sha256_hex(csv) + "\"}}";
  const std::string axis =
      R"({"label": [["x", ""]], "unit": [], "log": true, "whole": false, "clip": false, "low": null,)"
      R"( "high": null})";
  const std::string chart = R"({"x": )" + axis + R"(, "y": )" + axis +
                            R"(, "title": [], "lines": [], "series": [{"title": [["a", ""]],)"
                            R"( "colour": "#000000", "point": 7, "shift": 0, "line": true,)"
                            R"( "dashed": false, "band": false, "points": [[1, 2, null, null]]}]})";
  return {csv + '\0' + lineage, csv + "x" + '\0' + lineage,
          std::string("x,y\n1,2\n") + '\0' + chart};
}

std::vector<std::string> packing_seeds() {
  const std::string box = "0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n";
  return {
      "2\nLattice=\"9 0 0 0 9 0 0 0 9\" Origin=\"0 0 0\" length_unit=d "
      "Properties=species:S:1:pos:R:3:velo:R:3:id:I:1:radius:R:1:wall_side:I:1\n"
      "H 1 1 1 0 0 0 1 0.5 0\nHe 3 3 3 0 0 0 2 0.5 1\n",
      "2\n\nA 1 1 1\nA 3 3 3\n",
      "title\n\n2 atoms\n1 atom types\n" + box +
          "\nMasses\n\n1 1\n\nAtoms # atomic\n\n2 1 1 1 1\n1 1 3 3 3 0 0 -1\n\n"
          "Velocities\n\n1 0 0 0\n2 0 0 1e-3\n",
      "LAMMPS data file by shearcell, units =, cell 0 9 0 9 0 9 tilt 0\n\n2 atoms\n" + box +
          "0 0 0 xy xz yz\n\nAtoms # sphere\n\n1 1 1 1.9 1 1 1 0 0 0\n2 5 1 1.9 3 3 3 0 0 0\n",
      "title\n2 atoms\n\nAtoms # hybrid\n\n1 1 1 1 1 1 1.9\n2 1 3 3 3 1 1.9\n",
      "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS xy xz yz ff ff pp\n"
      "0 9 0\n0 9 0\n0 9 0\nITEM: ATOMS id x y z vx vy vz\n2 1 1 1 0 0 0\n1 3 3 3 0 0 0\n",
      "x_d;y_d;z_d;\"diameter_d\"\n1;1;1;1\n3;3;3;1\n"};
}

std::vector<std::string> measure_seeds() {
  Analysis analysis;
  analysis.crystallites = {{3, 5}, {0, 0}, {2}, {Eigen::Vector3d(1, 2, 3)}, 12, 0, 20};
  return {as_string(encode_result(provider("crystallites").compute({&analysis}))),
          as_string(encode_result(provider("scalars").compute({&analysis})))};
}

}  // namespace shearcell::fuzz
