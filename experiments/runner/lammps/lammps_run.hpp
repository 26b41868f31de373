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

/// The program lammps_name(), on PATH if the name has no slash. Throws ProgramError when there is
/// no such program, when the program lacks the package GRANULAR or does not answer, or when there
/// is no mpirun for several ranks. Throws Interrupted when the program does not answer and a stop
/// is requested.
LammpsProgram find_lammps(std::size_t ranks = 1);

/// Steps between two checks of LAMMPS for a request to stop, and of this program for progress:
/// about half a second of work.
std::uint64_t lammps_check_steps(std::size_t grains, std::size_t ranks);

/// Starts LAMMPS in `folder`, with more than one of `ranks` processes under mpirun. Throws
/// ProgramError.
std::unique_ptr<ChildProcess> start_lammps(const LammpsProgram& program, const LammpsTask& task,
                                           const std::filesystem::path& folder, std::size_t ranks);

class LammpsRun {
 public:
  /// Starts LAMMPS as start_lammps() does.
  LammpsRun(const LammpsProgram& program, const LammpsTask& task, std::size_t ranks);

  /// The next frame; waits for it at most for `patience`. Throws ProgramError with LAMMPS's message
  /// if it ended without one.
  std::optional<State> next_frame(std::chrono::milliseconds patience);

  /// Asks LAMMPS to write one more frame and end.
  void ask_to_stop();

  /// The newest step in LAMMPS's log.
  std::uint64_t step();

  /// Processor time of LAMMPS; nothing under mpirun, whose processes are not ours.
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
  std::unique_ptr<ChildProcess> process_;  // ends before its folder is deleted
};

}  // namespace shearcell
