// SPDX-License-Identifier: GPL-3.0-or-later
// Exported frames, also as other programs read them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "analysis/near_grains.hpp"
#include "experiments/bench/packing.hpp"
#include "experiments/export/formats.hpp"
#include "experiments/manifest/identity.hpp"
#include "experiments/manifest/packing_file.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

/// A small packing at the end of a cycle, and the same grains in a cell that tilts and whose wall
/// moves.
std::vector<Checkpoint> checkpoints() {
  Checkpoint upright;
  upright.run = std::string(64, 'a');
  const bench::Packing packing = bench::pressed_packing({.grains = 250}, 1);
  upright.cell = packing.cell;
  upright.state = packing.state;
  upright.state.position.row(2).array() += 2 * upright.cell.depth;  // z is unwrapped
  upright.cycle = 3;
  upright.time_s = 6;
  upright.state.step = 136800;
  Checkpoint tilted = upright;
  tilted.theta = 0.07;
  tilted.cycle = 3.25;
  tilted.time_s = 6.5;
  tilted.state.step = 148200;
  tilted.state.wall_velocity = 0.125;
  const WallPose pose = wall_pose(tilted.cell, tilted.theta, tilted.state.wall_height);
  for (Eigen::Index i = 0; i < tilted.state.position.cols(); ++i) {
    tilted.state.position(0, i) += (tilted.state.position(1, i) - pose.top) * pose.tan_theta;
    tilted.state.velocity.col(i) = Eigen::Vector3d(0.5, -0.25, 0.125) * static_cast<double>(i);
  }
  return {upright, tilted};
}

/// A frame of a run that has no other checkpoints.
ExportedState frame_of(const Checkpoint& checkpoint, CheckpointRecord record = {}, Run run = {}) {
  const TemporaryFolder folder;
  Store store(folder.path() / "store", Access::create);
  run.stage.id = record.run = checkpoint.run;
  run.stage.memberships = {{.place = run.place}};
  store.declare_stage(run.stage);
  MeasureSources sources(store);
  sources.read_run(record.run);
  return shearcell::frame_of(checkpoint, record, run, sources, 1);
}

nlohmann::json rows(const Eigen::Matrix3Xd& columns) {
  nlohmann::json all = nlohmann::json::array();
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    all.push_back({columns(0, i), columns(1, i), columns(2, i)});
  }
  return all;
}

/// As a store would name it.
Run about() {
  Run run;
  run.stage.id = std::string(64, 'a');
  run.stage.resolved = {{"parameters",
                         {{"stiffness_N_per_m", 654.0},
                          {"mass_kg", 2e-5},
                          {"diameter_m", 3e-3},
                          {"gravity_m_per_s2", 9.81},
                          {"fluid", "still"},
                          {"steps_per_cycle", 45600}}}};
  run.place.experiment = "drag";
  run.place.scale = "smoke";
  run.place.variant = "fluid=still,amplitude_rad=0.0833";
  run.place.seed = 7;
  return run;
}

CheckpointRecord record_of(const Checkpoint& checkpoint) {
  CheckpointRecord record;
  record.sha256 = std::string(64, 'b');
  record.cycle = checkpoint.cycle;
  record.observables = {{"cell_height_d", 11.5}};
  return record;
}

/// In place of the motion since an earlier checkpoint.
std::vector<double> made_up(std::size_t particles, double step) {
  std::vector<double> values;
  for (std::size_t i = 0; i < particles; ++i) values.push_back(step * static_cast<double>(i));
  return values;
}

std::vector<double>& column(ExportedState& frame, const std::string& name) {
  return std::ranges::find(frame.columns, name, &ExportedColumn::name)->values;
}

