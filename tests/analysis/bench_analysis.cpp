// SPDX-License-Identifier: GPL-3.0-or-later
// How long the analysis of one checkpoint takes, beside voro++ on the same packing.
//
// The packing is jammed, with rough walls. Cells are compared with voro++ before anything is timed.
// Each time is the best of several runs on one thread, in turn, so that a busy moment of the
// machine hurts both. voro++ gets the best of three block sizes. The times of reading checkpoints
// are not in those of `motion`. Memory is the rise of the process's peak, for one analysis and then
// for several at once. Usage: bench_analysis [grains [at once]]
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <latch>
#include <thread>
#include <vector>

#include "analysis/measures.hpp"
#include "analysis/voronoi.hpp"
#include "tests/analysis/oracles.hpp"
#include "tests/analysis/packings.hpp"

namespace {

template <typename Work>
double seconds(Work&& work) {
  const double start = shearcell::test::thread_seconds();
  work();
  return shearcell::test::thread_seconds() - start;
}

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

void analyse_at_once(const shearcell::Checkpoint& p, int count) {
  std::latch start(count);
  std::vector<std::jthread> threads;
  for (int k = 0; k < count; ++k) {
    threads.emplace_back([&] {
      start.arrive_and_wait();
      shearcell::analyse(p);
    });
  }
}

/// Best of three for each result that can be kept, beyond the analysis that they share.
void time_measures(const shearcell::test::Packing& packing) {
  using namespace shearcell;
  shearcell::test::Packing before = packing;
  shearcell::test::jitter(before, 0.05, 2);
  const Checkpoint earlier = shearcell::test::checkpoint_of(before);
  const Checkpoint checkpoint = shearcell::test::checkpoint_of(packing);
  const Analysis analysis = analyse(checkpoint);
  const MeasureInput input{&analysis, &checkpoint, [&] { return &earlier; }};
  std::printf("%-18s %s\n", "measure", "beyond the analysis [s]");
  for (const Provider& one : all_providers()) {
    if (one.from != ComputedFrom::checkpoint) continue;
    double best = 1e9;
    for (int k = 0; k < 3; ++k) best = std::min(best, seconds([&] { one.compute(input); }));
    std::printf("%-18s %.4f\n", one.name.c_str(), best);
  }
}

}  // namespace

int main(int argc, char** argv) {
  using namespace shearcell;
  const int grains = argc > 1 ? std::atoi(argv[1]) : 18200;
  const int at_once = argc > 2 ? std::atoi(argv[2]) : 4;
  if (grains < 1 || at_once < 1) {
    std::fprintf(stderr, "usage: bench_analysis [grains [at once]]\n");
    return 2;
  }
  const test::Packing p = test::jammed(grains, true, 0, 1);
  const Checkpoint checkpoint = test::checkpoint_of(p);
  double own = 1e9;
  double whole = 1e9;
  double peer = 1e9;
  const double before = peak_memory_mb();
  whole = seconds([&] { analyse(checkpoint); });
  const double memory = peak_memory_mb();
  analyse_at_once(checkpoint, at_once);
  const double memory_at_once = peak_memory_mb();

  double worst = 0;
  const VoronoiDiagram diagram = voronoi(p.cell, p.pose, p.grains);
  const std::vector<test::VoroCell> cells = test::voro_cells(p);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    worst = std::max(worst, std::abs(cells[i].volume - diagram.volume[i]));
  }
  if (!(worst < 1e-9)) {
    std::fprintf(stderr, "volumes differ from voro++ by %g\n", worst);
    return 1;
  }
  for (int k = 0; k < 11; ++k) {
    own = std::min(own, seconds([&] { voronoi(p.cell, p.pose, p.grains); }));
    whole = std::min(whole, seconds([&] { analyse(checkpoint); }));
    for (const double block : {4.0, 6.0, 8.0}) {
      peer = std::min(peer, test::time_voro(p, block));
    }
  }
  std::printf("grains %d, wall grains %zu, volumes agree within %.1e d^3\n", grains,
              p.cell.wall_grains.size(), worst);
  std::printf("voronoi %.4f s, voro++ %.4f s, ratio %.2f\n", own, peer, own / peer);
  std::printf("whole analysis %.4f s; memory %.0f MB, of which %.0f MB before it\n", whole, memory,
              before);
  std::printf("%d at once: memory %.0f MB, %.0f MB for each\n", at_once, memory_at_once,
              (memory_at_once - before) / at_once);
  time_measures(p);
  return 0;
}
