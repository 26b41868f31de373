// SPDX-License-Identifier: GPL-3.0-or-later
// Hostile manifests, hostile names that reach gnuplot, existing files and folders where the program
// writes, and a machine with few threads.
#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>

#include "core/machine.hpp"
#include "tests/experiments/damage.hpp"
#include "tests/experiments/program.hpp"
#include "tests/support/variable.hpp"

namespace shearcell::test {
namespace {

namespace fs = std::filesystem;

class HostileManifest : public ProgramTest {};

TEST_F(HostileManifest, TooManyGrainsForTheMemoryAreRejectedAtOnce) {
  if (machine_memory() > 60e9) GTEST_SKIP() << "this machine holds them";
  write("m.yaml", tiny_manifest("  grains: 100000000\n"));
  expect(3, {"run", "m.yaml"}, {"use fewer grains"});
}

/// Lines of `base`, the exit code of `plan`, and a part of what it says.
TEST_F(HostileManifest, ImpossibleParametersAreRejectedWithTheirLine) {
  struct Case {
    const char* base;
    int code;
    const char* says;
  };
  for (const auto& [base, code, says] :
       {Case{"fill_packing_fraction: 1e-5", 2, ":4:26: fill_packing_fraction: the cell for"},
        Case{"fill_packing_fraction: 1e-10", 2, ":4:26: base.fill_packing_fraction: is out"},
        Case{"nominal_packing_fraction: 1e-15", 2, ":4:29: base.nominal_packing_fraction: is out"},
        Case{"nominal_packing_fraction: 1e-6", 2, ":4:29: fill_packing_fraction: the random"},
        Case{"settle_time_step_s: 1e-18", 2, ":4:23: base.settle_time_step_s: is out of range"},
        Case{"settle_time_step_s: 1e-14", 2, ":4:23: settle_time_step_s: settling may need"},
        Case{"drag_kg_per_s: 1e-320", 0, "left: "}, Case{"gravity_m_per_s2: 1e-320", 0, "left: "},
        Case{"amplitude_rad: 1e-320", 0, "left: "},
        Case{"max_overlap_diameters: 1e-320", 0, "left: "},
        Case{"wall_mass_grains_per_d2: 1e-320", 0, "left: "},
        Case{"settle_force_tolerance: 1e-320", 0, "left: "},
        Case{"settle_time_limit_s: 1e-320", 0, "left: "},
        Case{"height_over_width: 100", 0, "left: "},
        Case{"cycles: 1000000\n  steps_per_cycle: 1000000000\n  grains: 100000000", 0,
             " years "}}) {
    SCOPED_TRACE(base);
    write("m.yaml", "experiment: a\n# Hard.\nbase:\n  " + std::string(base) + "\n");
    const Outcome outcome = expect(code, {"plan", "m.yaml"}, {says});
    for (const char* odd : {"-1537", "nan", "inf "}) {
      EXPECT_FALSE(has(outcome.out, odd));
    }
  }
}

class Outputs : public ProgramTest {
 protected:
  void SetUp() override {
    campaign(tiny_manifest("  grains: 200\n", kBothFluids), {"--cycles", "1"});
    id_ = last_run();
    fs::create_directories(path("out/tiny/base"));
  }

  void expect_in_the_way(const Arguments& command, const std::string& file) {
    const auto listed = [this] {  // measures are kept all the same
      auto files = listing();
      files.erase("shearcell-store/derived.sqlite");
      return files;
    };
    const auto before = listed();
    expect(2, command, {file, "--out"});
    EXPECT_EQ(listed(), before);
  }