/// From the checkpoint and its analysis, not through ExportedState.
nlohmann::json truth(const Checkpoint& c) {
  const double d = c.units.diameter_m;
  const WallPose pose = wall_pose(c.cell, c.theta, c.state.wall_height);
  Analysis measured = analyse(c);
  const Eigen::Index grains = c.state.position.cols();
  const auto walls = static_cast<Eigen::Index>(c.cell.wall_grains.size());
  Eigen::Matrix3Xd position(3, grains + walls), velocity(3, grains + walls);
  position << c.state.position, wall_grain_positions(c.cell, pose);
  std::vector<double> periods(static_cast<std::size_t>(grains + walls), 0);
  for (Eigen::Index i = 0; i < grains; ++i) {
    const double passed = std::floor(position(2, i) / c.cell.depth);
    periods[static_cast<std::size_t>(i)] = passed;
    position(2, i) -= c.cell.depth * passed;
  }
  velocity << c.state.velocity * d,
      wall_grain_velocities(c.cell, pose, 0, c.state.wall_velocity) * d;  // about() names no drive
  std::vector<int> type(static_cast<std::size_t>(grains), 0);
  for (Eigen::Index w = 0; w < walls; ++w) {
    const WallSide side = c.cell.wall_grains[static_cast<std::size_t>(w)].side;
    type.push_back(1 + static_cast<int>(side));
  }
  std::vector<double> phi_local = measured.grains.phi_local, q6 = measured.grains.q6,
                      overlap = measured.grains.overlaps.largest,
                      pressure = measured.mechanics.grain_pressure;
  std::vector<int> structure, crystallite, id;
  for (std::size_t i = 0; i < phi_local.size(); ++i) {
    structure.push_back(static_cast<int>(measured.grains.structure[i]));
    crystallite.push_back(measured.grains.crystallite[i] + 1);
  }
  for (std::size_t i = 0; i < type.size(); ++i) id.push_back(static_cast<int>(i) + 1);
  for (double& of_grain : pressure) of_grain *= 654.0 / 3e-3;
  for (auto* numbers : {&phi_local, &q6, &overlap, &pressure}) numbers->resize(type.size(), 0.0);
  for (auto* numbers : {&structure, &crystallite}) numbers->resize(type.size(), -1);
  Measures numbers_of_all;
  const RunFacts run{.parameters = about().stage.resolved.at("parameters")};
  for (const char* name : {"scalars", "mechanics", "lattices", "core"}) {
    provider(name).read(provider(name).compute({&measured, &c, {}, nullptr, &run}), numbers_of_all);
  }
  nlohmann::json scalars = numbers_of_all.numbers;
  scalars["cell_height_d"] = 11.5;
  // Of a few grains in the middle, which touch no wall.
  std::vector<std::uint8_t> inner(measured.grains.interior.size(), 0);
  std::vector<int> inner_id;
  double inner_volume = 0;
  for (std::size_t i = 0; i < inner.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    if (std::fabs(c.state.position(0, column) - c.cell.width / 2) > 1) continue;
    if (std::fabs(c.state.position(1, column) - (pose.bottom + pose.top) / 2) > 1.5) continue;
    inner[i] = 1;
    inner_id.push_back(static_cast<int>(i) + 1);
    inner_volume += measured.grains.cells.volume[i] * d * d * d;
  }
  // Pairs of them up to each distance, in steps of 0.02 d.
  std::vector<double> inner_pairs(75, 0);
  for_each_pair(c.cell, pose, c.state.position, 1.5,
                [&](std::int32_t i, std::int32_t j, const Eigen::Vector3d& r) {
                  if (inner[static_cast<std::size_t>(i)] == 0) return;
                  if (inner[static_cast<std::size_t>(j)] == 0) return;
                  const auto bin = static_cast<std::size_t>(r.norm() / 0.02);
                  for (std::size_t b = bin; b < inner_pairs.size(); ++b) ++inner_pairs[b];
                });
  std::vector<int> lattice = provider("grain_lattices").compute({nullptr, &c}).at("lattice");
  std::vector<int> inner_contacts;
  lattice.resize(type.size(), -1);
  std::vector<int> contacts(measured.grains.overlaps.contacts.begin(),
                            measured.grains.overlaps.contacts.end());
  for (const int id_of : inner_id) {
    inner_contacts.push_back(contacts[static_cast<std::size_t>(id_of) - 1]);
  }
  contacts.resize(type.size(), 0);
  const Mechanics m = mechanics(c, measured.grains.cells.volume, inner);
  const double k_per_d = 654.0 / 3e-3;
  nlohmann::json facts = about().stage.resolved.at("parameters");
  facts.update({{"run", std::string(64, 'a')},
                {"experiment", "drag"},
                {"scale", "smoke"},
                {"variant", "fluid=still,amplitude_rad=0.0833"},
                {"seed", 7}});
  const double height = (pose.top - pose.bottom) * d;
  const double shift = height * pose.tan_theta;
  return {
      {"facts", facts},
      {"checkpoint", std::string(64, 'b')},
      {"scalars", scalars},
      {"inner_id", inner_id},
      {"inner_pairs", inner_pairs},
      {"inner_contacts", inner_contacts},
      {"inner_volume", inner_volume},
      {"inner_stress",
       {m.stress(0, 0) * k_per_d, m.stress(1, 1) * k_per_d, m.stress(2, 2) * k_per_d,
        m.stress(0, 1) * k_per_d, m.stress(0, 2) * k_per_d, m.stress(1, 2) * k_per_d}},
      {"step", c.state.step},
      {"time", c.time_s},
      {"cycle", c.cycle},
      {"theta", c.theta},
      {"mass", c.units.mass_kg},
      {"origin", {-shift, pose.bottom * d, 0.0}},
      {"edges", {{c.cell.width * d, 0.0, 0.0}, {shift, height, 0.0}, {0.0, 0.0, c.cell.depth * d}}},
      {"position", rows(position * d)},
      {"velocity", rows(velocity)},
      {"radius", std::vector<double>(type.size(), d / 2)},
      {"id", id},
      {"type", type},
      {"phi_local", phi_local},
      {"q6", q6},
      {"overlap", overlap},
      {"grain_pressure_Pa", pressure},
      {"displacement_d", made_up(type.size(), 1e-3)},
      {"d2min_d2", made_up(type.size(), 1e-5)},
      {"contacts", contacts},
      {"structure", structure},
      {"lattice", lattice},
      {"crystallite", crystallite},
      {"periods", periods}};
}

