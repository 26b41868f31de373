// SPDX-License-Identifier: GPL-3.0-or-later
// Times the store with 100 runs of 100 checkpoints: bench_store [RUNS] [CHECKPOINTS] [FOLDER].
//
// Each number is the time of the call that a command of the program makes, including the opening of
// the store; the slowest of three if it can be repeated. Every result is checked before its time is
// printed. The store is removed afterwards, unless FOLDER is given.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <vector>

#include "provenance/event_log.hpp"
#include "provenance/io/clock.hpp"
#include "tests/provenance/samples.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;

double seconds(const std::function<void()>& work) {
  const Stopwatch watch;
  work();
  return watch.seconds();
}

double slowest_of_three(const std::function<void()>& work) {
  double slowest = 0;
  for (int i = 0; i < 3; ++i) slowest = std::max(slowest, seconds(work));
  return slowest;
}

void require(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(std::string("not as it must be: ") + what);
}

/// Seconds that each recorded checkpoint took: file, event and all syncs.
std::vector<double> fill(const fs::path& folder, int runs, int checkpoints) {
  Store store(folder, Access::create);
  const std::string manifest = store.register_manifest("bench: 1\n", "bench.yaml", {});
  std::vector<double> took;
  for (int r = 0; r < runs; ++r) {
    Stage run = test::sample_run(r);
    run.memberships[0].ask.target_cycles = static_cast<std::uint64_t>(checkpoints) - 1;
    run.memberships[0].place.manifest = manifest;
    store.declare_stage(run);
    store.start_stage(run.id, {{"host", "bench"}});
    for (int c = 0; c < checkpoints; ++c) {
      const auto step = static_cast<std::uint64_t>(c) * test::kCycle;
      const Checkpoint checkpoint = test::sample_checkpoint(run.id, step);
      took.push_back(seconds([&] { store.record_checkpoint(run.id, checkpoint, {1, 1}); }));
    }
    store.complete_stage(run.id, {}, run.memberships[0].ask.target_cycles);
  }
  return took;
}

/// What the disk takes for the least that a durable append could do.
void sync_one_page(const fs::path& path) {
  const std::vector<char> page(4096, 'x');
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  require(file >= 0 && write(file, page.data(), page.size()) == 4096 && fsync(file) == 0, "a file");
  close(file);
}

void print_time(const char* what, double value, const char* unit, double limit) {
  fmt::print("{:<52} {:9.3f} {:<3} (limit {:g}{})\n", what, value, unit, limit,
             value < limit ? "" : ": OVER");
}

void measure(const fs::path& folder, int runs, int checkpoints) {
  std::vector<double> took = fill(folder, runs, checkpoints);
  std::sort(took.begin(), took.end());
  print_time("recording a checkpoint, file and syncs, median", 1e3 * took[took.size() / 2], "ms",
             20);
  print_time("the same, 99th percentile", 1e3 * took[took.size() * 99 / 100], "ms", 20);

  std::vector<double> each, plain;
  {
    Store store(folder, Access::write);
    const fs::path probe = folder / "probe";
    for (int i = 0; i < 300; ++i) {
      each.push_back(seconds([&] {
        store.record("figure/bench", {"FigureGenerated", {{"i", i}}});
      }));
      plain.push_back(seconds([&] { sync_one_page(probe); }));
    }
    fs::remove(probe);
  }
  std::sort(each.begin(), each.end());
  std::sort(plain.begin(), plain.end());
  print_time("appending an event, with its syncs, median", 1e3 * each[150], "ms", 20);
  print_time("the same, 99th percentile", 1e3 * each[297], "ms", 20);
  fmt::print("{:<52} {:9.3f} ms\n", "  one write and fsync of 4 kB at the same time, median",
             1e3 * plain[150]);

  print_time("status: open, all runs, who holds them", slowest_of_three([&] {
               const Store store(folder, Access::read);
               require(store.stages().size() == static_cast<std::size_t>(runs), "the runs");
               require(store.leases().empty(), "no leases");
             }),
             "s", 0.5);

  print_time("verify: the chain alone", slowest_of_three([&] {
               sqlite::Database database = open_database(folder / "store.sqlite", Access::read);
               require(!EventLog(database).verify_chain(), "the chain");
             }),
             "s", 2);

  VerifyReport report;
  const double all = slowest_of_three([&] { report = Store(folder, Access::read).verify(); });
  require(report.ok() && report.checkpoints == took.size(), "the store");
  const double reading = slowest_of_three([&] {
    for (const auto& entry : fs::recursive_directory_iterator(folder / "objects")) {
      if (entry.is_regular_file()) sha256_hex(test::read_bytes(entry.path()));
    }
  });
  print_time("verify: chain, tables and every file hashed", all, "s", 2 + reading);
  fmt::print("{:<52} {:9.3f} s\n", "  of which reading and hashing the files alone takes", reading);

  print_time("rebuild", slowest_of_three([&] { Store(folder, Access::write).rebuild(); }), "s", 5);
  require(Store(folder, Access::read).verify().ok(), "the store after rebuild");
  fmt::print("{} events, {} checkpoints ({:.0f} MB), log {:.1f} MB\n", report.events,
             report.checkpoints, static_cast<double>(report.bytes) * 1e-6,
             static_cast<double>(fs::file_size(folder / "store.sqlite")) * 1e-6);
}

}  // namespace
}  // namespace shearcell

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::atoi(argv[1]) : 100;
  const int checkpoints = argc > 2 ? std::atoi(argv[2]) : 100;
  const std::filesystem::path folder =
      argc > 3 ? argv[3] : std::filesystem::temp_directory_path() / "shearcell-bench-store";
  if (runs < 1 || checkpoints < 1 || std::filesystem::exists(folder)) {
    fmt::print(stderr, "usage: bench_store [RUNS] [CHECKPOINTS] [FOLDER]; {} must not exist\n",
               folder.string());
    return 2;
  }
  int code = 0;
  try {
    shearcell::measure(folder, runs, checkpoints);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_store: {}\n", error.what());
    code = 1;
  }
  if (argc <= 3) std::filesystem::remove_all(folder);
  return code;
}
