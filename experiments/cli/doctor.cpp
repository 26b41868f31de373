// SPDX-License-Identifier: GPL-3.0-or-later
// `doctor`: checks that the machine has what the program needs, and measures the speed.
#include <fmt/format.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "core/machine.hpp"
#include "experiments/bench/speed.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/runner/host.hpp"
#include "experiments/runner/lammps/lammps_run.hpp"
#include "experiments/runner/outlook.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/clock.hpp"
#include "provenance/words.hpp"

namespace shearcell::cli {
namespace {

namespace fs = std::filesystem;

struct Check {
  std::string what;
  std::string found;
  std::string state;  ///< "ok", "slow", "low", "missing"
  std::string advice;
};

Check vectors(const std::string& simd) {
  if (simd != scalar_kernels().name) return {"vectors", simd, "ok", ""};
  return {"vectors", simd, "slow", "the scalar kernel is 20 times slower than the AVX-512 kernel"};
}

Check memory() {
  double bytes = machine_memory();
  std::ifstream facts("/proc/meminfo");
  for (std::string word; facts >> word;) {
    double kib = 0;
    if (word == "MemAvailable:" && facts >> kib) bytes = std::min(bytes, 1024 * kib);
  }
  return {"memory", format_bytes(bytes) + " free", "ok",
          fmt::format("enough for {:.1e} grains, summed over the runs computed at the same time",
                      bytes / kRunBytesPerGrain)};
}

Check disk(const fs::path& place) {
  const double free = static_cast<double>(fs::space(place).available);
  Geometry shape;  // by default, the walls are rough
  shape.grains = 5200;
  return {"disk", fmt::format("{} free in {}", format_bytes(free), place.string()),
          free > 1e9 ? "ok" : "low",
          free > 0 ? fmt::format("room for {:.0f} checkpoints of 5200 grains",
                                 free / checkpoint_bytes(shape))
                   : ""};
}

Check filesystem(const fs::path& place) {
  struct statfs facts {};
  if (statfs(place.c_str(), &facts) != 0) return {"file system", "unknown", "ok", ""};
  constexpr unsigned long network[] = {0x6969, 0xFF534D42, 0x0BD00BD0,
                                       0x517B, 0x47504653, 0xFE534D42};
  const auto type = static_cast<unsigned long>(facts.f_type);
  if (std::ranges::count(network, type) == 0) {
    return {"file system", fmt::format("local (type {:#x})", type), "ok", ""};
  }
  return {
      "file system", fmt::format("network (type {:#x})", type), "slow",
      "SQLite needs file locks, which are unreliable on a network file system: keep the store on a "
      "local disk, and copy it later with `merge`"};
}

Check writing(const std::string& store, const fs::path& place) {
  if (std::error_code none; fs::exists(store, none) && !fs::is_directory(store, none)) {
    return {"writing", store + " is a file", "missing",
            "a store is a folder; choose a folder with --store"};
  }
  std::string name = (place / "shearcell-doctor-XXXXXX").string();
  const int file = mkstemp(name.data());
  if (file < 0) {
    return {"writing", fmt::format("not possible in {} ({})", place.string(), std::strerror(errno)),
            "missing", "the program cannot write to this folder; choose another with --store"};
  }
  constexpr int count = 10;
  const Stopwatch watch;
  bool written = true;
  for (int k = 0; k < count; ++k)
    written = ::write(file, "x", 1) == 1 && fsync(file) == 0 && written;
  const double ms = 1e3 * watch.seconds() / count;
  close(file);
  fs::remove(name);
  if (!written) return {"writing", "failed in " + place.string(), "missing", "is the disk full?"};
  return {"writing", fmt::format("{:.1f} ms to sync", ms), ms < 100 ? "ok" : "slow",
          "storing a checkpoint needs about six syncs"};
}

Check program(const std::string& name, const std::string& use, const std::string& package) {
  if (const auto file = find_program(name)) return {name, file->string(), "ok", use};
  return {name, "not found", "missing", use + ": apt install " + package};
}

Check speed() {
  bench::SpeedOptions options;
  options.sizes = {2000};
  options.repeats = 3;
  options.seconds_per_repeat = 0.3;
  const std::vector<bench::SpeedResult> results = bench::measure_speed(options);
  const double rate = std::ranges::max(results, {}, &bench::SpeedResult::median_rate).median_rate;
  const double cycle = 5200 * 45600 / (rate * 1e6);
  return {"speed", fmt::format("{:.0f} M particle-steps/s", rate), rate > 20 ? "ok" : "slow",
          fmt::format("on one core, one cycle with 5200 grains takes about {:.1f} s", cycle)};
}

std::vector<Check> examine(const std::string& store, bool with_speed) {
  const nlohmann::json facts = host_facts();
  const nlohmann::json& libraries = facts.at("libraries");
  const auto version = [&](const char* name) { return libraries.at(name).get<std::string>(); };
  const fs::path place = existing_folder(store);
  const std::size_t cores = usable_cores();
  std::vector<Check> found = {{"processor", facts.at("cpu").get<std::string>(), "ok", ""},
                              {"cores", fmt::format("{} usable", cores), "ok",
                               fmt::format("`run` computes {} at a time", counted(cores, "run"))},
                              vectors(facts.at("simd").get<std::string>()),
                              memory(),
                              disk(place),
                              filesystem(place),
                              writing(store, place),
                              {"SQLite", version("sqlite"), "ok", "the log"},
                              {"HDF5", version("hdf5"), "ok", "checkpoints"},
                              program("gnuplot", "draws figures", "gnuplot-nox"),
                              program("rsvg-convert", "figures as PDF", "librsvg2-bin"),
                              program(lammps_name(), "`run --engine lammps`", "lammps")};
  if (with_speed) found.push_back(speed());
  return found;
}

void doctor(const bool& no_speed, Context& context) {
  const std::vector<Check> findings = examine(context.store, !no_speed);
  const auto no_store = [](const Check& f) { return f.what == "writing" && f.state == "missing"; };
  if (std::ranges::any_of(findings, no_store)) fail(context, kOtherError);
  const auto facts = [](const Check& f) -> Facts {
    return {{"what", f.what, "what"},
            {"state", f.state, ""},
            {"found", f.found, "found"},
            {"advice", f.advice}};
  };
  print_list("findings", list_of(findings, facts), context);
  if (context.json) return;
  fmt::print("\n");
  for (const Check& f : findings) {
    if (!f.advice.empty()) fmt::print("{}: {}\n", f.what, f.advice);
  }
}

}  // namespace

void add_doctor(CLI::App& app, Context& context) {
  const auto [command, no_speed] =
      add_command(app, context, "doctor", "Check this machine and measure its speed", doctor);
  command->add_flag("--no-speed", *no_speed, "Skip the speed measurement (5 seconds)");
  add_common_options(
      *command, context,
      "The exit code is 1 if the program cannot write to the folder given by --store.\n"
      "Examples:\n  shearcell doctor\n  shearcell doctor --store /data/store --json");
}

}  // namespace shearcell::cli
