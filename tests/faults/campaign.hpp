// SPDX-License-Identifier: GPL-3.0-or-later
// A campaign of less than a second for tests with faults and kills, and checks of its store.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace shearcell::test {

/// 60 grains between smooth walls: a packing and two sheared runs of it, some 20 events.
std::string small_manifest(const std::string& more = "", std::size_t cycles = 2);

struct Fault {
  long at = 0;  ///< number of the file operation, from 1; 0 for none
  std::string kind;
};

using Words = std::vector<std::string>;

/// Starts `shearcell WORDS --store FOLDER/store` in the folder, with the fault layer if `fault` has
/// a kind. With `reads` the layer also counts operations that read. Standard output is appended to
/// FOLDER/printed, standard error to FOLDER/said.
pid_t start_program(const std::filesystem::path& folder, const Words& words, const Fault& fault,
                    bool reads = false);

/// `run` of the manifest in the folder.
pid_t start_campaign(const std::filesystem::path& folder, const Fault& fault);

/// Waits for it: the exit code, or minus the signal that ended it.
int wait_for_exit(pid_t program);

/// Runs the command under the fault layer without a fault; its operations on the store.
std::vector<std::string> list_operations(const std::filesystem::path& folder, const Words& words,
                                         bool reads = false);

/// Every kind of fault at each of the operations; of those that read, errors alone.
std::vector<Fault> fault_points(const std::vector<std::string>& operations);

/// Checks a store after a fault: it opens, `verify` finds no error, every recorded checkpoint can
/// be loaded, and a program that could still write after it has released its runs. Returns the
/// violations.
std::vector<std::string> check_left_behind(const std::filesystem::path& folder, bool could_write);

}  // namespace shearcell::test
