// SPDX-License-Identifier: GPL-3.0-or-later
// The commands of provenance/README.md, "Reading it by hand", give its output. They do not use this
// program.
#include <gtest/gtest.h>

#include <cstdio>
#include <sstream>

#include "provenance/io/child_process.hpp"
#include "tests/provenance/lineage_samples.hpp"

namespace shearcell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): the helpers of these tests

namespace fs = std::filesystem;

/// The indented blocks of the section.
std::string commands_of_the_readme() {
  std::istringstream readme(
      read_bytes(fs::path(SHEARCELL_TEST_DATA) / "../../provenance/README.md"));
  std::string commands;
  bool inside = false;
  for (std::string line; std::getline(readme, line);) {
    if (line.starts_with("## ")) inside = line == "## Reading it by hand";
    if (inside && line.starts_with("    ")) commands += line.substr(4) + "\n";
  }
  return commands;
}

/// Debian's python3, which has h5py, may come after another one on PATH.
ProgramOutcome run_script(const std::string& script) {
  return run_program({"sh", "-euc", "PATH=/usr/bin:$PATH\n" + script}, "/").value();
}

TEST(WorkedExample, CommandsOfTheReadmeGiveItsOutput) {
  for (const char* tool : {"sqlite3 -version", "h5dump --version", "sha256sum --version",
                           "python3 -c 'import h5py'"}) {
    if (run_script(tool).code != 0) GTEST_SKIP() << "this machine has no " << tool;
  }
  const TemporaryFolder folder;
  Store store(folder.path() / "store", Access::create);
  const SampleHistory history(store);
  const auto [code, output, messages] =
      run_script("cd '" + store.folder().string() + "'\n" + commands_of_the_readme());
  std::printf("%.*s\n", 1500, output.c_str());
  ASSERT_EQ(code, 0) << output << messages;

  std::istringstream lines(output);
  std::string computed, recorded;
  std::getline(lines, computed);
  std::getline(lines, recorded);
  EXPECT_EQ(recorded, store.events().at(3).hash);
  EXPECT_EQ(computed.substr(0, 64), recorded) << "the hash of event 4";
  for (const std::string& run : {history.packing, history.sheared}) {
    for (const CheckpointRecord& record : store.checkpoints(run, Listed::all)) {
      EXPECT_TRUE(has(output, record.file + ": OK")) << record.file;
    }
  }
  const std::string frame = "sha256 of all bytes after the first 512: ";
  const std::size_t at = output.find(frame);
  ASSERT_NE(at, std::string::npos);
  const std::string promised = output.substr(at + frame.size(), 64);
  EXPECT_TRUE(is_sha256_hex(promised)) << promised;
  EXPECT_TRUE(has(output, promised + "  -")) << "the frame and sha256sum differ";
  EXPECT_TRUE(has(output, "ATTRIBUTE \"step\"")) << "h5dump";
  EXPECT_TRUE(has(output, "DATASET \"/particles/all/position/value\""));
}

}  // namespace
}  // namespace shearcell
