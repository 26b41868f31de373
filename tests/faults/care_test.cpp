// SPDX-License-Identifier: GPL-3.0-or-later
// The commands that change what is kept survive what campaigns survive: after any fault the store
// is sound, and the same command again does what it would have done.
#include <gtest/gtest.h>
#include <signal.h>

#include <cstdio>
#include <set>

#include "provenance/schema.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/faults/campaign.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

/// States of runs and checkpoints, and the files that are there.
std::set<std::string> facts(const fs::path& folder) {
  std::set<std::string> found;
  const Store store(folder / "store", Access::read);
  for (const RunRecord& run : store.runs()) {
    found.insert(run.id + " " + name_of(run.state) + " " + run.state_hash);
    for (const CheckpointRecord& record : store.checkpoints(run.id, true)) {
      found.insert(record.sha256 + " " + name_of(record.state));
    }
  }
  for (const auto& entry : fs::recursive_directory_iterator(folder / "store" / "objects")) {
    if (entry.path().extension() == ".h5") found.insert(entry.path().filename());
  }
  return found;
}

class CareUnderFaults : public testing::Test {
 protected:
  CareUnderFaults() {
    for (const char* name : {"campaign", "other"}) {
      fs::create_directory(at(name));
      std::ofstream(at(name) / "small.yaml")
          << small_manifest(std::string(name) == "other" ? "seeds: [2]\n" : "");
      run_on(at(name));
    }
    fs::create_directory(at("pruned"));
    fs::copy(at("campaign"), at("pruned"), fs::copy_options::recursive);
    Store store(at("pruned") / "store", Access::write);
    const auto chosen = store.prunable({});
    sha256_ = chosen.at(0).sha256;
    store.prune(chosen);
    fs::create_directory(at("old"));
    fs::copy(fs::path(SHEARCELL_TEST_DATA) / "store_v1", at("old") / "store",
             fs::copy_options::recursive);
  }

  fs::path at(const std::string& name) const { return folder_.path() / name; }

  /// The command, on a copy of a folder, with every `every`-th of its fault points.
  void sweep(const std::string& base, const Words& words, std::size_t every) {
    const auto copy = [&](const TemporaryFolder& into) {
      fs::copy(at(base), into.path(), fs::copy_options::recursive);
    };
    const TemporaryFolder whole;
    copy(whole);
    const auto operations = list_operations(whole.path(), words);
    const auto golden = facts(whole.path());
    const std::vector<Fault> all = fault_points(operations);
    std::size_t tried = 0;
    for (std::size_t i = 0; i < all.size() && !HasFailure(); i += every, ++tried) {
      const TemporaryFolder folder;
      copy(folder);
      const int code = wait_for_exit(start_program(folder.path(), words, all[i]));
      const std::string where = words[0] + ": " + all[i].kind + " at " +
                                operations.at(static_cast<std::size_t>(all[i].at - 1));
      EXPECT_TRUE(code >= 0 || code == -SIGKILL) << where << ": signal " << -code;
      for (const std::string& wrong : check_left_behind(folder.path())) {
        ADD_FAILURE() << where << " (ended with " << code << "): " << wrong;
      }
      EXPECT_EQ(wait_for_exit(start_program(folder.path(), words, {})), 0)
          << where << ": again: " << read_bytes(folder.path() / "said");
      EXPECT_EQ(facts(folder.path()), golden) << where;
      EXPECT_TRUE(Store(folder.path() / "store", Access::read).verify().ok()) << where;
    }
    std::printf("%s: %zu of %zu fault points (%zu operations)\n", words[0].c_str(), tried,
                all.size(), operations.size());
  }

  void sweep_all(std::size_t every) {
    sweep("campaign", {"prune", "--keep-every", "2", "--yes"}, every);
    sweep("pruned", {"regenerate", sha256_}, every);
    sweep("campaign", {"merge", (at("other") / "store").string()}, every);
    sweep("pruned", {"rebuild"}, every);
    sweep("old", {"resume", "-q"}, every);
  }

  TemporaryFolder folder_;
  std::string sha256_;
};

TEST_F(CareUnderFaults, AtSomePointsIsDoneByTheSameCommandAgain) {
  sweep_all(45);
}

// With the label `sweep`.
TEST_F(CareUnderFaults, DISABLED_AtEveryPointIsDoneByTheSameCommandAgain) {
  sweep_all(1);
}

}  // namespace
}  // namespace shearcell::test