  std::string id_;
};

TEST_F(Outputs, FiguresReplaceOnlyTheirOwnFiles) {
  const std::vector<std::string> figures = {"figures", "S2", "--out", "out"};
  for (const char* file :
       {"S2a.csv", "S2a.gp", "S2b.svg", "S2b.pdf", "S2.verdict.json", "S2.lineage.json"}) {
    const fs::path place = path(std::string("out/tiny/base/") + file);
    write_bytes(place, "{\"mine\": 1}\n");
    expect_in_the_way(figures, file);
    EXPECT_EQ(read_bytes(place), "{\"mine\": 1}\n");
    fs::remove(place);
    fs::create_symlink(path("m.yaml"), place);
    expect_in_the_way(figures, file);
    fs::remove(place);
  }
  expect(0, figures);
  expect(0, figures);                        // over those of an earlier call
  fs::remove(path("out/tiny/base/S2a.gp"));  // killed before it was drawn
  fs::remove(path("out/tiny/base/S2a.svg"));
  fs::remove(path("out/tiny/base/S2a.pdf"));
  expect(0, figures);
  for (const auto& entry : fs::recursive_directory_iterator(path("out"))) {
    if (entry.is_directory()) continue;
    struct stat status {};
    ASSERT_EQ(stat(entry.path().c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0133, 0U) << entry.path() << ": others may write it, or run it";
  }
}

TEST_F(Outputs, AReportReplacesOnlyAReport) {
  write("out/notes.html", "<!doctype html>\n<html>mine\n");
  fs::create_symlink(path("m.yaml"), path("out/link.html"));
  ASSERT_EQ(mkfifo(path("out/pipe.html").c_str(), 0600), 0);
  for (const char* taken : {"out/notes.html", "m.yaml", "out", "out/link.html", "out/pipe.html"}) {
    expect_in_the_way({"report", "--out", taken}, taken);
  }
  expect(0, {"report", "--out", "out/r.html"});
  expect(0, {"report", "--out", "out/r.html"});
}

TEST_F(Outputs, AnExportOverwritesNothing) {
  const std::string notes = "mine\n";
  write("out/notes", notes);
  fs::create_symlink(path("nowhere"), path("dangling"));
  for (const char* format : {"h5md", "extxyz", "vtk", "lammps", "ro-crate"}) {
    for (const char* place : {"out", "out/notes", "dangling", "m.yaml"}) {
      expect_refused({"export", id_, "--to", format, "--out", place}, {place});
    }
  }
  EXPECT_EQ(read_bytes(path("out/notes")), notes);
}

TEST_F(Outputs, AScaleOfAForgedStoreNamesNoFolder) {
  for (const std::string scale : {"../out", "/tmp/out", "a/b", "..", "x\ny"}) {
    SCOPED_TRACE(scale);
    fs::remove_all(path("shearcell-store"));
    campaign(tiny_manifest("", kBothFluids), {"--cycles", "1"});
    rebuilt(payload("RunDeclared", [&](nlohmann::json& body) {
      body["membership"]["scale"] = scale;
    }))(path("shearcell-store"));
    const auto before = listing();
    expect(4, {"figures", "S2", "--out", "in"}, {"a scale of the store", "cannot be a folder"});
    for (const std::string& file : listing()) {
      EXPECT_TRUE(before.contains(file) || file.ends_with("derived.sqlite")) << file;
    }
  }
}

/// A forged store can name its variants as it likes; the names reach gnuplot's script and the CSV.
TEST_F(Outputs, NamesOfAForgedStoreAreQuotedForGnuplot) {
  const std::string evil =
      "a'`touch owned`\"$(touch owned)\n!touch owned\r;system('touch owned')%s,"
      "{/:Bold x}\\";
  rebuilt(payload("RunDeclared", [&](nlohmann::json& body) {
    body["membership"]["variant"] = evil + body["membership"]["variant"].get<std::string>();
    body["membership"]["labels"] = {{evil, evil}};
  }))(path("shearcell-store"));
  expect(0, {"verify"});
  expect(0, {"figures", "S2", "--out", "out"});
  EXPECT_TRUE(fs::exists(path("out/tiny/base/S2a.svg")));
  expect(0, {"report", "--out", "r.html", "--drawings"});
  expect(0, {"export", id_, "--to", "ro-crate", "--out", "crate"});
  EXPECT_FALSE(has(run({"status"}).out, "\r"));
  for (const std::string& file : listing()) EXPECT_FALSE(has(file, "owned"));
}

/// Labels that gnuplot, XML or a shell could misread, through every program that draws.
TEST_F(Outputs, LabelsAreDrawnAsTheyAre) {
  write("q.yaml",
        tiny_manifest("", kBothFluids +
                              "labels: {\"fluid=still\": \"'at ''rest'']]>\", \"fluid=cell\": "
                              "'a`touch owned`{b}^c\\U+0041 $HOME \"d\"'}\n"));
  expect(0, {"run", "q.yaml", "-q", "--store", "labelled"});
  expect(0, {"figures", "S2", "--out", "drawn", "--store", "labelled"});
  const std::string svg = read_bytes(path("drawn/tiny/base/S2a.svg"));
  EXPECT_TRUE(has(svg, ">'at ''rest'']]&gt;<"));
  EXPECT_TRUE(has(svg, ">a`touch owned`{b}^c\\</tspan>"));
  EXPECT_TRUE(fs::exists(path("drawn/tiny/base/S2a.pdf")));
  expect(0, {"report", "--out", "l.html", "--drawings", "--store", "labelled"});
  for (const std::string& file : listing()) EXPECT_FALSE(has(file, "owned"));
}

TEST_F(Outputs, AFailedDrawingIsReported) {
  write("gnuplot", "#!/bin/sh\necho no paper >&2\nexit 3\n");
  fs::permissions(path("gnuplot"), fs::perms::owner_all);
  const Variable before("PATH", path("").string() + ":" + std::getenv("PATH"));
  for (const Arguments& command : {Arguments{"figures", "S2", "--out", "out"},
                                   Arguments{"report", "--out", "r.html", "--drawings"}}) {
    expect(1, command,
           {"tiny/S2: gnuplot could not draw S2a.svg: it ended with code 3", "no paper"});
  }
  EXPECT_TRUE(has(read_bytes(path("r.html")), "No drawing: gnuplot could not draw S2a.svg"));
  const auto facts = expect(1, {"report", "--out", "r.html", "--drawings", "--json"}).out;
  EXPECT_EQ(nlohmann::json::parse(facts).at("undrawn").size(), 2U);
  EXPECT_FALSE(has(expect(0, {"log"}).out, "FigureGenerated"));
}

/// gnuplot ends with code 0 even if it could not write the drawing.
TEST_F(Outputs, AFullFolderForTemporaryFilesLeavesNoCutDrawing) {
  for (const char* size : {"4k", "8k", "12k", "16k"}) {
    fs::create_directory(path(size));
    const Outcome drawn =
        shell(std::string("export size=") + size +
              " program=\"$0\"\nunshare -m true || exit 77\nexec unshare -m sh -c '"
              "mount -t tmpfs -o size=$size none $size || exit 77; export TMPDIR=$PWD/$size; "
              "exec \"$program\" figures S2 --out of-$size'");
    if (drawn.code == 77) GTEST_SKIP() << "only root mounts";
    std::printf("%s: code %d %s\n", size, drawn.code, drawn.err.c_str());
    const std::string svg = read_bytes(path(std::string("of-") + size + "/tiny/base/S2a.svg"));
    if (drawn.code == 0) {
      EXPECT_TRUE(has(svg, "</svg>"));
    } else {
      EXPECT_EQ(drawn.code, 1);
      EXPECT_TRUE(has(drawn.err, "No space left on device"));
      EXPECT_FALSE(has(expect(0, {"log"}).out, "FigureGenerated"));
    }
  }
}

/// An archived store gives its figures: cached measures are read, others are measured and not kept.
TEST_F(Outputs, FiguresOfAReadOnlyStoreAreThoseOfAWritableOne) {
  const std::string read_only =
      "export program=\"$0\"\nunshare -m true || exit 77\nexec unshare -m sh -c '"
      "mount --bind shearcell-store shearcell-store || exit 77; "
      "mount -o remount,bind,ro shearcell-store || exit 77; "
      "exec \"$program\" figures S2 --out ";
  const Outcome measured = shell(read_only + "measured'");
  if (measured.code == 77) GTEST_SKIP() << "only root mounts";
  EXPECT_EQ(measured.code, 0) << measured.err;
  EXPECT_TRUE(has(measured.err, "not recorded in the store: shearcell-store/store.sqlite: "));
  EXPECT_TRUE(has(measured.err, "measures cannot be cached: ")) << measured.err;
  EXPECT_FALSE(has(expect(0, {"log"}).out, "FigureGenerated"));
  expect(0, {"figures", "S2", "--out", "out"});
  const Outcome cached = shell(read_only + "cached'");
  EXPECT_EQ(cached.code, 0) << cached.err;
  EXPECT_FALSE(has(cached.err, "measures cannot be cached")) << cached.err;
  for (const char* file : {"S2a.csv", "S2.verdict.json", "S2.lineage.json"}) {
    for (const char* folder : {"measured", "cached"}) {
      EXPECT_EQ(read_bytes(path(std::string(folder) + "/tiny/base/" + file)),
                read_bytes(path(std::string("out/tiny/base/") + file)))
          << file;
    }
  }
}

class HostileMachine : public ProgramTest {};

TEST_F(HostileMachine, WithTooFewThreadsGivesTheSameBits) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer needs more addresses than this limit leaves";
#endif
  write("m.yaml", tiny_manifest("  grains: 100\n", kBothFluids));
  expect(0, {"run", "m.yaml", "-q", "-j", "1", "--store", "many"});
  // A stack of 1 GB for each thread that does not ask for another, and 6 GB of addresses.
  const Outcome few = shell(
      "ulimit -s 1048576 && ulimit -v 6291456 || exit 77\n"
      "exec \"$0\" run m.yaml -q -j 64 -t 64 --store few");
  if (few.code == 77) GTEST_SKIP() << "this user's limits are lower";
  EXPECT_EQ(few.code, 0) << few.err;
  EXPECT_EQ(hashes("few"), hashes("many"));
}

// No file is visible under its final name before it is complete: a reader at the same time, or a
// program that is killed, must not leave or find half of one.

/// What happens to names below a folder, whose folders exist already, while a program runs.
class NameWatch {
 public:
  explicit NameWatch(const fs::path& folder) {
    watch(folder);
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_directory()) watch(entry.path());
    }
  }
  ~NameWatch() { close(descriptor_); }
  NameWatch(const NameWatch&) = delete;
  NameWatch& operator=(const NameWatch&) = delete;

