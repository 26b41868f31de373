// SPDX-License-Identifier: GPL-3.0-or-later
// A campaign of a fraction of a second, run by the program under faults and kills, and what must
// hold of the store afterwards.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace shearcell::test {

/// 60 grains between smooth walls: a packing and two sheared runs of it, some 20 events.
std::string small_manifest(const std::string& more = "");

struct Fault {
  long at = 0;  ///< number of the file operation, from 1; 0 for none
  std::string kind;
};

using Words = std::vector<std::string>;

/// Starts `shearcell WORDS --store FOLDER/store`, with the fault layer when a fault is named.
pid_t start_program(const std::filesystem::path& folder, Words words, const Fault& fault);

/// `run` of the manifest in the folder.
pid_t start_campaign(const std::filesystem::path& folder, const Fault& fault);

/// Waits for it: the exit code, or minus the signal that ended it.
int wait_for_exit(pid_t program);

/// Runs it to its end under the fault layer; the operations that it did on the store, one a line.
std::vector<std::string> list_operations(const std::filesystem::path& folder, const Words& words);
std::vector<std::string> list_operations(const std::filesystem::path& folder);

/// Every way in which each of the operations may go wrong.
std::vector<Fault> fault_points(const std::vector<std::string>& operations);

/// What must hold of the store as a fault left it: it opens, `verify` finds no error, and every
/// recorded checkpoint is there. Each thing that does not hold is a line.
std::vector<std::string> check_left_behind(const std::filesystem::path& folder);

/// Runs on, undisturbed, and gives the final state hash of each run; "" for runs that do not
/// complete.
std::map<std::string, std::string> run_on(const std::filesystem::path& folder);

}  // namespace shearcell::test
