// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the built program in a temporary folder and checks its exit code, output and files.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/experiments/temporary_store.hpp"
#include "tests/support/text.hpp"

namespace shearcell::test {

struct Outcome {
  int code = -1;   ///< exit code; -1 if a signal ended it
  int signal = 0;  ///< that ended it; 0 if none
  std::string out;
  std::string err;
};

/// Where a function was called. clang 14 has no std::source_location.
struct CallPlace {
  const char* file;
  int line;
  static CallPlace here(const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    return {file, line};
  }
};

/// "run m.yaml -q" as three arguments.
inline std::vector<std::string> split(const std::string& line) {
  std::istringstream words(line);
  return {std::istream_iterator<std::string>(words), {}};
}

/// The words of both.
inline std::vector<std::string> joined(std::vector<std::string> words,
                                       const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

class ProgramTest : public testing::Test {
 protected:
  using Arguments = std::vector<std::string>;

  /// Runs it to its end.
  Outcome run(const Arguments& arguments);

  /// Runs a command that must end with this code and print each of `says`, on either stream.
  Outcome expect(int code, const Arguments& arguments, const std::vector<std::string>& says = {},
                 CallPlace where = CallPlace::here());

  /// A bad command line must end with code 2, print to standard error only, and write no file.
  void expect_refused(const Arguments& arguments, const std::vector<std::string>& says,
                      CallPlace where = CallPlace::here());

  /// Runs a script of sh, whose "$0" is the program.
  Outcome shell(const std::string& script);

  /// Sends `signal` as soon as the store has at least `files` checkpoint files.
  Outcome run_until(const Arguments& arguments, std::size_t files, int signal);

  /// A program that runs while the test continues; its output goes to files of its own.
  struct Running {
    pid_t pid = 0;
    std::filesystem::path out, err;
  };
  Running start_beside(const Arguments& arguments, const std::string& name);
  static Outcome wait_for(const Running& program);

  /// Waits until this is on its standard error, at most as long as wait_for().
  static void wait_for_words(const Running& program, const std::string& words);

  /// Copies to `place` what `make` writes to an empty folder. `make` runs once per build; all test
  /// processes share the result.
  void shared(const std::string& identity, const std::string& place,
              const std::function<void(const std::string& folder)>& make);

  /// Writes m.yaml and the store that `run m.yaml OPTIONS -q` makes in an empty folder; shared.
  void campaign(const std::string& manifest, const Arguments& options = {},
                const std::string& store = "shearcell-store");

  /// Runs a command that must succeed and parses its output as JSON.
  nlohmann::json json(const Arguments& arguments);

  /// Writes a file in the folder and returns its name.
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return name;
  }

  /// Sets SHEARCELL_STORE for the programs started from here on; "" unsets it.
  void name_store(const std::string& store) { named_store_ = store; }

  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }

  /// All paths below the folder, relative to it.
  std::set<std::string> listing() const;

  /// Checkpoint files of a store.
  std::size_t objects(const std::string& store = "shearcell-store") const;

  /// Run id -> state hash, from `status --json`.
  std::map<std::string, std::string> hashes(const std::string& store = "shearcell-store");

  /// Id of the run that was declared last, which shears.
  std::string last_run() const {
    return Store(path("shearcell-store"), Access::read).stages().back().id;
  }

  /// File of the last checkpoint of a run, relative to the test's folder.
  std::string newest_file(const std::string& run) const {
    const Store store(path("shearcell-store"), Access::read);
    return "shearcell-store/" + store.checkpoints(run).back().file;
  }

  /// The subcommands that the program's help lists.
  std::vector<std::string> commands();

  /// Waits until the store has that many checkpoint files.
  void wait_for_objects(std::size_t files, const std::string& store = "shearcell-store") const;

 private:
  Running start(const Arguments& arguments, const std::string& name = "",
                const char* executable = SHEARCELL_PROGRAM);

  TemporaryFolder folder_;
  std::string named_store_;
  TemporaryFolder outputs_;  // not in folder_, which listing() shows
};

}  // namespace shearcell::test