/// Writes a frame for each of many names. Readers may take those of the first list for numbers,
/// logical values, lists or JSON.
void write_texts(const fs::path& at) {
  nlohmann::ordered_json texts;
  for (const char* name :
       {"T",     "F",   "True", "false", "1e3",    "1E3", "1d3",    "007",  "7",
        "-1",    "+5",  ".5",   "1_0",   "nan",    "NaN", "inf",    "-inf", "infinity",
        "1 2 3", "T F", "T,F",  "nan x", "[1, 2]", "{1}", "_JSON 1"}) {
    texts[name] = fmt::format("'{}'", name);
  }
  for (const char* name : {"amplitude", "Tilt", "drag_2", "2_drag", "1e3_grains", "True-or-not",
                           "nano", "0x10", "{a}", "fluid=T", "_JSON_1"}) {
    texts[name] = name;
  }
  const FrameWriter xyz = extxyz_writer(at / "texts.xyz", LengthUnit::d);
  ExportedState frame = frame_of(checkpoints().front(), {}, about());
  std::size_t k = 0;
  for (const auto& [name, as_text] : texts.items()) {
    for (auto& [key, value] : frame.run) {
      if (key == "experiment" || key == "scale") value = name;
    }
    xyz(frame);
    h5md_writer(at / fmt::format("texts_{}.h5md", k++), 1)(frame);
  }
  std::ofstream(at / "texts.json") << texts;
}

TEST(Export, OtherProgramsReadEveryNumber) {
  const TemporaryFolder folder;
  const fs::path at = folder.path();
  fs::create_directories(at / "vtk");
  fs::create_directories(at / "lammps");
  {
    const std::vector<Checkpoint> all = checkpoints();
    const FrameWriter writers[] = {h5md_writer(at / "run.h5md", all.size()),
                                   extxyz_writer(at / "run.xyz", LengthUnit::d),
                                   extxyz_writer(at / "metres.xyz", LengthUnit::m),
                                   vtk_writer(at / "vtk", all.size()),
                                   facts_writer(at / "vtk", all.size()),
                                   lammps_writer(at / "lammps")};
    nlohmann::json frames = nlohmann::json::array();
    for (const Checkpoint& checkpoint : all) {
      frames.push_back(truth(checkpoint));
      ExportedState frame = frame_of(checkpoint, record_of(checkpoint), about());
      EXPECT_TRUE(std::isnan(column(frame, "displacement_d").front())) << "nothing is earlier";
      column(frame, "displacement_d") = made_up(frame.particles(), 1e-3);
      column(frame, "d2min_d2") = made_up(frame.particles(), 1e-5);
      for (const FrameWriter& write : writers) write(frame);
    }
    std::ofstream(at / "truth.json") << frames;
    write_texts(at);
  }
  const std::string python = "/usr/bin/python3 ";
  if (std::system((python + "-c 'import ase, h5py, MDAnalysis, vtk' 2>/dev/null").c_str()) != 0) {
    GTEST_SKIP() << "needs python3-ase, python3-h5py, python3-mdanalysis and python3-vtk9";
  }
  EXPECT_EQ(
      std::system((python + SHEARCELL_TEST_DATA "/../export/read_back.py " + at.string()).c_str()),
      0);
}

