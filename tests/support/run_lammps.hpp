// SPDX-License-Identifier: GPL-3.0-or-later
// Runs one task in LAMMPS and waits for its last frame.
#pragma once

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>
#include <utility>

#include "experiments/runner/lammps/lammps_run.hpp"

namespace shearcell {

struct LammpsResult {
  State state;             ///< at the end of the task
  double loop_seconds;     ///< wall time of its time loop, as it printed it
  std::size_t peak_bytes;  ///< memory of the largest process of LAMMPS so far
};

/// The task must ask for one frame, its last. Throws ProgramError.
inline LammpsResult run_lammps(const LammpsProgram& program, const LammpsTask& task,
                               std::size_t ranks) {
  const TemporaryFolder folder;
  const auto process = start_lammps(program, task, folder.path(), ranks);
  const int code = process->wait();
  const std::string log = read_plain(folder.path() / "log", kLargestFile).value_or("");
  if (code != 0) throw ProgramError(fmt::format("LAMMPS ended with code {}: {}", code, log));
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  LammpsResult result{read_lammps_frame(folder.path() / fmt::format("frame.{}", task.end),
                                        static_cast<std::size_t>(task.state.position.cols())),
                      0, static_cast<std::size_t>(used.ru_maxrss) * 1024};
  // "Loop time of T on P procs for S steps with A atoms", once for each run.
  constexpr std::string_view title = "Loop time of ";
  for (auto at = log.find(title); at != log.npos; at = log.find(title, at + 1)) {
    double seconds = 0;
    std::from_chars(log.data() + at + title.size(), log.data() + log.size(), seconds);
    result.loop_seconds += seconds;
  }
  return result;
}

}  // namespace shearcell