  /// File -> the events that happened to its name since the last call.
  std::map<fs::path, std::uint32_t> events() {
    std::map<fs::path, std::uint32_t> seen;
    alignas(inotify_event) std::array<char, 1 << 16> buffer{};
    for (ssize_t size = 0; (size = read(descriptor_, buffer.data(), buffer.size())) > 0;) {
      for (const char* at = buffer.data(); at < buffer.data() + size;) {
        inotify_event event{};
        std::memcpy(&event, at, sizeof(event));
        EXPECT_EQ(event.mask & IN_Q_OVERFLOW, 0U);
        if (event.len > 0) seen[folders_[event.wd] / (at + sizeof(event))] |= event.mask;
        at += sizeof(event) + event.len;
      }
    }
    return seen;
  }

 private:
  void watch(const fs::path& folder) {
    const int wd =
        inotify_add_watch(descriptor_, folder.c_str(), IN_CREATE | IN_MODIFY | IN_MOVED_TO);
    ASSERT_GE(wd, 0) << folder;
    folders_[wd] = folder;
  }

  int descriptor_ = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  std::map<int, fs::path> folders_;
};

class FinalNames : public ProgramTest {
 protected:
  void SetUp() override {
    campaign(tiny_manifest("  grains: 200\n", kBothFluids), {"--cycles", "3"});
    id_ = last_run();
  }