// Against all pairs of exported particles, and the forces on the bottom wall.
TEST(Export, ContactsAreAllPairsThatTouch) {
  const double d = 3e-3, k = 654;
  for (const WallTexture walls : {WallTexture::rough, WallTexture::smooth}) {
    const TemporaryFolder folder;
    Checkpoint c = checkpoints().back();  // tilted
    if (walls == WallTexture::smooth) {
      const bench::Packing packing = bench::pressed_packing({.grains = 250, .walls = walls}, 1);
      c = checkpoints().front();
      c.cell = packing.cell;
      c.state = packing.state;
    }
    const ExportedState frame = frame_of(c, record_of(c), about());
    contacts_writer(folder.path())(frame);
    std::ifstream file(folder.path() / fmt::format("contacts_{}.csv", frame_name(frame)));
    std::string line;
    std::getline(file, line);
    EXPECT_EQ(line, "grain,other,wall_side,overlap_d,force_N,normal_x,normal_y,normal_z");
    std::map<std::pair<std::size_t, std::size_t>, double> pairs;
    std::array<double, 2> on_bottom{};
    std::size_t planes = 0;
    while (std::getline(file, line)) {
      std::size_t i = 0, j = 0;
      int side = 0;
      double overlap = 0, force = 0;
      Eigen::Vector3d n;
      ASSERT_EQ(std::sscanf(line.c_str(), "%zu,%zu,%d,%lf,%lf,%lf,%lf,%lf", &i, &j, &side, &overlap,
                            &force, &n[0], &n[1], &n[2]),
                8)
          << line;
      EXPECT_DOUBLE_EQ(force, k * overlap * d);
      EXPECT_NEAR(n.norm(), 1, 1e-12);
      if (side == 3) on_bottom[0] -= force * n.x(), on_bottom[1] -= force * n.y();
      if (j == 0) {
        ++planes;
        continue;
      }
      EXPECT_EQ(side, frame.type[j - 1]);
      EXPECT_TRUE(pairs.emplace(std::pair(i, j), overlap).second) << line;
      const auto at = [&](std::size_t p) {
        return frame.position.col(static_cast<Eigen::Index>(p) - 1);
      };
      Eigen::Vector3d r = at(i) - at(j);
      r.z() = std::remainder(r.z(), frame.edges(2, 2));
      EXPECT_LT((r - (1 - overlap) * d * n).norm(), 1e-12 * d) << line;
    }
    std::size_t touching = 0;
    for (std::size_t i = 0; i < frame.grains; ++i) {
      for (std::size_t j = i + 1; j < frame.particles(); ++j) {
        Eigen::Vector3d r = frame.position.col(static_cast<Eigen::Index>(i)) -
                            frame.position.col(static_cast<Eigen::Index>(j));
        r.z() = std::remainder(r.z(), frame.edges(2, 2));
        if (r.norm() < d) ++touching;
      }
    }
    EXPECT_EQ(pairs.size(), touching);
    EXPECT_GT(touching, 400U);
    EXPECT_GE(planes, walls == WallTexture::smooth ? 50U : 0U);
    for (const auto& [name, value] : frame.scalars) {
      if (!name.starts_with("force_bottom_")) continue;
      EXPECT_NEAR(on_bottom[name == "force_bottom_x_N" ? 0 : 1], value, 1e-12 * k * d) << name;
    }
    EXPECT_NE(on_bottom[1], 0);
  }
}

