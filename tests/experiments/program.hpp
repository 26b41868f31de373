// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the built program as a person would, in a folder of its own, and says what came of it.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "tests/experiments/temporary_store.hpp"

namespace shearcell::test {

struct Outcome {
  int code = -1;   ///< exit code, or -1 when a signal ended it
  int signal = 0;  ///< that ended it, or 0
  std::string out;
  std::string err;
};

class ProgramTest : public testing::Test {
 protected:
  using Arguments = std::vector<std::string>;

  /// Runs it to its end.
  Outcome run(const Arguments& arguments);

  /// Runs a script of sh, whose "$0" is the program.
  Outcome shell(const std::string& script);

  /// Sends `signal` as soon as the store has at least `files` checkpoint files.
  Outcome run_until(const Arguments& arguments, std::size_t files, int signal);

  /// One that runs beside the test; its output goes to files of its own.
  struct Running {
    pid_t pid = 0;
    std::filesystem::path out, err;
  };
  Running start_beside(const Arguments& arguments, const std::string& name);
  static Outcome wait_for(const Running& program);

  /// Leaves m.yaml and the store as `run m.yaml OPTIONS -q` does in an empty folder. Each campaign
  /// is computed once per build and shared by all test processes.
  void campaign(const std::string& manifest, const Arguments& options = {},
                const std::string& store = "shearcell-store");

  /// Output of a command that must succeed, read as JSON.
  nlohmann::json json(const Arguments& arguments);

  /// Writes a file in the folder and returns its name.
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return name;
  }

  /// The store that the program's environment names from here on; "" for none.
  void name_store(const std::string& store) { named_store_ = store; }

  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }

  /// Everything below the folder, and so whether something was written.
  std::set<std::string> listing() const;

  /// Checkpoint files of a store.
  std::size_t objects(const std::string& store = "shearcell-store") const;

  /// Run id -> state hash, from `status --json`.
  std::map<std::string, std::string> hashes(const std::string& store = "shearcell-store");

  /// File of the last checkpoint of a run, relative to the test's folder.
  std::string newest_file(const std::string& run, const std::string& store = "shearcell-store");

 private:
  Running start(const Arguments& arguments, const std::string& name = "",
                const char* executable = SHEARCELL_PROGRAM);

  TemporaryFolder folder_;
  std::string named_store_;
  TemporaryFolder outputs_;  // apart, so that they do not show in the listing
};

}  // namespace shearcell::test
