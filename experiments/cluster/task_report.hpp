// SPDX-License-Identifier: GPL-3.0-or-later
// The progress of a task, in a small file beside its store. No other machine opens the store
// itself while the task runs, because SQLite's locks may not work between machines.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "provenance/records.hpp"

namespace shearcell {

struct ReportedRun {
  RunState state = RunState::declared;
  double cycle = 0;
};

/// Puts `FOLDER.progress.json` there, whole or not at all, for the task's store FOLDER.
void write_task_report(const std::filesystem::path& folder, const std::vector<RunRecord>& runs);

/// By run id; empty when there is no such file or it cannot be understood.
std::map<std::string, ReportedRun> read_task_report(const std::filesystem::path& folder);

}  // namespace shearcell
