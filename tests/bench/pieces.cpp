// SPDX-License-Identifier: GPL-3.0-or-later
// Google Benchmark of the pieces of a time step and of a checkpoint, each on one packing:
//   cmake --build --preset release --target bench_pieces && build/release/tests/bench/bench_pieces
#include <benchmark/benchmark.h>

#include <filesystem>
#include <map>

#include "core/diagnostics.hpp"
#include "core/simulation.hpp"
#include "experiments/manifest/conversion.hpp"
#include "protocols/settle.hpp"
#include "provenance/store.hpp"

namespace shearcell {
namespace {

struct Packing {
  Cell cell;
  State state;
  Scene scene;
};

const Packing& packing(std::size_t grains) {
  static std::map<std::size_t, Packing> made;
  const auto [at, is_new] = made.try_emplace(grains);
  if (is_new) {
    Parameters parameters;
    parameters.grains = grains;
    at->second.cell = make_cell(geometry(parameters), 1);
    const State loose = fill_cell(at->second.cell, geometry(parameters), 1);
    at->second.state = pressed(at->second.cell, loose, settle_scene(parameters), {});
    at->second.scene = shear_scene(parameters);
  }
  return at->second;
}

// Everything that the kernels need, laid out as Simulation does.
struct Arrays {
  const Packing& from;
  const Kernels& kernels;
  std::size_t grains;
  WallPose pose;
  ListSettings settings;
  Walls walls;
  Team team{1};
  NeighbourLists lists;
  CellOrder order;
  AlignedVector<double> rows, next;
  std::array<AlignedVector<double>, 3> velocity;
  std::vector<double> push;
  std::vector<std::int32_t> id;
  std::vector<Site> sites;

  Arrays(std::size_t n, Simd simd)
      : from(packing(n)),
        kernels(*find_kernels(simd)),
        grains(n),
        pose(wall_pose(from.cell, 0, from.state.wall_height)),
        walls(from.cell),
        lists(kernels, settings, from.cell.depth, walls, team),
        rows(4 * (padded(n) + 1 + walls.size()), 0.0),
        next(rows.size(), 0.0),
        push(padded(n)) {
    for (std::size_t g = n; g < padded(n); ++g) rows[4 * g] = 1e30;
    rows[4 * padded(n)] = -1e30;
    for (auto& axis : velocity) axis.assign(padded(n), 0.0);
    lay_in_cell_order();
    make_lists();
  }

  Snapshot now() {
    Snapshot snapshot;
    snapshot.rows = rows.data();
    for (std::size_t axis = 0; axis < 3; ++axis) snapshot.velocity[axis] = velocity[axis].data();
    snapshot.grains = grains;
    snapshot.pose = pose;
    snapshot.time_step = from.scene.time_step;
    return snapshot;
  }

  void write_rows() {
    for (std::size_t g = 0; g < grains; ++g) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        rows[4 * g + axis] = from.state.position(static_cast<Eigen::Index>(axis), id[g]);
      }
    }
  }

  void lay_in_cell_order() {
    for (std::size_t g = 0; g < grains; ++g) id.push_back(static_cast<std::int32_t>(g));
    write_rows();
    sort_sites();
    std::vector<std::int32_t> sorted;
    const auto first = static_cast<std::int32_t>(walls.active().size());
    for (const std::int32_t site : order.site()) {
      if (site >= first) sorted.push_back(site - first);
    }
    id = sorted;
    write_rows();
  }

  void sort_sites() {
    lists.set_outer_margins(now());
    walls.choose_active(pose, 3);
    sites.clear();
    for (const std::int32_t w : walls.active()) sites.push_back({wall_offset(grains) + 4 * w, w});
    for (std::size_t g = 0; g < grains; ++g) {
      sites.push_back(
          {static_cast<std::int32_t>(4 * g), static_cast<std::int32_t>(walls.size()) + id[g]});
    }
    order.build(from.cell, pose, 1 + 2 * settings.widest_margin(), rows.data(), sites);
  }

  void make_lists() {
    sort_sites();
    lists.build(now(), id, order);
  }

  StepTask step_task() {
    StepTask task;
    task.grains = grains;
    task.rows = rows.data();
    task.next_rows = next.data();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      task.velocity[axis] = velocity[axis].data();
      task.reference[axis] = lists.reference().data(axis);
    }
    task.neighbours = lists.rows();
    const auto planes = walls.planes(pose);
    std::copy(planes.begin(), planes.end(), task.planes);
    task.moving_wall_force_y = push.data();
    task.depth = from.cell.depth;
    task.per_depth = 1 / from.cell.depth;
    task.velocity_factor = 0.5;  // velocities stay finite over any number of repeats
    task.contact_kick = from.scene.time_step * from.scene.stiffness;
    task.time_step = from.scene.time_step;
    task.frame_height = pose.top;
    return task;
  }
};