/// An export as a start: the grains alone, with the planes of their cell.
void expect_the_checkpoint(const fs::path& file, const PackingFacts& facts) {
  SCOPED_TRACE(file);
  const Checkpoint c = checkpoints().front();
  const PackingFile packing = read_packing(read_bytes(file), file.string(), facts);
  ASSERT_EQ(packing.position.cols(), c.state.position.cols());
  Eigen::Matrix3Xd moved = packing.position - c.state.position;
  const Eigen::RowVectorXd periods = moved.row(2) / c.cell.depth;  // z is wrapped
  EXPECT_LT((periods.array() - periods.array().round()).abs().maxCoeff(), 1e-13);
  moved.row(2).setZero();
  EXPECT_LT(moved.cwiseAbs().maxCoeff(), 1e-13);
  ASSERT_TRUE(packing.velocity && packing.box);
  EXPECT_LT((*packing.velocity - c.state.velocity).cwiseAbs().maxCoeff(), 1e-12);
  const Eigen::Vector3d low(0, c.state.wall_height, 0);
  EXPECT_LT((packing.box->min() - low).norm(), 1e-13);
  EXPECT_LT((packing.box->max() - Eigen::Vector3d(c.cell.width, c.cell.top, c.cell.depth)).norm(),
            1e-12);
}

TEST(Export, IsReadBackAsAStart) {
  const TemporaryFolder folder;
  const fs::path& at = folder.path();
  const std::vector<Checkpoint> all = checkpoints();
  const ExportedState upright = frame_of(all.front(), {}, about()),
                      tilted = frame_of(all.back(), {}, about());
  extxyz_writer(at / "d.xyz", LengthUnit::d)(upright);
  extxyz_writer(at / "m.xyz", LengthUnit::m)(upright);
  lammps_writer(at)(upright);
  const PackingFacts facts{.diameter_m = upright.radius * 2, .largest_overlap = 0.25};
  expect_the_checkpoint(at / "d.xyz", facts);
  expect_the_checkpoint(at / "m.xyz", facts);
  expect_the_checkpoint(at / "frame_3.data", facts);
  extxyz_writer(at / "tilted.xyz", LengthUnit::m)(tilted);
  lammps_writer(at)(tilted);
  for (const char* name : {"tilted.xyz", "frame_3.25.data"}) {
    expect_refused<ManifestError>([&] { read_packing(read_bytes(at / name), name, facts); },
                                  {"the box is not orthogonal", "at the end of a cycle"});
  }
}

