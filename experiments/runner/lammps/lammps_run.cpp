// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/lammps/lammps_run.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <thread>
#include <vector>

#include "core/drive.hpp"
#include "experiments/runner/stop.hpp"
#include "provenance/io/read_number.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kCheckInterval{20};
constexpr double kHelpSeconds = 10;

std::string last_line(std::string_view text) {
  while (text.ends_with('\n')) text.remove_suffix(1);
  const auto newline = text.rfind('\n');
  return std::string(newline == text.npos ? text : text.substr(newline + 1));
}

// Environment variables for LAMMPS and MPI that are not set yet. Without these variables, Open MPI
// would bind all runs on a machine to the same cores, and waiting processes would keep cores busy.
std::vector<std::string> variables() {
  std::vector<std::pair<std::string, std::string>> all = {
      {"OMP_NUM_THREADS", "1"},
      {"OMPI_MCA_hwloc_base_binding_policy", "none"},
      {"OMPI_MCA_mpi_yield_when_idle", "1"},
      {"OMPI_MCA_rmaps_base_oversubscribe", "1"}};
  if (geteuid() == 0) {
    all.emplace_back("OMPI_ALLOW_RUN_AS_ROOT", "1");
    all.emplace_back("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
  }
  std::vector<std::string> missing;
  for (const auto& [name, value] : all) {
    if (std::getenv(name.c_str()) == nullptr) missing.push_back(name + '=' + value);
  }
  return missing;
}

// "... Massively Parallel Simulator - 29 Sep 2021 - Update 2"
constexpr std::string_view kTitle = "Massively Parallel Simulator - ";

// MPI sometimes fails to start while another MPI program starts, so there are three attempts.
std::string help_of(const fs::path& program, const fs::path& folder) {
  constexpr int kAttempts = 3;
  try {
    for (int attempt = 1;; ++attempt) {
      const auto outcome = run_program({program.string(), "-h"}, folder, {}, kHelpSeconds);
      std::string said = outcome ? outcome->output + outcome->messages : "";
      if (said.find(kTitle) != said.npos || attempt == kAttempts) return said;
    }
  } catch (const ProgramError&) {
    give_up_if_requested();
    throw;
  }
}

}  // namespace

std::string lammps_name() {
  const char* named = std::getenv("SHEARCELL_LAMMPS");
  return named == nullptr || *named == '\0' ? "lmp" : named;
}

LammpsProgram find_lammps(std::size_t ranks) {
  const std::string name = lammps_name();
  const auto path = find_program(name);
  if (!path) {
    throw ProgramError("LAMMPS is not installed: there is no program " + name +
                       ". Install the Debian package lammps, or set "
                       "SHEARCELL_LAMMPS to the path of LAMMPS");
  }
  if (ranks > 1 && !find_program("mpirun")) {
    throw ProgramError("there is no program mpirun; install the Debian package openmpi-bin");
  }
  const TemporaryFolder folder;
  const std::string text = help_of(*path, folder.path());
  const auto at = text.find(kTitle);
  if (at == text.npos) {
    throw ProgramError(path->string() +
                       " is not LAMMPS, or cannot start: the output of -h ends with '" +
                       last_line(text) + "'");
  }
  if (text.find("gran/hooke") == text.npos) {
    throw ProgramError(path->string() + " was built without the package GRANULAR of LAMMPS");
  }
  const auto version = at + kTitle.size();
  return {path->string(), text.substr(version, text.find('\n', version) - version)};
}

std::uint64_t lammps_check_steps(std::size_t grains, std::size_t ranks) {
  return std::max<std::uint64_t>(1, 3'000'000 * ranks / std::max<std::size_t>(1, grains));
}

