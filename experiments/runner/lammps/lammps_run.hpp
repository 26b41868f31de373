// SPDX-License-Identifier: GPL-3.0-or-later
// Runs LAMMPS for one task, in a temporary folder, alone or under mpirun.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "experiments/runner/lammps/lammps_deck.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/file.hpp"

namespace shearcell {

struct LammpsProgram {
  std::string path;
  std::string version;  ///< "29 Sep 2021 - Update 2"
};

/// Name of the program: $SHEARCELL_LAMMPS, or "lmp".
std::string lammps_name();

/// Finds the program lammps_name(), in PATH if the name has no slash. Throws ProgramError if the
/// program does not exist, does not answer or lacks the package GRANULAR, or if `ranks` is above 1
/// and mpirun does not exist. Throws Interrupted if the program does not answer and a stop is
/// requested.
LammpsProgram find_lammps(std::size_t ranks = 1);

/// Number of steps after which LAMMPS checks for a stop request and logs its progress: about half a
/// second of work.
std::uint64_t lammps_check_steps(std::size_t grains, std::size_t ranks);

/// Starts LAMMPS in `folder` with `ranks` processes, under mpirun if there are several. Throws
/// ProgramError.
std::unique_ptr<ChildProcess> start_lammps(const LammpsProgram& program, const LammpsTask& task,
                                           const std::filesystem::path& folder, std::size_t ranks);

class LammpsRun {
 public:
  /// Starts LAMMPS in a temporary folder with start_lammps().
  LammpsRun(const LammpsProgram& program, const LammpsTask& task, std::size_t ranks);

  /// Waits at most `patience` for the next frame. Returns nothing if none was written by then.
  /// Throws ProgramError, with the message of LAMMPS, if LAMMPS has ended without another frame.
  std::optional<State> next_frame(std::chrono::milliseconds patience);

  /// Asks LAMMPS to write one more frame and end.
  void ask_to_stop();

  /// The newest step in LAMMPS's log.
  std::uint64_t step();

  /// Processor time of LAMMPS [s]; empty under mpirun, because the time is then not accessible.
  std::optional<double> core_seconds() const {
    return ranks_ > 1 ? std::nullopt : std::optional(process_->core_seconds());
  }

 private:
  std::optional<State> take_frame();
  [[noreturn]] void fail(int code) const;

  TemporaryFolder folder_;
  std::size_t grains_;
  std::size_t ranks_;
  std::uint64_t step_;
  std::unique_ptr<ChildProcess> process_;  // last member: destroyed before folder_
};

}  // namespace shearcell
