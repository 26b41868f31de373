// SPDX-License-Identifier: GPL-3.0-or-later
// The commands of provenance/README.md, "Reading it by hand", do what it says: none of them uses
// this program.
#include <gtest/gtest.h>

#include <cstdio>
#include <sstream>

#include "tests/provenance/lineage_samples.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;

/// The indented blocks of the section.
std::string commands_of_the_readme() {
  std::istringstream readme(
      test::read_bytes(fs::path(SHEARCELL_TEST_DATA) / "../../provenance/README.md"));
  std::string commands;
  bool inside = false;
  for (std::string line; std::getline(readme, line);) {
    if (line.starts_with("## ")) inside = line == "## Reading it by hand";
    if (inside && line.starts_with("    ")) commands += line.substr(4) + "\n";
  }
  return commands;
}

std::string output_of(const std::string& script, int& status) {
  FILE* pipe = popen(("PATH=/usr/bin:$PATH sh -eu '" + script + "' 2>&1").c_str(), "r");
  std::string text;
  for (int c = 0; pipe != nullptr && (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  status = pipe == nullptr ? -1 : pclose(pipe);
  return text;
}

bool has(const std::string& command) {
  return std::system(("PATH=/usr/bin:$PATH; " + command + " > /dev/null 2>&1").c_str()) == 0;
}

TEST(WorkedExample, CommandsOfTheReadmeDoWhatItSays) {
  for (const char* tool : {"sqlite3 -version", "h5dump --version", "sha256sum --version",
                           "python3 -c 'import h5py'"}) {
    if (!has(tool)) GTEST_SKIP() << "this machine has no " << tool;
  }
  const TemporaryFolder folder;
  Store store(folder.path() / "store", Access::create);
  const test::SampleHistory history(store);
  const fs::path script = folder.path() / "script";
  test::write_bytes(script, "cd '" + store.folder().string() + "'\n" + commands_of_the_readme());
  int status = 0;
  const std::string output = output_of(script.string(), status);
  std::printf("%.*s\n", 1500, output.c_str());
  ASSERT_EQ(status, 0) << output;

  std::istringstream lines(output);
  std::string computed, recorded;
  std::getline(lines, computed);
  std::getline(lines, recorded);
  EXPECT_EQ(recorded, store.events().at(3).hash);
  EXPECT_EQ(computed.substr(0, 64), recorded) << "the hash of event 4";
  for (const std::string& run : {history.packing, history.sheared}) {
    for (const CheckpointRecord& record : store.checkpoints(run, Listed::all)) {
      EXPECT_NE(output.find(record.file + ": OK"), std::string::npos) << record.file;
    }
  }
  const std::string frame = "sha256 of all bytes after the first 512: ";
  const std::size_t at = output.find(frame);
  ASSERT_NE(at, std::string::npos);
  const std::string promised = output.substr(at + frame.size(), 64);
  EXPECT_TRUE(is_sha256_hex(promised)) << promised;
  EXPECT_NE(output.find(promised + "  -"), std::string::npos) << "the frame and sha256sum differ";
  EXPECT_NE(output.find("ATTRIBUTE \"step\""), std::string::npos) << "h5dump";
  EXPECT_NE(output.find("DATASET \"/particles/all/position/value\""), std::string::npos);
}

}  // namespace
}  // namespace shearcell