std::unique_ptr<ChildProcess> start_lammps(const LammpsProgram& program, const LammpsTask& task,
                                           const fs::path& folder, std::size_t ranks) {
  const WallPose pose =
      wall_pose(task.cell, tilt(task.drive, task.state.step).theta, task.state.wall_height);
  write_output(folder / "scene.data",
               lammps_data(particles_of(task.cell, pose, task.state, 0, task.units),
                           "by shearcell: lengths in d, masses in m, times in s"));
  write_output(folder / "deck.in", lammps_deck(task));
  std::vector<std::string> words = {program.path, "-in",     "deck.in", "-log",
                                    "log",        "-screen", "none"};
  if (ranks > 1) words.insert(words.begin(), {"mpirun", "-np", std::to_string(ranks)});
  const fs::path file = folder / "said";
  const Descriptor said(open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  if (!said.valid()) throw ProgramError("cannot write " + file.string());
  return std::make_unique<ChildProcess>(
      Command{words, folder, variables(), said.get(), said.get()});
}

LammpsRun::LammpsRun(const LammpsProgram& program, const LammpsTask& task, std::size_t ranks)
    : grains_(static_cast<std::size_t>(task.state.position.cols())),
      ranks_(ranks),
      step_(task.state.step) {
  process_ = start_lammps(program, task, folder_.path(), ranks);
}

std::optional<State> LammpsRun::take_frame() {
  constexpr std::string_view prefix = "frame.";
  std::uint64_t first = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path())) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix)) continue;
    const auto step =
        read_number<std::uint64_t>(std::string_view(name).substr(prefix.size())).value_or(0);
    if (step != 0 && (first == 0 || step < first)) first = step;
  }
  if (first == 0) return std::nullopt;
  const fs::path file = folder_.path() / fmt::format("{}{}", prefix, first);
  State state = read_lammps_frame(file, grains_);
  if (state.step != first) throw ProgramError(file.string() + " contains a different step");
  fs::remove(file);
  step_ = std::max(step_, first);
  return state;
}

std::optional<State> LammpsRun::next_frame(std::chrono::milliseconds patience) {
  const auto until = std::chrono::steady_clock::now() + patience;
  for (;;) {
    // The exit code is read before take_frame(), so that a frame that LAMMPS writes just before its
    // end is not missed.
    const auto code = process_->exit_code();
    if (auto state = take_frame()) return state;
    if (code) fail(*code);
    if (std::chrono::steady_clock::now() >= until) return std::nullopt;
    std::this_thread::sleep_for(kCheckInterval);
  }
}

void LammpsRun::ask_to_stop() {
  write_output(folder_.path() / "stop", "");
}

std::uint64_t LammpsRun::step() {
  std::ifstream log(folder_.path() / "log", std::ios::binary);
  if (!log.seekg(-64, std::ios::end)) return step_;
  // LAMMPS logs step numbers and messages. If the last complete line is a number, it is the step.
  std::string tail(64, '\0');
  log.read(tail.data(), 64);
  tail.resize(tail.rfind('\n') == tail.npos ? 0 : tail.rfind('\n'));
  std::string line = last_line(tail);
  line.erase(std::remove(line.begin(), line.end(), ' '), line.end());
  step_ = std::max(step_, read_number<std::uint64_t>(line).value_or(0));
  return step_;
}

void LammpsRun::fail(int code) const {
  const std::string log = read_plain(folder_.path() / "log", kLargestFile).value_or("");
  const std::string said = read_plain(folder_.path() / "said", kLargestFile).value_or("");
  std::string why;
  for (const std::string* text : {&log, &said}) {
    const auto at = text->find("ERROR");
    if (at != text->npos && why.empty()) why = text->substr(at, text->find('\n', at) - at);
  }
  if (why.empty()) why = last_line(said.empty() ? log : said);
  throw ProgramError(fmt::format("LAMMPS{} ended with code {} near step {}: {}",
                                 ranks_ > 1 ? fmt::format(" on {} processes", ranks_) : "", code,
                                 step_, why.empty() ? "no message" : why));
}

}  // namespace shearcell