Arrays arrays(const benchmark::State& state) {
  return {static_cast<std::size_t>(state.range(0)), static_cast<Simd>(state.range(1))};
}

void count_grains(benchmark::State& state) {
  state.SetItemsProcessed(state.iterations() * state.range(0));
}

bool lacks_instructions(benchmark::State& state) {
  if (find_kernels(static_cast<Simd>(state.range(1))) != nullptr) return false;
  state.SkipWithError("this machine lacks the instructions");
  return true;
}

void step(benchmark::State& state) {
  if (lacks_instructions(state)) return;
  Arrays a = arrays(state);
  const StepTask task = a.step_task();
  const std::size_t blocks = (a.grains + a.kernels.lanes - 1) / a.kernels.lanes;
  for (auto _ : state) benchmark::DoNotOptimize(a.kernels.step[1][0](task, 0, blocks));
  count_grains(state);
}

void search(benchmark::State& state) {
  if (lacks_instructions(state)) return;
  Arrays a = arrays(state);
  for (auto _ : state) a.make_lists();
  count_grains(state);
}

void prune(benchmark::State& state) {
  if (lacks_instructions(state)) return;
  Arrays a = arrays(state);
  for (auto _ : state) benchmark::DoNotOptimize(a.lists.prune(a.now()));
  count_grains(state);
}

void place_walls(benchmark::State& state) {
  Arrays a = arrays(state);
  for (auto _ : state) {
    a.walls.place(a.pose, a.rows.data() + wall_offset(a.grains));
    benchmark::ClobberMemory();
  }
  count_grains(state);
}

void watchdog(benchmark::State& state) {
  const Packing& from = packing(static_cast<std::size_t>(state.range(0)));
  Simulation simulation(from.cell, from.scene, from.state);
  simulation.advance(Drive{}, 1);
  for (auto _ : state) simulation.check();
  count_grains(state);
}

void encode(benchmark::State& state) {
  const Packing& from = packing(static_cast<std::size_t>(state.range(0)));
  Checkpoint checkpoint;
  checkpoint.run = std::string(64, '0');
  checkpoint.cell = from.cell;
  checkpoint.state = from.state;
  for (auto _ : state) benchmark::DoNotOptimize(encode_checkpoint(checkpoint));
  count_grains(state);
}

// A checkpoint through the store, every sync included; `share` is of the time of one cycle of Table
// I at 100 million particle-steps/s.
void record(benchmark::State& state) {
  namespace fs = std::filesystem;
  const Packing& from = packing(static_cast<std::size_t>(state.range(0)));
  const fs::path folder = fs::temp_directory_path() / "shearcell-bench-store";
  fs::remove_all(folder);
  Store store(folder, Access::create);
  RunDeclaration run;
  run.id = std::string(64, 'a');
  run.kind = "shear";
  store.declare_run(run);
  store.start_run(run.id, {});
  Checkpoint checkpoint;
  checkpoint.run = run.id;
  checkpoint.cell = from.cell;
  checkpoint.state = from.state;
  for (auto _ : state) {
    ++checkpoint.state.step;
    store.record_checkpoint(run.id, checkpoint);
  }
  fs::remove_all(folder);
  const double cycle = 45600 * static_cast<double>(state.range(0)) / 1e8;
  state.counters["share"] =
      benchmark::Counter(cycle * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

const std::vector<std::int64_t> kSizes = {600, 5200, 18200};
const std::vector<std::int64_t> kWidths = {static_cast<std::int64_t>(Simd::avx512),
                                           static_cast<std::int64_t>(Simd::avx2),
                                           static_cast<std::int64_t>(Simd::scalar)};
const std::vector<std::string> kNames = {"N", "simd(3=AVX-512,2=AVX2,1=scalar)"};

BENCHMARK(step)->ArgsProduct({kSizes, kWidths})->ArgNames(kNames);
BENCHMARK(search)->ArgsProduct({kSizes, kWidths})->ArgNames(kNames);
BENCHMARK(prune)->ArgsProduct({kSizes, kWidths})->ArgNames(kNames);
BENCHMARK(place_walls)->ArgsProduct({kSizes, {0}})->ArgNames(kNames);
BENCHMARK(watchdog)->ArgsProduct({kSizes})->ArgNames({"N"});
BENCHMARK(record)->ArgsProduct({kSizes})->ArgNames({"N"})->UseRealTime();
BENCHMARK(encode)->ArgsProduct({kSizes})->ArgNames({"N"});

}  // namespace
}  // namespace shearcell

BENCHMARK_MAIN();
