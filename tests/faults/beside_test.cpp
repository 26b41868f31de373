// SPDX-License-Identifier: GPL-3.0-or-later
// Commands that read a store while other programs write to it: none of them says that the store is
// damaged, and none fails.
#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <cstdio>
#include <map>
#include <thread>

#include "tests/experiments/temporary_store.hpp"
#include "tests/faults/campaign.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

/// Ten checkpoints in each cycle.
std::string manifest(std::size_t cycles) {
  return small_manifest("checkpoints: {phases: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]}\n",
                        cycles);
}

class Beside : public testing::Test {
 protected:
  Beside() {
    fs::create_directory(at("home"));
    write_bytes(at("home") / "small.yaml", manifest(4));
    Store store(at("home") / "store", Access::create);
    compute(store, manifest(4), {}, 1);
    Store other(at("other"), Access::create);
    compute(other, small_manifest("seeds: [2]\n"), {}, 1);
    run_ = store.stages().back().id;
  }

  fs::path at(const std::string& name) const { return folder_.path() / name; }

  /// Runs the commands in turn until the test stops them.
  void write(const std::string& name, const std::vector<Words>& commands) {
    for (std::size_t k = 0; !stopped_; ++k, ++written_) {
      Words words = commands[k % commands.size()];
      if (words[0] == "run") {
        words.insert(words.end(), {"--cycles", std::to_string(cycles_ += 2)});
      }
      const int code = run(name, words);
      // A merge is refused while a program computes.
      EXPECT_TRUE(code == 0 || (words[0] == "merge" && code == 1)) << said(name, words, code);
      fs::remove_all(at(name));
    }
  }

  void read_beside(const std::vector<std::vector<Words>>& writers, std::size_t repetitions) {
    stopped_ = false;
    written_ = 0;
    std::vector<std::thread> threads;
    for (const std::vector<Words>& commands : writers) {
      const std::string name = "writer" + std::to_string(threads.size());
      threads.emplace_back([this, name, commands] { write(name, commands); });
    }
    for (std::size_t k = 0; k < repetitions; ++k) {
      for (const Words& words : readers()) {
        const int code = run("reader", words);
        EXPECT_EQ(code, 0) << said("reader", words, code);
        fs::remove_all(at("reader"));
      }
    }
    stopped_ = true;
    for (std::thread& thread : threads) thread.join();
    std::printf("%zu readings beside %zu writings\n", repetitions * readers().size(),
                written_.load());
    for (const std::string& wrong : check_left_behind(at("home"), true)) ADD_FAILURE() << wrong;
  }

  std::vector<Words> readers() const {
    std::vector<Words> all = {{"status"},
                              {"table"},
                              {"log"},
                              {"log", run_},
                              {"show", run_},
                              {"verify"},
                              {"figures"},
                              {"report"},
                              {"plan", (at("home") / "small.yaml").string()},
                              {"doctor"},
                              {"merge", (at("home") / "store").string()}};
    for (const char* format : {"h5md", "extxyz", "vtk", "lammps", "contacts", "ro-crate"}) {
      all.push_back({"export", run_, "--to", format, "--out", "out"});
    }
    return all;
  }

  std::vector<Words> writers() const {
    return {{"run", (at("home") / "small.yaml").string(), "-q"},
            {"prune", "--keep-every", "4", "--yes"},
            {"regenerate", "--all"},
            {"merge", at("other").string()},
            {"figures"}};
  }

 private:
  /// Runs `shearcell WORDS` in a new folder on the store of the campaign; a reading merge, on a new
  /// store.
  int run(const std::string& name, const Words& words) const {
    fs::create_directory(at(name));
    const bool reads_other = words[0] == "merge" && words[1] != at("other");
    if (!reads_other) fs::create_directory_symlink(at("home") / "store", at(name) / "store");
    return wait_for_exit(start_program(at(name), words, {}));
  }

  std::string said(const std::string& name, const Words& words, int code) const {
    return testing::PrintToString(words) + " ends with " + std::to_string(code) + ": " +
           read_bytes(at(name) / "said") +
           (words[0] == "verify" ? read_bytes(at(name) / "printed") : "");
  }

  TemporaryFolder folder_;
  std::string run_;
  std::size_t cycles_ = 4;
  std::atomic<bool> stopped_ = false;
  std::atomic<std::size_t> written_ = 0;
};

TEST_F(Beside, EveryReaderBesideAllWriters) {
  std::vector<Words> others = writers();
  const Words run = others.front();
  others.erase(others.begin());
  read_beside({{run}, others}, 1);
}

// With the label `sweep`.
TEST_F(Beside, DISABLED_EveryReaderBesideEachWriterOften) {
  for (const Words& words : writers()) {
    SCOPED_TRACE(words[0]);
    read_beside({{words}}, 5);
    read_beside({{writers().front()}, {words}}, 5);
  }
}

}  // namespace
}  // namespace shearcell::test