TEST(Export, WallGrainsMoveWithTheShearOfTheirRun) {
  const Parameters parameters;
  shearcell::Run run = about();
  run.stage.kind = name_of(StageKind::shear);
  run.stage.resolved = last_stage(parameters, 1, prepare_stage(parameters, 1)).resolved;
  const Checkpoint checkpoint = checkpoints().front();  // upright, at the largest shear rate
  CheckpointRecord record = record_of(checkpoint);
  record.step = checkpoint.state.step;
  const ExportedState frame = frame_of(checkpoint, record, run);
  for (const auto& [key, value] : frame.parameters) {
    EXPECT_NE(key, "max_overlap_diameters") << "its record is a constant";
  }
  const double rate = 2 * std::numbers::pi / parameters.period_s * parameters.amplitude_rad;
  const double d = checkpoint.units.diameter_m;
  const double top = wall_pose(checkpoint.cell, 0, checkpoint.state.wall_height).top * d;
  const double bottom = checkpoint.state.wall_height * d;
  ASSERT_GT(frame.particles(), frame.grains);
  for (std::size_t i = frame.grains; i < frame.particles(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const bool on_top = frame.type[i] == 1 + static_cast<int>(WallSide::top);
    const bool below = frame.type[i] == 1 + static_cast<int>(WallSide::bottom);
    const double y = below ? bottom : frame.position(1, column);
    EXPECT_NEAR(frame.velocity(0, column), on_top ? 0.0 : (y - top) * rate, 1e-12);
    EXPECT_EQ(frame.velocity(1, column), below ? checkpoint.state.wall_velocity * d : 0.0);
  }
}

TEST(Export, WritesTheSameBytesTwice) {
  const TemporaryFolder folder;
  ExportedState frame = frame_of(checkpoints().back(), {}, about());
  for (int k = 0; k < 20; ++k) frame.parameters.emplace_back("key_" + std::to_string(k), 0.5 * k);
  std::string bytes[2];
  for (int k = 0; k < 2; ++k) {
    const fs::path file = folder.path() / ("run" + std::to_string(k) + ".h5");
    h5md_writer(file, 1)(frame);
    bytes[k] = read_bytes(file);
  }
  EXPECT_FALSE(bytes[0].empty());
  EXPECT_EQ(bytes[0], bytes[1]);
}

// NaN has no whole number. A sanitizer of float-cast-overflow reports it if it is converted.
TEST(Export, OnlyWholeNumbersAreConvertedToThem) {
  const TemporaryFolder folder;
  const ExportedState frame = frame_of(checkpoints().front());
  bool unknown = false;
  for (const ExportedColumn& column : frame.columns) {
    for (const double value : column.values) {
      unknown |= std::isnan(value);
      if (column.whole) {
        EXPECT_EQ(value, std::floor(value)) << column.name;
      }
    }
  }
  EXPECT_TRUE(unknown) << "the displacement since an earlier checkpoint";
  vtk_writer(folder.path(), 1)(frame);
  h5md_writer(folder.path() / "frame.h5", 1)(frame);
}

TEST(Export, CloseCheckpointsHaveSeparateFiles) {
  const TemporaryFolder folder;
  ExportedState frame = frame_of(checkpoints().back(), {}, about());
  const FrameWriter writers[] = {vtk_writer(folder.path(), 2), lammps_writer(folder.path())};
  for (const double cycle : {100.00002, 100.00004}) {
    frame.checkpoint.cycle = cycle;
    for (const FrameWriter& write : writers) write(frame);
  }
  for (const char* name : {"grains_100.00002.vtp", "cell_100.00004.vtp", "frame_100.00004.data"}) {
    EXPECT_TRUE(fs::exists(folder.path() / name)) << name;
  }
}

TEST(Export, CallsTheScaleOfAManifestWithoutScalesBase) {
  const TemporaryFolder folder;
  shearcell::Run run = about();
  run.place.scale.clear();  // a manifest without scales
  extxyz_writer(folder.path() / "run.xyz", LengthUnit::d)(frame_of(checkpoints().back(), {}, run));
  const std::string text = read_bytes(folder.path() / "run.xyz");
  EXPECT_TRUE(has(text, " experiment=\"drag\" scale=\"base\" variant="));
}

TEST(Export, HasOnlyKeysOfAManifest) {
  shearcell::Run run = about();
  run.stage.resolved["parameters"]["forged=1\n99\n"] = 1;
  for (const auto& [key, value] : frame_of(checkpoints().back(), {}, run).parameters) {
    EXPECT_FALSE(has(key, "forged"));
  }
}

TEST(Export, ReportsWhatItCannotWrite) {
  const ExportedState frame = frame_of(checkpoints().front());
  EXPECT_THROW(extxyz_writer("/nowhere/run.xyz", LengthUnit::m)(frame), std::runtime_error);
  EXPECT_THROW(h5md_writer("/nowhere/run.h5", 1), std::runtime_error);
  EXPECT_THROW(vtk_writer("/nowhere", 1)(frame), std::runtime_error);
  EXPECT_THROW(lammps_writer("/nowhere")(frame), std::runtime_error);
  const TemporaryFolder folder;
  const FrameWriter one = h5md_writer(folder.path() / "run.h5", 1);
  one(frame);
  EXPECT_THROW(one(frame), std::runtime_error);
}

TEST(Export, EachCheckpointOfAPackingHasAFile) {
  const TemporaryFolder folder;
  Checkpoint packing = checkpoints().front();
  packing.cycle = 0;
  const FrameWriter vtk = vtk_writer(folder.path(), 2), lammps = lammps_writer(folder.path());
  for (const std::uint64_t step : {45600U, 54720U}) {
    packing.state.step = step;
    const ExportedState frame = frame_of(packing);
    vtk(frame);
    lammps(frame);
    for (const std::string file : {"grains_step{}.vtp", "cell_step{}.vtp", "frame_step{}.data"}) {
      EXPECT_TRUE(fs::exists(folder.path() / fmt::format(fmt::runtime(file), step))) << file;
    }
  }
}

}  // namespace
}  // namespace shearcell::test
