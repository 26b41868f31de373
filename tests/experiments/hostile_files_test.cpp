// SPDX-License-Identifier: GPL-3.0-or-later
// Hostile manifests through the program, hostile names that reach gnuplot, and what stands in the
// way of the files that the program writes; and a machine that lends little.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <sstream>

#include "core/memory.hpp"
#include "provenance/event_log.hpp"
#include "tests/experiments/program.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

class HostileManifest : public ProgramTest {};

TEST_F(HostileManifest, MoreGrainsThanTheMachineHoldsAreRefusedBeforeTheyAreMade) {
  if (machine_memory() > 60e9) GTEST_SKIP() << "this machine holds them";
  write("m.yaml", tiny_manifest("  grains: 100000000\n"));
  const Outcome outcome = run({"run", "m.yaml"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_NE(outcome.err.find("use fewer grains"), std::string::npos) << outcome.err;
}

/// Lines of `base`, the exit code of `plan`, and a part of what it says.
TEST_F(HostileManifest, ParametersThatCannotBeComputedAreRefusedWithTheirLine) {
  struct Case {
    const char* base;
    int code;
    const char* says;
  };
  for (const auto& [base, code, says] :
       {Case{"fill_packing_fraction: 1e-5", 2, ":4:26: fill_packing_fraction: the cell for"},
        Case{"fill_packing_fraction: 1e-10", 2, ":4:26: base.fill_packing_fraction: is out"},
        Case{"fill_packing_fraction: 1e-300", 2, ":4:26: base.fill_packing_fraction: is out"},
        Case{"nominal_packing_fraction: 1e-15", 2, ":4:29: base.nominal_packing_fraction: is out"},
        Case{"nominal_packing_fraction: 1e-6", 2, ":4:29: nominal_packing_fraction: the grains"},
        Case{"settle_time_step_s: 1e-18", 2, ":4:23: base.settle_time_step_s: is out of range"},
        Case{"settle_time_step_s: 5e-324", 2, ":4:23: base.settle_time_step_s: is out of range"},
        Case{"settle_time_step_s: 1e-14", 2, ":4:23: settle_time_step_s: settling takes up to"},
        Case{"period_s: 1e-320", 2, ":4:13: period_s: the parameters are so far apart"},
        Case{"mass_kg: 1e-320", 2, ":4:12: mass_kg: the parameters are so far apart"},
        Case{"diameter_m: 1e-320", 2, ":4:15: diameter_m: the parameters are so far apart"},
        Case{"stiffness_N_per_m: 1e-320", 2, ":4:22: stiffness_N_per_m: the parameters"},
        Case{"pressure_Pa: 4.9e-324", 2, ":4:16: pressure_Pa: the parameters are so far apart"},
        Case{"drag_kg_per_s: 1e-320", 0, "left: "},
        Case{"gravity_m_per_s2: 1e-320", 0, "left: "},
        Case{"amplitude_rad: 1e-320", 0, "left: "},
        Case{"max_overlap_diameters: 1e-320", 0, "left: "},
        Case{"wall_mass_grains_per_d2: 1e-320", 0, "left: "},
        Case{"settle_force_tolerance: 1e-320", 0, "left: "},
        Case{"settle_time_limit_s: 1e-320", 0, "left: "},
        Case{"height_over_width: 100", 0, "left: "},
        Case{"cycles: 1000000\n  steps_per_cycle: 1000000000\n  grains: 100000000", 0, " years "},
        Case{"protocol: paused\n  pause_s: 1e6", 2, ":5:12: pause_s: the pause takes"},
        Case{"grains: 1", 2, ":4:11: grains: the cell for so few grains"}}) {
    SCOPED_TRACE(base);
    write("m.yaml", "experiment: a\n# Hard.\nbase:\n  " + std::string(base) + "\n");
    const Outcome outcome = run({"plan", "m.yaml"});
    EXPECT_EQ(outcome.code, code) << outcome.err;
    EXPECT_NE((outcome.out + outcome.err).find(says), std::string::npos)
        << outcome.out << outcome.err;
    for (const char* odd : {"-1537", "nan", "inf "}) {
      EXPECT_EQ(outcome.out.find(odd), std::string::npos) << outcome.out;
    }
  }
}

class Outputs : public ProgramTest {
 protected:
  void SetUp() override {
    campaign(tiny_manifest("  grains: 200\n", kBothFluids), {"--cycles", "1"});
    id_ = json({"status", "--json"})["runs"].back()["id"];
    fs::create_directories(path("out/tiny"));
  }

  void expect_refused(const std::vector<std::string>& command, const std::string& file) {
    const auto listed = [this] {  // measures are kept all the same
      auto files = listing();
      files.erase("shearcell-store/derived.sqlite");
      return files;
    };
    const auto before = listed();
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 2) << file << outcome.err;
    EXPECT_NE(outcome.err.find(file), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("--out"), std::string::npos) << outcome.err;
    EXPECT_EQ(listed(), before);
  }

  std::string id_;
};

TEST_F(Outputs, FiguresReplaceTheirOwnFilesAndNoOthers) {
  const std::vector<std::string> figures = {"figures", "S2", "--out", "out"};
  for (const char* file :
       {"S2a.csv", "S2a.gp", "S2b.svg", "S2b.pdf", "S2.verdict.json", "S2.lineage.json"}) {
    write(std::string("out/tiny/") + file, "{\"mine\": 1}\n");
    expect_refused(figures, file);
    EXPECT_EQ(read_bytes(path(std::string("out/tiny/") + file)), "{\"mine\": 1}\n");
    fs::remove(path(std::string("out/tiny/") + file));
    fs::create_symlink(path("m.yaml"), path(std::string("out/tiny/") + file));
    expect_refused(figures, file);
    fs::remove(path(std::string("out/tiny/") + file));
  }
  ASSERT_EQ(run(figures).code, 0);
  EXPECT_EQ(run(figures).code, 0) << "made by an earlier call";
  fs::remove(path("out/tiny/S2a.gp"));  // killed before it was drawn
  fs::remove(path("out/tiny/S2a.svg"));
  fs::remove(path("out/tiny/S2a.pdf"));
  EXPECT_EQ(run(figures).code, 0);
  for (const auto& entry : fs::recursive_directory_iterator(path("out"))) {
    if (entry.is_directory()) continue;
    struct stat status {};
    ASSERT_EQ(stat(entry.path().c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0133, 0U) << entry.path() << ": others may write it, or run it";
  }
}

TEST_F(Outputs, AReportReplacesAReportAndNothingElse) {
  write("out/notes.html", "<!doctype html>\n<html>mine\n");
  expect_refused({"report", "--out", "out/notes.html"}, "notes.html");
  expect_refused({"report", "--out", "m.yaml"}, "m.yaml");
  expect_refused({"report", "--out", "out"}, "out");
  fs::create_symlink(path("m.yaml"), path("out/link.html"));
  expect_refused({"report", "--out", "out/link.html"}, "link.html");
  ASSERT_EQ(mkfifo(path("out/pipe.html").c_str(), 0600), 0);
  expect_refused({"report", "--out", "out/pipe.html"}, "pipe.html");
  ASSERT_EQ(run({"report", "--out", "out/r.html"}).code, 0);
  EXPECT_EQ(run({"report", "--out", "out/r.html"}).code, 0);
}

TEST_F(Outputs, AnExportIsNeverWrittenOverAnything) {
  const std::string notes = "mine\n";
  write("out/notes", notes);
  fs::create_symlink(path("nowhere"), path("dangling"));
  for (const char* format : {"h5md", "extxyz", "vtk", "lammps", "ro-crate"}) {
    for (const char* place : {"out", "out/notes", "dangling", "m.yaml"}) {
      const auto before = listing();
      EXPECT_EQ(run({"export", id_, "--to", format, "--out", place}).code, 2) << format << place;
      EXPECT_EQ(listing(), before);
    }
  }
  EXPECT_EQ(read_bytes(path("out/notes")), notes);
}

/// A forged store can name its variants as it likes; the names reach gnuplot's script and the CSV.
TEST_F(Outputs, NamesOfAForgedStoreAreTextToGnuplot) {
  const std::string evil =
      "a'`touch owned`\"$(touch owned)\n!touch owned\r;system('touch owned')%s,"
      "{/:Bold x}\\";
  {
    Store store(path("shearcell-store"), Access::write);
    std::vector<Event> events = store.events();
    sqlite::Database log(path("shearcell-store/store.sqlite"), sqlite::Open::existing);
    log.execute("DROP TRIGGER events_are_never_updated");
    std::string prev(64, '0');
    for (Event& event : events) {
      nlohmann::json body = event.body();
      if (event.type == "RunDeclared") {
        body["membership"]["variant"] = evil + body["membership"]["variant"].get<std::string>();
        body["membership"]["labels"] = {{evil, evil}};
      }
      event.payload = body.dump();
      event.prev_hash = prev;
      prev = event.hash = event_hash(event);
      sqlite::Statement update(
          log, "UPDATE events SET payload = ?, prev_hash = ?, hash = ? WHERE seq = ?");
      update.bind(1, event.payload).bind(2, event.prev_hash).bind(3, event.hash);
      update.bind(4, event.seq).run();
    }
    store.rebuild();
  }
  EXPECT_EQ(run({"verify"}).code, 0);
  const Outcome figures = run({"figures", "S2", "--out", "out"});
  EXPECT_EQ(figures.code, 0) << figures.err;
  EXPECT_TRUE(fs::exists(path("out/tiny/S2a.svg")));
  EXPECT_EQ(run({"report", "--out", "r.html", "--drawings"}).code, 0);
  EXPECT_EQ(run({"export", id_, "--to", "ro-crate", "--out", "crate"}).code, 0);
  EXPECT_EQ(run({"status"}).out.find('\r'), std::string::npos);
  for (const std::string& file : listing()) {
    EXPECT_EQ(file.find("owned"), std::string::npos) << file;
  }
}

/// A limit on this process and those it starts, until it goes.
class Limit {
 public:
  using Resource = decltype(RLIMIT_AS);

  Limit(Resource resource, rlim_t value) : resource_(resource) {
    getrlimit(resource_, &before_);
    const rlimit now{value, before_.rlim_max};
    set_ = value <= before_.rlim_max && setrlimit(resource_, &now) == 0;
  }
  ~Limit() { setrlimit(resource_, &before_); }
  Limit(const Limit&) = delete;
  Limit& operator=(const Limit&) = delete;
  bool set() const { return set_; }

 private:
  Resource resource_;
  rlimit before_{};
  bool set_ = false;
};

class HostileMachine : public ProgramTest {};

TEST_F(HostileMachine, ThatLendsFewThreadsGivesTheSameBits) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer needs more addresses than this limit leaves";
#endif
  write("m.yaml", tiny_manifest("  grains: 100\n", kBothFluids));
  ASSERT_EQ(run({"run", "m.yaml", "-q", "-j", "1", "--store", "many"}).code, 0);
  {
    const Limit stack(RLIMIT_STACK, rlim_t{1} << 30);  // of a thread, unless it asks for another
    const Limit addresses(RLIMIT_AS, rlim_t{6} << 30);
    if (!stack.set() || !addresses.set()) GTEST_SKIP() << "this user's limits are lower";
    const Outcome outcome = run({"run", "m.yaml", "-q", "-j", "64", "-t", "64", "--store", "few"});
    EXPECT_EQ(outcome.code, 0) << "signal " << outcome.signal << ": " << outcome.err;
  }
  EXPECT_EQ(hashes("few"), hashes("many"));
}

}  // namespace
}  // namespace shearcell::test