  /// Removes the files below `folder`, but keeps its folders.
  void clear(const std::string& folder) const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(path(folder))) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
    for (const fs::path& file : files) fs::remove(file);
  }

  /// Everything that there is at the end and that was touched came by a rename or a hard link.
  /// Returns how many there are.
  static std::size_t expect_whole(NameWatch& watch) {
    std::size_t files = 0;
    for (const auto& [file, mask] : watch.events()) {
      if (!fs::exists(file) || has(file.filename().string(), ".sqlite")) {
        continue;  // a temporary name; a database
      }
      ++files;
      EXPECT_EQ(mask & IN_MODIFY, 0U) << file << " was written under its name";
      if ((mask & IN_MOVED_TO) != 0) continue;
      EXPECT_TRUE(fs::is_regular_file(file)) << file << " is a folder that was made empty";
    }
    return files;
  }

  std::string id_;
};

TEST_F(FinalNames, AreGivenToCompleteFilesAndFolders) {
  for (const Arguments& command :
       std::vector<Arguments>{{"export", id_, "--to", "extxyz", "--out", "out/e.xyz"},
                              {"export", id_, "--to", "h5md", "--out", "out/e.h5md"},
                              {"export", id_, "--to", "vtk", "--out", "out/vtk"},
                              {"export", id_, "--to", "lammps", "--out", "out/lammps"},
                              {"export", id_, "--to", "ro-crate", "--out", "out/crate"},
                              {"new", "out/n.yaml"}}) {
    SCOPED_TRACE(command.back());
    fs::create_directories(path("out"));
    NameWatch watch(path("out"));
    expect(0, command);
    EXPECT_EQ(expect_whole(watch), 1U);
    fs::remove_all(path("out"));
  }
}

TEST_F(FinalNames, OfExistingFilesAreGivenToCompleteFiles) {
  struct Case {
    Arguments command;
    std::size_t files;
  };
  for (const auto& [command, files] : std::vector<Case>{{{"figures", "S2", "--out", "out/f"}, 12},
                                                        {{"table", "--out", "out/t.csv"}, 1},
                                                        {{"report", "--out", "out/r.html"}, 1}}) {
    SCOPED_TRACE(command.front());
    fs::create_directories(path("out"));
    expect(0, command);  // which leaves the folders to watch
    NameWatch watch(path("out"));
    expect(0, command);
    EXPECT_EQ(expect_whole(watch), files) << "over its own files";
    clear("out");
    watch.events();
    expect(0, command);
    EXPECT_EQ(expect_whole(watch), files) << "where there were none";
    fs::remove_all(path("out"));
  }
}

TEST_F(FinalNames, AreGivenToCompleteCheckpoints) {
  Arguments again = {"regenerate"};
  const nlohmann::json pruning = json({"prune", "--keep-every", "2", "--yes", "--json"});
  for (const auto& pruned : pruning.at("checkpoints")) {
    again.push_back(pruned["sha256"]);
  }
  NameWatch watch(path("shearcell-store"));
  expect(0, again);
  EXPECT_EQ(expect_whole(watch), again.size() - 1);
}

}  // namespace
}  // namespace shearcell::test
